//! Truth of visible sets: rays through the meshes that walkers see.
//!
//! Eyes stand at random 1.6 m to 3 m above the floors of a cell, and look about, mostly along the ground. What a ray ends at, and the
//! trees and furniture before it, is drawn with some cell: that cell must be in the visible set of the eye's, or on the skyline, or in a
//! district that walkers have about them or see from afar. Districts have no trees and no furniture: rays that see some there are counted apart,
//! and so are those that see something missing only where haze hides it.
//! What streaming leaves out of all that under its caps (of skyline cells, vistas, memory) is not looked at.

mod scene;

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};
use rayon::prelude::*;
use veduta_cells::PartitionSettings;
use veduta_city::draw::Draw;
use veduta_city::{CellShell, GridPos, Id, Overview, bounds};
use veduta_store::{CellEntry, CityIndex};

use scene::{Hit, Scene};

/// How visible sets are put to the proof.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProofSettings {
    /// Rays from eyes all over the city.
    pub rays: u64,
    /// Eyes of each cell that look for all that can be seen from it, to tell by how much its set is too large; none if 0.
    pub eyes_a_cell: u32,
    /// Seed of the eyes.
    pub seed: u64,
    /// Walkers have districts within this distance at least, metres, as streaming's `overview_m`; less than 0 for none.
    pub districts_m: f64,
    /// How far one sees at all, metres, as the partition's `far_m`.
    pub far_m: f64,
}

impl Default for ProofSettings {
    fn default() -> Self {
        Self { rays: 1_000_000, eyes_a_cell: 0, seed: 1, districts_m: Overview::ABOUT_M, far_m: PartitionSettings::default().far_m }
    }
}

/// Something that is seen and should not be, by the visible set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Missing {
    /// The cell of the eye.
    pub from: u32,
    /// The cell that is not in its visible set.
    pub cell: u32,
    /// The eye: plan position and height above the city's zero, metres.
    pub eye: (DVec2, f64),
    /// What it sees.
    pub seen: (DVec2, f64),
}

/// What a proof found.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Proof {
    /// Triangles that the rays were sent through.
    pub triangles: usize,
    /// Rays that were sent.
    pub rays: u64,
    /// Rays that met something.
    pub hits: u64,
    /// Rays that saw a cell that is missing: in neither visible set nor skyline nor district.
    pub misses: u64,
    /// Rays that saw nothing missing, but something that only a district tells of.
    pub by_districts: u64,
    /// Rays that saw a tree or furniture there, which districts are without.
    pub bare: u64,
    /// Rays that saw what is missing only farther away than one sees at all.
    pub hazy: u64,
    /// One of those that saw something missing for each pair of cells.
    pub missing: Vec<Missing>,
    /// Area of what the visible sets hold, square metres, summed over all cells; the skyline apart. With
    /// [`ProofSettings::eyes_a_cell`] only.
    pub held_m2: f64,
    /// Area of what was truly seen of it.
    pub seen_m2: f64,
}

impl Proof {
    /// How many times as much ground as can be seen the visible sets hold.
    #[must_use]
    pub fn excess(&self) -> Option<f64> {
        (self.seen_m2 > 0.0).then(|| self.held_m2 / self.seen_m2)
    }
}

/// Lowest and highest eye above its floor, metres.
const EYE_M: (f64, f64) = (1.6, 3.0);
/// Places drawn for an eye before it is left out: cells may be narrow within their bounds, or all under something.
const TRIES: u64 = 64;
/// What only a ray sees, and none beside it, is seen through a crack between two meshes that is no pixel wide: how far the rays beside
/// it are turned, radians.
const BESIDE: f64 = 1e-4;
/// Rays of an eye that look about, besides those to the cells that it should see.
const ABOUT: u64 = 32;
/// Eyes after which nothing new was seen are the last.
const IN_VAIN: u32 = 500;

