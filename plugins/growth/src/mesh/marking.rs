use glam::{DVec2, DVec3};
use veduta_city::{CellShell, Marking, MarkingKind, Rgb, Tile, metres};

use super::data::{MeshData, Paint};
use super::drape::Drape;
use super::outline::centre_of;

/// How far rails' beds lie above the ground, and paint, which also lies on those; metres: more than the depth buffer confuses, less than
/// a shoe.
const LIFT_M: f64 = 0.012;
const PAINT_LIFT_M: f64 = 0.018;
/// Worn white.
const PAINT: Rgb = Rgb(0xDD, 0xDA, 0xD0);
/// Steel that wheels keep bright, and the setts that rails lie in.
const STEEL: Rgb = Rgb(0x8E, 0x8F, 0x8E);
const BED: Rgb = Rgb(0x77, 0x74, 0x70);
/// Breadth of a zebra's stripes and of the gaps between them, metres.
const STRIPE_M: f64 = 0.5;
/// Breadth of a rail's head and of its groove, and of the paving about a track beyond its rails; metres.
const RAIL_M: f64 = 0.07;
const BED_M: f64 = 0.45;
/// Distance between sleepers; how far they reach beyond the rails, how broad and how high they are; metres.
const SLEEPER_STEP_M: f64 = 0.6;
const SLEEPER_M: (f64, f64, f64) = (0.52, 0.25, 0.09);
/// Creosoted oak, and the rust of a rail's web.
const SLEEPER: Rgb = Rgb(0x5A, 0x4B, 0x3F);
const RUST: Rgb = Rgb(0x6E, 0x4E, 0x3C);
const RAIL_HEIGHT_M: f64 = 0.14;
/// Mitres at bends reach at most so many times as far as on a straight line.
const LONGEST_MITRE: f64 = 3.0;
/// Most dashes or stripes of one marking.
const MOST: usize = 100;

/// Paint and rails on the ground of a cell, facing up. Centres are the middles of the markings' lines.
#[must_use]
pub fn markings(shell: &CellShell) -> MeshData {
    let mut mesh = MeshData::default();
    let drape = Drape::of(shell);
    for marking in &shell.markings {
        let line: Vec<DVec2> = marking.line.iter().map(|p| p.to_metres()).collect();
        lay(marking.kind, &line, metres(marking.width.max(0)), (&drape, metres(marking.z)), &mut mesh);
    }
    mesh
}

/// What markings are laid on.
pub(super) trait Floor {
    /// A place so far above it, in the engine's axes.
    fn above(&self, p: DVec2, lift: f64) -> DVec3;
    /// The places at which a straight way bends with it, its ends among them.
    fn way(&self, a: DVec2, b: DVec2) -> Vec<DVec2>;
    /// Calls `each` with the pieces of a convex polygon on each of which it is flat.
    fn pieces(&self, polygon: &[DVec2], each: &mut dyn FnMut(&[DVec2]));
}

impl Floor for Drape<'_> {
    fn above(&self, p: DVec2, lift: f64) -> DVec3 {
        self.above(p, lift)
    }

    fn way(&self, a: DVec2, b: DVec2) -> Vec<DVec2> {
        self.way(a, b)
    }

    fn pieces(&self, polygon: &[DVec2], each: &mut dyn FnMut(&[DVec2])) {
        self.pieces(polygon, each);
    }
}

/// Lays a marking along a line, so wide, so far above a floor; metres.
pub(super) fn lay(kind: MarkingKind, line: &[DVec2], width: f64, (floor, z): (&dyn Floor, f64), mesh: &mut MeshData) {
    let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return };
    let paint = Paint::new(centre_of((first + last) / 2.0), PAINT, Tile::Plaster);
    let is_paint = !matches!(kind, MarkingKind::Rails | MarkingKind::Track);
    let layer = Layer { floor, lift: z + if is_paint { PAINT_LIFT_M } else { LIFT_M }, paint };
    match kind {
        MarkingKind::Line => layer.strip(line, [-width / 2.0, width / 2.0], mesh),
        MarkingKind::Dashes => {
            let period = Marking::DASH_M + Marking::GAP_M;
            let dashes = dashes(line, period, Marking::DASH_M);
            dashes.iter().for_each(|dash| layer.strip(dash, [-width / 2.0, width / 2.0], mesh));
        }
        MarkingKind::Zebra => {
            let stripes = dashes(line, 2.0 * STRIPE_M, STRIPE_M);
            stripes.iter().for_each(|stripe| layer.strip(stripe, [-width / 2.0, width / 2.0], mesh));
        }
        MarkingKind::Rails => tramway(&layer, line, width, mesh),
        MarkingKind::Track => railway(&layer, line, width, mesh),
    }
}

