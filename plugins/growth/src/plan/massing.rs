//! Heights and roofs: from tags where a map has them, from the style where not.

use glam::DVec2;
use rayon::prelude::*;
use veduta_city::draw::Draw;
use veduta_city::{Finding, GRID_PER_METRE, GridPos, PlanRoof, RoofShape, Severity, Style, metres};

use super::facing::{BodyRef, Facing};
use super::houses::{Body, Draft, StyleBook};
use super::outline::{self, Box2};
use super::walls::DOORSTEP;

/// Least height of walls under a roof that stands on the ground; metres.
const LEAST_WALL_M: f64 = 2.2;
/// Least height of walls of a body that hangs; metres.
const LEAST_HANGING_WALL_M: f64 = 0.25;
/// Footprints larger than this get level roofs where a map says nothing; square metres.
const LEVEL_ROOF_M2: f64 = 2_000.0;
/// Footprints smaller than this are sheds; square metres.
const SHED_M2: f64 = 30.0;
/// Neighbouring eaves of grown houses differ at least by this; metres.
const EAVES_STEP_M: f64 = 0.3;
/// Widest front of houses whose kind shows its gables, metres.
const WIDEST_GABLE_M: f64 = 16.0;
/// Most that a grown house's eaves leave its row's; metres.
const EAVES_SPREAD_M: f64 = 1.1;

/// Heights and roof of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mass {
    /// The house's floor above the city's zero, grid steps.
    pub floor: i32,
    /// Grid steps.
    pub bottom: i32,
    /// Grid steps.
    pub eaves: i32,
    /// Its colour is set later.
    pub roof: PlanRoof,
}

impl Mass {
    /// The same on another floor.
    fn raised(self, floor: i32) -> Self {
        Self { floor, bottom: self.bottom.saturating_add(floor), eaves: self.eaves.saturating_add(floor), ..self }
    }

    /// Whether its foot is too high for doors.
    pub fn hangs(&self) -> bool {
        self.bottom.saturating_sub(self.floor) > DOORSTEP
    }
}

/// Heights and roofs of all bodies of all houses.
pub(super) fn masses(
    drafts: &[Draft],
    facing: &Facing,
    floors: &[i32],
    book: &StyleBook<'_>,
    findings: &mut Vec<Finding>,
) -> Vec<Vec<Mass>> {
    let grown = grown_eaves(drafts, facing, floors);
    let of_house = |(h, draft): (usize, &Draft)| {
        let mut findings = Vec::new();
        let style = book.style(draft.style);
        let mass = |(b, body): (usize, &Body)| mass(draft, body, (h, b), facing, style, grown[h], &mut findings).raised(floors[h]);
        (draft.bodies.iter().enumerate().map(mass).collect(), findings)
    };
    let (masses, told): (Vec<Vec<Mass>>, Vec<Vec<Finding>>) = drafts.par_iter().enumerate().map(of_house).unzip();
    findings.extend(told.into_iter().flatten());
    masses
}

/// Eaves of grown houses, in order: within 1.1 m of their row's, 0.3 m or more from every neighbour's that is settled.
fn grown_eaves(drafts: &[Draft], facing: &Facing, floors: &[i32]) -> Vec<Option<f64>> {
    let wish = |draft: &Draft| draft.draw.between("eaves", -EAVES_SPREAD_M, EAVES_SPREAD_M);
    let wishes: Vec<f64> = drafts.par_iter().map(wish).collect();
    let mut eaves: Vec<Option<f64>> = vec![None; drafts.len()];
    for (h, draft) in drafts.iter().enumerate() {
        let Some(grown) = draft.grown else { continue };
        // Above this house's own floor.
        let settled = facing.neighbours(h).filter_map(|n| Some(eaves[n]? + metres(floors[n] - floors[h])));
        let settled: Vec<f64> = settled.collect();
        let clear = |e: f64| settled.iter().map(|s| (s - e).abs()).fold(f64::INFINITY, f64::min);
        let wish = wishes[h];
        // Steps away from the wish, up and down in turn, within the spread: the first that is clear, else the clearest.
        let steps = (0..=88).map(|i| wish + f64::from((i + 1) / 2) * 0.05 * if i % 2 == 0 { 1.0 } else { -1.0 });
        let even = |d: f64| metres(even(grown.eaves_m + d));
        let within = steps.map(even).filter(|e| (e - grown.eaves_m).abs() <= EAVES_SPREAD_M);
        let first = within.clone().find(|&e| clear(e) >= EAVES_STEP_M + 0.005);
        let best = first.or_else(|| within.max_by(|a, b| clear(*a).total_cmp(&clear(*b))));
        eaves[h] = best.or(Some(grown.eaves_m));
    }
    eaves
}