/// Puts a city's visible sets to the proof, all of whose regions must be there. `shells` are by cell. The same arguments find the same, for any number of threads.
#[must_use]
pub fn prove(index: &CityIndex, shells: &[CellShell], settings: &ProofSettings) -> Proof {
    if shells.is_empty() {
        return Proof::default();
    }
    let cells: Vec<&CellEntry> = index.cells().map(|(_, cell)| cell).collect();
    let mut is_skyline = vec![false; cells.len()];
    index.regions_here().flat_map(|(_, region)| &region.skyline).for_each(|&cell| is_skyline[cell as usize] = true);
    let town = Town { index, cells, is_skyline, shells, scene: Scene::new(shells), settings };
    let ray = |number: u64| {
        let cell = Draw::new(settings.seed, Id(number), "cell").below("cell", shells.len()) as u32;
        town.look_once(cell, number)
    };
    let looks: Vec<Look> = (0..settings.rays).into_par_iter().filter_map(ray).collect();
    let mut proof = Proof { triangles: town.scene.len(), rays: looks.len() as u64, ..Proof::default() };
    let mut pairs = BTreeSet::new();
    for look in looks {
        proof.hits += u64::from(look.hit);
        proof.misses += u64::from(!look.missing.is_empty());
        proof.by_districts += u64::from(look.is_by_district && look.missing.is_empty());
        proof.bare += u64::from(look.is_bare && look.missing.is_empty());
        proof.hazy += u64::from(look.is_hazy && look.missing.is_empty());
        proof.missing.extend(look.missing.into_iter().filter(|missing| pairs.insert((missing.from, missing.cell))));
    }
    if settings.eyes_a_cell > 0 {
        let areas: Vec<(f64, f64)> =
            (0..shells.len() as u32).into_par_iter().map(|cell| town.areas(cell, settings.eyes_a_cell)).collect();
        (proof.held_m2, proof.seen_m2) = areas.into_iter().fold((0.0, 0.0), |sum, area| (sum.0 + area.0, sum.1 + area.1));
    }
    proof
}

/// What came of a ray.
#[derive(Default)]
struct Look {
    hit: bool,
    missing: Vec<Missing>,
    /// Whether it saw something that is in no set, but in a district.
    is_by_district: bool,
    /// Whether that is a tree or furniture.
    is_bare: bool,
    /// Whether it saw something that is in none of them, but hidden by haze.
    is_hazy: bool,
}

struct Town<'a> {
    index: &'a CityIndex,
    cells: Vec<&'a CellEntry>,
    is_skyline: Vec<bool>,
    shells: &'a [CellShell],
    scene: Scene,
    settings: &'a ProofSettings,
}

