use glam::DVec2;
use veduta_city::{CellShell, FacadeSheet, HouseShell, Opening, Tile, VolumeShell, Wall, WallKind, metres};

use super::arcade;
use super::data::{MeshData, MeshError, Paint};
use super::form::RoofForm;
use super::gable;
use super::moulding::add_mouldings;
use super::outline::{Edge, centre_of, draw_at, engine, wall_edge};
use super::painted;

/// The cell's walls as coloured outlines: one face from foot to eaves and the gable above it. Centres are the middles of the walls.
#[must_use]
pub fn level1(shell: &CellShell) -> MeshData {
    let mut mesh = MeshData::default();
    mesh.reserve_quads(wall_total(shell) * 2);
    let mut along = Vec::new();
    let houses = shell.houses.iter().filter(|house| !house.is_monument);
    for (house, volume) in houses.flat_map(|house| house.volumes.iter().map(move |volume| (house, volume))) {
        let (first, form, plaster) = (mesh.positions.len(), RoofForm::new(volume), plaster(volume));
        for &wall in &volume.walls {
            let Some(front) = Front::new(volume, wall, plaster) else { continue };
            front.plain(&mut mesh);
            front.gable(&form, wall, false, &mut along, &mut mesh);
        }
        arcade::coarse(volume, &mut mesh);
        mesh.stand(first, house.floor);
    }
    mesh
}

/// The cell's walls with their openings and mouldings: [`facades`] and [`mouldings`](super::mouldings).
///
/// # Errors
/// [`MeshError::SheetLength`] if the sheet is not of this shell.
pub fn level2(shell: &CellShell, sheet: &FacadeSheet) -> Result<MeshData, MeshError> {
    let mut mesh = facades(shell, sheet)?;
    add_mouldings(shell, sheet, &mut mesh);
    Ok(mesh)
}

/// The walls of [`level1`], cut into rectangles of equal openings: one repeat of the tile is one bay of one storey. A window
/// shared by all bays and by storeys of one height is one rectangle.
///
/// # Errors
/// [`MeshError::SheetLength`] if the sheet is not of this shell.
pub fn facades(shell: &CellShell, sheet: &FacadeSheet) -> Result<MeshData, MeshError> {
    check(shell, sheet)?;
    Ok(facades_as(shell, sheet, Front::flat))
}

/// Bays side by side and storeys above one another that all hold the same opening.
#[derive(Debug, Clone, Copy)]
pub(super) struct Run {
    /// Bays of the whole wall.
    pub(super) of: u8,
    /// From this bay …
    pub(super) from: u8,
    /// … to this one, which is not included.
    pub(super) to: u8,
    pub(super) opening: Opening,
    /// The lowest storey, 0 on the ground.
    pub(super) storey: usize,
    pub(super) rows: usize,
    /// Metres, of the lower and the upper edge.
    pub(super) heights: [f64; 2],
}

impl Run {
    /// The bay in its middle; of two, the second.
    fn middle(&self) -> u8 {
        self.from + (self.to - self.from) / 2
    }

    /// Whether a shop's name stands over a bay.
    fn is_named(&self, bay: u8) -> bool {
        bay == self.middle()
    }

    /// Where a bay begins, as a share of the wall's length.
    pub(super) fn share(&self, bay: u8) -> f64 {
        f64::from(bay) / f64::from(self.of)
    }
}

/// The walls of a sheet of the right length that nobody painted; `draw` draws their runs.
pub(super) fn facades_as(shell: &CellShell, sheet: &FacadeSheet, draw: impl Fn(&Front, &Run, &mut MeshData)) -> MeshData {
    let mut mesh = MeshData::default();
    mesh.reserve_quads(sheet.walls.len() * 5);
    let mut along = Vec::new();
    for (house, volume, plans, number) in seen(shell, sheet) {
        let (first, form, plaster) = (mesh.positions.len(), RoofForm::new(volume), plaster(volume));
        let corner = volume.footprint.outer.first().copied().unwrap_or_default();
        let trade = draw_at(shell, corner, "shop").below("trade", Tile::TRADES.into()) as u8;
        for (n, (&wall, plan)) in (number..).zip(volume.walls.iter().zip(plans)) {
            if painted::find(sheet, n).is_some() {
                continue;
            }
            let Some(front) = Front::new(volume, wall, plaster) else { continue };
            let front = Front { trade, ..front };
            front.bays(plan, &draw, &mut mesh);
            front.gable(&form, wall, plan.kind == WallKind::Street, &mut along, &mut mesh);
        }
        mesh.stand(first, house.floor);
    }
    mesh
}

