//! Landmarks as small pictures: the city's own houses, raised from their outlines and seen from the lower edge of the map, a third of a
//! right angle above the horizon (an orthographic projection), in the light from the upper left that maps are drawn in.

use glam::{DVec2, DVec3};
use veduta_city::{GridPos, Massing, Overview, PlaceKind, Rgb, RoofShape, metres};

use crate::{Area, Colours, Frame};

/// A house that is drawn as a small picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Landmark {
    /// Its name in the map.
    pub name: String,
    /// Middle of the ground that it stands on, plan metres.
    pub plan_pos: DVec2,
    /// How far it reaches from there, metres.
    pub reach_m: f64,
    /// Height, metres.
    pub height_m: f64,
    parts: Vec<Part>,
}

/// Houses with a name are landmarks from this height on; those that a place tells of as monuments, from half of it on.
pub const LANDMARK_M: f64 = 30.0;

/// A body of it.
#[derive(Debug, Clone, PartialEq)]
struct Part {
    ring: Vec<DVec2>,
    height_m: f64,
    rise_m: f64,
    roof: RoofShape,
    /// Direction of its ridge.
    along: DVec2,
    wall: Rgb,
    cover: Rgb,
}

impl Part {
    fn of(massing: &Massing) -> Self {
        let ring: Vec<DVec2> = massing.outline.outer.iter().map(|&pos| GridPos::to_metres(pos)).collect();
        let along = f64::from(massing.roof.direction).to_radians();
        let (height_m, rise_m) = (metres(massing.height), metres(massing.roof.height.max(0)));
        Self {
            ring,
            height_m,
            rise_m: rise_m.min(height_m),
            roof: massing.roof.shape,
            along: DVec2::new(libm::sin(along), libm::cos(along)),
            wall: massing.colour,
            cover: massing.roof.colour,
        }
    }
}

/// The landmarks that an overview tells of, the highest first.
#[must_use]
pub fn landmarks(overview: &Overview) -> Vec<Landmark> {
    let monuments: Vec<(&str, DVec2)> = overview
        .places
        .iter()
        .filter(|place| place.kind == PlaceKind::Monument)
        .map(|place| (place.name.as_str(), place.pos))
        .collect();
    let named = overview.names.iter().filter(|name| !name.name.is_empty());
    let mut found: Vec<Landmark> = named
        .filter_map(|name| {
            let first = name.house as usize;
            let parts: Vec<Part> = overview.houses.iter().skip(first).take(name.parts as usize).map(Part::of).collect();
            let landmark = Landmark::of(&name.name, parts)?;
            let is_told = || monuments.iter().any(|&(told, pos)| told == name.name && landmark.plan_pos.distance(pos) < 150.0);
            let is_high = |least: f64| landmark.height_m >= least;
            (is_high(LANDMARK_M) || is_high(LANDMARK_M / 2.0) && is_told()).then_some(landmark)
        })
        .collect();
    found.sort_by(|a, b| b.height_m.total_cmp(&a.height_m).then_with(|| a.name.cmp(&b.name)));
    found
}

/// A face of a picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Facet {
    /// Its corners, metres on the picture from the middle of the ground: x to the right, y downwards.
    pub points: Vec<DVec2>,
    /// Its colour.
    pub fill: Rgb,
    /// Its outline, where it has one.
    pub edge: Option<Rgb>,
}

/// A landmark as it is drawn, the farthest faces first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// Its faces.
    pub facets: Vec<Facet>,
    /// What it covers, metres on the picture.
    pub bounds: Area,
}

/// Sine and cosine of the angle from which pictures are seen.
const DOWN: f64 = 0.5;
const UP: f64 = 0.866_025_403_784_438_6;
/// Light comes from the left, before and above: x to the right, y away, z up.
const LIGHT: DVec3 = DVec3::new(-0.52, -0.38, 0.765);

/// Headings that pictures may be seen along besides that of the map's upper edge, degrees from there.
const ASLANT_DEG: [f64; 2] = [40.0, -40.0];

/// Heights of a round roof's rings and their radii, both in parts.
const DOME: [(f64, f64); 5] = [(0.0, 1.0), (0.38, 0.93), (0.70, 0.71), (0.92, 0.38), (1.0, 0.0)];
const ONION: [(f64, f64); 6] = [(0.0, 0.8), (0.2, 1.0), (0.42, 0.85), (0.62, 0.42), (0.78, 0.16), (1.0, 0.0)];
const CONE: [(f64, f64); 2] = [(0.0, 1.0), (1.0, 0.0)];

