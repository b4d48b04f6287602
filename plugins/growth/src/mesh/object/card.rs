//! Trees as cards, for who is far away: upright pictures across one another, of which the shader shows the one that looks towards the
//! eye, and one of the crown for those who look from above.

use glam::{DVec2, DVec3};
use veduta_city::tree::{self, TreeCard};
use veduta_city::{CellShell, PlanObject, Rgb, Season, Tile, metres};

use super::{draw_of, drawn, scale_of};
use crate::mesh::data::{MeshData, Paint};
use crate::mesh::outline::{centre_of, engine};

/// All trees of a cell as cards that bear their pictures, as they are in a season: 18 triangles each. Centres are their positions.
#[must_use]
pub fn tree_cards(shell: &CellShell, season: Season) -> MeshData {
    let mut mesh = MeshData::default();
    for object in drawn(shell).filter(|object| object.kind.is_tree()) {
        lay(object, season, &mut mesh);
    }
    mesh
}

fn lay(object: &PlanObject, season: Season, mesh: &mut MeshData) {
    let (plan, scale, draw) = (object.pos.to_metres(), scale_of(object), draw_of(object));
    let hue = tree::leaves(object.kind, season, draw);
    let tile = Tile::of_tree(object.kind, hue.is_none());
    let paint = Paint::new(centre_of(plan), hue.unwrap_or(Rgb(255, 255, 255)), tile);
    let TreeCard { half_m, height_m, crown_m } = TreeCard::of(object.kind);
    let (half, foot) = (half_m * scale, engine(plan, metres(object.z)));
    let angle = draw.between("cards", 0.0, core::f64::consts::PI);
    let way = |turn: f64| DVec3::new(libm::cos(angle + turn), 0.0, libm::sin(angle + turn));
    // Once about: each is seen from both sides.
    for i in 0..2 * TreeCard::UPRIGHT {
        let right = way(core::f64::consts::PI * f64::from(i) / f64::from(TreeCard::UPRIGHT));
        let rise = DVec3::Y * (height_m * scale);
        picture(mesh, [foot - right * half, foot + right * half], rise, (right.cross(DVec3::Y), TreeCard::SIDE), paint);
    }
    let along = way(0.0);
    let (middle, back) = (foot + DVec3::Y * (crown_m * scale), DVec3::Y.cross(along) * half);
    let front = [middle - back - along * half, middle - back + along * half];
    picture(mesh, front, back * 2.0, (DVec3::Y, TreeCard::TOP), paint);
}

/// A picture from the left and right end of its foot up, with its normal and where it lies on the tile.
fn picture(mesh: &mut MeshData, [left, right]: [DVec3; 2], rise: DVec3, (normal, at): (DVec3, [(f64, f64); 2]), paint: Paint) {
    let [(u0, u1), (v0, v1)] = at;
    let uvs = [(u0, v1), (u1, v1), (u1, v0), (u0, v0)].map(DVec2::from);
    mesh.quad([left, right, right + rise, left + rise], normal.as_vec3().to_array(), uvs, paint);
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use veduta_city::{GridPos, Id, ObjectKind};

    use super::*;
    use crate::mesh::object::{nominal_m, trees};

    fn wood(kind: ObjectKind) -> CellShell {
        let height = GridPos::steps(nominal_m(kind));
        let tree =
            |id: u64| PlanObject { id: Id(id), kind, pos: GridPos(2048, 1024), z: 1024, heading: 40, height, monument: None };
        CellShell { objects: (0..40).map(tree).collect(), ..CellShell::default() }
    }

    #[test]
    fn cards_are_few_triangles_that_face_where_their_normals_point() {
        for (kind, season) in ObjectKind::TREES.into_iter().flat_map(|kind| Season::ALL.map(|season| (kind, season))) {
            let mesh = tree_cards(&wood(kind), season);
            assert_eq!((mesh.validate(), mesh.triangle_count()), (Ok(()), 40 * 18), "{kind:?}");
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| Vec3::from_array(mesh.positions[i as usize]));
                let normal = Vec3::from_array(mesh.normals[t[0] as usize]);
                assert!((b - a).cross(c - a).normalize().dot(normal) > 0.999, "{kind:?}");
                // The picture is the right way up and not mirrored.
                let [p, q, r] = [t[0], t[1], t[2]].map(|i| glam::Vec2::from_array(mesh.uvs[i as usize]));
                assert!((q - p).perp_dot(r - p) < 0.0, "v runs downwards");
            }
        }
    }

    #[test]
    fn a_card_is_as_large_as_its_tree() {
        let size = |mesh: &MeshData| {
            let of = |i: usize, way: fn(f32, f32) -> f32, from: f32| mesh.positions.iter().map(|p| p[i]).fold(from, way);
            let foot = Vec3::new(2.0, 1.0, -1.0);
            let wide = mesh.positions.iter().map(|p| (Vec3::from_array(*p) - foot).with_y(0.0).length()).fold(0.0, f32::max);
            (wide, of(1, f32::max, 0.0) - foot.y)
        };
        for kind in ObjectKind::TREES {
            let (body, cards) = (size(&trees(&wood(kind), Season::Summer)), size(&tree_cards(&wood(kind), Season::Summer)));
            // The corners of the card from above reach farther out.
            let (wide, high) = (body.0 / (cards.0 / core::f32::consts::SQRT_2), body.1 / cards.1);
            assert!((0.85..1.1).contains(&wide) && (0.9..1.06).contains(&high), "{kind:?}: {wide} {high} of the card");
        }
    }

    #[test]
    fn cards_bear_leaves_when_trees_do() {
        let layer = |kind, season| tree_cards(&wood(kind), season).colours[0][3] as usize;
        assert_eq!(layer(ObjectKind::Birch, Season::Autumn), Tile::LeafyTree(ObjectKind::Birch).index());
        assert_eq!(layer(ObjectKind::Birch, Season::Winter), Tile::BareTree(ObjectKind::Birch).index());
        assert_eq!(layer(ObjectKind::Conifer, Season::Winter), Tile::LeafyTree(ObjectKind::Conifer).index());
    }
}