/// Number of walls that a shell lists.
pub(super) fn wall_total(shell: &CellShell) -> usize {
    shell.houses.iter().flat_map(|house| &house.volumes).map(|volume| volume.walls.len()).sum()
}

/// Volumes whose walls are seen, each with what a sheet tells of its walls, and the number of the first of them.
pub(super) fn seen<'a>(
    shell: &'a CellShell,
    sheet: &'a FacadeSheet,
) -> impl Iterator<Item = (&'a HouseShell, &'a VolumeShell, &'a [Wall], usize)> {
    let mut told = sheet.walls.as_slice();
    let volumes = shell.houses.iter().flat_map(|house| house.volumes.iter().map(move |volume| (house, volume)));
    volumes.filter_map(move |(house, volume)| {
        let number = sheet.walls.len() - told.len();
        let (plans, rest) = told.split_at(volume.walls.len().min(told.len()));
        told = rest;
        (!house.is_monument).then_some((house, volume, plans, number))
    })
}

/// Whether a sheet has as many walls as a shell.
pub(super) fn check(shell: &CellShell, sheet: &FacadeSheet) -> Result<(), MeshError> {
    let (shell, sheet) = (wall_total(shell), sheet.walls.len());
    if shell == sheet { Ok(()) } else { Err(MeshError::SheetLength { shell, sheet }) }
}

/// What a volume's walls are drawn with, but for the place.
fn plaster(volume: &VolumeShell) -> Paint {
    Paint::new([0.0; 2], volume.colour, Tile::Plaster)
}

/// A wall that stands.
pub(super) struct Front {
    pub(super) edge: Edge,
    pub(super) bottom: f64,
    pub(super) eaves: f64,
    pub(super) plaster: Paint,
    /// What its shops sell, if it has any.
    pub(super) trade: u8,
}

impl Front {
    /// `None` for walls without length or height, and for indices beyond the footprint.
    pub(super) fn new(volume: &VolumeShell, wall: u16, plaster: Paint) -> Option<Self> {
        let edge = wall_edge(&volume.footprint, wall.into())?;
        let plaster = plaster.at(centre_of((edge.a + edge.b) / 2.0));
        let (bottom, eaves) = (metres(volume.bottom), metres(volume.eaves));
        (bottom < eaves).then_some(Self { edge, bottom, eaves, plaster, trade: 0 })
    }

    /// The tile of a run's bay.
    pub(super) fn tile(&self, run: &Run, bay: u8) -> Tile {
        if run.opening == Opening::Shop { Tile::of_shop(self.trade, run.is_named(bay)) } else { Tile::of_opening(run.opening) }
    }

    fn plain(&self, mesh: &mut MeshData) {
        self.plaster_rows(0.0, 1.0, self.bottom, self.eaves, mesh);
    }

    /// Bare wall between two shares of the length and two heights.
    fn plaster_rows(&self, from: f64, to: f64, low: f64, high: f64, mesh: &mut MeshData) {
        let uv = |share: f64, y: f64| DVec2::new(share * self.edge.length, self.eaves - y) / self.plaster.size_m();
        self.rectangle([from, to], [low, high], [uv(from, low), uv(to, high)], self.plaster, mesh);
    }

    /// A rectangle of the wall; texture coordinates of its lower start and upper end.
    fn rectangle(&self, shares: [f64; 2], heights: [f64; 2], uvs: [DVec2; 2], paint: Paint, mesh: &mut MeshData) {
        let ([from, to], [low, high]) = (shares.map(|s| self.edge.at(s)), heights);
        let corners = [engine(from, low), engine(to, low), engine(to, high), engine(from, high)];
        let [start, end] = uvs;
        mesh.quad(corners, self.edge.normal(), [start, DVec2::new(end.x, start.y), end, DVec2::new(start.x, end.y)], paint);
    }

