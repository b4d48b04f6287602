//! Mouldings of stucco: surrounds, cornices, sills, pediments, keystones, drawn from their profiles.
//!
//! A profile gives the height over the wall along the way across a moulding; its slope gives the painted light (from the
//! upper left) and, by way of the relief, the normals.

use crate::canvas::{Canvas, Rect, Texel, stroke};
use crate::hole::Hole;
use crate::noise::{falloff, smoothstep};

/// Painted light falls along this way (x, y), from the upper left.
const LIGHT: (f32, f32) = (-0.45, 0.75);

/// Light on a slope: how much brighter or darker than the flat wall.
#[inline]
fn light_on(slope_x: f32, slope_y: f32) -> f32 {
    1.0 - 0.4 * (slope_x * LIGHT.0 + slope_y * LIGHT.1).clamp(-0.75, 0.75)
}

/// Two fasciae and a raised outer fillet: height in metres at a share of the way out.
fn architrave(t: f32) -> f32 {
    0.022 + 0.012 * smoothstep(0.3, 0.36, t) + 0.024 * smoothstep(0.66, 0.8, t) - 0.058 * smoothstep(0.96, 1.0, t)
}

/// A moulded band of the given width around an opening, standing on the foot of its rectangle.
pub(crate) fn surround(canvas: &mut Canvas, hole: &Hole, width: f32, fill: Texel) {
    let outer = hole.inset(-width, 0.0);
    canvas.cast(outer.rect, |x, y| outer.distance(x, y), 0.06, 0.4);
    let profile = |d: f32| architrave((d / width).clamp(0.0, 1.0));
    canvas.paint(
        outer.rect,
        |x, y| outer.distance(x, y),
        |x, y| {
            let d = hole.distance(x, y);
            let slope = (profile(d + 0.008) - profile(d - 0.008)) / 0.016;
            let (ox, oy) = hole.outwards(x, y);
            fill.at(profile(d)).times(light_on(slope * ox, slope * oy))
        },
    );
}

/// Bed moulding, corona and cyma of a cornice: how far it stands out, as a share, at a share of its height.
fn cornice_profile(t: f32) -> f32 {
    0.12 + 0.3 * smoothstep(0.05, 0.32, t) + 0.33 * smoothstep(0.38, 0.44, t) + 0.25 * smoothstep(0.7, 0.95, t)
}

/// A straight cornice over `rect`, standing out `proud` metres at the top, also beyond its ends.
pub(crate) fn cornice(canvas: &mut Canvas, rect: Rect, proud: f32, fill: Texel) {
    let profile = |y: f32| proud * cornice_profile(((y - rect.y0) / rect.height()).clamp(0.0, 1.0));
    let area = rect.grow(proud, 0.0);
    let shape = |x: f32, y: f32| {
        let half = rect.width() / 2.0 + 0.6 * profile(y);
        ((x - rect.cx()).abs() - half).max(rect.y0 - y).max(y - rect.y1)
    };
    canvas.cast(area, shape, proud, 0.5);
    canvas.paint(area, shape, |_, y| {
        let slope = (profile(y + 0.008) - profile(y - 0.008)) / 0.016;
        let cap = 0.1 * falloff(rect.y1 - y, 0.02);
        fill.at(profile(y)).times(1.0 - 0.3 * (slope * 0.6).clamp(0.0, 1.0) + cap)
    });
}

/// A window sill: a slab with a shaded underside, and its shadow.
pub(crate) fn sill(canvas: &mut Canvas, cx: f32, top: f32, width: f32, fill: Texel) {
    canvas.slab(Rect::standing(cx, top - 0.13, width - 0.1, 0.06), fill.times(0.86), 0.035);
    canvas.slab(Rect::standing(cx, top - 0.085, width, 0.085), fill.times(1.06), 0.085);
}

