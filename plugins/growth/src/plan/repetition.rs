//! How much the fronts along a street are alike: what visitors call boring, as a number.

use std::collections::BTreeMap;

use glam::DVec2;
use veduta_city::{CityPlan, GridPos, Id, Ornament, PlanStreet, Volume, Wall, WallKind};

use super::variety::alike;

/// How alike the fronts are that a visitor sees side by side.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Repetition {
    /// Fronts that stand with another on the same side of a street.
    pub fronts: usize,
    /// Mean likeness of each front to that one which is most like it, of those on its side of the street within [`SEEN_M`]: 0 if they have
    /// nothing in common, 1 if each has a double. See [`TRAITS`].
    pub mean: f64,
    /// The street of eight fronts or more on which the mean is greatest: its name, or its id where it has none, and its mean.
    pub dullest: Option<(String, f64)>,
    /// Houses that nothing tells apart, pair by pair, ascending.
    pub doubles: Vec<(Id, Id)>,
}

/// So far along a street fronts are seen together, metres.
pub const SEEN_M: f64 = 40.0;

/// What fronts have in common, and how much each counts, by what is seen from afar: colours and outline first, openings and ornament next.
pub const TRAITS: [(&str, f64); 10] = [
    ("colour of the wall", 3.0),
    ("colour of the roof", 1.0),
    ("eaves, within 0.3 m", 2.0),
    ("shape of gable and roof", 1.0),
    ("width, within a twentieth", 1.0),
    ("window axes", 1.0),
    ("storeys", 1.0),
    ("windows", 2.0),
    ("ground floor", 2.0),
    ("ornament", 1.0),
];

/// A front belongs to a street whose middle line lies no farther off than this, and half its width; metres.
const FACED_M: f64 = 8.0;
/// Eaves that differ by less look alike; metres.
const EAVES_M: f64 = 0.3;
/// Fronts on one side of a street face about one way: cosine of what they may differ by.
const FACING: f64 = 0.7;
/// Shortest wall that is a front, metres.
const LEAST_M: f64 = 3.0;
/// Fewest fronts of a street that may be the dullest.
const LEAST_FRONTS: usize = 8;
/// Side of the squares in which streets are looked up, metres.
const SQUARE_M: f64 = 64.0;

/// Looks at all fronts of a plan.
///
/// ```
/// use veduta_city::{CityGraph, file};
/// use veduta_growth::plan::{Stock, grow, repetition};
///
/// let graph: CityGraph = file::parse(
///     r#"(name: "A lane", anchor: (lat: 50.09, lon: 14.42), seed: 1,
///         nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (80, 0))],
///         links: [(from: 1, to: 2, kind: Street(Lane), name: "Long Lane")],
///         blocks: [(outline: [(5, 3.5), (75, 3.5), (75, 50), (5, 50)])])"#,
///     "lane.graph.ron",
/// )?;
/// let seen = repetition(&grow(&graph, &Stock::new())?.plan);
/// assert!(seen.fronts > 5 && seen.mean < 0.9 && seen.doubles.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn repetition(plan: &CityPlan) -> Repetition {
    let streets = Streets::new(plan);
    // By street, the longest front of each house.
    let mut fronts = BTreeMap::<usize, Vec<Front<'_>>>::new();
    for front in plan.houses.iter().flat_map(|house| house.volumes.iter().flat_map(move |volume| Front::of(house.id, volume))) {
        let Some(street) = streets.faced(&front) else { continue };
        let along = fronts.entry(street).or_default();
        match along.iter_mut().find(|other| other.house == front.house && other.out.dot(front.out) > FACING) {
            Some(other) if other.length_m < front.length_m => *other = front,
            Some(_) => {}
            None => along.push(front),
        }
    }
    let (mut all, mut by_name, mut doubles) = (Vec::new(), BTreeMap::<&str, Vec<f64>>::new(), Vec::new());
    for (street, along) in &fronts {
        for (n, front) in along.iter().enumerate() {
            let seen = along.iter().enumerate().filter(|&(m, other)| m != n && front.is_seen_with(other));
            let Some(likeness) = seen.map(|(_, other)| front.likeness(other)).max_by(f64::total_cmp) else { continue };
            all.push(likeness);
            by_name.entry(streets.names[*street].as_str()).or_default().push(likeness);
            let twins = along.iter().filter(|other| front.house < other.house && front.is_seen_with(other));
            doubles.extend(twins.filter(|other| front.likeness(other) > 0.999).map(|other| (front.house, other.house)));
        }
    }
    doubles.sort_unstable();
    doubles.dedup();
    let mean = |of: &[f64]| of.iter().sum::<f64>() / of.len().max(1) as f64;
    let long = by_name.into_iter().filter(|(_, likenesses)| likenesses.len() >= LEAST_FRONTS);
    let dullest = long.map(|(name, likenesses)| (name.to_owned(), mean(&likenesses))).max_by(|a, b| a.1.total_cmp(&b.1));
    Repetition { fronts: all.len(), mean: mean(&all), dullest, doubles }
}

