use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::bounds::{self, Bounds};
use veduta_ecs::{City, CityOpened, Eye, Rim};

/// What is seen beyond the city's edge, where streets end at blind portals. Live.
#[derive(Resource, Debug, Clone, Default, PartialEq)]
pub enum Backdrop {
    /// The picture that travels with the city, `X.backdrop.png`; of a city without one roofs and hills in haze, as high as its own
    /// rise near its edge ([`Rim`]).
    #[default]
    OfCity,
    /// A picture of all that is round about: its left edge is north, then clockwise, and its lower edge lies on the horizon. It is as
    /// high as its shape says, of full turns; where it lets through, the sky is seen.
    Picture(Handle<Image>),
    /// Nothing, for a game with a landscape of its own there.
    None,
}

/// The picture that travels with the open city.
#[derive(Resource, Debug, Default)]
pub(crate) struct OwnPicture(Option<Handle<Image>>);

/// Asks for the picture of a city that opens.
pub(crate) fn open(
    mut opened: MessageReader<CityOpened>,
    city: Option<Res<City>>,
    assets: Res<AssetServer>,
    mut own: ResMut<OwnPicture>,
) {
    if opened.read().count() == 0 {
        return;
    }
    own.0 = city.and_then(|city| city.file(".backdrop.png")).map(|path| {
        // Another city's file may have had the same name.
        assets.reload(path.clone());
        assets.load(path)
    });
}

/// The picture to be shown, once it is here, and how high it is, radians.
pub(crate) fn picture<'a>(backdrop: &'a Backdrop, own: &'a OwnPicture, images: &Assets<Image>) -> Option<(&'a Handle<Image>, f32)> {
    let handle = match backdrop {
        Backdrop::OfCity => own.0.as_ref(),
        Backdrop::Picture(handle) => Some(handle),
        Backdrop::None => None,
    }?;
    let size = images.get(handle)?.size_f32();
    Some((handle, core::f32::consts::TAU * size.y / size.x.max(1.0)))
}

/// What is made up stands so far beyond the city's edge, metres: too far for anything of a house to be told but its outline.
const BEYOND_M: f64 = 600.0;
/// It rises so much with every metre to it at least, also for who looks from above: so that the horizon is no ruled line.
const LEAST: f64 = 0.006;
/// Where a viewer is counts in steps of so many metres, across and up: less is not seen at that distance.
const STEP_M: DVec2 = DVec2::new(16.0, 2.0);

/// How much the backdrop rises with every metre to it, by direction as in [`Rim`], in fours; zero where no city is open.
pub(crate) type Slopes = [Vec4; Rim::DIRECTIONS / 4];

/// The backdrop of a city, as an eye sees it.
pub(crate) fn slopes(city: &City, eye: &Eye) -> Slopes {
    let (Some(tops_m), Some(edge)) = (city.rim.tops_m, bounds::around(&city.extent.outer)) else { return Slopes::default() };
    let pos = (eye.plan_pos / STEP_M.x).round() * STEP_M.x;
    let z_m = (eye.z_m() / STEP_M.y).round() * STEP_M.y;
    let slope = |direction: usize| {
        let (sin, cos) = (core::f64::consts::TAU * direction as f64 / Rim::DIRECTIONS as f64).sin_cos();
        let away_m = way_out_m(edge, pos, DVec2::new(sin, cos)) + BEYOND_M;
        ((tops_m[direction] - z_m).max(0.0) / away_m + LEAST) as f32
    };
    core::array::from_fn(|four| Vec4::from_array(core::array::from_fn(|n| slope(4 * four + n))))
}

/// Metres from a place in a box to its border, in a direction of length 1; 0 from outside.
fn way_out_m((low, high): Bounds, pos: DVec2, direction: DVec2) -> f64 {
    let (low, high) = (low.to_metres(), high.to_metres());
    let out = |low: f64, high: f64, pos: f64, way: f64| match way {
        east if east > 1e-9 => (high - pos) / way,
        west if west < -1e-9 => (low - pos) / way,
        _ => f64::INFINITY,
    };
    out(low.x, high.x, pos.x, direction.x).min(out(low.y, high.y, pos.y, direction.y)).max(0.0)
}

#[cfg(test)]
mod tests {
    use veduta_city::{GridPolygon, GridPos};

    use super::*;

    fn city() -> City {
        let corner = |x: f64, y: f64| GridPos::from_metres(DVec2::new(x, y));
        let outer = vec![corner(0.0, 0.0), corner(1000.0, 0.0), corner(1000.0, 400.0), corner(0.0, 400.0)];
        let mut tops_m = [30.0; Rim::DIRECTIONS];
        tops_m[8] = 61.65;
        City { extent: GridPolygon { outer, holes: Vec::new() }, rim: Rim { tops_m: Some(tops_m) }, ..City::default() }
    }

    fn slope(eye: &Eye, direction: usize) -> f64 {
        f64::from(slopes(&city(), eye)[direction / 4][direction % 4])
    }

    #[test]
    fn it_rises_as_the_city_does_and_as_one_comes_near() {
        let eye = Eye { plan_pos: DVec2::new(800.0, 192.0), ..Eye::default() };
        assert!((slope(&eye, 8) - (61.65 - 2.0) / 800.0 - LEAST).abs() < 1e-3, "to the east");
        assert!((slope(&eye, 24) - 28.0 / 1400.0 - LEAST).abs() < 1e-3, "to the west");
        assert!((slope(&eye, 0) - 28.0 / 808.0 - LEAST).abs() < 1e-3, "to the north");
        let nearer = Eye { plan_pos: DVec2::new(992.0, 192.0), ..eye };
        assert!(slope(&nearer, 8) > slope(&eye, 8) && slope(&nearer, 24) < slope(&eye, 24));
        let above = Eye { eye_m: 200.0, ..eye };
        assert!((slope(&above, 8) - LEAST).abs() < 1e-6, "whoever looks from above looks over it");
        let outside = Eye { plan_pos: DVec2::new(2000.0, 192.0), ..eye };
        assert!((slope(&outside, 8) - 60.0 / 600.0 - LEAST).abs() < 1e-2);
    }

    #[test]
    fn a_picture_is_as_high_as_its_shape_says() {
        let mut images = Assets::<Image>::default();
        let size = bevy::render::render_resource::Extent3d { width: 720, height: 30, depth_or_array_layers: 1 };
        let (dimension, format) =
            (bevy::render::render_resource::TextureDimension::D2, bevy::render::render_resource::TextureFormat::Rgba8UnormSrgb);
        let given = images.add(Image::new_fill(size, dimension, &[0; 4], format, default()));
        let own = OwnPicture(Some(images.add(Image::default())));
        let wished = Backdrop::Picture(given.clone());
        let (handle, high) = picture(&wished, &own, &images).expect("it is here");
        assert!(*handle == given && (high.to_degrees() - 15.0).abs() < 1e-3, "{high}");
        assert!(picture(&Backdrop::OfCity, &own, &images).is_some_and(|(handle, _)| *handle != given));
        assert_eq!(picture(&Backdrop::None, &own, &images), None);
        assert_eq!(picture(&Backdrop::OfCity, &OwnPicture(None), &images), None);
        assert_eq!(picture(&Backdrop::Picture(Handle::default()), &own, &images), None, "it has not come");
    }

    #[test]
    fn no_city_has_none() {
        assert_eq!(slopes(&City::default(), &Eye::default()), Slopes::default());
    }
}
