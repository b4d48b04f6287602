use bevy::math::{DVec2, DVec3};
use veduta_city::{CellShell, Footfall, GridPos, ObjectKind, Setting, SurfaceKind, metres};

/// What lies about a listener, as far as it is heard.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Surroundings {
    /// How much of each of [`Setting::ALL`] one stands in, 0 to 1.
    pub shares: [f32; Setting::ALL.len()],
    /// What is trodden on; `None` where nobody walks.
    pub footfall: Option<Footfall>,
    /// What stands about and sounds by its kind: where its foot is, plan metres with the elevation.
    pub objects: Vec<(ObjectKind, DVec3)>,
}

/// Rings around the listener on which the ground is looked at: radius in metres, and how many looks.
const RINGS: [(f64, usize); 4] = [(6.0, 8), (14.0, 12), (26.0, 14), (48.0, 16)];
/// Rings by which it is told whether one stands in the open.
const NEAR_RINGS: usize = 3;
/// Farther objects are not told, metres.
const OBJECTS_M: f64 = 150.0;

/// One look at the ground.
#[derive(Clone, Copy)]
struct Look {
    at: DVec2,
    radius_m: f64,
    found: Option<SurfaceKind>,
}

impl Surroundings {
    /// What lies about a plan position, of cells that are here.
    pub fn of<'a>(plan_pos: DVec2, shells: impl Iterator<Item = &'a CellShell>) -> Self {
        let mut looks = vec![Look { at: plan_pos, radius_m: 0.0, found: None }];
        for (radius_m, count) in RINGS {
            looks.extend((0..count).map(|n| {
                let (sin, cos) = (core::f64::consts::TAU * n as f64 / count as f64).sin_cos();
                Look { at: plan_pos + DVec2::new(cos, sin) * radius_m, radius_m, found: None }
            }));
        }
        let (mut is_roofed, mut objects) = (false, Vec::new());
        for shell in shells {
            let origin = shell.origin.to_metres();
            look_down(&mut looks, shell, plan_pos);
            let here = GridPos::from_metres(plan_pos) - shell.origin;
            is_roofed |= is_under_arcade(shell, here);
            let heard = shell.objects.iter().filter(|object| veduta_city::SoundSource::of_object(object.kind).is_some());
            let placed = heard.map(|object| (object.kind, (origin + object.pos.to_metres()).extend(metres(object.z))));
            objects.extend(placed.filter(|(_, at)| at.truncate().distance(plan_pos) < OBJECTS_M));
        }
        let footfall = looks[0].found.and_then(Footfall::of);
        Self { shares: shares(&looks, is_roofed), footfall, objects }
    }

    /// How much of a setting one stands in.
    #[must_use]
    pub fn share(&self, setting: Setting) -> f32 {
        Setting::ALL.iter().position(|&s| s == setting).map_or(0.0, |n| self.shares[n])
    }
}

/// Finds out what each look meets in a cell.
fn look_down(looks: &mut [Look], shell: &CellShell, plan_pos: DVec2) {
    let origin = shell.origin.to_metres();
    let farthest = RINGS[RINGS.len() - 1].0;
    for patch in &shell.ground {
        let Some((low, high)) = patch.outline.bounds() else { continue };
        let (low, high) = (low.to_metres() + origin, high.to_metres() + origin);
        if plan_pos.distance(plan_pos.clamp(low, high)) > farthest {
            continue;
        }
        for look in looks.iter_mut().filter(|look| look.found.is_none()) {
            let is_near = look.at.cmpge(low).all() && look.at.cmple(high).all();
            if is_near && patch.outline.contains(GridPos::from_metres(look.at) - shell.origin) {
                look.found = Some(patch.surface);
            }
        }
    }
}

fn is_under_arcade(shell: &CellShell, here: GridPos) -> bool {
    let volumes = shell.houses.iter().flat_map(|house| &house.volumes);
    volumes.filter(|volume| !volume.arcades.is_empty()).any(|volume| volume.footprint.contains(here))
}

