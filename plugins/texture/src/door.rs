//! Ways into houses: the sandstone portal, the plain door, the carriage gate. They stand on the bay's foot.

use veduta_city::Opening;
use veduta_city::draw::Draw;

use crate::bay::{BAY, MIDDLE};
use crate::canvas::{Canvas, Rect, Texel, disc, srgb, stroke};
use crate::glass::{Cloth, glaze};
use crate::hole::{Hole, reveal, shade_recess};
use crate::moulding::{cornice, keystone, surround};
use crate::noise::{falloff, floor, hash, word};
use crate::stone::{Sandstone, steps, stone_ring};
use crate::timber::{Timber, boards, leaf};

/// How deep doors lie behind the wall.
const DEPTH: f32 = -0.12;

const OXBLOOD: u32 = 0x005E_2E27;
const BOTTLE_GREEN: u32 = 0x002C_473B;
const OAK: u32 = 0x006B_4A30;
const IRON: u32 = 0x0035_3432;
const BRASS: u32 = 0x00B0_8D4A;

/// A knob or ring of metal.
fn knob(canvas: &mut Canvas, at: (f32, f32), radius: f32, hex: u32) {
    let metal = Texel::solid(srgb(hex), 0.4).at(DEPTH + 0.05);
    let area = Rect::standing(at.0, at.1 - radius, radius * 2.0, radius * 2.0);
    canvas.cast(area, |x, y| disc(at.0, at.1, radius, x, y), 0.03, 0.5);
    canvas.paint(area, |x, y| disc(at.0, at.1, radius, x, y), |x, y| metal.times(1.0 + 0.5 * (y - at.1 - x + at.0) / radius));
}

/// The light over a door: panes between bars that fan out from the middle of its foot.
fn fanlight(canvas: &mut Canvas, hole: &Hole, foot: f32, timber: &Timber, draw: Draw) {
    let clip = Rect { y0: foot, ..hole.rect };
    let pane = |x: f32, y: f32| (hole.distance(x, y) + 0.07).max(foot + 0.05 - y);
    glaze(canvas, clip, pane, Rect { y0: foot - 0.5, ..hole.rect }, Cloth::None, draw.part(50));
    let (cx, radius) = (hole.rect.cx(), hole.rect.width() / 2.0);
    for (dx, dy) in [(-0.87, 0.5), (-0.5, 0.87), (0.0, 1.0), (0.5, 0.87), (0.87, 0.5)] {
        let (from, to) = ((cx, foot), (cx + dx * radius, foot + dy * radius));
        let bar = |x: f32, y: f32| stroke(from, to, 0.016, x, y).max(hole.distance(x, y));
        boards(canvas, clip, bar, timber, DEPTH + 0.02);
    }
    let hub = |x: f32, y: f32| (disc(cx, foot, 0.2, x, y).abs() - 0.016).max(hole.distance(x, y)).max(foot - y);
    boards(canvas, clip, hub, timber, DEPTH + 0.02);
}

/// Round-arched sandstone portal with voussoirs, a double door of oxblood timber under a fanlight, two steps.
pub(crate) fn portal(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let hole = Hole::of(Opening::Portal);
    stone_ring(canvas, &hole, 0.34, (0.34, 11.0), 0.07, &stone);
    for side in [-1.0, 1.0] {
        let at = MIDDLE + side * 1.035;
        stone.block(canvas, Rect::standing(at, hole.springing() - 0.1, 0.42, 0.14), 1.12, 0.1);
        stone.block(canvas, Rect::standing(at, 0.0, 0.42, 0.46), 0.92, 0.1);
    }
    keystone(canvas, MIDDLE, hole.rect.y1 - 0.02, hole.rect.y1 + 0.4, 0.26, stone.texel(MIDDLE, 3.0, (9, 9)).times(1.1));
    let inner = reveal(canvas, &hole, 0.06, 0.0);
    let timber = Timber::new(OXBLOOD, draw, BAY);
    boards(canvas, inner.rect, |x, y| inner.distance(x, y), &timber, DEPTH);
    let transom = inner.springing();
    fanlight(canvas, &inner, transom, &timber, draw);
    canvas.slab(
        Rect::new(inner.rect.x0, transom - 0.06, inner.rect.x1, transom + 0.05),
        Texel::solid(srgb(OXBLOOD), 0.55).at(DEPTH),
        0.05,
    );
    for (x0, x1) in [(inner.rect.x0 + 0.03, MIDDLE - 0.005), (MIDDLE + 0.005, inner.rect.x1 - 0.03)] {
        leaf(canvas, Rect::new(x0, 0.3, x1, transom - 0.06), &timber, &[(0.05, 0.27), (0.33, 0.66), (0.71, 0.95)], 1, DEPTH);
    }
    knob(canvas, (MIDDLE + 0.07, 1.18), 0.038, BRASS);
    knob(canvas, (MIDDLE - 0.07, 1.18), 0.03, BRASS);
    shade_recess(canvas, &hole, 0.3, 0.55);
    steps(canvas, MIDDLE, &[2.2, 1.9], 0.15, &stone);
}