fn mass(
    draft: &Draft,
    body: &Body,
    at: BodyRef,
    facing: &Facing,
    style: &Style,
    grown: Option<f64>,
    findings: &mut Vec<Finding>,
) -> Mass {
    let draw = draft.draw.part(at.1 as u64);
    let bounds = outline::smallest_box(&body.footprint.outer);
    let shape = shape(body, style, draw);
    let ridge = ridge(body, shape, (at, facing), &bounds, draft, style.gable_fronts, draw);
    let span = span_m(body, ridge, &bounds, shape);
    let natural = roof_height_m(shape, span, draw.between("pitch", style.pitch_deg.0, style.pitch_deg.1));
    let least = if body.bottom_m > 0.0 { LEAST_HANGING_WALL_M } else { LEAST_WALL_M };
    let (eaves_m, roof_m) = match (grown, body.height_m) {
        (Some(eaves), None) => (eaves, body.roof.height_m.unwrap_or(natural.min(eaves * 0.75))),
        (_, Some(top)) => under_ridge(draft, body, top, natural, least, style, findings),
        (None, None) => {
            let eaves = eaves_from_storeys(body, style, draw).max(body.bottom_m + least);
            (eaves, body.roof.height_m.unwrap_or_else(|| natural.min(most_roof_m(eaves - body.bottom_m, style))))
        }
    };
    let level = matches!(shape, RoofShape::Flat);
    let bottom = GridPos::steps(body.bottom_m);
    let eaves = even(eaves_m).max(bottom + GridPos::steps(LEAST_HANGING_WALL_M));
    let height = if level { 0 } else { even(roof_m).max(0) };
    let shape = if height == 0 { RoofShape::Flat } else { shape };
    Mass {
        floor: 0,
        bottom,
        eaves,
        roof: PlanRoof { shape, height, direction: degrees(ridge, shape), colour: veduta_city::Rgb::default() },
    }
}

/// Heights of eaves, roofs, storeys and objects are whole sixteenths of a metre: nobody sees the difference, and fewer digits travel.
pub(super) const HEIGHT_STEP: i32 = GRID_PER_METRE / 16;

/// The nearest such height, grid steps.
pub(super) fn even(height_m: f64) -> i32 {
    let sixteenths = libm::round(height_m * f64::from(GRID_PER_METRE / HEIGHT_STEP)) as i32;
    sixteenths.saturating_mul(HEIGHT_STEP)
}

/// Most that a roof rises over walls of a height where no map says so.
fn most_roof_m(wall_m: f64, style: &Style) -> f64 {
    // Steep roofs are those of towers and churches, where the roof may be the larger part.
    if style.pitch_deg.1 > 60.0 { wall_m * 1.5 } else { (wall_m * 0.75).clamp(1.2, 14.0) }
}

