//! The windows of houses, from the plain one with a sill to the one under a pediment.

use veduta_city::Opening;
use veduta_city::draw::Draw;

use crate::bay::{MIDDLE, streaks};
use crate::canvas::{Canvas, Rect, Texel};
use crate::glass::{Cloth, Sash, sash};
use crate::hole::{Hole, reveal, shade_recess};
use crate::moulding::{console, cornice, keystone, panel, pediment, sill, surround};

/// Height of the sill above the storey's floor.
const SILL: f32 = 0.9;
/// Clear width of a common window.
const WIDTH: f32 = 1.1;

/// Cream paint of sashes.
const CREAM: u32 = 0x00D6_CCB6;
/// White paint gone grey.
const WHITE: u32 = 0x00DD_D8CB;
/// Brown paint.
const BROWN: u32 = 0x0068_4A35;
/// Old oak.
const OAK: u32 = 0x0054_3D2B;

/// Two casements of three panes under a transom with two lights.
const COMMON: Sash = Sash { leaves: 2, rows: 2, transom: Some(1.2), timber: CREAM, frame: 0.062, cloth: Cloth::None };

/// Dirt under the ends of a sill.
fn sill_streaks(canvas: &mut Canvas, top: f32, width: f32, draw: Draw) {
    let under = top - 0.1;
    streaks(canvas, MIDDLE - width / 2.0 + 0.03, under, 0.1, 0.7, draw.part(1));
    streaks(canvas, MIDDLE + width / 2.0 - 0.05, under, 0.09, 0.56, draw.part(2));
    streaks(canvas, MIDDLE + draw.between("drip", -0.3, 0.3) as f32, under, 0.16, 0.36, draw.part(3));
    // What the whole sill sheds, faint.
    streaks(canvas, MIDDLE, under, width * 0.6, 0.24, draw.part(4));
}

fn glazed(canvas: &mut Canvas, hole: &Hole, division: &Sash, draw: Draw) {
    let inner = reveal(canvas, hole, 0.05, 0.0);
    sash(canvas, &inner, division, draw);
    shade_recess(canvas, hole, 0.2, 0.55);
}

/// Rectangular, with a narrow flat band and a sill.
pub(crate) fn plain(canvas: &mut Canvas, draw: Draw) {
    let hole = Hole::of(Opening::Window);
    sill_streaks(canvas, SILL, WIDTH + 0.3, draw);
    let band = hole.rect.grow(0.1, 0.1);
    canvas.slab(Rect { y0: SILL, ..band }, Texel::trim(1.0), 0.018);
    glazed(canvas, &hole, &Sash { cloth: Cloth::Sides(0.2), ..COMMON }, draw);
    sill(canvas, MIDDLE, SILL, WIDTH + 0.3, Texel::trim(1.04));
}

/// With a moulded surround that has ears, and a keystone.
pub(crate) fn framed(canvas: &mut Canvas, draw: Draw) {
    let hole = Hole::of(Opening::FramedWindow);
    sill_streaks(canvas, SILL, WIDTH + 0.5, draw);
    let trim = Texel::trim(1.06);
    let ear = 0.26;
    canvas.slab(
        Rect::new(hole.rect.x0 - ear, hole.rect.y1 - 0.12, hole.rect.x1 + ear, hole.rect.y1 + 0.18),
        trim.times(0.98),
        0.035,
    );
    surround(canvas, &hole, 0.18, trim);
    keystone(canvas, MIDDLE, hole.rect.y1 - 0.02, hole.rect.y1 + 0.25, 0.17, trim);
    glazed(canvas, &hole, &Sash { timber: WHITE, cloth: Cloth::Half(0.42), ..COMMON }, draw);
    for side in [-1.0, 1.0] {
        console(canvas, Rect::standing(MIDDLE + side * 0.6, SILL - 0.27, 0.12, 0.19), trim.times(0.95));
    }
    sill(canvas, MIDDLE, SILL, WIDTH + 0.5, trim);
}

/// Apron under a window of the first floor.
fn apron(canvas: &mut Canvas, trim: Texel) {
    let field = Rect::standing(MIDDLE, 0.3, WIDTH + 0.2, 0.5);
    canvas.slab(field, Texel::trim(0.97), 0.02);
    panel(canvas, field.grow(-0.09, -0.09), 0.03, Texel::tinted(1.0, 0.9).at(0.02), 0.02);
    for side in [-1.0, 1.0] {
        console(canvas, Rect::standing(MIDDLE + side * 0.66, 0.5, 0.13, 0.32), trim.times(0.95));
    }
}

