//! Openings of churches and towers: lancets, slits, belfries and the great dial.

use veduta_city::Opening;
use veduta_city::draw::Draw;

use crate::bay::{BAY, MIDDLE, streaks};
use crate::canvas::{Canvas, Rect, Texel, disc, srgb, stroke};
use crate::hole::{Head, Hole, reveal, shade_recess};
use crate::moulding::{cornice, sill};
use crate::noise::{falloff, floor, hash, smoothstep, word};
use crate::stone::{Sandstone, quoins, stone_ring};

/// Tall pointed window: stone jambs, two lights under a quatrefoil, leaded lozenges.
pub(crate) fn lancet(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let hole = Hole::of(Opening::LancetWindow);
    quoins(canvas, &hole, (0.2, 0.34), 0.3, &stone);
    stone_ring(canvas, &hole, 0.13, (0.36, 12.0), 0.03, &stone);
    let inner = reveal(canvas, &hole, 0.07, 0.0);
    leaded(canvas, &inner, draw);
    tracery(canvas, &inner, &stone);
    shade_recess(canvas, &hole, 0.26, 0.55);
    streaks(canvas, MIDDLE - 0.5, 0.25, 0.09, 0.24, draw.part(1));
    sill(canvas, MIDDLE, 0.36, 1.5, stone.texel(MIDDLE, 0.3, (4, 4)).times(1.08));
}

/// Quarries of old glass in lead, no two of one colour or tilt.
fn leaded(canvas: &mut Canvas, hole: &Hole, draw: Draw) {
    const QUARRY: f32 = 0.13;
    let (key, lead) = (draw.bits("quarries"), srgb(0x0024_2628));
    let tones = [srgb(0x003A_4A50), srgb(0x0047_5648), srgb(0x0035_4156), srgb(0x0055_5340), srgb(0x0053_6470)];
    canvas.paint(
        hole.rect,
        |x, y| hole.distance(x, y),
        |x, y| {
            let (a, b) = ((x + y * 0.62) / QUARRY, (x - y * 0.62) / QUARRY);
            let (ia, ib) = (floor(a), floor(b));
            let (fa, fb) = (a - ia as f32, b - ib as f32);
            let came = fa.min(1.0 - fa).min(fb).min(1.0 - fb) * QUARRY * 0.6;
            let bits = hash(key, ia, ib);
            let tone = tones[(word(bits, 0) * tones.len() as f32) as usize];
            let high = (y - hole.rect.y0) / hole.rect.height();
            let glass = tone * (0.5 + 0.55 * word(bits, 1) + 0.35 * high);
            let leading = smoothstep(0.014, 0.006, came);
            Texel::solid(glass.lerp(lead, leading), 0.2 + 0.4 * leading).at(-0.14 + (word(bits, 2) - 0.5) * 0.04 * fa)
        },
    );
}

/// Mullion, two pointed lights and a ring above them.
fn tracery(canvas: &mut Canvas, hole: &Hole, stone: &Sandstone) {
    let rect = hole.rect;
    let springing = hole.springing() - 0.12;
    let half = rect.width() / 2.0;
    let bar = 0.036;
    let light = |left: f32| Hole::new(Rect::new(left, rect.y0, left + half, springing + half * 0.866), Head::Pointed(0.0));
    let (first, second) = (light(rect.x0), light(rect.cx()));
    let eye = (rect.cx(), springing + half * 1.06);
    let ribs = |x: f32, y: f32| {
        let arches = first.distance(x, y).abs().min(second.distance(x, y).abs()) - bar;
        let ring = disc(eye.0, eye.1, half * 0.42, x, y).abs() - bar * 0.8;
        let post = ((x - rect.cx()).abs() - bar).max(y - springing);
        let rim = -hole.distance(x, y) - bar;
        arches.min(ring).min(post).min(rim).max(hole.distance(x, y))
    };
    canvas.cast(rect, ribs, 0.05, 0.45);
    canvas
        .paint(rect, ribs, |x, y| stone.texel(x, y, (floor(y / 0.6), 11)).times(0.96 + 0.2 * falloff(-ribs(x, y), 0.02)).at(-0.07));
}

