//! Heights, storeys, roofs and colours of a building or part, as its tags tell them
//! (<https://wiki.openstreetmap.org/wiki/Simple_3D_Buildings>).

use glam::DVec2;
use veduta_city::{Id, Rgb, RoofShape, RoofTags, Severity};

use crate::length;
use crate::lines::short;
use crate::log::Log;
use crate::osm::Tags;
use crate::polygon::{Polygon, edges};

/// Tallest building that is believed, in metres.
const TALLEST_M: f64 = 900.0;
/// Height of a storey where only their number is known, in metres.
const STOREY_M: f64 = 3.2;

/// What tags say of a building's body.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Body {
    pub min_height_m: f64,
    pub height_m: Option<f64>,
    pub levels: Option<f64>,
    pub roof: RoofTags,
    pub colour: Option<Rgb>,
}

impl Body {
    /// Reads the tags of a building or part with this footprint.
    pub(crate) fn of(tags: &Tags, footprint: &Polygon, id: Id, log: &mut Log) -> Self {
        let mut reader = TagReader { tags, id, pos: footprint.outer.first().copied(), log };
        let mut height_m = reader.length(&["height", "building:height", "est_height"]).filter(|&h| h > 0.0);
        let levels = reader.number(&["building:levels", "levels"]).filter(|&n| n > 0.0);
        let roof = reader.roof(footprint);
        let min_level = reader.number(&["building:min_level", "min_level"]).unwrap_or(0.0).max(0.0);
        let storey_m = match (height_m, levels) {
            (Some(height), Some(levels)) if min_level > 0.0 => ((height - roof.height_m.unwrap_or(0.0)) / levels).clamp(2.2, 6.0),
            _ => STOREY_M,
        };
        let mut min_height_m =
            reader.length(&["min_height", "building:min_height"]).filter(|&h| h >= 0.0).unwrap_or(min_level * storey_m);
        // A roof on posts (a carport, a station's canopy) is a slab in the air: houses below it stay free.
        if tags.is_any("building", &["roof", "carport"]) || tags.is("building:part", "roof") {
            let top = *height_m.get_or_insert(4.0);
            if min_height_m == 0.0 {
                min_height_m = (top - roof.height_m.unwrap_or(0.0) - 0.5).max(0.0);
            }
        }
        if let Some(top) = height_m.filter(|&top| top <= min_height_m) {
            reader.tell(format!("its top ({top} m) is not above its underside ({min_height_m} m): both were left to the style"));
            (height_m, min_height_m) = (None, 0.0);
        }
        let colour = reader.colour(&["building:colour", "building:color", "building:facade:colour", "colour"]);
        Self { min_height_m, height_m, levels, roof, colour }
    }
}

/// Reads values of one thing and tells those that make no sense.
struct TagReader<'t, 'l> {
    tags: &'t Tags,
    id: Id,
    pos: Option<DVec2>,
    log: &'l mut Log,
}

impl TagReader<'_, '_> {
    fn tell(&mut self, message: String) {
        self.log.note(self.id, self.pos, message);
    }

    fn value<T>(&mut self, keys: &[&str], read: impl Fn(&str) -> Option<T>) -> Option<T> {
        let (key, text) = keys.iter().find_map(|k| self.tags.get(k).map(|v| (k, v)))?;
        let value = read(text);
        if value.is_none() {
            self.log.tally(
                Severity::Note,
                self.id,
                self.pos,
                format!("{key}=\"{}\" is not understood: left to the style", short(text)),
            );
        }
        value
    }

    fn length(&mut self, keys: &[&str]) -> Option<f64> {
        self.value(keys, |text| length::metres(text).filter(|m| (0.0..=TALLEST_M).contains(m)))
    }

    fn number(&mut self, keys: &[&str]) -> Option<f64> {
        self.value(keys, |text| length::number(text).filter(|n| (-10.0..=200.0).contains(n)))
    }

    fn colour(&mut self, keys: &[&str]) -> Option<Rgb> {
        self.value(keys, |text| text.split(';').next().and_then(|t| t.trim().parse().ok()))
    }