/// Surround, frieze and straight cornice on consoles.
pub(crate) fn corniced(canvas: &mut Canvas, draw: Draw) {
    let hole = Hole::of(Opening::CorniceWindow);
    let trim = Texel::trim(1.08);
    apron(canvas, trim);
    sill_streaks(canvas, SILL, WIDTH + 0.5, draw);
    surround(canvas, &hole, 0.17, trim);
    let frieze = Rect::new(hole.rect.x0 - 0.12, hole.rect.y1 + 0.17, hole.rect.x1 + 0.12, hole.rect.y1 + 0.37);
    canvas.slab(frieze, Texel::trim(0.98), 0.02);
    panel(canvas, frieze.grow(-0.12, -0.055), 0.02, Texel::tinted(0.97, 0.9).at(0.02), 0.015);
    for side in [-1.0, 1.0] {
        console(canvas, Rect::standing(MIDDLE + side * 0.69, frieze.y0 - 0.16, 0.13, 0.36), trim);
    }
    cornice(canvas, Rect::standing(MIDDLE, frieze.y1 - 0.02, WIDTH + 0.44, 0.17), 0.2, trim);
    glazed(canvas, &hole, &Sash { timber: BROWN, cloth: Cloth::Sides(0.26), transom: Some(1.15), ..COMMON }, draw);
    sill(canvas, MIDDLE, SILL, WIDTH + 0.5, trim);
}

/// Surround and triangular pediment.
pub(crate) fn pedimented(canvas: &mut Canvas, draw: Draw) {
    let hole = Hole::of(Opening::PedimentWindow);
    let trim = Texel::trim(1.08);
    apron(canvas, trim);
    sill_streaks(canvas, SILL, WIDTH + 0.5, draw);
    surround(canvas, &hole, 0.17, trim);
    for side in [-1.0, 1.0] {
        console(canvas, Rect::standing(MIDDLE + side * 0.71, hole.rect.y1 - 0.14, 0.13, 0.33), trim);
    }
    let foot = hole.rect.y1 + 0.17;
    pediment(canvas, Rect::standing(MIDDLE, foot, WIDTH + 0.76, 0.56), trim);
    glazed(canvas, &hole, &Sash { timber: WHITE, cloth: Cloth::Sides(0.3), transom: Some(1.06), ..COMMON }, draw);
    sill(canvas, MIDDLE, SILL, WIDTH + 0.5, trim);
}

/// Round-arched, with imposts and keystone.
pub(crate) fn arched(canvas: &mut Canvas, draw: Draw) {
    let hole = Hole::of(Opening::ArchedWindow);
    let trim = Texel::trim(1.06);
    sill_streaks(canvas, SILL, 1.6, draw);
    surround(canvas, &hole, 0.18, trim);
    for side in [-1.0, 1.0] {
        let impost = Rect::standing(MIDDLE + side * 0.68, hole.springing() - 0.06, 0.28, 0.1);
        canvas.slab(impost, trim, 0.07);
    }
    keystone(canvas, MIDDLE, hole.rect.y1 - 0.03, hole.rect.y1 + 0.26, 0.19, trim);
    glazed(canvas, &hole, &Sash { timber: OAK, transom: Some(1.3), cloth: Cloth::Half(0.3), ..COMMON }, draw);
    sill(canvas, MIDDLE, SILL, 1.6, trim);
}

/// Small and square, high up in the storey.
pub(crate) fn attic(canvas: &mut Canvas, draw: Draw) {
    let hole = Hole::of(Opening::AtticWindow);
    sill_streaks(canvas, 1.2, 1.1, draw);
    canvas.slab(hole.rect.grow(0.13, 0.13), Texel::trim(1.02), 0.025);
    glazed(canvas, &hole, &Sash { rows: 2, transom: None, timber: WHITE, ..COMMON }, draw);
    sill(canvas, MIDDLE, 1.2, 1.14, Texel::trim(1.04));
}

/// Broad and modern: three lights in dark metal, one with its blind down.
pub(crate) fn wide(canvas: &mut Canvas, draw: Draw) {
    let hole = Hole::of(Opening::WideWindow);
    canvas.slab(Rect::standing(MIDDLE, SILL - 0.04, 2.17, 0.05), Texel::solid(crate::canvas::srgb(0x0077_7B7D), 0.45), 0.05);
    let inner = reveal(canvas, &hole, 0.035, 0.0);
    let metal = Sash { leaves: 3, rows: 1, transom: None, timber: 0x0050_5456, frame: 0.05, cloth: Cloth::None };
    sash(canvas, &inner, &metal, draw);
    let third = inner.rect.width() / 3.0;
    let blind = Rect { x1: inner.rect.x0 + third - 0.02, ..inner.rect.grow(-0.085, -0.085) };
    crate::glass::glaze(canvas, blind, |x, y| blind.distance(x, y), inner.rect, Cloth::Blind(0.45), draw.part(40));
    shade_recess(canvas, &hole, 0.14, 0.5);
    sill_streaks(canvas, SILL, 2.0, draw);
}