impl Landmark {
    fn of(name: &str, parts: Vec<Part>) -> Option<Self> {
        let corners = || parts.iter().flat_map(|part| &part.ring).copied();
        let first = corners().next()?;
        let (low, high) = corners().fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
        let height_m = parts.iter().map(|part| part.height_m).fold(0.0, f64::max);
        let plan_pos = (low + high) / 2.0;
        Some(Self { name: name.to_owned(), plan_pos, reach_m: (high - low).length() / 2.0, height_m, parts })
    }

    /// Whether a plan position lies on its ground.
    #[must_use]
    pub fn stands_on(&self, plan_pos: DVec2) -> bool {
        let p = GridPos::from_metres(plan_pos);
        // Few places lie near enough to be looked at more closely.
        let is_near = self.plan_pos.distance(plan_pos) <= self.reach_m;
        is_near
            && self.parts.iter().any(|part| {
                let ring = part.ring.iter().map(|&p| GridPos::from_metres(p)).collect();
                veduta_city::GridPolygon::simple(ring).contains(p)
            })
    }

    /// From where it is seen, as the heading that points up: from the lower edge, or from aslant where its towers would hide one another.
    fn best_view(&self, up_deg: f64) -> f64 {
        let high = self.parts.iter().filter(|part| part.height_m >= self.height_m * 0.85);
        let tops: Vec<DVec2> = high.map(|part| part.ring.iter().sum::<DVec2>() / part.ring.len().max(1) as f64).collect();
        let spread = |turn_deg: f64| {
            let frame = Frame::new(self.plan_pos, DVec2::ZERO, 1.0, up_deg + turn_deg);
            let across = || tops.iter().map(|&top| frame.project(top).x);
            across().fold(f64::NEG_INFINITY, f64::max) - across().fold(f64::INFINITY, f64::min)
        };
        let best = ASLANT_DEG.into_iter().max_by(|a, b| spread(*a).total_cmp(&spread(*b))).unwrap_or_default();
        // Straight on, unless much more is seen.
        up_deg + if spread(best) > 1.5 * spread(0.0) + 2.0 { best } else { 0.0 }
    }

    /// Its picture on a map whose upper edge lies in a direction.
    #[must_use]
    pub fn picture(&self, up_deg: f64, colours: Colours) -> Picture {
        let frame = Frame::new(self.plan_pos, DVec2::ZERO, 1.0, self.best_view(up_deg));
        // x to the right, y away from who looks.
        let seen = |p: DVec2| {
            let at = frame.project(p);
            DVec2::new(at.x, -at.y)
        };
        let mut parts: Vec<(Vec<DVec2>, DVec2, &Part)> = self
            .parts
            .iter()
            .map(|part| {
                let along = frame.project_offset(part.along);
                (part.ring.iter().map(|&p| seen(p)).collect(), DVec2::new(along.x, -along.y), part)
            })
            .collect();
        let nearest = |ring: &[DVec2]| ring.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        parts.sort_by(|a, b| nearest(&b.0).total_cmp(&nearest(&a.0)).then(a.2.height_m.total_cmp(&b.2.height_m)));
        let mut draft = Draft { colours, facets: Vec::new() };
        for (ring, along, part) in &parts {
            draft.part(ring, *along, part);
        }
        let facets = draft.facets;
        let points = || facets.iter().flat_map(|facet| &facet.points).copied();
        let first = points().next().unwrap_or_default();
        let (min, max) = points().fold((first, first), |(low, high), p| (low.min(p), high.max(p)));
        Picture { facets, bounds: Area { min, max } }
    }
}

struct Draft {
    colours: Colours,
    facets: Vec<Facet>,
}