/// Sleepers, and two rails on them.
fn railway(layer: &Layer<'_>, line: &[DVec2], gauge: f64, mesh: &mut MeshData) {
    let of =
        |colour, tile, lift: f64| Layer { lift: layer.lift + lift, paint: Paint::new(layer.paint.centre, colour, tile), ..*layer };
    let wood = of(SLEEPER, Tile::Wood, 0.0);
    let half = (gauge / 2.0 + SLEEPER_M.0, SLEEPER_M.1 / 2.0);
    for piece in dashes(line, SLEEPER_STEP_M, SLEEPER_STEP_M) {
        let (Some(&first), Some(&last)) = (piece.first(), piece.last()) else { continue };
        let (middle, way) = ((first + last) / 2.0, (last - first).normalize_or_zero());
        let corner = |x: f64, y: f64| middle + way.perp() * x + way * y;
        let ring = [corner(-half.0, -half.1), corner(-half.0, half.1), corner(half.0, half.1), corner(half.0, -half.1)];
        wood.block(&ring, SLEEPER_M.2, mesh);
    }
    let (rust, steel) = (of(RUST, Tile::Metal, SLEEPER_M.2), of(STEEL, Tile::Metal, SLEEPER_M.2 + RAIL_HEIGHT_M));
    for side in [-1.0, 1.0] {
        let (inner, outer) = (side * gauge / 2.0, side * (gauge / 2.0 + RAIL_M));
        let (right, left) = (inner.min(outer), inner.max(outer));
        steel.strip(line, [right, left], mesh);
        rust.upright(line, right, RAIL_HEIGHT_M, false, mesh);
        rust.upright(line, left, RAIL_HEIGHT_M, true, mesh);
    }
}

/// A bed of setts, and two rails in it.
fn tramway(layer: &Layer<'_>, line: &[DVec2], gauge: f64, mesh: &mut MeshData) {
    let of =
        |colour, tile, lift: f64| Layer { lift: layer.lift + lift, paint: Paint::new(layer.paint.centre, colour, tile), ..*layer };
    let half = gauge / 2.0;
    of(BED, Tile::Stone, 0.0).strip(line, [-half - BED_M, half + BED_M], mesh);
    for side in [-1.0, 1.0] {
        let (inner, outer) = (side * half, side * (half + RAIL_M));
        of(STEEL, Tile::Metal, LIFT_M).strip(line, [inner.min(outer), inner.max(outer)], mesh);
        let groove = side * (half - 0.05);
        of(Rgb(0x3A, 0x39, 0x38), Tile::Metal, LIFT_M).strip(line, [groove.min(inner), groove.max(inner)], mesh);
    }
}

/// The pieces of a line that a rhythm covers, from its start on.
fn dashes(line: &[DVec2], period: f64, dash: f64) -> Vec<Vec<DVec2>> {
    let length: f64 = line.windows(2).map(|e| e[0].distance(e[1])).sum();
    let count = (length / period).ceil().clamp(0.0, MOST as f64) as usize;
    let piece = |i: usize| part(line, i as f64 * period, (i as f64 * period + dash).min(length));
    (0..count).map(piece).filter(|piece| piece.len() > 1).collect()
}

/// A line from one arc length to another.
fn part(line: &[DVec2], from: f64, to: f64) -> Vec<DVec2> {
    let (mut out, mut gone): (Vec<DVec2>, f64) = (Vec::new(), 0.0);
    for e in line.windows(2) {
        let length = e[0].distance(e[1]);
        let (start, end) = (gone, gone + length);
        if end > from && start < to && length > 0.0 {
            if out.is_empty() {
                out.push(e[0].lerp(e[1], ((from - start) / length).max(0.0)));
            }
            out.push(e[0].lerp(e[1], ((to - start) / length).min(1.0)));
        }
        gone = end;
    }
    out
}

/// What a marking is drawn with.
struct Layer<'a> {
    floor: &'a dyn Floor,
    /// Above the floor, metres.
    lift: f64,
    paint: Paint,
}