    /// The wall storey by storey.
    pub(super) fn bays(&self, wall: &Wall, draw: impl Fn(&Self, &Run, &mut MeshData), mesh: &mut MeshData) {
        let total: i64 = wall.storeys.iter().map(|s| i64::from(s.height.max(0))).sum();
        if wall.bays == 0 || total == 0 {
            return self.plain(mesh);
        }
        let stretch = (self.eaves - self.bottom) / total as f64;
        let level = |steps: i64| if steps == total { self.eaves } else { self.bottom + steps as f64 * stretch };
        let (mut storey, mut risen) = (0, 0);
        while let Some(first) = wall.storeys.get(storey) {
            let low = level(risen);
            let mut rows = 1;
            // Above the ground floor all bays hold the same.
            if storey > 0 {
                rows = wall.storeys[storey..].iter().take_while(|s| *s == first).count();
            }
            risen += i64::from(first.height.max(0)) * rows as i64;
            let heights = [low, level(risen)];
            if heights[0] < heights[1] {
                for (from, to, opening) in runs(wall, storey) {
                    draw(self, &Run { of: wall.bays, from, to, opening, storey, rows, heights }, mesh);
                }
            }
            storey += rows;
        }
    }

    /// A run as one rectangle; one of shops as three, with the name over the middle one.
    pub(super) fn flat(&self, run: &Run, mesh: &mut MeshData) {
        if run.opening == Opening::Shop {
            let middle = run.middle();
            for (from, to) in [(run.from, middle), (middle, middle + 1), (middle + 1, run.to)] {
                if from < to {
                    self.alike(&Run { from, to, ..*run }, self.tile(run, from), mesh);
                }
            }
        } else {
            self.alike(run, self.tile(run, run.from), mesh);
        }
    }

    fn alike(&self, run: &Run, tile: Tile, mesh: &mut MeshData) {
        let (shares, [low, high]) = ([run.share(run.from), run.share(run.to)], run.heights);
        if run.opening == Opening::Blank {
            return self.plaster_rows(shares[0], shares[1], low, high, mesh);
        }
        let start = DVec2::new(run.from.into(), 1.0 - run.storey as f64);
        let end = DVec2::new(run.to.into(), 1.0 - (run.storey + run.rows) as f64);
        let paint = self.plaster.with_tile(tile);
        self.rectangle(shares, run.heights, [start, end], paint, mesh);
    }

    /// The gable above the wall, up to the roof.
    pub(super) fn gable(
        &self,
        form: &RoofForm<'_>,
        wall: u16,
        has_windows: bool,
        along: &mut Vec<(f64, f64)>,
        mesh: &mut MeshData,
    ) {
        form.along_wall(wall.into(), along);
        let volume = form.volume;
        if gable::is_shaped(volume.gable, along) {
            let trim = Paint::new(self.plaster.centre, volume.trim, Tile::Carved);
            return gable::gable(volume.gable, &self.edge, self.eaves, along, [self.plaster, trim], has_windows, mesh);
        }
        for pair in along.windows(2) {
            let [(from, low), (to, high)] = [pair[0], pair[1]];
            if to - from < 1e-9 || low.max(high) < 1e-4 {
                continue;
            }
            let outline = [(from, 0.0), (to, 0.0), (to, high), (from, low)];
            let base = mesh.positions.len() as u32;
            let mut count = 0;
            for (share, h) in outline.into_iter().enumerate().filter(|(k, (_, h))| *k < 2 || *h >= 1e-4).map(|(_, p)| p) {
                let uv = DVec2::new(share * self.edge.length, -h) / self.plaster.size_m();
                mesh.vertex(engine(self.edge.at(share), self.eaves + h), self.edge.normal(), uv, self.plaster);
                count += 1;
            }
            mesh.indices.extend([base, base + 1, base + 2]);
            if count == 4 {
                mesh.indices.extend([base, base + 2, base + 3]);
            }
        }
    }
}

/// Runs of equal openings of a storey: from bay, to bay (not included), opening.
pub(super) fn runs(wall: &Wall, storey: usize) -> impl Iterator<Item = (u8, u8, Opening)> + '_ {
    let mut bay = 0;
    core::iter::from_fn(move || {
        let (from, opening) = (bay, wall.opening(storey, bay));
        while bay < wall.bays && wall.opening(storey, bay) == opening {
            bay += 1;
        }
        (from < bay).then_some((from, bay, opening))
    })
}

#[cfg(test)]
pub(super) mod tests {
    use veduta_city::{Gable, GridPolygon, GridPos, GroundFloor, HouseShell, PlanRoof, Rgb, RoofShape, Storey, WallKind};

    use super::*;

