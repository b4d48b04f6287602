//! The city plan from the city graph.
//!
//! ```text
//!  CityGraph ─┬─► extent ─► streets ─► ground ─► verges ─┬─► lots ─┐
//!             ├─► houses (given) ───────────────────────┴─────────┴─► facing ─► floors ─► massing ─► variety ─┐
//!             ├─► earthworks ─► bridges ─► terrain (streets cut into it) ─► spans, tunnels (open the ground) ─┤
//!             └─► network (who waits where) ─► objects, markings, places, start ─► CityPlan ◄─ arcades ◄─ ornament ◄─ walls
//! ```
//!
//! Every stage is a function of the graph, the styles and the seed; each draw is keyed by seed, id and question. Geometry
//! that ends in the plan is computed in integers, outlines in steps of 1/64 m.
//!
//! ```
//! use veduta_city::{CityGraph, file};
//! use veduta_growth::plan::{Stock, grow};
//!
//! let graph: CityGraph = file::parse(
//!     r#"(name: "A lane", anchor: (lat: 50.09, lon: 14.42), seed: 1,
//!         nodes: [(id: 1, pos: (0, 0)), (id: 2, pos: (80, 0))],
//!         links: [(from: 1, to: 2, kind: Street(Lane), name: "Long Lane")],
//!         blocks: [(outline: [(5, 3.5), (75, 3.5), (75, 50), (5, 50)])])"#,
//!     "lane.graph.ron",
//! )?;
//! let growth = grow(&graph, &Stock::new())?;
//! assert!(growth.plan.houses.len() > 10, "the empty block has been built up");
//! assert!(growth.findings.is_empty());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Limits
//! Bridges go from ground to ground: over water, over valleys that the terrain tells, and over streets and railways on lower layers, to which
//! the ways on both sides rise on embankments where the terrain tells none. Where nothing of that lies under a link that a map calls a
//! bridge, it stays on the ground. Tunnels come out on the ground at one end at least, each for itself: where they meet one another below it,
//! or have no room for their ramps, they are left out with a finding, as covered watercourses are.
//! Arcades on slopes, at sharp corners and under shallow houses are painted. The `z` of nodes is not looked at: the ground is the
//! graph's terrain alone.
//!
//! # Rejected
//! Boolean operations in place of one arrangement of the ground (neighbours do not share their vertices) ·
//! floating-point overlays that are snapped afterwards (snapping makes rings cross) · subdividing blocks
//! recursively into lots (good for suburbs; an old town's lots are a ring of burgages round a courtyard).

mod arcades;
mod arrangement;
mod band;
pub(crate) mod boolean;
mod bridges;
mod cellars;
mod chains;
mod courses;
mod crossings;
mod crossroads;
mod earthworks;
mod extent;
mod facing;
mod floors;
mod furniture;
mod ground;
mod groups;
mod houses;
mod index;
mod inradius;
mod lots;
mod markings;
mod massing;
mod monuments;
mod network;
mod objects;
mod ornament;
mod outline;
mod painted;
mod perimeter;
mod places;
mod profile;
mod relation;
mod repetition;
mod spans;
mod stand;
mod stock;
mod streets;
mod terrain;
mod tunnels;
mod variety;
mod walks;
mod walls;
mod water;

use std::borrow::Cow;

use veduta_city::{Block, CityGraph, CityPlan, Finding, GraphError, GridPolygon, GridPos, StyleError};

pub use repetition::{Repetition, SEEN_M, TRAITS, repetition};
pub use stock::{Stock, StockError};

/// Version of growth: plans grown by one version from the same graph are the same bytes; another version may differ.
pub const GROWTH_VERSION: u32 = 20;

/// A plan, and what had to be left out or mended on the way to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Growth {
    /// The plan.
    pub plan: CityPlan,
    /// What was dropped or repaired, in order of stages.
    pub findings: Vec<Finding>,
}

/// Why nothing was grown.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GrowthError {
    /// The graph is unsound.
    #[error("the graph has {} mistakes; the first: {}", .0.len(), first(.0))]
    Graph(Vec<GraphError>),
    /// The styles are unsound.
    #[error("the styles have {} mistakes; the first: {}", .0.len(), first(.0))]
    Styles(Vec<StyleError>),
    /// There is no style, or there are more than plans can number.
    #[error("{0} styles: there need to be 1 to 65,535")]
    StyleCount(usize),
}

fn first<E: core::fmt::Display>(errors: &[E]) -> String {
    errors.first().map(ToString::to_string).unwrap_or_default()
}

/// A block's ground as valid polygons.
struct Area<'a> {
    block: &'a Block,
    polygons: Vec<GridPolygon>,
}

impl Area<'_> {
    fn holds(&self, pos: GridPos) -> bool {
        self.polygons.iter().any(|p| p.contains(pos))
    }
}