/// Eaves and roof height of a body whose ridge is known.
fn under_ridge(
    draft: &Draft,
    body: &Body,
    top: f64,
    natural: f64,
    least: f64,
    style: &Style,
    findings: &mut Vec<Finding>,
) -> (f64, f64) {
    let most = (top - body.bottom_m - least).max(0.0);
    match body.roof.height_m {
        Some(tagged) if tagged > most + 0.01 && body.bottom_m == 0.0 => {
            let place = body.footprint.outer.first().map(|p| p.to_metres());
            let message = format!("a roof of {tagged} m leaves no walls under a ridge at {top} m: it is made {most:.1} m high");
            findings.push(Finding::new(Severity::Repaired, draft.id, place, message));
            (top - most, most)
        }
        Some(tagged) => (top - tagged.min(most), tagged.min(most)),
        None => {
            // A share of the whole that leaves believable walls: two fifths, steep styles three fifths.
            let share = if style.pitch_deg.1 > 60.0 { 0.6 } else { 0.42 };
            let mut roof = natural.min((top - body.bottom_m) * share).min(most);
            if let Some(levels) = body.levels {
                // Where a map counts the storeys too, they get the room they need before the roof does.
                let walls = style.ground_floor_m.0.min(style.storey_m.0) * levels;
                roof = roof.min((top - body.bottom_m - walls).max(most.min(1.0)));
            }
            (top - roof, roof)
        }
    }
}

fn eaves_from_storeys(body: &Body, style: &Style, draw: Draw) -> f64 {
    let area = body.footprint.area_m2();
    let (ground, upper) = storey_heights(style, draw);
    let storeys = body.levels.unwrap_or_else(|| {
        let (low, high) = (f64::from(style.storeys.0), f64::from(style.storeys.1));
        let drawn = low + draw.below("storeys", (high - low) as usize + 1) as f64;
        if area < SHED_M2 && style.shops > 0.0 { 1.0 } else { drawn }
    });
    let ground = if area < SHED_M2 && storeys <= 1.0 { ground.min(2.8) } else { ground };
    if storeys <= 1.0 { ground * storeys.max(0.5) } else { ground + (storeys - 1.0) * upper }
}

/// Heights of the ground floor and of an upper storey that a house would have by itself, metres.
pub(super) fn storey_heights(style: &Style, draw: Draw) -> (f64, f64) {
    (
        draw.between("ground floor", style.ground_floor_m.0, style.ground_floor_m.1),
        draw.between("storey", style.storey_m.0, style.storey_m.1),
    )
}

fn shape(body: &Body, style: &Style, draw: Draw) -> RoofShape {
    if let Some(shape) = body.roof.shape {
        return shape;
    }
    if body.is_covered || body.roof.height_m == Some(0.0) || body.footprint.area_m2() > LEVEL_ROOF_M2 && style.pitch_deg.1 < 54.0 {
        return RoofShape::Flat;
    }
    let drawn = draw.pick("roof", &style.roofs).copied().unwrap_or_default();
    let is_quad = body.footprint.outer.len() == 4 && body.footprint.holes.is_empty();
    match drawn {
        RoofShape::Gabled | RoofShape::HalfHipped | RoofShape::Gambrel if !is_quad => RoofShape::Hipped,
        other => other,
    }
}

/// Unit vector along the ridge; for skillions along the fall.
fn ridge(
    body: &Body,
    shape: RoofShape,
    (at, facing): (BodyRef, &Facing),
    bounds: &Box2,
    draft: &Draft,
    gable_fronts: f64,
    draw: Draw,
) -> DVec2 {
    let skillion = shape == RoofShape::Skillion;
    if let Some(degrees) = body.roof.direction_deg {
        let angle = degrees.to_radians();
        let fall = DVec2::new(libm::sin(angle), libm::cos(angle));
        return if skillion { fall } else { fall.perp() };
    }
    if skillion {
        return bounds.along.perp();
    }
    if body.roof.across {
        return bounds.along.perp();
    }
    // In a row, ridges run along the street, unless a house shows it its gable.
    let edges = || facing.of_body(at, &body.footprint);
    let in_row = edges().any(|e| e.parties.iter().any(|party| party.share > 0.5));
    let street = edges().filter(|e| e.is_public).max_by(|a, b| a.length_m().total_cmp(&b.length_m()));
    if let (true, Some(street)) = (in_row || draft.grown.is_some(), street) {
        let along = (street.b() - street.a()).normalize_or(DVec2::X);
        let is_narrow = street.length_m() < if gable_fronts > 0.3 { WIDEST_GABLE_M } else { 9.5 };
        return if is_narrow && draw.chance("gable to the street", gable_fronts) { along.perp() } else { along };
    }
    bounds.along
}

