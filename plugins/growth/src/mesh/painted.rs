//! Walls that somebody painted: flat, with their windows behind them, and the gables above.

use glam::{DVec2, DVec3};
use veduta_city::{CellShell, FacadeObjectKind, FacadeSheet, GridPos, PaintedFacade, PaintedObject, Tile, metres};

use super::data::{MeshData, MeshError, Paint, newell};
use super::form::RoofForm;
use super::outline::engine;
use super::wall::{Front, check, seen};

/// What is added to the downward texture coordinate of panes, so that a shader may tell them; and [`PANES_APART`] more for each window or
/// shop before, up to [`PANES_TOLD`] of them, so that it may tell one from another.
pub const PANE: f32 = 4.0;
/// See [`PANE`].
pub const PANES_APART: f32 = 2.0;
/// See [`PANE`].
pub const PANES_TOLD: usize = 64;

/// The painted walls of a cell with their gables, and where their pictures lie on them: u counts sections from the wall's start, v is 0 at the
/// picture's upper edge and 1 at the wall's foot, [`PANE`] more on glass. The layer that colours tell is the façade's first: those of a cell
/// follow one another in the order of the sheet, section by section.
///
/// In relief, windows and doors lie behind the wall: taken back by its [relief](MeshData::reliefs) it is the flat one.
///
/// # Errors
/// [`MeshError::SheetLength`] if the sheet is not of this shell.
pub fn painted(shell: &CellShell, sheet: &FacadeSheet, in_relief: bool) -> Result<MeshData, MeshError> {
    check(shell, sheet)?;
    let mut mesh = MeshData::default();
    let mut along = Vec::new();
    for (house, volume, plans, number) in seen(shell, sheet) {
        let first = mesh.positions.len();
        for (place, &wall) in volume.walls.iter().enumerate().take(plans.len()) {
            let Some((layer, painted)) = find(sheet, number + place) else { continue };
            let plaster = Paint::new([0.0; 2], painted.colour, Tile::Plaster);
            let Some(front) = Front::new(volume, wall, plaster) else { continue };
            let Some(canvas) = Canvas::new(&front, painted, layer) else { continue };
            canvas.wall(in_relief, &mut mesh);
            let gable = mesh.positions.len();
            front.gable(&RoofForm::new(volume), wall, false, &mut along, &mut mesh);
            canvas.cover(gable, &mut mesh);
        }
        mesh.stand(first, house.floor);
    }
    // What is flat needs none, and a gable has none.
    mesh.reliefs.resize(if in_relief { mesh.positions.len() } else { 0 }, [0.0; 3]);
    Ok(mesh)
}

/// The façade of a sheet's wall, if it is painted, and its first layer.
pub(super) fn find(sheet: &FacadeSheet, wall: usize) -> Option<(usize, &PaintedFacade)> {
    let nth = sheet.painted.iter().position(|painted| painted.wall as usize == wall)?;
    let layer = sheet.painted[..nth].iter().map(|painted| usize::from(painted.painted.sections)).sum();
    Some((layer, &sheet.painted[nth].painted))
}

/// A wall with a picture on it.
struct Canvas<'a> {
    front: &'a Front,
    painted: &'a PaintedFacade,
    /// Width and height of the picture, metres.
    size: DVec2,
    /// Height of the wall, metres.
    height: f64,
    colour: [f32; 4],
}

impl<'a> Canvas<'a> {
    /// `None` if the façade cannot be drawn.
    fn new(front: &'a Front, painted: &'a PaintedFacade, layer: usize) -> Option<Self> {
        painted.check().ok()?;
        let size = GridPos(painted.size.0, painted.size.1).to_metres();
        let [r, g, b] = painted.colour.to_linear();
        Some(Self { front, painted, size, height: front.eaves - front.bottom, colour: [r, g, b, layer as f32] })
    }

    fn wall(&self, in_relief: bool, mesh: &mut MeshData) {
        let is_on_wall = |object: &PaintedObject, low: (i32, i32)| metres(low.1 + object.size.1) < self.height - 0.01;
        let objects: Vec<(&PaintedObject, (i32, i32))> = self
            .painted
            .objects
            .iter()
            .filter(|object| !object.is_flat())
            .flat_map(|object| object.places().map(move |low| (object, low)))
            .filter(|(o, low)| is_on_wall(o, *low))
            .collect();
        let cuts = |of: &dyn Fn(&PaintedObject, (i32, i32)) -> [i32; 2], end: i32| {
            let mut cuts: Vec<i32> = objects.iter().flat_map(|(object, low)| of(object, *low)).chain([0, end]).collect();
            cuts.sort_unstable();
            cuts.dedup();
            cuts
        };
        let top = GridPos::steps(self.height);
        let across = cuts(&|object, low| [low.0, low.0 + object.size.0], self.painted.size.0);
        let up = cuts(&|object, low| [low.1, low.1 + object.size.1], top);
        // Every rectangle of the grid that no opening has: they meet corner to corner.
        let is_of = |x: i32, y: i32, (object, low): &(&PaintedObject, (i32, i32))| {
            (low.0..low.0 + object.size.0).contains(&x) && (low.1..low.1 + object.size.1).contains(&y)
        };
        for rows in up.windows(2) {
            for columns in across.windows(2) {
                if !objects.iter().any(|object| is_of(columns[0], rows[0], object)) {
                    let at = |x: i32, y: i32| DVec2::new(metres(x), metres(y));
                    let [(x0, x1), (y0, y1)] = [(columns[0], columns[1]), (rows[0], rows[1])];
                    self.face(&[at(x0, y0), at(x1, y0), at(x1, y1), at(x0, y1)], 0.0, 0.0, mesh);
                }
            }
        }
        for (n, (object, (x, y))) in objects.into_iter().enumerate() {
            let pane = PANE + PANES_APART * (n % PANES_TOLD) as f32;
            self.object(object, DVec2::new(metres(x), metres(y)), pane, in_relief, mesh);
        }
    }

