use std::collections::BTreeMap;

use rayon::prelude::*;
use veduta_city::bounds::do_meet;
use veduta_city::{
    Cell, CellShell, Cells, CityPlan, Course, Design, FacadeSheet, GRID_PER_METRE, GridPolygon, GridPos, GridRing, GroundPatch,
    House, HouseShell, Marking, ObjectShell, PaintedWall, PictureFile, PlacedMonument, PlanFacade, PlanObject, PlanTerrain,
    SpanStation, Volume, VolumeShell, WaySpan,
};

use crate::ground;
use crate::overlay::{Bounds, Keep, combine, turned_rings};
use crate::patches::Patches;
use crate::widen::Hidden;

/// What goes into the packets of cells, cell by cell.
pub struct Contents<'a> {
    plan: &'a CityPlan,
    cells: &'a Cells,
    patches: Patches<'a>,
    hidden: Hidden<'a>,
    decks: Vec<Option<Bounds>>,
}

impl<'a> Contents<'a> {
    /// For the cells of a plan.
    #[must_use]
    pub fn new(plan: &'a CityPlan, cells: &'a Cells) -> Self {
        let decks = plan.spans.iter().map(|span| span.outline().bounds()).collect();
        Self { plan, cells, patches: Patches::new(plan), hidden: Hidden::new(plan), decks }
    }

    /// Content of a cell's level-1 packet: ground (of its yards, too), houses, objects and blind portals, relative to the packet's
    /// origin. Ground under houses is left out or, beside yards, told as suits their outlines, but not under monuments, which need not fill
    /// their buildings' footprints. Empty beyond the last cell.
    #[must_use]
    pub fn shell(&self, cell: usize) -> CellShell {
        let Some(cell) = self.cells.cells.get(cell) else { return CellShell::default() };
        let plan = self.plan;
        let origin = origin(cell);
        let footings = footings(plan, cell);
        let windows = core::iter::once(&cell.outline).chain(&cell.yards).chain(&footings);
        let portals = cell.portals.iter().filter_map(|&p| self.cells.portals.get(p as usize)).map(|portal| portal.ends);
        let portals: Vec<_> = portals.collect();
        let pieces = windows.flat_map(|window| self.patches.clipped(window)).collect();
        let ground = ground::merged(pieces, &portals, &self.hidden);
        let (courses, numbers) = courses(plan, &ground, origin);
        let patch = |patch: GroundPatch| {
            let course = patch.course.and_then(|course| numbers.get(&course).copied());
            GroundPatch { outline: patch.outline.map(|p| p.wrapping_sub(origin)), course, ..patch }
        };
        let ground: Vec<GroundPatch> = ground.into_iter().map(patch).collect();
        let houses = houses(plan, cell, origin);
        let mut designs = Designs::default();
        let monuments = monuments(plan, cell, origin, &mut designs);
        let objects = objects(plan, cell, origin, &mut designs);
        let spans = spans(plan, cell, &self.decks, origin);
        CellShell {
            origin,
            outline: cell.outline.map(|p| p.wrapping_sub(origin)),
            terrain: terrain(plan, origin, &ground, (&houses, spans.get(..cell.spans.len()).unwrap_or_default())),
            ground,
            courses,
            houses,
            objects,
            blind: blind(self.cells, cell, origin),
            markings: markings(plan, cell, origin),
            spans,
            drawn_spans: cell.spans.len() as u32,
            designs: designs.list,
            monuments,
        }
    }

    /// Content of a cell's level-2 packet: the openings of its walls, in the order in which its shell lists them. Walls that the plan does
    /// not have ([`crate::check`] names them) come as blind walls, so that the order holds. Empty beyond the last cell.
    #[must_use]
    pub fn sheet(&self, cell: usize) -> FacadeSheet {
        let wall = |&(h, v, w): &(u32, u16, u16)| {
            let volume = self.plan.houses.get(h as usize).and_then(|house| house.volumes.get(usize::from(v)))?;
            Some(volume.walls.get(usize::from(w)).cloned().unwrap_or_default())
        };
        let walls = self.cells.cells.get(cell).map_or(&[][..], |cell| &cell.walls);
        let mut sheet = FacadeSheet::of(walls.iter().filter_map(wall).collect());
        sheet.painted = self.painted(cell).map(|(wall, facade)| PaintedWall { wall, painted: facade.painted.clone() }).collect();
        sheet
    }

    /// Content of a cell's level-3 packet: pictures of its painted walls, in the order in which its sheet lists them.
    #[must_use]
    pub fn pictures(&self, cell: usize) -> Vec<PictureFile> {
        self.painted(cell).flat_map(|(_, facade)| facade.pictures.iter().cloned()).collect()
    }