/// Width that the roof has to span, metres: across the ridge, less where wings enclose a yard.
fn span_m(body: &Body, ridge: DVec2, bounds: &Box2, shape: RoofShape) -> f64 {
    let (_, across) = outline::extent_along(&body.footprint.outer, ridge);
    let wing = 2.0 * body.footprint.area_m2() / outline::perimeter_m(&body.footprint).max(1.0);
    let is_quad = body.footprint.outer.len() == 4 && body.footprint.holes.is_empty();
    match shape {
        RoofShape::Hipped | RoofShape::Pyramidal | RoofShape::Mansard | RoofShape::Cone | RoofShape::Dome | RoofShape::Onion => {
            if is_quad {
                bounds.width_m
            } else {
                bounds.width_m.min(2.0 * wing)
            }
        }
        _ if is_quad => across,
        _ => across.min(2.0 * wing),
    }
}

/// Height of a roof of a shape over a span, where a map gives none.
fn roof_height_m(shape: RoofShape, span: f64, pitch_deg: f64) -> f64 {
    let rise = span / 2.0 * libm::tan(pitch_deg.clamp(1.0, 80.0).to_radians());
    match shape {
        RoofShape::Flat => 0.0,
        RoofShape::Gabled | RoofShape::Hipped | RoofShape::HalfHipped | RoofShape::Pyramidal | RoofShape::Cone => rise,
        RoofShape::Skillion => span * libm::tan(pitch_deg.clamp(1.0, 25.0).to_radians()) * 0.6,
        RoofShape::Mansard | RoofShape::Gambrel => rise.min(span * 0.5).max(2.5),
        RoofShape::Dome => span / 2.0,
        RoofShape::Onion => span * 0.9,
        RoofShape::Round => span * 0.3,
        RoofShape::SawTooth => 1.8,
    }
}

/// Whole degrees clockwise from north. Ridges have no sense of direction: theirs stay below 180.
fn degrees(along: DVec2, shape: RoofShape) -> u16 {
    let angle = libm::atan2(along.x, along.y).to_degrees();
    let turn = if shape == RoofShape::Skillion { 360.0 } else { 180.0 };
    let whole = libm::round(angle).rem_euclid(turn);
    whole as u16 % turn as u16
}

/// Height of walls, metres.
pub(super) fn wall_m(mass: &Mass) -> f64 {
    metres(mass.eaves - mass.bottom)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_are_compass_degrees() {
        assert_eq!(degrees(DVec2::Y, RoofShape::Gabled), 0);
        assert_eq!(degrees(DVec2::X, RoofShape::Gabled), 90);
        assert_eq!(degrees(-DVec2::X, RoofShape::Gabled), 90);
        assert_eq!(degrees(-DVec2::X, RoofShape::Skillion), 270);
        assert_eq!(degrees(DVec2::new(-1e-9, 1.0), RoofShape::Skillion), 0);
    }

    #[test]
    fn steeper_is_higher() {
        assert!((roof_height_m(RoofShape::Gabled, 10.0, 45.0) - 5.0).abs() < 1e-9);
        assert!(roof_height_m(RoofShape::Gabled, 10.0, 55.0) > 7.0);
        assert_eq!(roof_height_m(RoofShape::Flat, 10.0, 45.0), 0.0);
    }
}
