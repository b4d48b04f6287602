//! Walls in relief: windows and doors behind the wall, sills, surrounds and hoods before it.

use glam::{DVec2, DVec3};
use veduta_city::opening::{BAY_M, Band, Recess, Slab};
use veduta_city::{CellShell, FacadeSheet, Rgb, Tile};

use super::data::{MeshData, MeshError, Paint};
use super::moulding::add_mouldings;
use super::outline::engine;
use super::wall::{Front, Run, check, facades_as};

/// How far the edges of what stands out are drawn in, metres: so that flattened it covers the wall as its picture does.
const BEVEL_M: f64 = 0.012;
/// Trodden sandstone.
const DOORSTEP: Rgb = Rgb(0x8C, 0x80, 0x70);

/// The cell's walls of [`level2`](super::level2) with their openings in relief, but for those of oriels and gables. Flattened, by taking every vertex back by its
/// [relief](MeshData::reliefs), it is the same surface with the same pictures.
///
/// # Errors
/// [`MeshError::SheetLength`] if the sheet is not of this shell.
pub fn level4(shell: &CellShell, sheet: &FacadeSheet) -> Result<MeshData, MeshError> {
    check(shell, sheet)?;
    let mut mesh = facades_as(shell, sheet, bays);
    add_mouldings(shell, sheet, &mut mesh);
    mesh.reliefs.resize(mesh.positions.len(), [0.0; 3]);
    Ok(mesh)
}

/// Each bay of a run with its opening in relief.
fn bays(front: &Front, run: &Run, mesh: &mut MeshData) {
    let Some(recess) = run.opening.recess() else { return front.flat(run, mesh) };
    mesh.reliefs.resize(mesh.positions.len(), [0.0; 3]);
    let [foot, top] = run.heights;
    // The last storey ends where the run does, to the bit.
    let level = |row: usize| if row == run.rows { top } else { foot + (top - foot) * row as f64 / run.rows as f64 };
    for row in 0..run.rows {
        for bay in run.from..run.to {
            let shares = [run.share(bay), run.share(bay + 1)];
            let corner = DVec2::new(bay.into(), 1.0 - (run.storey + row) as f64);
            let paint = front.plaster.with_tile(front.tile(run, bay));
            Bay { front, shares, heights: [level(row), level(row + 1)], corner, paint }.open(&recess, run.opening.slabs(), mesh);
        }
    }
}

/// One bay of one storey, and what it is drawn with.
struct Bay<'a> {
    front: &'a Front,
    shares: [f64; 2],
    heights: [f64; 2],
    /// Texture coordinates of its lower left corner.
    corner: DVec2,
    paint: Paint,
}