/// Loophole of a tower: a narrow slit in a splay of quoins.
pub(crate) fn slit(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let splay = Hole::of(Opening::Slit);
    quoins(canvas, &splay, (0.14, 0.3), 0.3, &stone);
    canvas.paint_rect(splay.rect, |x, y| {
        let side = 0.78 + 0.7 * (x - MIDDLE);
        stone.texel(x, y, (floor(y / 0.36), 12)).times(side).at(-0.1 * falloff((x - MIDDLE).abs() - 0.1, 0.12))
    });
    let gap = Rect::standing(MIDDLE, 1.06, 0.15, 1.28);
    let dark = srgb(0x0026_2422);
    canvas.paint_rect(gap, |x, _| Texel::solid(dark * (1.0 + 2.0 * (x - gap.x0)), 0.95).at(-0.14));
    shade_recess(canvas, &splay, 0.16, 0.5);
    streaks(canvas, MIDDLE, 0.66, 0.12, 0.45, draw.part(2));
}

/// Pair of louvred arches with a column between, under a hood and over a sill.
pub(crate) fn belfry(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let around = Hole::of(Opening::Belfry);
    quoins(canvas, &around, (0.14, 0.3), 0.34, &stone);
    canvas.paint(
        around.rect,
        |x, y| around.distance(x, y),
        |x, y| {
            let contact = 0.3 * falloff(-around.distance(x, y), 0.1);
            stone.texel(x, y, (floor(y / 0.34), 13)).times(0.9 - contact).at(-0.04)
        },
    );
    for side in [-1.0, 1.0] {
        let arch = Hole::new(Rect::standing(MIDDLE + side * 0.46, 0.55, 0.74, 1.98), Head::Round);
        stone_ring(canvas, &arch, 0.075, (0.3, 7.0), 0.03, &stone);
        louvres(canvas, &arch);
        shade_recess(canvas, &arch, 0.24, 0.5);
    }
    column(canvas, Rect::standing(MIDDLE, 0.55, 0.16, 1.6), &stone);
    shade_recess(canvas, &around, 0.12, 0.35);
    streaks(canvas, MIDDLE - 0.85, 0.44, 0.1, 0.36, draw.part(1));
    streaks(canvas, MIDDLE + 0.8, 0.44, 0.09, 0.3, draw.part(2));
    sill(canvas, MIDDLE, 0.55, 2.2, stone.texel(MIDDLE, 0.5, (6, 6)).times(1.08));
}

/// Slanting boards in a dark bell chamber.
fn louvres(canvas: &mut Canvas, hole: &Hole) {
    const PITCH: f32 = 0.17;
    let (board, dark) = (srgb(0x0066_5C50), srgb(0x0028_2623));
    canvas.paint(
        hole.rect,
        |x, y| hole.distance(x, y),
        |_, y| {
            let at = (y - hole.rect.y0) / PITCH;
            let part = at - floor(at) as f32;
            let lit = board * (0.55 + 0.55 * part);
            let colour = if part < 0.3 { dark.lerp(lit, smoothstep(0.18, 0.3, part)) } else { lit };
            Texel::solid(colour, 0.85).at(-0.14 + 0.05 * (1.0 - part))
        },
    );
}

/// A round shaft with base and capital.
fn column(canvas: &mut Canvas, rect: Rect, stone: &Sandstone) {
    canvas.cast(rect, |x, y| rect.distance(x, y), 0.1, 0.5);
    let half = rect.width() / 2.0;
    canvas.paint_rect(rect, |x, y| {
        let t = (x - rect.cx()) / half;
        stone.texel(x, y, (1, 14)).times(1.08 - 0.2 * t - 0.32 * t * t).at(0.06 * (1.0 - t * t))
    });
    let block = stone.texel(rect.cx(), rect.y1, (2, 14)).times(1.05);
    canvas.slab(Rect::standing(rect.cx(), rect.y0, 0.24, 0.12), block, 0.04);
    canvas.slab(Rect::standing(rect.cx(), rect.y1 - 0.14, 0.26, 0.14), block, 0.06);
}

const GOLD: u32 = 0x00C6_A24E;