impl Town<'_> {
    fn look_once(&self, cell: u32, number: u64) -> Option<Look> {
        let draw = Draw::new(self.settings.seed, Id(number), "eye");
        let eye = self.eye(cell, draw)?;
        let direction = about(draw);
        let mut seen = Vec::new();
        self.scene.look(eye, direction, &mut seen);
        let hit = !seen.is_empty();
        let is_missing = |met: &Hit| !self.sees(cell, met.cell);
        if !seen.iter().any(is_missing) || !self.is_wide(eye, direction, cell) {
            return Some(Look { hit, ..Look::default() });
        }
        let is_district = |met: &Hit| self.is_district(met.cell, cell, plan(eye).0);
        let is_by_district = seen.iter().any(|met| is_missing(met) && is_district(met));
        let is_bare = seen.iter().any(|met| met.is_loose && is_missing(met) && is_district(met));
        let told = |met: Hit| Missing { from: cell, cell: met.cell, eye: plan(eye), seen: plan(eye + direction * met.distance_m) };
        let (hazy, missing): (Vec<Hit>, Vec<Hit>) = seen
            .into_iter()
            .filter(|met| is_missing(met) && !is_district(met))
            .partition(|met| met.distance_m > self.settings.far_m);
        let missing = missing.into_iter().map(told).collect();
        Some(Look { hit, missing, is_by_district, is_bare, is_hazy: !hazy.is_empty() })
    }

    /// Whether a cell is in the visible set of another, or rises above the roofs.
    fn sees(&self, from: u32, cell: u32) -> bool {
        self.cells[from as usize].visible.binary_search(&cell).is_ok() || self.is_skyline(cell)
    }

    /// Whether a cell is seen as a district: its region's overview is about an eye, or told to be seen from the region of the eye's cell.
    fn is_district(&self, cell: u32, from: u32, eye: DVec2) -> bool {
        let Some((number, home)) = self.index.region_of(cell).zip(self.index.region_of(from)) else { return false };
        let is_near = bounds::distance_m(self.index.regions[number as usize].bounds, eye) <= self.settings.districts_m;
        is_near || self.index.region(home).is_some_and(|region| region.vistas.binary_search(&number).is_ok())
    }

    fn is_skyline(&self, cell: u32) -> bool {
        self.is_skyline[cell as usize]
    }

    /// Whether what should not be seen along a ray is seen beside it, too.
    fn is_wide(&self, eye: DVec3, direction: DVec3, cell: u32) -> bool {
        let (right, up) = direction.any_orthonormal_pair();
        let mut seen = Vec::new();
        [right, -right, up, -up].into_iter().any(|aside| {
            self.scene.look(eye, (direction + BESIDE * aside).normalize(), &mut seen);
            seen.iter().any(|other| !self.sees(cell, other.cell))
        })
    }

    /// An eye in a cell: on the ground or on a way above or below it. `None` where there is no room for one.
    fn eye(&self, cell: u32, draw: Draw) -> Option<DVec3> {
        let (entry, shell) = (self.cells[cell as usize], &self.shells[cell as usize]);
        let (low, high) = entry.outline.bounds()?;
        let (low, high) = (low.to_metres(), high.to_metres());
        (0..TRIES).map(|n| draw.part(n)).find_map(|draw| {
            let pos = DVec2::new(draw.between("x", low.x, high.x), draw.between("y", low.y, high.y));
            if !entry.outline.contains(GridPos::from_metres(pos)) {
                return None;
            }
            let p = pos - shell.origin.to_metres();
            let is_cut = shell.spans.iter().any(|span| span.is_ramp() && span.height_m(p).is_some());
            let ground = (!is_cut).then(|| shell.terrain.height_m(p));
            let floors: Vec<f64> = ground.into_iter().chain(shell.spans.iter().filter_map(|span| span.height_m(p))).collect();
            let floor = *draw.pick("floor", &floors)?;
            let at = |height: f64| DVec3::new(pos.x, height, -pos.y);
            let eye = at(floor + draw.between("eye", EYE_M.0, EYE_M.1));
            // Kerbs and paving lie above the terrain; whoever is under something has no head room, or stands in a wall.
            self.scene.is_open(at(floor + 0.5), eye).then_some(eye)
        })
    }

    /// Area of the cells in the visible set of one, and of those of them that were seen, square metres; the skyline apart.
    fn areas(&self, cell: u32, eyes: u32) -> (f64, f64) {
        let set: Vec<u32> = self.cells[cell as usize].visible.iter().copied().filter(|&c| !self.is_skyline(c)).collect();
        let mut unseen: BTreeSet<u32> = set.iter().copied().collect();
        unseen.remove(&cell);
        let (mut seen, mut last) = (Vec::new(), 0);
        // A cell's last one may show only from a corner of it: eyes go on where others still find something.
        for number in 0.. {
            if unseen.is_empty() || number >= eyes && number - last > IN_VAIN {
                break;
            }
            let draw = Draw::new(self.settings.seed, Id(u64::from(cell) << 32 | u64::from(number)), "all that is seen");
            let Some(eye) = self.eye(cell, draw) else { continue };
            let to = |n: u64, other: u32| {
                let draw = draw.part(n);
                self.scene.place_on(other, draw.bits("face") as usize, (draw.unit("u"), draw.unit("v")))
            };
            let aimed = unseen.iter().zip(ABOUT..).filter_map(|(&other, n)| Some(to(n, other)? - eye));
            let rays: Vec<DVec3> = (0..ABOUT).map(|n| about(draw.part(n))).chain(aimed).collect();
            for ray in rays {
                self.scene.look(eye, ray, &mut seen);
                for other in &seen {
                    if unseen.remove(&other.cell) {
                        last = number;
                    }
                }
            }
        }
        let area = |cell: &u32| self.cells[*cell as usize].outline.area_m2();
        let held: f64 = set.iter().map(area).sum();
        (held, held - unseen.iter().map(area).sum::<f64>())
    }
}

/// A direction to look in: any way round, mostly along the ground.
fn about(draw: Draw) -> DVec3 {
    let (turn, rise) = (draw.between("turn", 0.0, core::f64::consts::TAU), draw.between("rise", -1.0, 1.0));
    let rise = rise.powi(3) * core::f64::consts::FRAC_PI_2;
    DVec3::new(turn.cos() * rise.cos(), rise.sin(), turn.sin() * rise.cos())
}

/// Plan position and height of a place in the scene.
fn plan(p: DVec3) -> (DVec2, f64) {
    (DVec2::new(p.x, -p.z), p.y)
}