/// A wall that faces a street.
struct Front<'a> {
    house: Id,
    volume: &'a Volume,
    wall: &'a Wall,
    middle: DVec2,
    /// Out of the wall.
    out: DVec2,
    length_m: f64,
}

impl<'a> Front<'a> {
    fn of(house: Id, volume: &'a Volume) -> impl Iterator<Item = Self> {
        volume.footprint.edges().zip(&volume.walls).filter_map(move |((a, b), wall)| {
            let (a, b) = (a.to_metres(), b.to_metres());
            let length_m = a.distance(b);
            let is_front = wall.kind == WallKind::Street && wall.bays > 0 && length_m >= LEAST_M;
            is_front.then(|| Self { house, volume, wall, middle: (a + b) / 2.0, out: (a - b).perp() / length_m, length_m })
        })
    }

    fn is_seen_with(&self, other: &Self) -> bool {
        self.middle.distance(other.middle) <= SEEN_M && self.out.dot(other.out) > FACING
    }

    /// Share of [`TRAITS`] that both have in common.
    fn likeness(&self, other: &Self) -> f64 {
        let (a, b) = (self, other);
        let eaves = |front: &Self| GridPos(front.volume.eaves, 0).to_metres().x;
        let upper = |front: &Self| front.wall.storeys.iter().skip(1).map(|storey| storey.opening).collect::<Vec<_>>();
        let ground = |front: &Self| (0..front.wall.bays).map(|bay| front.wall.opening(0, bay)).collect::<Vec<_>>();
        let ornament = |front: &Self| front.wall.ornament.as_deref().copied().unwrap_or(Ornament::default());
        let is_alike = [
            alike(a.volume.colour, b.volume.colour),
            alike(a.volume.roof.colour, b.volume.roof.colour),
            (eaves(a) - eaves(b)).abs() < EAVES_M,
            a.volume.gable == b.volume.gable && a.volume.roof.shape == b.volume.roof.shape,
            (a.length_m - b.length_m).abs() < a.length_m.max(b.length_m) / 20.0,
            a.wall.bays == b.wall.bays,
            a.wall.storeys.len() == b.wall.storeys.len(),
            upper(a) == upper(b),
            ground(a) == ground(b),
            ornament(a) == ornament(b),
        ];
        let all: f64 = TRAITS.iter().map(|(_, weight)| weight).sum();
        is_alike.iter().zip(TRAITS).map(|(&is_alike, (_, weight))| if is_alike { weight } else { 0.0 }).sum::<f64>() / all
    }
}

/// Streets by their names, and where they run.
struct Streets<'a> {
    plan: &'a CityPlan,
    /// What each street is called; its id where it has no name.
    names: Vec<String>,
    /// Of each street of the plan, its place among the names.
    of: Vec<usize>,
    /// Segments by the squares that they are near to: street and place of its first vertex.
    squares: BTreeMap<(i64, i64), Vec<(usize, usize)>>,
}

impl<'a> Streets<'a> {
    fn new(plan: &'a CityPlan) -> Self {
        let name = |street: &PlanStreet| if street.name.is_empty() { street.id.to_string() } else { street.name.clone() };
        let mut names: Vec<String> = plan.streets.iter().map(name).collect();
        names.sort_unstable();
        names.dedup();
        let of = plan.streets.iter().map(|street| names.binary_search(&name(street)).unwrap_or_default()).collect();
        let mut squares = BTreeMap::<(i64, i64), Vec<(usize, usize)>>::new();
        for (n, street) in plan.streets.iter().enumerate().filter(|(_, street)| street.walkable) {
            let reach = reach_m(street);
            for (i, pair) in street.line.windows(2).enumerate() {
                let (a, b) = (pair[0].to_metres(), pair[1].to_metres());
                let (low, high) = (square(a.min(b) - reach), square(a.max(b) + reach));
                for x in low.0..=high.0 {
                    for y in low.1..=high.1 {
                        squares.entry((x, y)).or_default().push((n, i));
                    }
                }
            }
        }
        Self { plan, names, of, squares }
    }