    /// Painted walls of a cell, as many as it may have: where in its sheet each is.
    fn painted(&self, cell: usize) -> impl Iterator<Item = (u32, &'a PlanFacade)> {
        let facades = &self.plan.facades;
        let walls = self.cells.cells.get(cell).filter(|_| !facades.is_empty()).map_or(&[][..], |cell| &cell.walls);
        let is_of_plan = |&&(h, v, _): &&(u32, u16, u16)| {
            self.plan.houses.get(h as usize).is_some_and(|house| usize::from(v) < house.volumes.len())
        };
        let walls = (0_u32..).zip(walls.iter().filter(is_of_plan));
        let painted = walls.filter_map(|(n, wall)| facades.iter().find(|facade| facade.wall == *wall).map(|facade| (n, facade)));
        let mut sections = 0;
        painted.take_while(move |(_, facade)| {
            sections += usize::from(facade.painted.sections);
            sections <= FacadeSheet::MOST_SECTIONS
        })
    }
}

/// Content of every cell's level-1 packet: see [`Contents::shell`].
#[must_use]
pub fn cell_shells(plan: &CityPlan, cells: &Cells) -> Vec<CellShell> {
    let contents = Contents::new(plan, cells);
    (0..cells.cells.len()).into_par_iter().map(|cell| contents.shell(cell)).collect()
}

/// Content of every cell's level-2 packet: see [`Contents::sheet`].
#[must_use]
pub fn facade_sheets(plan: &CityPlan, cells: &Cells) -> Vec<FacadeSheet> {
    let contents = Contents::new(plan, cells);
    (0..cells.cells.len()).map(|cell| contents.sheet(cell)).collect()
}

/// As much as some ground needs of the courses that it is laid along, and their numbers by those of the plan. None where that is more
/// than a packet may hold.
fn courses(plan: &CityPlan, ground: &[GroundPatch], origin: GridPos) -> (Vec<Course>, BTreeMap<u32, u32>) {
    let mut needed: BTreeMap<u32, (usize, usize)> = BTreeMap::new();
    for patch in ground {
        let Some((number, course)) = patch.course.and_then(|number| Some((number, plan.courses.get(number as usize)?))) else {
            continue;
        };
        for i in patch.outline.rings().flatten().filter_map(|p| course.nearest(p.to_metres())) {
            let (first, last) = needed.entry(number).or_insert((i, i));
            (*first, *last) = ((*first).min(i), (*last).max(i));
        }
    }
    let part = |(&number, &(first, last)): (&u32, &(usize, usize))| {
        let part = plan.courses.get(number as usize)?.part(first, last);
        Some((number, Course { line: part.line.iter().map(|&p| p.wrapping_sub(origin)).collect(), ..part }))
    };
    let parts: Vec<(u32, Course)> = needed.iter().filter_map(part).collect();
    if parts.iter().map(|part| part.1.line.len()).sum::<usize>() > Course::MOST_VERTICES {
        return Default::default();
    }
    let numbers = parts.iter().zip(0..).map(|((number, _), i)| (*number, i)).collect();
    (parts.into_iter().map(|part| part.1).collect(), numbers)
}

/// The terrain under some ground and houses, and above ways that lead below it.
fn terrain(plan: &CityPlan, origin: GridPos, ground: &[GroundPatch], (houses, spans): (&[HouseShell], &[WaySpan])) -> PlanTerrain {
    let footprints = houses.iter().flat_map(|house| &house.volumes).map(|volume| &volume.footprint);
    let bounds = ground.iter().map(|patch| &patch.outline).chain(footprints).filter_map(GridPolygon::bounds);
    let below = spans.iter().filter(|span| span.is_ramp() || span.is_bore()).filter_map(|span| span.outline().bounds());
    let about = bounds
        .chain(below)
        .reduce(|(lo, hi), (l, h)| (GridPos(lo.0.min(l.0), lo.1.min(l.1)), GridPos(hi.0.max(h.0), hi.1.max(h.1))));
    let Some((lo, hi)) = about.filter(|_| !plan.terrain.is_level()) else { return PlanTerrain::default() };
    let place = |p: GridPos| GridPos(p.0.wrapping_add(origin.0), p.1.wrapping_add(origin.1));
    plan.terrain.crop((place(lo), place(hi)), origin)
}

/// The middle of a cell's bounds, to whole metres.
fn origin(cell: &Cell) -> GridPos {
    let (lo, hi) = cell.outline.bounds().unwrap_or_default();
    let middle = |lo: i32, hi: i32| {
        let middle = (i64::from(lo) + i64::from(hi)).div_euclid(2);
        let step = i64::from(GRID_PER_METRE);
        ((middle + step / 2).div_euclid(step) * step).clamp(i64::from(i32::MIN), i64::from(i32::MAX)) as i32
    };
    GridPos(middle(lo.0, hi.0), middle(lo.1, hi.1))
}