/// Shares of settings, from what was seen.
fn shares(looks: &[Look], is_roofed: bool) -> [f32; Setting::ALL.len()] {
    let nearest = RINGS[NEAR_RINGS - 1].0;
    let near: Vec<&Look> = looks.iter().filter(|look| look.radius_m <= nearest).collect();
    let part = |is: &dyn Fn(SurfaceKind) -> bool| {
        near.iter().filter(|look| look.found.is_some_and(is)).count() as f64 / near.len().max(1) as f64
    };
    let water = part(&|surface| surface == SurfaceKind::Water);
    let green = part(&|surface| surface == SurfaceKind::Grass);
    let open = water + green + part(&|surface| surface.is_public() || surface == SurfaceKind::Gravel);
    // Nearest water: the bank is heard from as far as looks reach.
    let farthest = RINGS[RINGS.len() - 1].0;
    let wet = looks.iter().filter(|look| look.found == Some(SurfaceKind::Water)).map(|look| look.radius_m);
    let by_water = wet.reduce(f64::min).map_or(0.0, |distance_m| 1.0 - 0.8 * distance_m / farthest);
    let is_wet_here = looks.first().is_some_and(|look| look.found == Some(SurfaceKind::Water));
    let bridge = ramp(water, 0.35, 0.65) * if is_wet_here { 0.0 } else { 1.0 };
    let roofed = if is_roofed { 1.0 } else { 0.0 };
    let park = ramp(green, 0.15, 0.55) * (1.0 - roofed);
    // On a quay people are fewer than in a street.
    let paved = (1.0 - park) * (1.0 - bridge) * (1.0 - roofed) * (1.0 - 0.6 * by_water);
    let square = ramp(open, 0.5, 0.8) * paved;
    let of = |setting| match setting {
        Setting::Lane => paved - square,
        Setting::Square => square,
        Setting::Park => park,
        Setting::Bank => by_water,
        Setting::Bridge => bridge,
        Setting::Arcade => roofed,
    };
    Setting::ALL.map(|setting| of(setting) as f32)
}

/// From 0 at one value to 1 at another.
fn ramp(x: f64, from: f64, to: f64) -> f64 {
    let x = ((x - from) / (to - from)).clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::{GridPolygon, GroundPatch, ObjectShell};

    fn patch(surface: SurfaceKind, (x0, y0): (i32, i32), (x1, y1): (i32, i32)) -> GroundPatch {
        let ring = [(x0, y0), (x1, y0), (x1, y1), (x0, y1)].map(|(x, y)| GridPos(x * 1_024, y * 1_024));
        GroundPatch { surface, outline: GridPolygon::simple(ring.into()), z: 0, course: None }
    }

    fn cell(ground: Vec<GroundPatch>) -> CellShell {
        CellShell { origin: GridPos(102_400, 0), ground, ..CellShell::default() }
    }

    fn most(surroundings: &Surroundings) -> Setting {
        let best = Setting::ALL.into_iter().max_by(|&a, &b| surroundings.share(a).total_cmp(&surroundings.share(b)));
        best.expect("there are settings")
    }

    #[test]
    fn places_are_told_by_the_ground_about_them() {
        let here = DVec2::new(100.0, 0.0);
        for (ground, setting) in [
            (vec![patch(SurfaceKind::Cobbles, (-4, -60), (4, 60))], Setting::Lane),
            (vec![patch(SurfaceKind::Mosaic, (-60, -60), (60, 60))], Setting::Square),
            (vec![patch(SurfaceKind::Grass, (-60, -60), (60, 60))], Setting::Park),
            (
                vec![
                    patch(SurfaceKind::Cobbles, (-5, -60), (5, 60)),
                    patch(SurfaceKind::Water, (5, -60), (60, 60)),
                    patch(SurfaceKind::Water, (-60, -60), (-5, 60)),
                ],
                Setting::Bridge,
            ),
            (vec![patch(SurfaceKind::Cobbles, (-4, -60), (5, 60)), patch(SurfaceKind::Water, (5, -60), (60, 60))], Setting::Bank),
        ] {
            let cell = cell(ground);
            let found = Surroundings::of(here, [&cell].into_iter());
            assert_eq!(most(&found), setting, "{found:?}");
            assert!(found.footfall.is_some());
        }
        let nowhere = Surroundings::of(here, core::iter::empty());
        assert_eq!((nowhere.footfall, most(&nowhere)), (None, Setting::Lane), "where nothing is known, a lane");
    }

    #[test]
    fn water_is_nearer_the_louder_and_fountains_are_found() {
        let mut shell =
            cell(vec![patch(SurfaceKind::Gravel, (-60, -60), (20, 60)), patch(SurfaceKind::Water, (20, -60), (60, 60))]);
        let fountain = ObjectShell {
            kind: ObjectKind::Fountain,
            pos: GridPos(0, 10_240),
            z: 1_024,
            heading: 0,
            height: 2_048,
            monument: None,
        };
        shell.objects = vec![fountain, ObjectShell { kind: ObjectKind::Lamp, ..fountain }];
        let bank = |x: f64| Surroundings::of(DVec2::new(100.0 + x, 0.0), [&shell].into_iter());
        assert!(bank(16.0).share(Setting::Bank) > bank(0.0).share(Setting::Bank) && bank(0.0).share(Setting::Bank) > 0.3);
        assert_eq!(bank(-55.0).share(Setting::Bank), 0.0);
        assert_eq!(bank(0.0).objects, [(ObjectKind::Fountain, DVec3::new(100.0, 10.0, 1.0))]);
        assert_eq!(bank(0.0).footfall, Some(Footfall::Gravel));
    }
}