impl Layer<'_> {
    /// A block on a ring that runs counter-clockwise, without its underside.
    fn block(&self, ring: &[DVec2; 4], height: f64, mesh: &mut MeshData) {
        mesh.polygon(&ring.map(|p| self.floor.above(p, self.lift + height)), self.paint);
        for (i, &a) in ring.iter().enumerate() {
            let b = ring[(i + 1) % 4];
            let face = [(a, 0.0), (b, 0.0), (b, height), (a, height)];
            mesh.polygon(&face.map(|(p, up)| self.floor.above(p, self.lift + up)), self.paint);
        }
    }

    /// Upright faces so far to the left of a line, seen from its left or from its right.
    fn upright(&self, line: &[DVec2], left: f64, height: f64, from_left: bool, mesh: &mut MeshData) {
        for pair in line.windows(2) {
            let off = (pair[1] - pair[0]).normalize_or_zero().perp() * left;
            let (a, b) = if from_left { (pair[1] + off, pair[0] + off) } else { (pair[0] + off, pair[1] + off) };
            for pair in self.floor.way(a, b).windows(2) {
                let face = [(pair[0], 0.0), (pair[1], 0.0), (pair[1], height), (pair[0], height)];
                mesh.polygon(&face.map(|(p, up)| self.floor.above(p, self.lift + up)), self.paint);
            }
        }
    }

    /// A strip along a line between two distances to its left.
    fn strip(&self, line: &[DVec2], [right, left]: [f64; 2], mesh: &mut MeshData) {
        let way = |i: usize| line.get(i..i + 2).map(|e| (e[1] - e[0]).normalize_or_zero());
        let mut before: Option<[DVec2; 2]> = None;
        for (i, &p) in line.iter().enumerate() {
            let (a, b) = (i.checked_sub(1).and_then(way), way(i));
            let (Some(a), Some(b)) = (a.or(b), b.or(a)) else { return };
            let mitre = (a + b).perp() / (1.0 + a.dot(b)).max(2.0 / (LONGEST_MITRE * LONGEST_MITRE));
            let here = [p + mitre * right, p + mitre * left];
            if let Some([r, l]) = before {
                let whole = [r, here[0], here[1], l];
                self.floor.pieces(&whole, &mut |piece| {
                    let corners: Vec<DVec3> = piece.iter().map(|&p| self.floor.above(p, self.lift)).collect();
                    mesh.polygon(&corners, self.paint);
                });
            }
            before = Some(here);
        }
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::GridPos;

    use super::*;

    fn made(kind: MarkingKind, line: &[(i32, i32)], width: f64) -> MeshData {
        let line = line.iter().map(|&(x, y)| GridPos(x * 1024, y * 1024)).collect();
        let marking = Marking { kind, line, width: GridPos::steps(width), z: 0 };
        let mesh = markings(&CellShell { markings: vec![marking], ..CellShell::default() });
        mesh.validate().unwrap_or_else(|e| panic!("{e}"));
        assert!(kind == MarkingKind::Track || mesh.normals.iter().all(|n| n[1] > 0.999), "it faces up");
        mesh
    }

    fn area(mesh: &MeshData) -> f32 {
        let at = |i: u32| glam::Vec3::from_array(mesh.positions[i as usize]);
        mesh.indices.chunks_exact(3).map(|t| (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).length() / 2.0).sum()
    }

    #[test]
    fn markings_cover_what_they_should() {
        assert!((area(&made(MarkingKind::Line, &[(0, 0), (10, 0), (10, 10)], 0.2)) - 4.0).abs() < 0.05);
        // Three of nine metres, bent or not.
        assert!((area(&made(MarkingKind::Dashes, &[(0, 0), (20, 0), (20, 7)], 0.1)) - 0.9).abs() < 0.01);
        // Every other half metre of eight.
        let zebra = made(MarkingKind::Zebra, &[(0, 0), (0, 8)], 3.0);
        assert!((area(&zebra) - 12.0).abs() < 0.01 && zebra.triangle_count() == 16);
        assert_eq!(made(MarkingKind::Rails, &[(0, 0), (30, 0)], 1.435).triangle_count(), 10);
    }

    #[test]
    fn a_railway_has_sleepers_under_its_rails() {
        let mesh = made(MarkingKind::Track, &[(0, 0), (12, 0)], 1.435);
        // Twenty sleepers of five faces, two rails of three.
        assert_eq!(mesh.triangle_count(), 2 * (20 * 5 + 2 * 3));
        let reach = |axis: usize| {
            let all = mesh.positions.iter().map(|p| p[axis]);
            all.fold((f32::INFINITY, f32::NEG_INFINITY), |(low, high), c| (low.min(c), high.max(c)))
        };
        let (x, y, z) = (reach(0), reach(1), reach(2));
        assert!(x.0 >= 0.0 && x.1 <= 12.01 && (z.1 - z.0 - 2.475).abs() < 0.01, "{x:?} {z:?}");
        assert!((y.1 - y.0 - 0.23).abs() < 0.01, "{y:?}");
        // Every face looks away from the middle of what it is a side of: up, or out of a rail or sleeper.
        for t in mesh.indices.chunks_exact(3) {
            let [a, b, c] = [t[0], t[1], t[2]].map(|i| glam::Vec3::from_array(mesh.positions[i as usize]));
            let normal = glam::Vec3::from_array(mesh.normals[t[0] as usize]);
            assert!((b - a).cross(c - a).dot(normal) > 0.0 && normal.y > -0.01);
        }
        let outwards = mesh.positions.iter().zip(&mesh.normals).filter(|(p, _)| p[2].abs() > 1.2);
        assert!(outwards.clone().count() > 0);
        assert!(outwards.into_iter().all(|(p, n)| n[2].abs() < 0.5 || n[2] * p[2] > 0.0), "ends of sleepers look outwards");
    }

    #[test]
    fn a_line_without_length_is_nothing() {
        assert!(made(MarkingKind::Zebra, &[(3, 3), (3, 3)], 3.0).is_empty());
        assert!(made(MarkingKind::Rails, &[(3, 3)], 3.0).is_empty());
    }
}