/// Grows a plan from a graph: street surfaces, houses from footprints and on the lots of empty blocks, walls, roofs, objects
/// and places. Things without an id are given one first ([`CityGraph::fill_ids`]).
///
/// # Errors
/// [`GrowthError`] if the graph or the styles do not pass their own validation. A monument that cannot be built is a finding.
pub fn grow(graph: &CityGraph, stock: &Stock) -> Result<Growth, GrowthError> {
    let Stock { styles, monuments, furniture, models, facades } = stock;
    let mut graph = Cow::Borrowed(graph);
    if !graph.has_ids() {
        graph.to_mut().fill_ids();
    }
    let graph: &CityGraph = &graph;
    let mistakes = graph.validate();
    if !mistakes.is_empty() {
        return Err(GrowthError::Graph(mistakes));
    }
    let mistakes = styles.validate();
    if !mistakes.is_empty() {
        return Err(GrowthError::Styles(mistakes));
    }
    if styles.0.is_empty() || styles.0.len() > usize::from(u16::MAX) {
        return Err(GrowthError::StyleCount(styles.0.len()));
    }
    let mut findings = Vec::new();
    let mut told = Vec::new();
    let ((extent, areas), (courses, network)) = rayon::join(
        || rayon::join(|| extent::extent(graph, &mut findings), || streets::areas(&graph.blocks, &mut told)),
        || rayon::join(|| courses::Courses::of(graph), || network::Network::new(graph)),
    );
    findings.extend(told);
    let depths = water::Depths::of(graph.terrain.as_ref());
    let works = earthworks::Earthworks::of(graph);
    let waters = water::Waters::of(graph, &areas, depths);
    let mut bridges = bridges::Bridges::of(graph, &waters, &works);
    let terrain = terrain::terrain(graph, (&bridges, &works), &extent);
    let mut spans = spans::spans(graph, &bridges, &terrain);
    let book = houses::StyleBook::new(styles, &areas, &mut findings);
    let mut drafts = houses::given(graph, &book, &extent, &mut findings);
    let below = tunnels::Ground { graph, terrain: &terrain, waters: &waters, bridges: &bridges, given: &drafts, extent: &extent };
    let tunnels = tunnels::Tunnels::of(&below, &mut findings);
    spans.extend(tunnels.spans);
    bridges.add(tunnels.ways);
    let layers = streets::layers(graph, &areas, (&bridges, depths, &courses), tunnels.openings, &mut findings);

    let mut ground = ground::partition(&extent, &layers);
    let (_, obstacles) = rayon::join(
        || ground::pave_verges(&mut ground, &extent, &facing::bodies(&drafts)),
        || lots::Obstacles::new(graph, &layers, &drafts),
    );
    drop(layers);
    let (on_ground, grown) = rayon::join(
        || ground::index(&ground),
        || lots::grow_lots(graph, &areas, &ground, &extent, &obstacles, &book, &mut findings),
    );
    drop(obstacles);
    drafts.reserve_exact(grown.len());
    drafts.extend(grown);
    let (facing, cells) = facing::facing(&drafts, &on_ground);
    let (masses, looks) = rayon::join(
        || {
            let floors = floors::floors(&drafts, &facing, &terrain);
            massing::masses(&drafts, &facing, &floors, &book, &mut findings)
        },
        || variety::looks(&drafts, &facing, &book),
    );
    let mut houses = walls::houses(drafts, &facing, &masses, &looks, &book, &terrain);
    let mut designs = monuments::Designs::new(monuments, models);
    drop((facing, masses, looks));
    let standing = walls::standing(&houses, cells);
    designs.of_houses(graph, &mut houses, &mut findings);
    ornament::adorn(&mut houses, &standing, &terrain, &book, graph.seed);
    arcades::open(&mut houses, (&on_ground, &standing), &terrain);
    cellars::build(&mut houses, &terrain);
    designs.stand_in(graph, &mut houses, &mut findings);
    let facades = painted::hang(facades, &mut houses, &mut findings);

    let (doorsteps, decks) = rayon::join(|| walls::doorsteps(&houses), || spans::Decks::new(spans.iter().enumerate()));
    let site = objects::Site { terrain: &terrain, ground: &on_ground, decks: &decks, standing: &standing, doorsteps: &doorsteps };
    let ((mut objects, monumental), (markings, (places, streets))) = rayon::join(
        || objects::objects(graph, &areas, (&network, furniture), &site, &mut findings),
        || {
            let others = || (places::places(graph, &houses, styles), streets::centre_lines(graph, &bridges));
            rayon::join(|| markings::markings(graph, &network, &bridges, &site), others)
        },
    );
    designs.of_objects(&monumental, &mut objects, &mut findings);
    let start = places::start(graph, &extent, &site, &objects, &mut findings);
    let plan = CityPlan {
        name: graph.name.clone(),
        anchor: graph.anchor,
        attribution: graph.attribution.clone(),
        seed: graph.seed,
        growth_version: GROWTH_VERSION,
        styles: styles.clone(),
        designs: designs.finish(),
        start,
        extent: extent.polygon(),
        places,
        terrain,
        ground,
        courses: courses.finish(),
        houses,
        facades,
        objects,
        markings,
        spans,
        streets,
    };
    Ok(Growth { plan, findings })
}
