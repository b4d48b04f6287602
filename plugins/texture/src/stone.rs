//! Dressed stone: its grain, the rings and quoins around openings, steps, and the ashlar of plinths and monuments.

use glam::Vec3;
use veduta_city::draw::Draw;

use crate::canvas::{Canvas, Rect, Texel, srgb};
use crate::hole::{Head, Hole};
use crate::noise::{Fractal, falloff, floor, hash, mix, smoothstep, word};

/// Sandstone with its grain and weather.
pub(crate) struct Sandstone {
    grain: Fractal,
    weather: Fractal,
    light: Vec3,
    soot: Vec3,
    key: u64,
    size_m: (f32, f32),
}

impl Sandstone {
    pub(crate) fn new(draw: Draw, size_m: (f32, f32)) -> Self {
        Self {
            grain: Fractal::new(draw.bits("stone grain"), 40, 48, 2, 0.7),
            weather: Fractal::new(draw.bits("stone weather"), 6, 7, 3, 0.6),
            light: srgb(0x00BC_A680),
            soot: srgb(0x006E_6353),
            key: draw.bits("stone blocks"),
            size_m,
        }
    }

    /// The stone of one block; the wall's colour still tells in it a little.
    pub(crate) fn texel(&self, x: f32, y: f32, block: (i32, i32)) -> Texel {
        let (u, v) = (x / self.size_m.0, y / self.size_m.1);
        let bits = hash(self.key, block.0, block.1);
        let (grain, weather) = (self.grain.at(u, v), self.weather.at(u, v));
        let shade = 1.0 + 0.3 * (word(bits, 0) - 0.5) + 0.08 * grain + 0.1 * weather;
        let sooty = (0.26 + 0.4 * (word(bits, 1) - 0.5) + 0.3 * weather).clamp(0.0, 0.7);
        let warm = Vec3::new(1.0, 1.0, 1.0 + 0.16 * (word(bits, 2) - 0.5));
        let own = self.light.lerp(self.soot, sooty) * warm * (0.8 * shade);
        Texel { own, tint: Vec3::splat(0.2 * shade), height: 0.004 * grain, rough: 0.86 }
    }
}

impl Sandstone {
    /// A block that stands out of the wall: base, impost, guard stone.
    pub(crate) fn block(&self, canvas: &mut Canvas, rect: Rect, light: f32, proud: f32) {
        let id = (floor(rect.x0 * 16.0), floor(rect.y0 * 16.0));
        let plain = self.texel(rect.cx(), rect.y0, id);
        canvas.slab(rect, plain.times(light), proud);
        canvas.shade(rect, |x, y| {
            let (u, v) = (x / self.size_m.0, y / self.size_m.1);
            1.0 + 0.09 * self.grain.at(u, v) + 0.1 * self.weather.at(u * 2.0, v * 2.0)
        });
    }
}

/// Light on a block's rim: dark in the joint, lit above, shaded below. `edge` is the distance to the nearest joint.
fn rim(edge: f32, joint: f32) -> f32 {
    1.0 - 0.4 * falloff(edge, joint)
}

/// Number of a block along the ring around an opening and the distance to its nearest joint: courses up the jambs, wedges
/// about the arch.
fn ring_block(hole: &Hole, x: f32, y: f32, course: f32, wedges: f32) -> (i32, f32) {
    let springing = hole.springing();
    let right = i32::from(x > hole.rect.cx());
    let (at, length, offset) = if y < springing || hole.head == Head::Flat {
        ((y - hole.rect.y0) / course, course, 100 * right)
    } else {
        let centre = match hole.head {
            Head::Segment(rise) => {
                let half = hole.rect.width() / 2.0;
                hole.rect.y1 - (half * half + rise * rise) / (2.0 * rise)
            }
            _ => springing,
        };
        let (dx, dy) = (x - hole.rect.cx(), y - centre);
        let half_turn = core::f32::consts::PI;
        (libm::atan2f(dy, dx) / half_turn * wedges, (dx * dx + dy * dy).sqrt() * half_turn / wedges, 300)
    };
    let whole = floor(at);
    let part = at - whole as f32;
    (whole + offset, part.min(1.0 - part) * length)
}

/// A ring of stones of the given width around an opening: jamb courses and voussoirs.
pub(crate) fn stone_ring(
    canvas: &mut Canvas,
    hole: &Hole,
    width: f32,
    (course, wedges): (f32, f32),
    proud: f32,
    stone: &Sandstone,
) {
    let outer = hole.inset(-width, 0.0);
    canvas.cast(outer.rect, |x, y| outer.distance(x, y), proud, 0.4);
    canvas.paint(
        outer.rect,
        |x, y| outer.distance(x, y),
        |x, y| {
            let (block, edge) = ring_block(hole, x, y, course, wedges);
            let (from_outer, from_hole) = (-outer.distance(x, y), hole.distance(x, y));
            let bead = 0.16 * falloff((from_hole - 0.055).abs(), 0.018) * f32::from(u8::from(from_hole > 0.0));
            let (ox, oy) = hole.outwards(x, y);
            let turn = falloff(from_outer, 0.03) * (0.16 * oy - 0.14 * ox);
            let light = rim(edge, 0.016) * (1.0 + turn - bead);
            let texel = stone.texel(x, y, (block, 1)).times(light);
            texel.at(texel.height + proud * smoothstep(0.0, 0.03, from_outer) - 0.012 * falloff(edge, 0.014) - 0.1 * bead)
        },
    );
}

