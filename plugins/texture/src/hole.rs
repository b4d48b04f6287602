//! The outline of an opening, and the depth it is seen to have.

use veduta_city::Opening;
use veduta_city::opening::Recess;

use crate::bay::MIDDLE;
use crate::canvas::{Canvas, Rect, Texel, disc};
use crate::noise::{falloff, smoothstep};

/// How an opening ends at the top; lengths are metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Head {
    Flat,
    Segment(f32),
    Round,
    Pointed(f32),
}

impl From<veduta_city::opening::Head> for Head {
    fn from(head: veduta_city::opening::Head) -> Self {
        use veduta_city::opening::Head::{Flat, Pointed, Round, Segment};
        match head {
            Flat => Self::Flat,
            Segment(rise) => Self::Segment(rise as f32),
            Round => Self::Round,
            Pointed(outside) => Self::Pointed(outside as f32),
        }
    }
}

/// An opening: a rectangle around it, and its head.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Hole {
    pub(crate) rect: Rect,
    pub(crate) head: Head,
}

/// Rise of a pointed arch of the given width whose centres lie `out` metres outside of its feet.
fn pointed_rise(width: f32, out: f32) -> f32 {
    let (radius, run) = (width + out, width / 2.0 + out);
    (radius * radius - run * run).max(0.0).sqrt()
}

impl Hole {
    pub(crate) const fn new(rect: Rect, head: Head) -> Self {
        Self { rect, head }
    }

    /// The hole of an opening in its bay; nothing where nothing opens.
    pub(crate) fn of(opening: Opening) -> Self {
        let nothing = Self::new(Rect::standing(MIDDLE, 0.0, 0.0, 0.0), Head::Flat);
        opening.recess().map_or(nothing, |Recess { low, high, head, .. }| {
            Self::new(Rect::new(low.x as f32, low.y as f32, high.x as f32, high.y as f32), head.into())
        })
    }

    /// Height where the head begins.
    pub(crate) fn springing(&self) -> f32 {
        let width = self.rect.width();
        match self.head {
            Head::Flat => self.rect.y1,
            Head::Segment(rise) => self.rect.y1 - rise,
            Head::Round => self.rect.y1 - width / 2.0,
            Head::Pointed(out) => self.rect.y1 - pointed_rise(width, out),
        }
    }

    /// Signed distance, negative in the opening.
    #[inline]
    pub(crate) fn distance(&self, x: f32, y: f32) -> f32 {
        let r = &self.rect;
        match self.head {
            Head::Flat => r.distance(x, y),
            Head::Segment(rise) => {
                let half = r.width() / 2.0;
                let radius = (half * half + rise * rise) / (2.0 * rise);
                let sides = Rect { y1: f32::MAX, ..*r }.distance(x, y);
                // Below the arc's own middle its circle would close again.
                if y < r.y1 - radius { sides } else { sides.max(disc(r.cx(), r.y1 - radius, radius, x, y).min(y - r.y1 + rise)) }
            }
            Head::Round => {
                let springing = self.springing();
                if y < springing {
                    Rect { y1: f32::MAX, ..*r }.distance(x, y)
                } else {
                    disc(r.cx(), springing, r.width() / 2.0, x, y)
                }
            }
            Head::Pointed(out) => {
                let (springing, width) = (self.springing(), r.width());
                if y < springing {
                    Rect { y1: f32::MAX, ..*r }.distance(x, y)
                } else {
                    disc(r.x0 - out, springing, width + out, x, y).max(disc(r.x1 + out, springing, width + out, x, y))
                }
            }
        }
    }

    /// The outline moved inwards by `sides`, and up by `foot` at the bottom; negative values move it outwards.
    pub(crate) fn inset(&self, sides: f32, foot: f32) -> Self {
        let Rect { x0, y0, x1, y1 } = self.rect;
        let (head, top) = match self.head {
            // The arcs keep their centres.
            Head::Pointed(out) => {
                let out = out + sides;
                (Head::Pointed(out), self.springing() + pointed_rise(self.rect.width() - 2.0 * sides, out))
            }
            head => (head, y1 - sides),
        };
        Self::new(Rect::new(x0 + sides, y0 + foot, x1 - sides, top), head)
    }

    /// Direction away from the opening, of length about 1.
    #[inline]
    pub(crate) fn outwards(&self, x: f32, y: f32) -> (f32, f32) {
        const STEP: f32 = 0.004;
        let here = self.distance(x, y);
        ((self.distance(x + STEP, y) - here) / STEP, (self.distance(x, y + STEP) - here) / STEP)
    }
}

/// Cuts an opening into the wall: the jambs of its reveal, narrow because seen from the front, and returns what is left of
/// it for window or door.
pub(crate) fn reveal(canvas: &mut Canvas, hole: &Hole, jamb: f32, foot: f32) -> Hole {
    let inner = hole.inset(jamb, foot);
    canvas.paint(
        hole.rect,
        |x, y| hole.distance(x, y),
        |x, y| {
            let (ox, oy) = hole.outwards(x, y);
            let deep = smoothstep(0.0, jamb, -hole.distance(x, y));
            // The right jamb takes the light, the left one and the soffit lie in shade.
            let light = 0.62 + 0.34 * ox - 0.2 * oy.max(0.0) - 0.08 * deep;
            Texel::trim(light).at(-0.06 * deep)
        },
    );
    inner
}

/// The shade that lies in a recess `depth` metres deep: thrown by head and left jamb, gathered in the corners.
pub(crate) fn shade_recess(canvas: &mut Canvas, hole: &Hole, depth: f32, strength: f32) {
    let (right, down, blur) = (0.35 * depth, 0.8 * depth, 0.2 * depth + 0.012);
    canvas.shade(hole.rect, |x, y| {
        let distance = hole.distance(x, y);
        if distance >= 0.0 {
            return 1.0;
        }
        let thrown = smoothstep(-blur, blur, hole.distance(x - right, y + down));
        let corner = 0.45 * falloff(-distance, depth * 0.6);
        1.0 - strength * thrown.max(corner)
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heads_touch_the_top_of_their_rectangle_and_leave_its_corners() {
        let rect = Rect::standing(0.0, 0.0, 1.0, 3.0);
        for head in [Head::Segment(0.2), Head::Round, Head::Pointed(0.0), Head::Pointed(0.3)] {
            let hole = Hole::new(rect, head);
            assert!(hole.distance(0.0, 2.99) < 0.0 && hole.distance(0.0, 3.01) > 0.0, "{head:?} reaches its top");
            assert!(hole.distance(0.49, 2.98) > 0.0, "{head:?} leaves the corner");
            assert!(hole.distance(0.49, 0.01) < 0.0 && hole.distance(0.51, 1.0) > 0.0);
        }
    }

    #[test]
    fn an_inset_lies_inside_by_its_width() {
        for head in [Head::Flat, Head::Round, Head::Pointed(0.0)] {
            let hole = Hole::new(Rect::standing(0.0, 0.0, 1.0, 3.0), head);
            let inner = hole.inset(0.1, 0.1);
            for (x, y) in [(0.0, 1.5), (0.2, 2.5), (0.39, 1.0), (0.1, 2.7)] {
                let apart = inner.distance(x, y) - hole.distance(x, y);
                assert!((apart - 0.1).abs() < 0.001, "{head:?} at {x}, {y}: {apart}");
            }
        }
    }
}