impl Draft {
    fn part(&mut self, ring: &[DVec2], along: DVec2, part: &Part) {
        let eaves = part.height_m - part.rise_m;
        let mut walls: Vec<(DVec2, DVec2)> = ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)).collect();
        // The farther first.
        walls.sort_by(|a, b| (b.0.y + b.1.y).total_cmp(&(a.0.y + a.1.y)));
        for (a, b) in walls {
            self.face(&[a.extend(0.0), b.extend(0.0), b.extend(eaves), a.extend(eaves)], part.wall, true);
        }
        match part.roof {
            _ if part.rise_m <= 0.0 => self.level(ring, eaves, part.cover),
            RoofShape::Dome | RoofShape::Round => self.turned(ring, eaves, part, &DOME),
            RoofShape::Onion => self.turned(ring, eaves, part, &ONION),
            RoofShape::Cone | RoofShape::Pyramidal => self.turned(ring, eaves, part, &CONE),
            RoofShape::Flat | RoofShape::SawTooth | RoofShape::Skillion => self.level(ring, part.height_m, part.cover),
            RoofShape::Gabled | RoofShape::Gambrel => self.ridged(ring, along, eaves, part, 0.0),
            RoofShape::HalfHipped => self.ridged(ring, along, eaves, part, 0.4),
            RoofShape::Hipped | RoofShape::Mansard => self.ridged(ring, along, eaves, part, 1.0),
        }
    }

    fn level(&mut self, ring: &[DVec2], z: f64, cover: Rgb) {
        let top: Vec<DVec3> = ring.iter().map(|p| p.extend(z)).collect();
        self.face(&top, cover, true);
    }

    /// A roof over a ridge along a direction, whose ends lie so far in, as a share of half its breadth.
    fn ridged(&mut self, ring: &[DVec2], along: DVec2, eaves: f64, part: &Part, hip: f64) {
        let across = along.perp();
        let range = |axis: DVec2| {
            ring.iter().map(|p| p.dot(axis)).fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
        };
        let ((from, to), (left, right)) = (range(along), range(across));
        let inset = (hip * (right - left) / 2.0).min((to - from) / 2.0);
        let ridge = |p: DVec2| {
            // Over a point both ends are one, but for rounding.
            let at = p.dot(along).max(from + inset).min(to - inset);
            (along * at + across * ((left + right) / 2.0)).extend(part.height_m)
        };
        for (a, b) in ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)) {
            let (top_a, top_b) = (ridge(a), ridge(b));
            let is_gable = hip == 0.0 && (b - a).normalize_or_zero().dot(along).abs() < 0.5;
            let mut face = vec![a.extend(eaves), b.extend(eaves), top_b];
            if top_a.distance(top_b) > 1e-6 {
                face.push(top_a);
            }
            self.face(&face, if is_gable { part.wall } else { part.cover }, true);
        }
    }

    /// A roof whose outline shrinks to its middle, ring by ring.
    fn turned(&mut self, ring: &[DVec2], eaves: f64, part: &Part, profile: &[(f64, f64)]) {
        let middle = ring.iter().sum::<DVec2>() / ring.len().max(1) as f64;
        let at = |p: DVec2, (up, out): (f64, f64)| (middle + (p - middle) * out).extend(eaves + part.rise_m * up);
        for pair in profile.windows(2) {
            for (a, b) in ring.iter().copied().zip(ring.iter().copied().cycle().skip(1)) {
                let mut face = vec![at(a, pair[0]), at(b, pair[0]), at(b, pair[1])];
                if pair[1].1 > 0.0 {
                    face.push(at(a, pair[1]));
                }
                self.face(&face, part.cover, profile.len() == 2);
            }
        }
    }

    /// Adds a face that looks towards who looks at it; corners counter-clockwise seen from outside.
    fn face(&mut self, corners: &[DVec3], colour: Rgb, has_edge: bool) {
        let normal = newell(corners).normalize_or_zero();
        // From before and above.
        if normal.dot(DVec3::new(0.0, -UP, DOWN)) <= 1e-6 {
            return;
        }
        let light = normal.dot(LIGHT).max(0.0);
        let fill = tinted(colour, self.colours).scaled(0.66 + 0.46 * light);
        let points = corners.iter().map(|p| DVec2::new(p.x, -(p.y * DOWN + p.z * UP))).collect();
        let edge = has_edge.then(|| tinted(colour, self.colours).scaled(if self.colours == Colours::Contrast { 0.0 } else { 0.5 }));
        self.facets.push(Facet { points, fill, edge });
    }
}

/// Normal of a polygon by Newell's method.
fn newell(corners: &[DVec3]) -> DVec3 {
    corners.iter().zip(corners.iter().cycle().skip(1)).map(|(a, b)| a.cross(*b)).sum()
}