/// Plain panelled door of bottle green with a light above, in a moulded surround under a small cornice.
pub(crate) fn door(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let hole = Hole::of(Opening::Door);
    let trim = Texel::trim(1.05);
    surround(canvas, &hole, 0.19, trim);
    for side in [-1.0, 1.0] {
        canvas.slab(Rect::standing(MIDDLE + side * 0.68, 0.0, 0.25, 0.4), trim.times(0.86), 0.06);
    }
    cornice(canvas, Rect::standing(MIDDLE, 3.0, 1.56, 0.15), 0.17, trim);
    let inner = reveal(canvas, &hole, 0.045, 0.0);
    let timber = Timber::new(BOTTLE_GREEN, draw, BAY);
    boards(canvas, inner.rect, |x, y| inner.distance(x, y), &timber, DEPTH);
    let light = Rect { y0: 2.26, ..inner.rect }.grow(-0.07, -0.06);
    let half = light.width() / 2.0 - 0.015;
    for (i, x0) in [light.x0, light.cx() + 0.015].into_iter().enumerate() {
        let pane = Rect { x0, x1: x0 + half, ..light };
        glaze(canvas, pane, |x, y| pane.distance(x, y), Rect { y0: 1.6, ..light }, Cloth::None, draw.part(60 + i as u64));
    }
    leaf(
        canvas,
        Rect::new(inner.rect.x0 + 0.04, 0.17, inner.rect.x1 - 0.04, 2.2),
        &timber,
        &[(0.05, 0.3), (0.38, 0.66), (0.72, 0.95)],
        2,
        DEPTH,
    );
    canvas.slab(Rect::new(inner.rect.x0, 2.2, inner.rect.x1, 2.28), Texel::solid(srgb(BOTTLE_GREEN) * 1.1, 0.55).at(DEPTH), 0.04);
    knob(canvas, (inner.rect.x1 - 0.1, 1.16), 0.034, BRASS);
    shade_recess(canvas, &hole, 0.24, 0.55);
    steps(canvas, MIDDLE, &[1.6], 0.15, &stone);
}

/// Carriage gate: segmental arch of stone, planked leaves with iron straps and studs, a wicket, guard stones at its foot.
pub(crate) fn gate(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let hole = Hole::of(Opening::Gate);
    stone_ring(canvas, &hole, 0.25, (0.42, 21.0), 0.05, &stone);
    keystone(canvas, MIDDLE, hole.rect.y1 - 0.02, hole.rect.y1 + 0.3, 0.24, stone.texel(MIDDLE, 3.0, (9, 9)).times(1.1));
    let inner = reveal(canvas, &hole, 0.06, 0.0);
    let timber = Timber::new(OAK, draw, BAY);
    let (key, board) = (draw.bits("planks"), 0.145);
    canvas.paint(
        inner.rect,
        |x, y| inner.distance(x, y),
        |x, y| {
            let at = (x - MIDDLE) / board;
            let across = (at - floor(at) as f32).min(1.0 - at + floor(at) as f32) * board;
            let shade = 0.9 + 0.2 * word(hash(key, floor(at), 0), 0);
            let damp = 1.0 - 0.3 * falloff(y, 0.5);
            timber.texel(x, y).times(shade * damp * (1.0 - 0.5 * falloff(across, 0.012))).at(DEPTH - 0.008 * falloff(across, 0.012))
        },
    );
    let iron = Texel::solid(srgb(IRON), 0.5).at(DEPTH);
    for y in [0.55, 1.45, 2.3] {
        for side in [-1.0, 1.0] {
            let outer = MIDDLE + side * (inner.rect.width() / 2.0);
            let strap = Rect::new(outer.min(MIDDLE + side * 0.18), y, outer.max(MIDDLE + side * 0.18), y + 0.06);
            canvas.slab(strap, iron, 0.012);
            for i in 0..5 {
                knob(canvas, (outer - side * (0.12 + 0.17 * i as f32), y + 0.03), 0.018, 0x0055_524E);
            }
        }
    }
    // The wicket is cut into the right leaf.
    let wicket = Rect::new(MIDDLE + 0.12, 0.08, MIDDLE + 0.92, 2.02);
    canvas.shade(wicket.grow(0.03, 0.03), |x, y| 1.0 - 0.5 * falloff(wicket.distance(x, y).abs(), 0.018));
    canvas.shade(inner.rect, |x, _| 1.0 - 0.6 * falloff((x - MIDDLE).abs(), 0.02));
    knob(canvas, (MIDDLE + 0.2, 1.1), 0.045, IRON);
    shade_recess(canvas, &hole, 0.32, 0.58);
    for side in [-1.0, 1.0] {
        let at = MIDDLE + side * 1.06;
        let shape = move |x: f32, y: f32| stroke((at, -0.1), (at, 0.42), 0.13 - 0.06 * y, x, y);
        let area = Rect::standing(at, 0.0, 0.34, 0.62);
        canvas.cast(area, shape, 0.1, 0.4);
        canvas.paint(area, shape, |x, y| stone.texel(x, y, (5, 5)).times(0.9 - 1.6 * (x - at) - 0.25 * falloff(y, 0.15)).at(0.1));
    }
}
