//! A city from words: a city graph without a map.
//!
//! ```text
//!  CityWords ─► border ─► river, quays ─► gates, bridges ─► main square, main streets, rings ─► blocks ─► CityGraph
//!               one face   three faces     vertices          faces (fabric.rs)                  faces      streets, squares,
//!                                                                                                          blocks, names
//! ```
//!
//! The town is a plane cut into faces, and the one thing that ever happens to it is that a line from border to border of a face
//! makes two of it (`fabric.rs`), if the line keeps clear of all others and meets them at wide angles (`fit.rs`). So streets
//! cannot cross without a node, run into each other, or end nowhere, whatever is drawn. Every draw is keyed by the seed and by
//! the place that it is about.
//!
//! Squares are open: streets end on their border, none runs in them. At an open edge of the town the outermost faces are
//! country, and streets that only they have are taken back.

mod centred;
mod check;
mod description;
mod fabric;
mod fit;
mod grain;
mod grounds;
mod hub;
mod landmarks;
mod lattice;
mod layout;
mod names;
mod network;
mod river;
mod shape;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;
use veduta_city::{Block, BlockKind, CityGraph, Id, Link, LinkKind, Node, Place, PlaceKind};

pub use check::WordsError;
pub use description::{CityWords, District, Outside, Part, Passes, Plan, River, TownEdge};

use crate::log::Log;
use crate::polygon::Polygon;
use crate::{Survey, SurveyError};
use fabric::rounded;
use layout::Town;
use names::Names;
use network::{Laid, Streets};

/// A direction turned left by an angle in radians.
fn turn(v: DVec2, angle: f64) -> DVec2 {
    let (sin, cos) = (libm::sin(angle), libm::cos(angle));
    DVec2::new(v.x * cos - v.y * sin, v.x * sin + v.y * cos)
}

/// Makes a city graph of a description: the same every time.
///
/// # Errors
/// [`SurveyError::Words`] if the description cannot be meant; what there was no room for is told in the findings instead.
pub fn survey_words(words: &CityWords) -> Result<Survey, SurveyError> {
    let name = words.name.trim().to_owned();
    let mistakes = words.validate();
    if !mistakes.is_empty() {
        return Err(SurveyError::Words { name, mistakes });
    }
    let mut log = Log::default();
    let mut town = layout::lay_out(words);
    tell_missing(&town, words, &mut log);
    let squares = grounds::open_squares(&mut town, words.squares);
    if squares < words.squares {
        log.note(Id::NONE, None, format!("{squares} of the {} squares that the words ask for have room", words.squares));
    }
    let church = grounds::choose_church(&mut town);
    grounds::choose_parks(&mut town, words.parks, words.seed);
    let graph = graph_of(&town, words, church);
    let errors = graph.validate();
    if !errors.is_empty() {
        let detail = errors.iter().take(3).map(ToString::to_string).collect::<Vec<_>>().join("; ");
        return Err(SurveyError::Graph { name, detail });
    }
    Ok(Survey { graph, findings: log.finish() })
}

fn tell_missing(town: &Town, words: &CityWords, log: &mut Log) {
    let Some(river) = &words.river else { return };
    if town.channel.is_none() {
        log.dropped(Id::NONE, None, "the river has no room in the town");
    } else if let Some(wanted) = river.bridges.filter(|&n| n as usize > town.bridges.len()) {
        log.note(Id::NONE, None, format!("{} of the {wanted} bridges that the words ask for have room", town.bridges.len()));
    }
}

fn graph_of(town: &Town, words: &CityWords, church: Option<usize>) -> CityGraph {
    let is_old = matches!(words.plan, Plan::Medieval { .. });
    let streets = Streets::of(&town.fabric);
    let mut names = Names::new(words.seed);
    let mut laid = streets.links(&town.fabric, is_old);
    let mut graph = CityGraph {
        name: words.name.trim().to_owned(),
        anchor: words.anchor,
        seed: words.seed,
        margin_m: CityGraph::default_margin_m(),
        nodes: network::nodes(&town.fabric, &laid),
        ..CityGraph::default()
    };
    let mut grounds = grounds::blocks(town, &streets, words);
    add_water(town, words, &mut names, &mut graph);
    add_squares(town, is_old, &mut names, &mut graph);
    let bridges = add_bridge_places(town, &laid, &mut names, &mut graph);
    for (name, pos) in grounds::districts(town, words, &mut grounds) {
        graph.places.push(place(&names.take(&name), PlaceKind::Other, pos, 60.0));
    }
    let mut blocks: Vec<Block> = grounds.into_iter().map(|g| name_ground(g, town, church, words, &mut names, &mut graph)).collect();
    graph.blocks.append(&mut blocks);
    name_streets(town, &mut laid, &bridges, &mut names);
    graph.links.extend(laid.into_iter().map(|l| l.link));
    add_outside(town, words, &mut graph);
    graph.fill_ids();
    graph.start = crate::start::start(&graph);
    graph
}

fn place(name: &str, kind: PlaceKind, pos: DVec2, radius_m: f64) -> Place {
    Place { name: name.to_owned(), kind, pos: rounded(pos), radius_m, ..Place::default() }
}