/// The city's own colour on paper; greys of its lightness in the other inks.
fn tinted(colour: Rgb, colours: Colours) -> Rgb {
    let Rgb(r, g, b) = colour;
    let grey = (f64::from(r) * 0.299 + f64::from(g) * 0.587 + f64::from(b) * 0.114) / 255.0;
    match colours {
        Colours::Paper => colour,
        Colours::Contrast | Colours::ColourBlind => Rgb(0xF4, 0xF2, 0xF0).scaled(0.3 + 0.7 * grey),
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::{GridPolygon, HouseName, PlanRoof};

    use super::*;

    /// Two towers west of a nave.
    fn church() -> Overview {
        let body = |x: f64, y: f64, size: (f64, f64), height: f64, shape, rise: f64| {
            let corner = |dx: f64, dy: f64| GridPos::from_metres(DVec2::new(x + dx, y + dy));
            let ring = vec![corner(0.0, 0.0), corner(size.0, 0.0), corner(size.0, size.1), corner(0.0, size.1)];
            let [height, rise] = [height, rise].map(GridPos::steps);
            let roof = PlanRoof { shape, height: rise, direction: 90, colour: Rgb(70, 80, 90) };
            Massing { outline: GridPolygon::simple(ring), height, roof, colour: Rgb(160, 150, 130) }
        };
        Overview {
            houses: vec![
                body(-40.0, 0.0, (12.0, 9.0), 14.0, RoofShape::Hipped, 4.0),
                body(10.0, 4.0, (40.0, 14.0), 40.0, RoofShape::Gabled, 14.0),
                body(0.0, 0.0, (10.0, 10.0), 80.0, RoofShape::Pyramidal, 30.0),
                body(0.0, 14.0, (10.0, 10.0), 80.0, RoofShape::Pyramidal, 30.0),
            ],
            names: vec![
                HouseName { house: 0, name: "Low".into(), number: String::new(), parts: 1 },
                HouseName { house: 1, name: "Church".into(), number: String::new(), parts: 3 },
            ],
            ..Overview::default()
        }
    }

    #[test]
    fn high_houses_with_a_name_are_landmarks_with_all_their_parts() {
        let found = landmarks(&church());
        assert_eq!(found.iter().map(|l| (l.name.as_str(), l.height_m, l.parts.len())).collect::<Vec<_>>(), [("Church", 80.0, 3)]);
        assert_eq!(found[0].plan_pos, DVec2::new(25.0, 12.0));
        assert!(found[0].stands_on(DVec2::new(5.0, 5.0)) && !found[0].stands_on(DVec2::new(30.0, 1.0)));
    }

    #[test]
    fn from_the_west_both_towers_stand_side_by_side_before_the_nave() {
        let church = &landmarks(&church())[0];
        // With east up, one looks from the west.
        let picture = church.picture(90.0, Colours::Paper);
        let apex = |facet: &Facet| facet.points.iter().copied().min_by(|a, b| a.y.total_cmp(&b.y)).unwrap_or_default();
        let top = picture.bounds.min.y;
        let mut spires: Vec<i32> =
            picture.facets.iter().map(apex).filter(|p| p.y < top + 1.0).map(|p| p.x.round() as i32).collect();
        spires.dedup();
        spires.sort_unstable();
        spires.dedup();
        assert_eq!(spires, [-7, 7], "two spires, 14 m apart: {spires:?}");
        // A house 80 m high and 24 m broad.
        let size = picture.bounds.size();
        assert!((size.x - 24.0).abs() < 1e-6 && size.y > 69.0 && size.y < 95.0, "{size}");
    }

    #[test]
    fn towers_that_would_hide_one_another_are_seen_from_aslant() {
        let church = &landmarks(&church())[0];
        assert_eq!(
            (church.best_view(90.0), church.best_view(0.0).abs()),
            (90.0, 40.0),
            "they stand one behind the other from the south"
        );
    }

    #[test]
    fn what_looks_away_is_not_drawn_and_light_comes_from_the_left() {
        let mut overview = church();
        overview.names = vec![HouseName { house: 2, name: "Tower".into(), number: String::new(), parts: 1 }];
        let picture = landmarks(&overview)[0].picture(0.0, Colours::Paper);
        // A wall and three slopes: the spire is so steep that its far slope looks away.
        assert_eq!(picture.facets.len(), 4);
        let slope = |left: bool| {
            let is_it = |f: &&Facet| f.points.len() == 3 && f.points.iter().map(|p| p.x).sum::<f64>().is_sign_negative() == left;
            let of = picture.facets.iter().find(|f| is_it(f) && f.points.iter().map(|p| p.x).sum::<f64>().abs() > 1.0);
            of.map(|f| u32::from(f.fill.0)).unwrap_or_default()
        };
        assert!(slope(true) > slope(false) && slope(false) > 0, "{} {}", slope(true), slope(false));
    }
}