/// A triangular pediment: raking and level cornices around a shaded field. `rect` holds it, proud parts included.
pub(crate) fn pediment(canvas: &mut Canvas, rect: Rect, fill: Texel) {
    let band = 0.1;
    let base = Rect::new(rect.x0 + 0.08, rect.y0, rect.x1 - 0.08, rect.y0 + 0.11);
    let (left, right) = ((rect.x0 + 0.03, rect.y0 + 0.13), (rect.x1 - 0.03, rect.y0 + 0.13));
    let apex = (rect.cx(), rect.y1 - band / 2.0);
    let rise = (apex.1 - left.1) / (apex.0 - left.0);
    let under = |x: f32, y: f32| (y - left.1 - rise * (rect.width() / 2.0 - 0.03 - (x - apex.0).abs())).max(rect.y0 - y);
    canvas.paint(rect, under, |x, y| {
        let below_rake = -under(x, y);
        fill.times(0.8 - 0.3 * falloff(below_rake - band / 2.0, 0.11)).at(0.02)
    });
    rosette(canvas, (rect.cx(), rect.y0 + 0.215), 0.075, fill);
    cornice(canvas, base, 0.11, fill);
    for (end, lit) in [(left, 1.05), (right, 0.93)] {
        let rake = |x: f32, y: f32| stroke(end, apex, band / 2.0, x, y).max(rect.y0 + 0.105 - y);
        canvas.cast(rect, rake, 0.06, 0.4);
        canvas.paint(rect, rake, |x, y| {
            let across = stroke(end, apex, 0.0, x, y) / (band / 2.0);
            let above = y > end.1 + (apex.1 - end.1) * ((x - end.0) / (apex.0 - end.0));
            let side = if above { 0.12 * across } else { -0.24 * across };
            let groove = 0.14 * falloff((across - 0.45).abs(), 0.16);
            fill.times(lit + side - groove).at(0.1 - 0.02 * across)
        });
    }
}

/// A round boss with petals.
fn rosette(canvas: &mut Canvas, at: (f32, f32), radius: f32, fill: Texel) {
    let area = Rect::standing(at.0, at.1 - radius, radius * 2.0, radius * 2.0);
    let shape = |x: f32, y: f32| crate::canvas::disc(at.0, at.1, radius, x, y);
    canvas.cast(area, shape, 0.03, 0.35);
    canvas.paint(area, shape, |x, y| {
        let (dx, dy) = ((x - at.0) / radius, (y - at.1) / radius);
        let petal = (dx * dx - dy * dy).abs().min(2.0 * (dx * dy).abs());
        fill.times(0.98 - 0.3 * petal - 0.18 * dx * 0.6 + 0.2 * dy).at(0.03 * (1.0 - dx * dx - dy * dy))
    });
}

/// A keystone: wider at the top, split by light.
pub(crate) fn keystone(canvas: &mut Canvas, cx: f32, foot: f32, top: f32, width: f32, fill: Texel) {
    let area = Rect::standing(cx, foot, width * 1.3, top - foot);
    let shape = |x: f32, y: f32| {
        let t = (y - foot) / (top - foot);
        ((x - cx).abs() - width * (0.36 + 0.26 * t)).max(foot - y).max(y - top)
    };
    canvas.cast(area, shape, 0.06, 0.4);
    canvas.paint(area, shape, |x, y| {
        let edge = falloff(-shape(x, y), 0.025);
        let side = if x < cx { 0.08 } else { -0.1 };
        fill.times(1.02 + side * edge + 0.12 * falloff(top - y, 0.02) - 0.25 * falloff(y - foot, 0.02)).at(0.08 - 0.02 * edge)
    });
}

/// A console: a scrolled bracket under cornice or sill.
pub(crate) fn console(canvas: &mut Canvas, rect: Rect, fill: Texel) {
    let half = rect.width() / 2.0;
    let shape = |x: f32, y: f32| {
        let t = (rect.y1 - y) / rect.height();
        ((x - rect.cx()).abs() - half * (1.0 - 0.35 * t * t)).max(rect.y0 - y).max(y - rect.y1)
    };
    canvas.cast(rect, shape, 0.07, 0.4);
    canvas.paint(rect, shape, |x, y| {
        let t = (rect.y1 - y) / rect.height();
        let scroll = 0.14 * falloff((t - 0.35).abs(), 0.08) + 0.1 * falloff((t - 0.75).abs(), 0.06);
        let groove = 0.16 * falloff((x - rect.cx()).abs(), rect.width() * 0.14);
        fill.times(1.06 - 0.22 * t - scroll - groove).at(0.08 * (1.0 - t))
    });
}

/// A sunk panel with a bevelled rim.
pub(crate) fn panel(canvas: &mut Canvas, rect: Rect, rim: f32, fill: Texel, depth: f32) {
    canvas.paint_rect(rect, |x, y| {
        let d = -rect.distance(x, y);
        let t = smoothstep(0.0, rim, d);
        let mut light = 1.0 - 0.03 * t;
        if d < rim {
            let (left, right) = (x - rect.x0, rect.x1 - x);
            let (foot, head) = (y - rect.y0, rect.y1 - y);
            let nearest = left.min(right).min(foot).min(head);
            light += if nearest == head {
                -0.3
            } else if nearest == left {
                -0.18
            } else if nearest == foot {
                0.2
            } else {
                0.1
            };
        }
        fill.times(light).at(fill.height - depth * t)
    });
}