    fn roof(&mut self, footprint: &Polygon) -> RoofTags {
        let shape = self.tags.first_of(&["roof:shape", "building:roof:shape", "building:roof"]).and_then(|text| {
            let (shape, note) = roof_shape(text);
            if let Some(note) = note {
                self.log.tally(Severity::Note, self.id, self.pos, note);
            }
            shape
        });
        let direction_deg = self.value(&["roof:direction", "roof:slope:direction"], |text| {
            // Some mappers write the orientation here.
            if matches!(text, "along" | "across") { Some(None) } else { length::bearing(text).map(Some) }
        });
        let direction_deg = direction_deg.flatten();
        let across = self.tags.is("roof:orientation", "across") || self.tags.is("roof:direction", "across");
        let mut height_m = self.length(&["roof:height", "building:roof:height"]);
        if height_m.is_none()
            && let Some(angle) =
                self.value(&["roof:angle"], |t| length::number(t.trim_end_matches('°')).filter(|a| (0.0..85.0).contains(a)))
        {
            let run_m = slope_run_m(footprint, shape.unwrap_or_default(), direction_deg);
            height_m = Some(run_m * libm::tan(angle.to_radians())).filter(|h| *h <= TALLEST_M);
        }
        if height_m.is_none() {
            height_m = self.number(&["roof:levels", "building:roof:levels"]).filter(|&n| n > 0.0).map(|n| n * 2.8);
        }
        let colour = self.colour(&["roof:colour", "roof:color", "building:roof:colour"]);
        RoofTags { shape, height_m, direction_deg, across, colour }
    }
}

/// How far a slope runs in plan: across the whole footprint for one slope, half its narrower side for two.
fn slope_run_m(footprint: &Polygon, shape: RoofShape, direction_deg: Option<f64>) -> f64 {
    let width = |direction: DVec2| {
        let along = footprint.outer.iter().map(|p| p.dot(direction));
        let (low, high) = along.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| (low.min(t), high.max(t)));
        (high - low).max(0.0)
    };
    // The narrowest of the widths square to an edge: that of the least rectangle for all convex footprints.
    let narrowest = || {
        let directions = edges(&footprint.outer).filter_map(|(a, b)| (b - a).perp().try_normalize());
        directions.map(width).fold(f64::INFINITY, f64::min)
    };
    let across = match direction_deg {
        Some(degrees) => width(DVec2::new(libm::sin(degrees.to_radians()), libm::cos(degrees.to_radians()))),
        None => narrowest(),
    };
    let run = if shape == RoofShape::Skillion { across } else { across / 2.0 };
    if run.is_finite() { run } else { 0.0 }
}

/// The nearest shape to a value of `roof:shape`, and what to tell where it is not the very same.
pub(crate) fn roof_shape(text: &str) -> (Option<RoofShape>, Option<String>) {
    let key = text.split(';').next().unwrap_or_default().trim().to_lowercase().replace([' ', '-'], "_");
    let exact = match key.as_str() {
        "flat" => RoofShape::Flat,
        "gabled" | "gable" | "pitched" => RoofShape::Gabled,
        "hipped" | "hip" => RoofShape::Hipped,
        "half_hipped" | "halfhipped" => RoofShape::HalfHipped,
        "pyramidal" | "pyramid" => RoofShape::Pyramidal,
        "skillion" | "lean_to" | "shed" => RoofShape::Skillion,
        "mansard" => RoofShape::Mansard,
        "gambrel" => RoofShape::Gambrel,
        "dome" => RoofShape::Dome,
        "onion" => RoofShape::Onion,
        "cone" | "conical" => RoofShape::Cone,
        "round" | "barrel" | "vault" => RoofShape::Round,
        "sawtooth" | "saw_tooth" => RoofShape::SawTooth,
        _ => return nearest_roof(&key, text),
    };
    (Some(exact), None)
}

