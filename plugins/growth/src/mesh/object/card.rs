//! Trees as cards, for who is far away: upright pictures, pictures from half above that lean back, and one from above. They
//! cross one another; the shader shows the one that looks towards the eye.

use glam::{DVec2, DVec3};
use veduta_city::draw::Draw;
use veduta_city::tree::{self, TreeCard};
use veduta_city::{CellShell, ObjectShell, Rgb, Season, Tile, metres};

use super::{drawn, scale_of};
use crate::mesh::data::{MeshData, Paint};
use crate::mesh::outline::{centre_of, engine};

/// All trees of a cell as cards that bear their pictures, as they are in a season: 34 triangles each. Centres are their positions.
#[must_use]
pub fn tree_cards(shell: &CellShell, season: Season) -> MeshData {
    let mut mesh = MeshData::default();
    for (object, draw) in drawn(shell).filter(|(object, _)| object.kind.is_tree()) {
        lay(object, draw, season, &mut mesh);
    }
    mesh
}

fn lay(object: &ObjectShell, draw: Draw, season: Season, mesh: &mut MeshData) {
    let (plan, scale) = (object.pos.to_metres(), scale_of(object));
    let hue = tree::leaves(object.kind, season, draw);
    let tile = Tile::of_tree(object.kind, hue.is_none());
    let paint = Paint::new(centre_of(plan), hue.unwrap_or(Rgb(255, 255, 255)), tile);
    let card = TreeCard::of(object.kind);
    let TreeCard { half_m, height_m, crown_m } = card;
    let (half, foot) = (half_m * scale, engine(plan, metres(object.z)));
    let angle = draw.between("cards", 0.0, core::f64::consts::PI);
    let way = |turn: f64| DVec3::new(libm::cos(angle + turn), 0.0, libm::sin(angle + turn));
    let (height, slant) = (height_m * scale, card.slant_m() * scale);
    for i in 0..TreeCard::DIRECTIONS {
        let right = way(core::f64::consts::TAU * f64::from(i) / f64::from(TreeCard::DIRECTIONS));
        let front = right.cross(DVec3::Y);
        picture(mesh, foot, right * half, DVec3::Y * height, (front, TreeCard::SIDE), paint);
        let (lean, rise) = (libm::sin(TreeCard::LEAN), libm::cos(TreeCard::LEAN));
        let up = DVec3::Y * rise - front * lean;
        let low = foot + DVec3::Y * (height / 2.0) - up * (slant / 2.0);
        picture(mesh, low, right * half, up * slant, (front * rise + DVec3::Y * lean, TreeCard::SLANT), paint);
    }
    let (right, back) = (way(0.0) * half, DVec3::Y.cross(way(0.0)) * half);
    picture(mesh, foot + DVec3::Y * (crown_m * scale) - back, right, back * 2.0, (DVec3::Y, TreeCard::TOP), paint);
}

/// A picture about the middle of its foot, as far as its right end and as its top, with its normal and where it lies on the tile.
fn picture(mesh: &mut MeshData, foot: DVec3, right: DVec3, up: DVec3, (normal, at): (DVec3, [(f64, f64); 2]), paint: Paint) {
    let [(u0, u1), (v0, v1)] = at;
    let uvs = [(u0, v1), (u1, v1), (u1, v0), (u0, v0)].map(DVec2::from);
    let corners = [foot - right, foot + right, foot + right + up, foot - right + up];
    mesh.quad(corners, normal.as_vec3().to_array(), uvs, paint);
}

#[cfg(test)]
mod tests {
    use glam::Vec3;
    use veduta_city::{GridPos, ObjectKind};

    use super::*;
    use crate::mesh::object::{nominal_m, trees};

    /// Forty trees in the same place of as many cells.
    fn wood(kind: ObjectKind, make: impl Fn(&CellShell) -> MeshData) -> MeshData {
        let height = GridPos::steps(nominal_m(kind));
        let tree = ObjectShell { kind, pos: GridPos(2048, 1024), z: 1024, heading: 40, height, monument: None };
        let cell = |n| CellShell { origin: GridPos(n, 1), objects: vec![tree], ..CellShell::default() };
        (0..40).map(cell).fold(MeshData::default(), |mut all, cell| {
            all.append(&make(&cell));
            all
        })
    }

    #[test]
    fn cards_are_few_triangles_that_face_where_their_normals_point() {
        for (kind, season) in ObjectKind::TREES.into_iter().flat_map(|kind| Season::ALL.map(|season| (kind, season))) {
            let mesh = wood(kind, |cell| tree_cards(cell, season));
            assert_eq!((mesh.validate(), mesh.triangle_count()), (Ok(()), 40 * 34), "{kind:?}");
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
        for kind in ObjectKind::TREES {
            let (foot, body) = (Vec3::new(2.0, 1.0, -1.0), wood(kind, |cell| trees(cell, Season::Summer)));
            let out = body.positions.iter().map(|p| (Vec3::from_array(*p) - foot).with_y(0.0).length()).fold(0.0, f32::max);
            let top = body.positions.iter().map(|p| p[1] - foot.y).fold(0.0, f32::max);
            let card = TreeCard::of(kind);
            let (wide, high) = (out / card.half_m as f32, top / card.height_m as f32);
            assert!((0.85..1.1).contains(&wide) && (0.9..1.06).contains(&high), "{kind:?}: {wide} {high} of the card");
        }
    }

    #[test]
    fn upright_cards_stand_on_the_ground_and_slanting_ones_show_the_foot_where_it_is() {
        let mesh = wood(ObjectKind::Tree, |cell| tree_cards(cell, Season::Summer));
        let corners = |quad: usize| [0, 1, 2, 3].map(|i| Vec3::from_array(mesh.positions[4 * quad + i]));
        let (foot, card) = (Vec3::new(2.0, 1.0, -1.0), TreeCard::of(ObjectKind::Tree));
        let [left, right, ..] = corners(0);
        assert!(((left + right) / 2.0 - foot).length() < 1e-4);
        // From where the slanting card looks, the foot lies as far below the middle of the picture as it does on it.
        let ([left, right, over, _], normal) = (corners(1), Vec3::from_array(mesh.normals[4]));
        let (middle, up) = ((left + over) / 2.0, (over - right).normalize());
        assert!((up.dot(foot - middle) + (card.height_m / 2.0 * libm::cos(TreeCard::LEAN)) as f32).abs() < 1e-3);
        assert!(up.dot(normal).abs() < 1e-5 && ((over - right).length() - card.slant_m() as f32).abs() < 1e-3);
    }

    #[test]
    fn cards_bear_leaves_when_trees_do() {
        let layer = |kind, season| wood(kind, |cell| tree_cards(cell, season)).colours[0][3] as usize;
        assert_eq!(layer(ObjectKind::Birch, Season::Autumn), Tile::LeafyTree(ObjectKind::Birch).index());
        assert_eq!(layer(ObjectKind::Birch, Season::Winter), Tile::BareTree(ObjectKind::Birch).index());
        assert_eq!(layer(ObjectKind::Conifer, Season::Winter), Tile::LeafyTree(ObjectKind::Conifer).index());
    }
}