    /// An object's rectangle: what of it is wall, its reveals, and what lies in it.
    fn object(&self, object: &PaintedObject, low: DVec2, pane: f32, in_relief: bool, mesh: &mut MeshData) {
        let recess = object.recess();
        let hole: Vec<DVec2> = recess.outline(0.0).into_iter().map(|p| low + p).collect();
        let depth = if in_relief { recess.depth_m } else { 0.0 };
        let pane = if matches!(object.kind, FacadeObjectKind::Window | FacadeObjectKind::Shop) { pane } else { 0.0 };
        // Beside an arch there is wall. The outline's first two points are its feet, the others lead over the top from right to left.
        let (head, top) = (hole.len() - 1, low.y + recess.high.y);
        let crown = 2 + (head - 2) / 2;
        for (corner, arc) in [(low.x + recess.high.x, 2..crown), (low.x, crown..head)] {
            for i in arc {
                self.face(&[DVec2::new(corner, top), hole[i + 1], hole[i]], 0.0, 0.0, mesh);
            }
        }
        self.face(&hole, -depth, pane, mesh);
        if depth > 0.0 {
            for i in 0..hole.len() {
                let (a, b) = (hole[i], hole[(i + 1) % hole.len()]);
                self.reveal(a, b, depth, mesh);
            }
        }
    }

    /// A face between the wall and what lies in it.
    fn reveal(&self, a: DVec2, b: DVec2, depth: f64, mesh: &mut MeshData) {
        let corners = [(a, 0.0), (b, 0.0), (b, -depth), (a, -depth)];
        let Some(normal) = newell(&corners.map(|(p, proud)| self.place(p, proud))) else { return };
        let first = mesh.positions.len() as u32;
        for (p, proud) in corners {
            self.vertex(p, proud, normal.as_vec3().to_array(), 0.0, mesh);
        }
        mesh.indices.extend([first, first + 1, first + 2, first, first + 2, first + 3]);
    }

    /// A flat convex face; none if it has no area.
    fn face(&self, outline: &[DVec2], proud: f64, pane: f32, mesh: &mut MeshData) {
        if newell(&outline.iter().map(|&p| p.extend(0.0)).collect::<Vec<_>>()).is_none() {
            return;
        }
        let first = mesh.positions.len() as u32;
        for &p in outline {
            self.vertex(p, proud, self.front.edge.normal(), pane, mesh);
        }
        for i in 1..outline.len() as u32 - 1 {
            mesh.indices.extend([first, first + i, first + i + 1]);
        }
    }

    fn vertex(&self, p: DVec2, proud: f64, normal: [f32; 3], pane: f32, mesh: &mut MeshData) {
        mesh.reliefs.resize(mesh.positions.len(), [0.0; 3]);
        let [u, v] = self.chart(p);
        mesh.positions.push(self.place(p, proud).as_vec3().to_array());
        mesh.normals.push(normal);
        mesh.uvs.push([u, v + pane]);
        mesh.centres.push(self.front.plaster.centre);
        mesh.colours.push(self.colour);
        let [x, _, z] = self.front.edge.normal();
        mesh.reliefs.push([x, z, proud as f32]);
    }

    /// Where a place of the picture lies that stands so far before the wall.
    fn place(&self, p: DVec2, proud: f64) -> DVec3 {
        let up = if p.y >= self.height - 1e-3 { self.front.eaves } else { self.front.bottom + p.y };
        engine(self.front.edge.at(p.x / self.size.x) + self.front.edge.out * proud, up)
    }

    /// Texture coordinates of a place of the picture, within its layers.
    fn chart(&self, p: DVec2) -> [f32; 2] {
        let sections = f64::from(self.painted.sections);
        let u = (p.x / self.size.x * sections).clamp(0.0, sections - 1e-4);
        [u as f32, (1.0 - p.y / self.size.y).clamp(0.0, 1.0) as f32]
    }

