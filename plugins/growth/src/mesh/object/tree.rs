//! Trees as bodies, for who is near.

use glam::DVec3;
use veduta_city::draw::Draw;
use veduta_city::tree::{self, Skin, TreeBuilder};
use veduta_city::{ObjectKind, Rgb, Season, Tile};

use super::Maker;
use crate::mesh::data::Paint;

impl Maker<'_> {
    pub(super) fn tree(&mut self, kind: ObjectKind, season: Season) {
        let (draw, hue) = (self.draw, tree::leaves(kind, season, self.draw).unwrap_or_default());
        tree::build(kind, season, draw, &mut Body { maker: self, hue });
    }
}

/// A tree in the making.
struct Body<'a, 'b> {
    maker: &'b mut Maker<'a>,
    /// Of its leaves.
    hue: Rgb,
}

impl Body<'_, '_> {
    fn paint(&self, skin: Skin) -> Paint {
        match skin {
            Skin::Bark(colour) => self.maker.paint(colour, Tile::Wood),
            Skin::Leaves(shade) => self.maker.paint(self.hue.scaled(shade), Tile::Leaves),
        }
    }
}

impl TreeBuilder for Body<'_, '_> {
    fn lump(&mut self, middle: DVec3, radii: DVec3, rough: f64, draw: Draw, skin: Skin) {
        let paint = self.paint(skin);
        self.maker.sculptor.blob(self.maker.ball, middle, radii, rough, draw, paint);
    }

    fn turned(&mut self, axis: (f64, f64), sides: usize, rings: &[(f64, f64)], skin: Skin) {
        let paint = self.paint(skin);
        self.maker.sculptor.turned(axis, sides, rings, paint);
    }

    fn limb(&mut self, from: DVec3, to: DVec3, radii: (f64, f64), skin: Skin) {
        let paint = self.paint(skin);
        self.maker.sculptor.limb(from, to, radii, paint);
    }

    fn blade(&mut self, corners: &[DVec3], skin: Skin) {
        let paint = self.paint(skin);
        let back: Vec<DVec3> = corners.iter().rev().copied().collect();
        self.maker.sculptor.face(corners, paint);
        self.maker.sculptor.face(&back, paint);
    }
}