    /// The street that a front faces, by its name's place.
    fn faced(&self, front: &Front<'_>) -> Option<usize> {
        let near = self.squares.get(&square(front.middle))?;
        let away = |&(n, i): &(usize, usize)| {
            let street = &self.plan.streets[n];
            let (a, b) = (street.line[i].to_metres(), street.line[i + 1].to_metres());
            let along = ((front.middle - a).dot(b - a) / (b - a).length_squared().max(1e-9)).clamp(0.0, 1.0);
            let to = a + (b - a) * along - front.middle;
            // It lies before the front, not behind the house.
            (to.length() <= reach_m(street) && to.dot(front.out) > 0.0).then_some((to.length(), n))
        };
        near.iter().filter_map(away).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, n)| self.of[n])
    }
}

fn reach_m(street: &PlanStreet) -> f64 {
    GridPos(street.width, 0).to_metres().x / 2.0 + FACED_M
}

fn square(p: DVec2) -> (i64, i64) {
    ((p.x / SQUARE_M).floor() as i64, (p.y / SQUARE_M).floor() as i64)
}

#[cfg(test)]
mod tests {
    use veduta_city::{CityGraph, House, Rgb, file};

    use super::*;
    use crate::plan::{Stock, grow};

    /// A lane with houses on both sides.
    fn lane() -> CityPlan {
        let graph: CityGraph = file::parse(
            r#"(name: "A lane", anchor: (lat: 50.09, lon: 14.42), seed: 3,
                nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (160, 0))],
                links: [(from: 1, to: 2, kind: Street(Lane), name: "Long Lane")],
                blocks: [(outline: [(5, 3.5), (155, 3.5), (155, 50), (5, 50)]),
                         (outline: [(5, -50), (155, -50), (155, -3.5), (5, -3.5)])])"#,
            "lane.graph.ron",
        )
        .expect("a graph");
        grow(&graph, &Stock::new()).expect("it grows").plan
    }

    #[test]
    fn a_grown_lane_is_no_row_of_doubles() {
        let seen = repetition(&lane());
        assert!(seen.fronts > 20, "{seen:?}");
        assert!(seen.mean > 0.05 && seen.mean < 0.75, "{seen:?}");
        assert_eq!(seen.dullest.as_ref().map(|(name, _)| name.as_str()), Some("Long Lane"));
        assert_eq!(seen.doubles, []);
    }

    #[test]
    fn copies_of_one_house_are_told() {
        let mut plan = lane();
        // One house again and again, 12 m apart along the lane.
        let house = plan.houses.iter().find(|house| house.volumes.iter().any(|v| Front::of(house.id, v).any(|f| f.out.y < -0.9)));
        let house = house.expect("one that faces the lane from the north").clone();
        let moved = |n: i32| House {
            id: Id(1_000 + n as u64),
            volumes: (house.volumes.iter())
                .map(|volume| Volume { footprint: volume.footprint.map(|p| GridPos(p.0 + n * 12 * 1024, p.1)), ..volume.clone() })
                .collect(),
            ..house.clone()
        };
        plan.houses = (0..9).map(moved).collect();
        plan.streets[0].line = vec![GridPos(-200 * 1024, 0), GridPos(400 * 1024, 0)];
        let copies = repetition(&plan);
        assert!((copies.mean - 1.0).abs() < 1e-9 && copies.fronts == 9, "{copies:?}");
        assert_eq!(copies.dullest, Some(("Long Lane".to_owned(), 1.0)));
        // Each with the three within 40 m after it.
        assert_eq!(copies.doubles.len(), 8 + 7 + 6);
        // Another colour is what is seen first, and is not all.
        for (n, house) in plan.houses.iter_mut().enumerate() {
            house.volumes.iter_mut().for_each(|volume| volume.colour = Rgb(20 * n as u8 + 30, 90, 200 - 20 * n as u8));
        }
        let painted = repetition(&plan);
        assert!((painted.mean - 12.0 / 15.0).abs() < 1e-9 && painted.doubles.is_empty(), "{painted:?}");
    }
}