    /// Lays the picture over vertices from `first` on.
    fn cover(&self, first: usize, mesh: &mut MeshData) {
        let edge = &self.front.edge;
        for i in first..mesh.positions.len() {
            let [x, y, z] = mesh.positions[i].map(f64::from);
            let along = (DVec2::new(x, -z) - edge.a).dot(edge.along) / edge.length;
            let uv = self.chart(DVec2::new(along * self.size.x, y - self.front.bottom));
            (mesh.uvs[i], mesh.colours[i]) = (uv, self.colour);
        }
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::{ObjectHead, PaintedWall, Rgb, SmallTexture};

    use super::super::wall::tests::{front, shell};
    use super::*;
    use crate::mesh::{level2, level4};

    /// The façade of a wall 9 m long and 13 m high: two rows of two arched windows, and a door.
    fn sheet() -> FacadeSheet {
        let window = PaintedObject {
            kind: FacadeObjectKind::Window,
            texture: 0,
            low: (1024, 5 * 1024),
            size: (1024, 2 * 1024),
            head: ObjectHead::Round,
            depth: 205,
            columns: 2,
            rows: 2,
            step: (4 * 1024, 3 * 1024),
        };
        let door = PaintedObject {
            kind: FacadeObjectKind::Door,
            low: (4 * 1024, 0),
            head: ObjectHead::Flat,
            columns: 1,
            rows: 1,
            ..window
        };
        let painted = PaintedFacade {
            size: (9 * 1024, 13 * 1024),
            sections: 2,
            colour: Rgb(200, 100, 50),
            textures: vec![SmallTexture { width: 1, palette: vec![Rgb(1, 2, 3)], texels: vec![0] }],
            objects: vec![window, door],
        };
        FacadeSheet { walls: vec![front()], painted: vec![PaintedWall { wall: 0, painted }] }
    }

    /// Area of a mesh seen from the south, flattened or not, square metres.
    fn area(mesh: &MeshData) -> f64 {
        let at = |i: u32| DVec3::from(mesh.positions[i as usize].map(f64::from));
        mesh.indices.as_chunks::<3>().0.iter().map(|t| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).z / 2.0).sum()
    }

    #[test]
    fn a_painted_wall_is_covered_once_and_no_longer_drawn_with_tiles() {
        let shell = shell(vec![0]);
        let (flat, relief) = (painted(&shell, &sheet(), false).unwrap(), painted(&shell, &sheet(), true).unwrap());
        for mesh in [&flat, &relief] {
            assert_eq!(mesh.validate(), Ok(()));
            assert!((area(mesh) - 9.0 * 13.0).abs() < 1e-3, "{} m²", area(mesh));
        }
        let bare = FacadeSheet { painted: Vec::new(), ..sheet() };
        let tiles = |sheet: &FacadeSheet| {
            [level2(&shell, sheet).unwrap(), level4(&shell, sheet).unwrap()].map(|mesh| mesh.triangle_count())
        };
        let ([with_2, with_4], [without_2, without_4]) = (tiles(&sheet()), tiles(&bare));
        assert!(
            with_2 < without_2 && with_4 < without_4 / 4,
            "only its crown is left: {with_2} of {without_2}, {with_4} of {without_4}"
        );
        assert_eq!(painted(&shell, &bare, true).unwrap().triangle_count(), 0);
    }

    #[test]
    fn pictures_lie_on_the_wall_from_its_start_and_foot() {
        let mesh = painted(&shell(vec![0]), &sheet(), true).unwrap();
        for ((p, uv), relief) in mesh.positions.iter().zip(&mesh.uvs).zip(&mesh.reliefs) {
            let v = if uv[1] > 2.0 { uv[1] % PANES_APART } else { uv[1] };
            assert!((uv[0] - (p[0] / 9.0 * 2.0).min(1.9999)).abs() < 1e-5, "{p:?} {uv:?}");
            assert!((v - (1.0 - p[1] / 13.0)).abs() < 1e-5, "{p:?} {uv:?}");
            assert!((p[2] - relief[2]).abs() < 1e-6, "what is told of a vertex is where it is");
        }
        let panes = mesh.uvs.iter().zip(&mesh.reliefs).filter(|(uv, _)| uv[1] > 2.0);
        assert!(panes.clone().all(|(_, relief)| (relief[2] + 0.2).abs() < 0.001) && panes.count() > 4 * 5);
    }

    #[test]
    fn a_gable_goes_on_with_the_picture() {
        let mut sheet = sheet();
        sheet.painted[0].painted.size.1 = 17 * 1024;
        // The roof's ridge runs east: the short walls have the gables, and one of them is all that the shell lists.
        let mesh = painted(&shell(vec![1]), &sheet, false).unwrap();
        let highest = mesh.positions.iter().zip(&mesh.uvs).max_by(|a, b| a.0[1].total_cmp(&b.0[1])).unwrap();
        assert!(highest.0[1] > 16.9 && highest.1[1] < 0.01 && (highest.1[0] - 1.0).abs() < 0.01, "{highest:?}");
    }
}