    pub(in crate::mesh) fn shell(walls: Vec<u16>) -> CellShell {
        let m = 1024;
        let footprint = GridPolygon::simple(vec![GridPos(0, 0), GridPos(9 * m, 0), GridPos(9 * m, 12 * m), GridPos(0, 12 * m)]);
        let roof = PlanRoof { shape: RoofShape::Gabled, height: 4 * m, direction: 90, colour: Rgb(0xA2, 0x4B, 0x33) };
        let (colour, trim) = (Rgb(0xD9, 0xB3, 0x6C), Rgb(0xEF, 0xE3, 0xC8));
        let volume = VolumeShell {
            footprint,
            bottom: 0,
            eaves: 13 * m,
            colour,
            trim,
            roof,
            gable: Gable::Plain,
            has_roof: true,
            walls,
            arcades: Vec::new(),
        };
        let house = HouseShell { style: 0, floor: 0, volumes: vec![volume], is_monument: false };
        CellShell { houses: vec![house], ..Default::default() }
    }

    pub(in crate::mesh) fn front() -> Wall {
        let storey = |metres: i32, opening| Storey { height: metres * 1024, opening };
        Wall {
            kind: WallKind::Street,
            bays: 3,
            storeys: vec![
                storey(4, Opening::Window),
                storey(3, Opening::PedimentWindow),
                storey(3, Opening::FramedWindow),
                storey(3, Opening::FramedWindow),
            ],
            ground_floor: GroundFloor { door_bay: Some(1), door: Opening::Portal, shops: 0b100, blank: 0 },
            ornament: None,
        }
    }

    #[test]
    fn a_front_is_one_rectangle_a_run() {
        let mesh = facades(&shell(vec![0]), &FacadeSheet::of(vec![front()])).unwrap();
        // Window, portal and shop below, pediments, and both upper storeys together.
        assert_eq!(mesh.triangle_count(), 5 * 2);
        let layer = |quad: usize| mesh.colours[quad * 4][3] as usize;
        let layers = [Opening::Window, Opening::Portal, Opening::PedimentWindow, Opening::FramedWindow];
        assert_eq!([0, 1, 3, 4].map(layer), layers.map(|o| Tile::Bay(o).index()));
        let shop = Tile::all().nth(layer(2)).and_then(Tile::shop);
        assert_eq!(shop.map(|(_, is_named)| is_named), Some(true), "a shop of one bay has its name over it");
        assert_eq!(mesh.uvs[4..8], [[1.0, 1.0], [2.0, 1.0], [2.0, 0.0], [1.0, 0.0]], "the portal's tile stands upright once");
        assert_eq!(mesh.uvs[16..20], [[0.0, -1.0], [3.0, -1.0], [3.0, -3.0], [0.0, -3.0]], "three bays by two storeys");
        assert_eq!(mesh.positions[4], [3.0, 0.0, 0.0]);
        assert_eq!(mesh.positions[19], [0.0, 13.0, 0.0]);
    }

    #[test]
    fn a_shops_name_stands_over_the_middle_of_its_bays() {
        let ground_floor = GroundFloor { door_bay: None, shops: 0b111, ..front().ground_floor };
        let wall = Wall { ground_floor, ..front() };
        let mesh = facades(&shell(vec![0]), &FacadeSheet::of(vec![wall])).unwrap();
        let shop = |quad: usize| Tile::all().nth(mesh.colours[quad * 4][3] as usize).and_then(Tile::shop);
        let [Some(left), Some(middle), Some(right)] = [0, 1, 2].map(shop) else { panic!("three bays of a shop") };
        assert_eq!([left.1, middle.1, right.1], [false, true, false]);
        assert!(left.0 == middle.0 && middle.0 == right.0, "they are of one trade");
    }

    #[test]
    fn a_side_carries_the_gable_of_its_roof() {
        let mesh = level1(&shell(vec![1]));
        assert_eq!(mesh.triangle_count(), 4, "a rectangle and two halves of a gable");
        let top = mesh.positions.iter().map(|p| p[1]).fold(0.0, f32::max);
        assert_eq!(top, 17.0);
        assert!(mesh.normals.iter().all(|n| *n == [1.0, 0.0, 0.0]), "the second wall looks east");
    }

    #[test]
    fn a_sheet_of_another_cell_is_refused() {
        let result = level2(&shell(vec![0, 1]), &FacadeSheet::of(vec![front()]));
        assert_eq!(result, Err(MeshError::SheetLength { shell: 2, sheet: 1 }));
    }

    #[test]
    fn storeys_that_do_not_add_up_are_stretched() {
        let mut wall = front();
        wall.storeys.truncate(2);
        let mesh = facades(&shell(vec![0]), &FacadeSheet::of(vec![wall])).unwrap();
        let top = mesh.positions.iter().map(|p| p[1]).fold(0.0, f32::max);
        assert_eq!(top, 13.0);
    }
}