/// Quoins around an opening: courses by turns long and short, toothed into the plaster, which overlaps them softly.
pub(crate) fn quoins(canvas: &mut Canvas, hole: &Hole, (short, long): (f32, f32), course: f32, stone: &Sandstone) {
    let area = hole.inset(-long, 0.0).rect.grow(0.0, course);
    let (foot, springing) = (hole.rect.y0 - course, hole.springing());
    let row_of = |y: f32| floor((y - foot) / course);
    let half = hole.rect.width() / 2.0;
    let shape = |x: f32, y: f32| {
        let reach = if row_of(y.min(springing)) % 2 == 0 { long } else { short };
        let in_course = (y - foot) / course - row_of(y) as f32;
        let slack = 0.02 * (in_course.min(1.0 - in_course) * 2.0).min(0.5);
        // Jambs are cut square; about an arch the stones follow its curve, over a lintel they end one course higher.
        let across = (x - hole.rect.cx()).abs() - half;
        let beyond = match hole.head {
            Head::Flat => across.max(y - hole.rect.y1 - course + reach),
            _ if y > springing => hole.distance(x, y),
            _ => across,
        };
        (beyond - reach - slack + 0.02).max(foot - y)
    };
    canvas.paint(area, shape, |x, y| {
        let row = row_of(y);
        let side = i32::from(x > hole.rect.cx());
        let (block, edge) = if y > springing {
            let (block, edge) = ring_block(hole, x, y, course, 7.0);
            ((block, 2), edge)
        } else {
            let part = (y - foot) / course - row as f32;
            ((row, 3 + side), part.min(1.0 - part) * course)
        };
        let light = rim(edge, 0.014) * (1.0 - 0.18 * falloff(-shape(x, y), 0.02));
        stone.texel(x, y, block).times(light).at(0.006)
    });
}

/// Steps before a door, the lowest first; each tread is lit, each riser shaded.
pub(crate) fn steps(canvas: &mut Canvas, cx: f32, widths: &[f32], rise: f32, stone: &Sandstone) {
    for (i, &width) in widths.iter().enumerate().rev() {
        let step = Rect::standing(cx, rise * i as f32, width, rise);
        canvas.cast(step, |x, y| step.distance(x, y), 0.08, 0.35);
        canvas.paint_rect(step, |x, y| {
            let tread = falloff(step.y1 - y, 0.045);
            let contact = falloff(y - step.y0, 0.05);
            let worn = 0.05 * falloff((x - cx).abs(), width * 0.35);
            let joint = 0.3 * falloff((x - cx - 0.3 + 0.55 * (i % 2) as f32).abs(), 0.012);
            stone.texel(x, y, (0, 20 + i as i32)).times(0.82 - joint + 0.3 * tread - 0.25 * contact + worn).at(0.03 * tread)
        });
    }
}

/// Courses of blocks that tile: boundaries in both directions, as shares of the tile, with irregular lengths.
pub(crate) struct Courses {
    rows: Vec<(f32, f32, Vec<f32>)>,
    size_m: (f32, f32),
    key: u64,
}

/// A place within a block.
pub(crate) struct InBlock {
    /// Distance to the nearest joint in metres.
    pub(crate) edge: f32,
    /// Hash of the block.
    pub(crate) bits: u64,
    /// Place within the block, 0 to 1, right and up.
    pub(crate) at: (f32, f32),
}

impl Courses {
    /// `rows` courses with about `blocks` blocks in each; `vary` between 0 (regular) and 1.
    pub(crate) fn new(key: u64, size_m: (f32, f32), rows: u32, blocks: u32, vary: f32) -> Self {
        let cuts = |n: u32, salt: i32| -> Vec<f32> {
            (0..n).map(|i| (i as f32 + (word(hash(key, i as i32, salt), 1) - 0.5) * vary * 0.7) / n as f32).collect()
        };
        // Moved by a part of a course, so that the tile's own edge lies on stone and not along a joint.
        let heights: Vec<f32> = cuts(rows, -1).into_iter().map(|h| h + 0.4 / rows as f32).collect();
        let row = |i: usize| {
            let top = heights.get(i + 1).copied().unwrap_or(heights[0] + 1.0);
            let extra = (word(hash(key, i as i32, -2), 0) * vary * 2.0) as u32;
            let shift = (i % 2) as f32 * 0.5 / blocks as f32 + 0.3 * vary * word(hash(key, i as i32, -3), 0) / blocks as f32;
            let mut joints: Vec<f32> =
                cuts(blocks + extra, i as i32 + 10).into_iter().map(|c| c + shift).map(|c| c - floor(c) as f32).collect();
            joints.sort_by(f32::total_cmp);
            (heights[i], top, joints)
        };
        Self { rows: (0..heights.len()).map(row).collect(), size_m, key }
    }