/// Ticks around a centre: `count` strokes between two radii.
fn ticks(canvas: &mut Canvas, (cx, cy): (f32, f32), radii: (f32, f32), count: u32, half: f32, hex: u32) {
    let paint = Texel::solid(srgb(hex), 0.4).at(0.05);
    for i in 0..count {
        let turn = i as f32 / count as f32 * core::f32::consts::TAU;
        let (sin, cos) = (libm::sinf(turn), libm::cosf(turn));
        let (a, b) = ((cx + cos * radii.0, cy + sin * radii.0), (cx + cos * radii.1, cy + sin * radii.1));
        let area = Rect::new(a.0.min(b.0), a.1.min(b.1), a.0.max(b.0), a.1.max(b.1)).grow(half * 2.0, half * 2.0);
        canvas.paint(area, |x, y| stroke(a, b, half, x, y), |_, _| paint);
    }
}

/// Roman numerals as bundles of strokes: enough to be read as hours from the square.
fn numerals(canvas: &mut Canvas, centre: (f32, f32), radius: f32, hex: u32) {
    let paint = Texel::solid(srgb(hex), 0.4).at(0.05);
    for hour in 0..24_u32 {
        let turn = hour as f32 / 24.0 * core::f32::consts::TAU;
        let (sin, cos) = (libm::sinf(turn), libm::cosf(turn));
        let strokes = [1, 2, 3, 2, 1, 2, 3, 4, 2, 1, 2, 3][(hour % 12) as usize];
        for i in 0..strokes {
            let off = (i as f32 - (strokes - 1) as f32 / 2.0) * 0.03;
            let skew = if hour % 12 > 3 && i + 1 == strokes { 0.025 } else { 0.0 };
            let place = |r: f32, side: f32| (centre.0 + cos * r - sin * side, centre.1 + sin * r + cos * side);
            let (a, b) = (place(radius - 0.05, off - skew), place(radius + 0.05, off + skew));
            let area = Rect::new(a.0.min(b.0), a.1.min(b.1), a.0.max(b.0), a.1.max(b.1)).grow(0.03, 0.03);
            canvas.paint(area, |x, y| stroke(a, b, 0.009, x, y), |_, _| paint);
        }
    }
}

/// A dial like that of the Old Town Hall: a black ring of old hours, a blue ring of Roman ones, day and night skies within, a
/// zodiac ring off the centre, sun and moon on their hands.
pub(crate) fn clock(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let centre = (MIDDLE, 1.72);
    let frame = Rect::standing(MIDDLE, 0.42, 2.56, 2.6);
    canvas.cast(frame, |x, y| frame.distance(x, y), 0.06, 0.4);
    canvas.paint_rect(frame, |x, y| {
        let block = (floor(x / 0.64), floor(y / 0.43));
        let (fx, fy) = (x / 0.64 - block.0 as f32, y / 0.43 - block.1 as f32);
        let edge = (fx.min(1.0 - fx) * 0.64).min(fy.min(1.0 - fy) * 0.43);
        stone.texel(x, y, block).times(1.0 - 0.35 * falloff(edge, 0.014)).at(0.05)
    });
    cornice(canvas, Rect::standing(MIDDLE, 3.0, 2.4, 0.16), 0.16, stone.texel(MIDDLE, 3.0, (1, 1)).times(1.1));
    canvas.slab(Rect::standing(MIDDLE, 0.36, 2.5, 0.1), stone.texel(MIDDLE, 0.4, (2, 2)).times(1.05), 0.09);
    let area = |r: f32| Rect::standing(centre.0, centre.1 - r, r * 2.0, r * 2.0);
    canvas.cast(area(1.18), |x, y| disc(centre.0, centre.1, 1.18, x, y), 0.08, 0.45);
    for (radius, hex, rough) in
        [(1.18, GOLD, 0.4), (1.14, 0x0033_3132, 0.6), (0.97, GOLD, 0.4), (0.95, 0x0030_4A6E, 0.5), (0.74, GOLD, 0.4)]
    {
        let paint = Texel::solid(srgb(hex), rough).at(0.06);
        canvas.paint(
            area(radius),
            |x, y| disc(centre.0, centre.1, radius, x, y),
            |x, y| paint.times(1.0 + 0.12 * (y - centre.1 - x + centre.0)),
        );
    }
    skies(canvas, centre, area(0.72));
    ticks(canvas, centre, (1.01, 1.1), 24, 0.012, GOLD);
    numerals(canvas, centre, 0.845, GOLD);
    zodiac(canvas, centre, draw);
}