fn add_water(town: &Town, words: &CityWords, names: &mut Names, graph: &mut CityGraph) {
    let Some(channel) = &town.channel else { return };
    let given = words.river.as_ref().map(|r| r.name.trim()).filter(|n| !n.is_empty());
    let name = match given {
        Some(name) => names.take(name),
        None => names.river(),
    };
    let outline = channel.water().into_iter().map(rounded).collect();
    let block =
        Block { id: Id::NONE, kind: BlockKind::Water, name: name.clone(), district: String::new(), outline, holes: Vec::new() };
    graph.blocks.push(block);
    let line: Vec<DVec2> = channel.middle.iter().map(|&p| rounded(p)).collect();
    let [first, inner @ .., last] = line.as_slice() else { return };
    let node = |pos: DVec2| Node { id: Id::from_place("water node", pos), pos, z: 0.0 };
    graph.nodes.extend([node(*first), node(*last)]);
    graph.links.push(Link {
        id: Id::NONE,
        from: node(*first).id,
        to: node(*last).id,
        via: inner.to_vec(),
        kind: LinkKind::Watercourse,
        width_m: channel.width_m,
        profile: Vec::new(),
        name,
        layer: 0,
        surfacing: None,
    });
}

fn add_squares(town: &Town, is_old: bool, names: &mut Names, graph: &mut CityGraph) {
    let mut squares = grounds::squares(&town.fabric, is_old);
    // The main one first.
    squares.sort_by_key(|(face, _)| (Some(*face) != town.square, *face));
    for (n, (_, mut square)) in squares.into_iter().enumerate() {
        square.name = names.square(n, is_old);
        let middle = Polygon { outer: square.outline.clone(), holes: Vec::new() }.inner_pos();
        graph.places.push(place(&square.name, PlaceKind::Square, middle, 40.0));
        graph.objects.push(landmarks::centrepiece(&square.outline, n, is_old));
        graph.squares.push(square);
    }
}

/// Places of the bridges; gives back their names by way.
fn add_bridge_places(town: &Town, laid: &[Laid], names: &mut Names, graph: &mut CityGraph) -> BTreeMap<usize, String> {
    let mut out = BTreeMap::new();
    for (n, bridge) in town.bridges.iter().enumerate() {
        if laid.iter().any(|l| l.way == bridge.way) {
            let middle = (town.fabric.pos(bridge.ends[0]) + town.fabric.pos(bridge.ends[1])) / 2.0;
            let name = names.bridge(n);
            graph.places.push(place(&name, PlaceKind::Monument, middle, 30.0));
            out.insert(bridge.way, name);
        }
    }
    out
}

/// Names of parks and the church, with their places.
fn name_ground(
    ground: grounds::Ground,
    town: &Town,
    church: Option<usize>,
    words: &CityWords,
    names: &mut Names,
    graph: &mut CityGraph,
) -> Block {
    let mut block = ground.block;
    let middle = Polygon { outer: block.outline.clone(), holes: Vec::new() }.inner_pos();
    let is_chosen = town.fabric.faces.get(ground.face).is_some_and(|f| f.use_ == fabric::Use::Park);
    if is_chosen {
        block.name = names.park(ground.face);
        graph.places.push(place(&block.name, PlaceKind::Other, middle, 40.0));
    } else if Some(ground.face) == church && block.kind == BlockKind::Monument {
        let name = names.church();
        // The ground was chosen for having room.
        graph.buildings.extend(landmarks::church(&block.outline, &name, words.seed));
        graph.places.push(place(&name, PlaceKind::Monument, middle, 35.0));
        block.name = name;
    }
    block
}

/// Names every street: a way by one name as far as it hangs together.
fn name_streets(town: &Town, laid: &mut [Laid], bridges: &BTreeMap<usize, String>, names: &mut Names) {
    let mut of_way: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (i, l) in laid.iter().enumerate() {
        of_way.entry(l.way).or_default().push(i);
    }
    let mut count = 0;
    for (way, mut links) in of_way {
        let Some(class) = network::class_of(&town.fabric, way) else { continue };
        while let Some(first) = links.first().copied() {
            let (mut piece, mut spots) = (vec![first], BTreeSet::from(laid[first].ends));
            while let Some(&next) = links.iter().find(|i| !piece.contains(i) && laid[**i].ends.iter().any(|s| spots.contains(s))) {
                piece.push(next);
                spots.extend(laid[next].ends);
            }
            links.retain(|i| !piece.contains(i));
            count += 1;
            let name = bridges.get(&way).cloned().unwrap_or_else(|| names.street(count, class));
            piece.iter().for_each(|&i| laid[i].link.name.clone_from(&name));
        }
    }
}

/// Wall, roads out of it, railway.
fn add_outside(town: &Town, words: &CityWords, graph: &mut CityGraph) {
    if town.is_closed {
        for (mut link, node) in landmarks::roads_out(town) {
            let inner = graph.links.iter().find(|l| [l.from, l.to].contains(&link.from) && (l.width_m - link.width_m).abs() < 1e-9);
            link.name = inner.map(|l| l.name.clone()).unwrap_or_default();
            if inner.is_some() {
                graph.nodes.push(node);
                graph.links.push(link);
            }
        }
        if matches!(words.plan, Plan::Medieval { edge: TownEdge::Wall, .. }) {
            graph.buildings.extend(landmarks::wall(town));
        }
    }
    if words.railway {
        let (link, nodes, station) = landmarks::railway(town, words.seed);
        graph.nodes.extend(nodes);
        graph.links.push(link);
        graph.places.push(place("Railway", PlaceKind::Other, station, 60.0));
    }
}