    /// The block at a place given in tiles.
    pub(crate) fn at(&self, u: f32, v: f32) -> InBlock {
        let v = v - floor(v) as f32;
        let (index, shifted) = self
            .rows
            .iter()
            .enumerate()
            .find_map(|(i, row)| [v, v + 1.0, v - 1.0].into_iter().find(|w| (row.0..row.1).contains(w)).map(|w| (i, w)))
            .unwrap_or((0, v));
        let (low, high, joints) = &self.rows[index];
        let u = u - floor(u) as f32;
        let n = joints.len();
        let after = joints.iter().position(|&j| j > u).unwrap_or(n);
        let left = if after == 0 { joints[n - 1] - 1.0 } else { joints[after - 1] };
        let right = if after == n { joints[0] + 1.0 } else { joints[after] };
        let block = (after + n - 1) % n;
        let x = (u - left).min(right - u) * self.size_m.0;
        let y = (shifted - low).min(high - shifted) * self.size_m.1;
        InBlock {
            edge: x.min(y),
            bits: hash(self.key, index as i32, block as i32 + 1000),
            at: ((u - left) / (right - left), (shifted - low) / (high - low)),
        }
    }
}

/// Ashlar in courses of 40 cm: coloured by the vertex.
pub(crate) fn ashlar(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let courses = Courses::new(draw.bits("ashlar"), size_m, 5, 3, 0.35);
    let grain = Fractal::new(draw.bits("grain"), 48, 48, 2, 0.7);
    let weather = Fractal::new(draw.bits("weather"), 4, 4, 4, 0.6);
    let runs = Fractal::new(draw.bits("runs"), 22, 3, 2, 0.5);
    Canvas::tiling(size, size_m, |u, v| {
        let (grain, weather) = (grain.at(u, v), weather.at(u, v));
        let block = courses.at(u + 0.001 * grain, v + 0.001 * weather);
        let joint = falloff(block.edge, 0.013);
        let rim = falloff(block.edge, 0.035) * 0.07;
        let shade = 1.03 + 0.2 * (word(block.bits, 0) - 0.5) + 0.06 * grain + 0.08 * weather + 0.04 * runs.at(u, v);
        let light = shade * (1.0 - rim) * mix(1.0, 0.55, joint) * (1.0 + 0.05 * (block.at.1 - 0.5));
        let soot = (weather * 0.5).clamp(-0.1, 0.3) + 0.15 * (word(block.bits, 1) - 0.5);
        let tint = Vec3::new(1.0, 1.0 - 0.03 * soot, 1.0 + 0.2 * soot) * light * (1.0 - 0.3 * soot.max(0.0));
        let height = 0.006 * grain - 0.014 * joint - 0.004 * falloff(block.edge, 0.03) + 0.002 * weather;
        Texel { own: Vec3::ZERO, tint, height, rough: 0.86 + 0.05 * grain }
    })
}

/// Carved stone that tiles: grain, soft weather and dark runs, without joints; coloured by the vertex.
pub(crate) fn carved(size: u32, size_m: (f32, f32), draw: Draw) -> Canvas {
    let grain = Fractal::new(draw.bits("grain"), 64, 64, 2, 0.7);
    let weather = Fractal::new(draw.bits("weather"), 5, 4, 4, 0.6);
    let runs = Fractal::new(draw.bits("runs"), 19, 2, 3, 0.6);
    Canvas::tiling(size, size_m, |u, v| {
        let (grain, weather, run) = (grain.at(u, v), weather.at(u, v), runs.at(u, v));
        let shade = 1.0 + 0.06 * grain + 0.11 * weather - 0.13 * smoothstep(0.1, 0.9, run);
        let warm = Vec3::new(1.0, 1.0 - 0.01 * weather, 1.0 - 0.05 * weather);
        Texel { own: Vec3::ZERO, tint: warm * shade, height: 0.0022 * grain, rough: 0.84 + 0.05 * weather }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::Id;

    #[test]
    fn courses_cover_the_tile_and_repeat() {
        let courses = Courses::new(3, (2.0, 2.0), 5, 3, 0.8);
        for i in 0..900 {
            let (u, v) = ((i % 30) as f32 / 30.0 + 0.003, (i / 30) as f32 / 30.0 + 0.003);
            let here = courses.at(u, v);
            assert!(here.edge >= 0.0 && here.edge < 0.4, "{}", here.edge);
            assert!((0.0..=1.0).contains(&here.at.0) && (0.0..=1.0).contains(&here.at.1));
            assert_eq!(here.bits, courses.at(u + 1.0, v - 1.0).bits);
        }
    }

    #[test]
    fn ashlar_keeps_the_colour_of_its_wall_on_the_whole() {
        let canvas = ashlar(64, (2.0, 2.0), Draw::new(1, Id(0), "test"));
        let mean = canvas.texels.iter().map(|t| t.tint.x).sum::<f32>() / 4096.0;
        assert!((0.85..1.1).contains(&mean), "mean {mean}");
    }
}