/// Day above (blue, with a band of dawn), night below.
fn skies(canvas: &mut Canvas, centre: (f32, f32), area: Rect) {
    let (day, pale, dawn, night) = (srgb(0x0048_74A0), srgb(0x0083_A6BC), srgb(0x00B0_6A43), srgb(0x002A_2C34));
    let inside = |x: f32, y: f32| disc(centre.0, centre.1, 0.72, x, y);
    canvas.paint(area, inside, |x, y| {
        let horizon = -disc(centre.0, centre.1 + 1.0, 1.18, x, y);
        let dusk = -disc(centre.0, centre.1 + 0.85, 1.16, x, y);
        let colour = night
            .lerp(dawn, smoothstep(-0.01, 0.01, dusk))
            .lerp(day.lerp(pale, falloff(disc(centre.0, centre.1, 0.25, x, y), 0.4)), smoothstep(-0.01, 0.01, horizon));
        let line = 0.25 * falloff((horizon).abs().min(dusk.abs()), 0.012);
        Texel::solid(colour * (1.0 + line), 0.5).at(0.06)
    });
    let gold = Texel::solid(srgb(GOLD), 0.4).at(0.065);
    let tropics = |x: f32, y: f32| (disc(centre.0, centre.1, 0.46, x, y).abs() - 0.007).max(inside(x, y));
    canvas.paint(area, tropics, |_, _| gold);
    for dx in [-0.55, -0.28, 0.0, 0.28, 0.55] {
        let (a, b) = ((centre.0, centre.1), (centre.0 + dx, centre.1 + 0.71));
        canvas.paint(area, |x, y| stroke(a, b, 0.005, x, y).max(inside(x, y)), |_, _| gold);
    }
}

/// The zodiac ring and the hands.
fn zodiac(canvas: &mut Canvas, centre: (f32, f32), draw: Draw) {
    let off = (centre.0 + 0.1, centre.1 + 0.13);
    let area = Rect::standing(off.0, off.1 - 0.52, 1.04, 1.04);
    let ring = |x: f32, y: f32| disc(off.0, off.1, 0.44, x, y).abs() - 0.07;
    canvas.cast(area, ring, 0.04, 0.5);
    let (gold, band) = (Texel::solid(srgb(GOLD), 0.38).at(0.09), Texel::solid(srgb(0x0036_4A60), 0.5).at(0.085));
    canvas.paint(area, ring, |_, _| gold);
    canvas.paint(area, |x, y| disc(off.0, off.1, 0.44, x, y).abs() - 0.052, |_, _| band);
    ticks(canvas, off, (0.4, 0.48), 12, 0.014, GOLD);
    let turn = draw.between("hour", 0.6, 2.4) as f32;
    let hands = [(turn, 0.9, 0.075, GOLD), (turn + 2.3, 0.62, 0.055, 0x00B9_B6AA)];
    for (angle, reach, bulb, hex) in hands {
        let (sin, cos) = (libm::sinf(angle), libm::cosf(angle));
        let place = |r: f32| (centre.0 + cos * r, centre.1 + sin * r);
        let (from, to, at) = (place(-0.12), place(reach), place(reach * 0.72));
        let area = Rect::standing(centre.0, centre.1 - 1.1, 2.2, 2.2);
        let shape = |x: f32, y: f32| stroke(from, to, 0.014, x, y).min(disc(at.0, at.1, bulb, x, y));
        canvas.cast(area, shape, 0.035, 0.5);
        let metal = Texel::solid(srgb(hex), 0.35).at(0.11);
        canvas.paint(area, shape, |_, _| metal);
    }
    let hub = Rect::standing(centre.0, centre.1 - 0.06, 0.12, 0.12);
    let globe = Texel::solid(srgb(0x0047_6A86), 0.4).at(0.12);
    canvas.paint(hub, |x, y| disc(centre.0, centre.1, 0.055, x, y), |_, _| globe);
}