impl Bay<'_> {
    fn open(&self, recess: &Recess, slabs: &[Slab], mesh: &mut MeshData) {
        let hole = recess.outline(0.0);
        self.wall_about(&hole, mesh);
        let inner = recess.outline(-recess.jamb_m);
        // What stands on the ground has a doorstep for a sill: seen from the front it has no height, and so no picture.
        let stands = hole[0].y < 1e-6;
        self.slope((&hole, 0.0), (&inner, -recess.depth_m), usize::from(stands), mesh);
        if stands {
            let step = Paint::new(self.paint.centre, DOORSTEP, Tile::Stone);
            Self { paint: step, ..*self }.side((&hole, 0.0), (&inner, -recess.depth_m), 0, mesh);
        }
        self.face(&inner, -recess.depth_m, mesh);
        if let Some(Band { width_m, proud_m }) = recess.surround {
            let rings = [width_m, width_m - BEVEL_M, BEVEL_M, 0.0].map(|out| recess.outline(out));
            let heights = [0.0, proud_m, proud_m, 0.0];
            for i in 0..3 {
                // Its foot stands on the sill or the ground.
                self.slope((&rings[i], heights[i]), (&rings[i + 1], heights[i + 1]), 1, mesh);
            }
        }
        for slab in slabs {
            let outline: Vec<DVec2> = slab.outline.iter().map(|&(x, y)| DVec2::new(x, y)).collect();
            let middle = outline.iter().sum::<DVec2>() / outline.len() as f64;
            let inner: Vec<DVec2> = outline.iter().map(|&p| p + (middle - p).clamp_length_max(BEVEL_M)).collect();
            self.slope((&outline, 0.0), (&inner, slab.proud_m), 0, mesh);
            self.face(&inner, slab.proud_m, mesh);
        }
    }

    /// The bay's wall about a hole: fans from its four corners, so that it meets its neighbours without further vertices.
    fn wall_about(&self, hole: &[DVec2], mesh: &mut MeshData) {
        let corners = [(0.0, 0.0), (BAY_M.0, 0.0), BAY_M, (0.0, BAY_M.1)].map(DVec2::from);
        let first = mesh.positions.len() as u32;
        let out = self.out();
        for &p in corners.iter().chain(hole) {
            self.vertex(p, 0.0, out, mesh);
        }
        let (on, head) = (|i: usize| first + 4 + i as u32, hole.len() - 1);
        let crown = 2 + (head - 2) / 2;
        let [low_left, low_right, high_right, high_left] = [0, 1, 2, 3].map(|i| first + i);
        if hole[0].y > 1e-6 {
            mesh.indices.extend([low_left, low_right, on(1), low_left, on(1), on(0)]);
        }
        mesh.indices.extend([low_right, high_right, on(2), low_right, on(2), on(1)]);
        for i in 2..crown {
            mesh.indices.extend([high_right, on(i + 1), on(i)]);
        }
        mesh.indices.extend([high_right, high_left, on(crown)]);
        for i in crown..head {
            mesh.indices.extend([high_left, on(i + 1), on(i)]);
        }
        mesh.indices.extend([high_left, low_left, on(0), high_left, on(0), on(head)]);
    }

    /// The faces between a ring and one within it, each at its height before the wall, from the ring's side `from` on.
    fn slope(&self, outer: (&[DVec2], f64), inner: (&[DVec2], f64), from: usize, mesh: &mut MeshData) {
        (from..outer.0.len()).for_each(|i| self.side(outer, inner, i, mesh));
    }

    /// One of those faces: from corner `i` on.
    fn side(&self, outer: (&[DVec2], f64), inner: (&[DVec2], f64), i: usize, mesh: &mut MeshData) {
        let next = (i + 1) % outer.0.len();
        let corners = [(outer.0[i], outer.1), (outer.0[next], outer.1), (inner.0[next], inner.1), (inner.0[i], inner.1)];
        let placed = corners.map(|(p, proud)| self.place(p, proud));
        let Some(normal) = super::data::newell(&placed) else { return };
        let first = mesh.positions.len() as u32;
        for (p, proud) in corners {
            self.vertex(p, proud, normal.as_vec3().to_array(), mesh);
        }
        mesh.indices.extend([first, first + 1, first + 2, first, first + 2, first + 3]);
    }

    /// A flat convex face at a height before the wall.
    fn face(&self, outline: &[DVec2], proud: f64, mesh: &mut MeshData) {
        let (first, out) = (mesh.positions.len() as u32, self.out());
        for &p in outline {
            self.vertex(p, proud, out, mesh);
        }
        for i in 1..outline.len() as u32 - 1 {
            mesh.indices.extend([first, first + i, first + i + 1]);
        }
    }

    fn out(&self) -> [f32; 3] {
        self.front.edge.normal()
    }

    /// Where a place of the bay lies that stands so far before the wall.
    fn place(&self, p: DVec2, proud: f64) -> DVec3 {
        let ([left, right], [low, high]) = (self.shares, self.heights);
        let along = left + (right - left) * p.x / BAY_M.0;
        let up = if p.y >= BAY_M.1 { high } else { low + (high - low) * p.y / BAY_M.1 };
        engine(self.front.edge.at(along) + self.front.edge.out * proud, up)
    }

    fn vertex(&self, p: DVec2, proud: f64, normal: [f32; 3], mesh: &mut MeshData) {
        let uv = self.corner + DVec2::new(p.x / BAY_M.0, -p.y / BAY_M.1);
        mesh.vertex(self.place(p, proud), normal, uv, self.paint);
        let [x, _, z] = self.out();
        mesh.reliefs.push([x, z, proud as f32]);
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::Opening;

    use super::super::wall::tests::{front, shell};
    use super::*;
    use crate::mesh::level2;

    fn area(mesh: &MeshData, flat: bool) -> f64 {
        let at = |i: u32| {
            let (p, [x, z, proud]) = (mesh.positions[i as usize], mesh.reliefs.get(i as usize).copied().unwrap_or_default());
            let back = if flat { proud } else { 0.0 };
            DVec3::new((p[0] - x * back).into(), p[1].into(), (p[2] - z * back).into())
        };
        let triangles = mesh.indices.as_chunks::<3>().0;
        triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(at);
                (b - a).cross(c - a).z / 2.0
            })
            .sum()
    }

    #[test]
    fn flattened_it_covers_the_wall_once_and_what_stands_out_covers_it_again() {
        let sheet = FacadeSheet::of(vec![front()]);
        let (flat, relief) = (level2(&shell(vec![0]), &sheet).unwrap(), level4(&shell(vec![0]), &sheet).unwrap());
        assert_eq!(relief.validate(), Ok(()));
        assert_eq!(relief.reliefs.len(), relief.positions.len());
        // The front looks south: areas as they are seen from there.
        let covered = area(&relief, true);
        let again: f64 = [
            (Opening::Window, 1),
            (Opening::PedimentWindow, 3),
            (Opening::FramedWindow, 6),
            (Opening::Portal, 1),
            (Opening::Shop, 1),
        ]
        .iter()
        .map(|&(opening, count)| f64::from(count) * twice_m2(opening))
        .sum();
        // Bays are 3 m wide and 4 m or 3 m high, and their openings are stretched alike: all areas by the same factor but for the storey.
        assert!(covered > area(&flat, true) + 0.5 * again && covered < area(&flat, true) + 1.6 * again, "{covered}");
    }

    /// What of an opening lies before the wall that it covers too, square metres of the bay it is designed for.
    fn twice_m2(opening: Opening) -> f64 {
        let polygon =
            |points: &[DVec2]| (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum::<f64>() / 2.0;
        let recess = opening.recess().unwrap();
        let band = recess.surround.map_or(0.0, |band| polygon(&recess.outline(band.width_m)) - polygon(&recess.outline(0.0)));
        let slabs = opening.slabs().iter().map(|slab| polygon(&slab.outline.iter().map(|&p| p.into()).collect::<Vec<_>>()));
        band + slabs.sum::<f64>()
    }

    #[test]
    fn windows_lie_behind_the_wall_and_sills_before_it() {
        let mesh = level4(&shell(vec![0]), &FacadeSheet::of(vec![front()])).unwrap();
        let (low, high) = mesh.reliefs.iter().fold((0.0_f32, 0.0_f32), |(low, high), r| (low.min(r[2]), high.max(r[2])));
        assert!((low + 0.3).abs() < 1e-6 && high > 0.09, "{low} {high}: the portal's leaves lie deepest");
        // The wall runs along z = 0 and looks to +z; what is told of a vertex is where it is.
        for (p, r) in mesh.positions.iter().zip(&mesh.reliefs).filter(|(_, r)| r[2] != 0.0) {
            assert!((p[2] - r[2]).abs() < 1e-5 && r[..2] == [0.0, 1.0], "{p:?} {r:?}");
        }
    }
}