fn nearest_roof(key: &str, text: &str) -> (Option<RoofShape>, Option<String>) {
    let near = match key {
        "saltbox"
        | "double_saltbox"
        | "gabled_height_moved"
        | "gabled_row"
        | "crosspitched"
        | "cross_gabled"
        | "dutch"
        | "bellcast_gable" => RoofShape::Gabled,
        "quadruple_saltbox" | "side_hipped" | "hipped_and_gabled" | "bellcast_hip" => RoofShape::Hipped,
        "side_half_hipped" => RoofShape::HalfHipped,
        "flat_mansard" => RoofShape::Mansard,
        "round_gabled" => RoofShape::Round,
        "sawtoth" => RoofShape::SawTooth,
        "hemisphere" | "spherical" | "cupola" => RoofShape::Dome,
        "spire" | "tented" | "helm" | "rhombic" | "frustum" | "frustrum" => RoofShape::Pyramidal,
        "zeltdach" => RoofShape::Pyramidal,
        "satteldach" => RoofShape::Gabled,
        "walmdach" => RoofShape::Hipped,
        "no" | "none" | "terrace" => RoofShape::Flat,
        _ => return (None, Some(format!("roof:shape={} is not known: left to the style", short(text)))),
    };
    (Some(near), Some(format!("roof:shape={} was taken as the nearest known, {near:?}", short(text))))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(pairs: &[(&str, &str)]) -> (Body, Vec<String>) {
        let tags: Tags = pairs.iter().copied().collect();
        let outer = vec![DVec2::ZERO, DVec2::new(20.0, 0.0), DVec2::new(20.0, 10.0), DVec2::new(0.0, 10.0)];
        let mut log = Log::default();
        let body = Body::of(&tags, &Polygon { outer, holes: Vec::new() }, Id(1), &mut log);
        (body, log.finish().into_iter().map(|f| f.message).collect())
    }

    #[test]
    fn heights_levels_and_colours_are_read() {
        let (b, told) = body(&[
            ("building", "yes"),
            ("height", "40'"),
            ("min_height", "3 m"),
            ("building:levels", "3,5"),
            ("building:colour", "#fa0"),
            ("roof:colour", "maroon"),
            ("roof:height", "2.5"),
        ]);
        assert_eq!((b.height_m, b.min_height_m, b.levels), (Some(12.192), 3.0, Some(3.5)));
        assert_eq!((b.colour, b.roof.colour, b.roof.height_m), (Some(Rgb(255, 170, 0)), Some(Rgb(128, 0, 0)), Some(2.5)));
        assert_eq!(told, [""; 0]);
    }

    #[test]
    fn nonsense_is_told_and_left_to_the_style() {
        let (b, told) = body(&[("height", "tall"), ("building:levels", "-"), ("building:colour", "nice"), ("roof:shape", "9.0")]);
        assert_eq!(b, Body::default());
        assert_eq!(told.len(), 4, "{told:?}");
        let (b, told) = body(&[("height", "5"), ("min_height", "9")]);
        assert_eq!((b.height_m, b.min_height_m), (None, 0.0));
        assert!(told[0].contains("not above its underside"), "{told:?}");
    }

    #[test]
    fn a_lowest_level_lifts_the_underside() {
        assert_eq!(body(&[("building:min_level", "2")]).0.min_height_m, 6.4);
        assert_eq!(body(&[("building:min_level", "2"), ("height", "12"), ("building:levels", "4")]).0.min_height_m, 6.0);
    }

    #[test]
    fn a_roof_on_posts_hangs_in_the_air() {
        let (b, _) = body(&[("building", "roof")]);
        assert_eq!((b.height_m, b.min_height_m), (Some(4.0), 3.5));
        let (b, _) = body(&[("building", "carport"), ("height", "3"), ("roof:height", "1")]);
        assert_eq!((b.height_m, b.min_height_m), (Some(3.0), 1.5));
    }

    #[test]
    fn an_angle_becomes_a_height_across_the_slope() {
        let height = |pairs: &[(&str, &str)]| body(pairs).0.roof.height_m.unwrap();
        let skillion = ("roof:shape", "skillion");
        assert!((height(&[skillion, ("roof:direction", "0"), ("roof:angle", "45")]) - 10.0).abs() < 1e-9);
        assert!((height(&[skillion, ("roof:direction", "E"), ("roof:angle", "45")]) - 20.0).abs() < 1e-9);
        assert!((height(&[("roof:shape", "gabled"), ("roof:angle", "45°")]) - 5.0).abs() < 1e-9);
        assert_eq!(height(&[("roof:levels", "2")]), 5.6);
    }

    #[test]
    fn every_known_roof_has_a_shape_and_strange_ones_a_note() {
        for text in [
            "flat",
            "gabled",
            "hipped",
            "half-hipped",
            "pyramidal",
            "skillion",
            "gambrel",
            "mansard",
            "round",
            "dome",
            "onion",
            "cone",
            "sawtooth",
        ] {
            let (shape, note) = roof_shape(text);
            assert!(shape.is_some() && note.is_none(), "{text}: {shape:?} {note:?}");
        }
        for text in [
            "flat_mansard",
            "saltbox",
            "double_saltbox",
            "quadruple_saltbox",
            "round_gabled",
            "side_hipped",
            "gabled_row",
            "gabled_height_moved",
            "sawtoth",
            "frustrum",
            "side_half-hipped",
            "crosspitched",
        ] {
            let (shape, note) = roof_shape(text);
            assert!(shape.is_some() && note.is_some(), "{text}: {shape:?} {note:?}");
        }
        for text in ["many", "9.0", ""] {
            let (shape, note) = roof_shape(text);
            assert!(shape.is_none() && note.is_some(), "{text}: {shape:?} {note:?}");
        }
    }

    #[test]
    fn orientation_and_direction_are_read() {
        let (b, _) = body(&[("roof:direction", "NE"), ("roof:orientation", "across")]);
        assert_eq!((b.roof.direction_deg, b.roof.across), (Some(45.0), true));
        let (b, told) = body(&[("roof:direction", "across")]);
        assert!(b.roof.direction_deg.is_none() && b.roof.across && told.is_empty());
    }
}