/// Houses with a wall or the roof here, ascending, each with its volumes that have something here.
fn houses(plan: &CityPlan, cell: &Cell, origin: GridPos) -> Vec<HouseShell> {
    let mut here: Vec<u32> = cell.walls.iter().map(|w| w.0).chain(cell.houses.iter().copied()).collect();
    here.sort_unstable();
    here.dedup();
    let shell = |h: u32| {
        let house = plan.houses.get(h as usize)?;
        let has_roof = cell.houses.binary_search(&h).is_ok();
        let first = cell.walls.partition_point(|w| w.0 < h);
        let walls = &cell.walls[first..cell.walls.partition_point(|w| w.0 <= h)];
        let volumes = (0..=u16::MAX).zip(&house.volumes).filter_map(|(v, volume)| {
            let walls: Vec<u16> = walls.iter().filter(|w| w.1 == v).map(|w| w.2).collect();
            (has_roof || !walls.is_empty()).then(|| VolumeShell {
                footprint: volume.footprint.map(|p| p.wrapping_sub(origin)),
                ..VolumeShell::of(volume, walls, has_roof)
            })
        });
        let is_monument = house.monument.is_some();
        Some(HouseShell { style: house.style, floor: house.floor, volumes: volumes.collect(), is_monument })
    };
    here.into_iter().filter_map(shell).collect()
}

/// The ground that monuments whose roofs the cell carries stand on, as polygons apart from each other.
fn footings(plan: &CityPlan, cell: &Cell) -> Vec<GridPolygon> {
    let monuments = cell.houses.iter().filter_map(|&h| plan.houses.get(h as usize)).filter(|house| house.monument.is_some());
    let rings: Vec<GridRing> = monuments.flat_map(footing).collect();
    if rings.is_empty() { Vec::new() } else { combine(Keep::FirstAlone, rings, [], true) }
}

/// Rings of the volumes of a house that stand on the ground.
fn footing(house: &House) -> Vec<GridRing> {
    let foot = house.volumes.iter().map(|volume| volume.bottom).min().unwrap_or(0);
    let stands = |volume: &&Volume| volume.bottom.saturating_sub(foot) < GRID_PER_METRE;
    house.volumes.iter().filter(stands).flat_map(|volume| turned_rings(&volume.footprint)).collect()
}

/// The designs of a cell's monuments, each once.
#[derive(Default)]
struct Designs {
    of_plan: Vec<u16>,
    list: Vec<Design>,
}

impl Designs {
    /// Where a design of the plan is in the list.
    fn index(&mut self, plan: &CityPlan, design: u16) -> Option<u16> {
        let known = self.of_plan.iter().position(|&d| d == design);
        let index = match known {
            Some(index) => index,
            None => {
                self.list.push(plan.designs.get(usize::from(design))?.clone());
                self.of_plan.push(design);
                self.list.len() - 1
            }
        };
        u16::try_from(index).ok()
    }
}

/// Monuments of the houses whose roofs the cell carries.
fn monuments(plan: &CityPlan, cell: &Cell, origin: GridPos, designs: &mut Designs) -> Vec<PlacedMonument> {
    let placed = cell.houses.iter().filter_map(|&h| plan.houses.get(h as usize)?.monument);
    let here =
        |m: PlacedMonument| Some(PlacedMonument { design: designs.index(plan, m.design)?, pos: m.pos.wrapping_sub(origin), ..m });
    placed.filter_map(here).collect()
}

fn objects(plan: &CityPlan, cell: &Cell, origin: GridPos, designs: &mut Designs) -> Vec<ObjectShell> {
    let objects = cell.objects.iter().filter_map(|&o| plan.objects.get(o as usize));
    let mut here = |object: &PlanObject| {
        let monument = object.monument.and_then(|design| designs.index(plan, design));
        ObjectShell { pos: object.pos.wrapping_sub(origin), monument, ..ObjectShell::of(object) }
    };
    objects.map(&mut here).collect()
}

fn markings(plan: &CityPlan, cell: &Cell, origin: GridPos) -> Vec<Marking> {
    let markings = cell.markings.iter().filter_map(|&m| plan.markings.get(m as usize));
    markings.map(|m| Marking { line: m.line.iter().map(|&p| p.wrapping_sub(origin)).collect(), ..m.clone() }).collect()
}

/// Spans that the cell draws, then those that others draw over it.
fn spans(plan: &CityPlan, cell: &Cell, decks: &[Option<Bounds>], origin: GridPos) -> Vec<WaySpan> {
    let Some(own) = cell.outline.bounds() else { return Vec::new() };
    let is_over = |deck: &Option<Bounds>| deck.is_some_and(|deck| do_meet(deck, own));
    let others = (0..).zip(decks).filter(|(b, deck)| is_over(deck) && cell.spans.binary_search(b).is_err());
    let here = cell.spans.iter().copied().chain(others.map(|(b, _)| b));
    let station = |s: &SpanStation| SpanStation { left: s.left.wrapping_sub(origin), right: s.right.wrapping_sub(origin), z: s.z };
    let spans = here.filter_map(|b| plan.spans.get(b as usize));
    spans.map(|span| WaySpan { stations: span.stations.iter().map(station).collect(), ..span.clone() }).collect()
}

fn blind(cells: &Cells, cell: &Cell, origin: GridPos) -> Vec<(GridPos, GridPos)> {
    let portals = cell.portals.iter().filter_map(|&p| cells.portals.get(p as usize)).filter(|portal| portal.is_blind());
    portals.map(|portal| (portal.ends.0.wrapping_sub(origin), portal.ends.1.wrapping_sub(origin))).collect()
}
