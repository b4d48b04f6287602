use glam::DVec2;

/// A line on a drawing by its length: what letters stand on.
#[derive(Debug, Clone, PartialEq)]
pub struct Ribbon {
    points: Vec<DVec2>,
    /// Length up to each point.
    upto: Vec<f64>,
}

/// Most points of one: a street of thousands of units is told more coarsely.
const MOST: usize = 4_000;
/// So often points move towards their neighbours: a bump of so many passes is about as broad as the square root of half of them.
const PASSES: usize = 12;

impl Ribbon {
    /// Through these points; `None` if they have no length.
    #[must_use]
    pub fn new(mut points: Vec<DVec2>) -> Option<Self> {
        points.retain(|p| p.is_finite());
        points.dedup();
        let mut upto = Vec::with_capacity(points.len());
        let mut length = 0.0;
        for (i, p) in points.iter().enumerate() {
            length += if i > 0 { p.distance(points[i - 1]) } else { 0.0 };
            upto.push(length);
        }
        (points.len() > 1 && length > 0.0).then_some(Self { points, upto })
    }

    /// A line with its corners rounded, as far as `reach` to both sides: its points move towards the means of their neighbours again and
    /// again, but none farther than `most_off` away. Ends stay.
    #[must_use]
    pub fn smooth(line: Vec<DVec2>, reach: f64, most_off: f64) -> Option<Self> {
        let rough = Self::new(line)?;
        let step = (reach / 4.0).max(rough.length() / MOST as f64);
        if step.is_nan() || step <= 0.0 {
            return Some(rough);
        }
        let count = (libm::ceil(rough.length() / step) as usize).clamp(1, MOST);
        let even: Vec<DVec2> = (0..=count).map(|i| rough.at(rough.length() * i as f64 / count as f64).0).collect();
        let mut smoothed = even.clone();
        for _ in 0..PASSES {
            let last = smoothed.clone();
            for i in 1..even.len() - 1 {
                let mean = (last[i - 1] + 2.0 * last[i] + last[i + 1]) / 4.0;
                smoothed[i] = even[i] + (mean - even[i]).clamp_length_max(most_off.max(0.0));
            }
        }
        Self::new(smoothed)
    }

    /// Its length.
    #[must_use]
    pub fn length(&self) -> f64 {
        self.upto.last().copied().unwrap_or(0.0)
    }

    /// The point so far along it, and the direction there; clamps.
    #[must_use]
    pub fn at(&self, along: f64) -> (DVec2, DVec2) {
        let i = self.upto.partition_point(|&upto| upto <= along).clamp(1, self.points.len() - 1);
        let (a, b) = (self.points[i - 1], self.points[i]);
        let (from, to) = (self.upto[i - 1], self.upto[i]);
        let share = if to > from { ((along - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        (a.lerp(b, share), (b - a).normalize_or_zero())
    }

    /// The piece between two lengths, run backwards if the second is the lesser.
    #[must_use]
    pub fn piece(&self, from: f64, to: f64) -> Vec<DVec2> {
        let (low, high) = (from.min(to), from.max(to));
        let inner = self.points.iter().zip(&self.upto).filter(|(_, upto)| **upto > low && **upto < high).map(|(p, _)| *p);
        let mut piece: Vec<DVec2> = core::iter::once(self.at(low).0).chain(inner).chain([self.at(high).0]).collect();
        if to < from {
            piece.reverse();
        }
        piece
    }
}

/// A line moved so far to its right (downwards for one that runs to the right on a drawing).
#[must_use]
pub fn beside(line: &[DVec2], right: f64) -> Vec<DVec2> {
    let direction = |i: usize| {
        let before = i.checked_sub(1).map_or(DVec2::ZERO, |b| (line[i] - line[b]).normalize_or_zero());
        let after = line.get(i + 1).map_or(DVec2::ZERO, |next| (*next - line[i]).normalize_or_zero());
        (before + after).normalize_or_zero()
    };
    (0..line.len()).map(|i| line[i] + direction(i).perp() * right).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_along_a_line_are_where_its_length_says() {
        let ribbon = Ribbon::new([(0.0, 0.0), (10.0, 0.0), (10.0, 5.0)].map(DVec2::from).to_vec()).expect("it has length");
        assert_eq!(ribbon.length(), 15.0);
        assert_eq!(ribbon.at(12.0), (DVec2::new(10.0, 2.0), DVec2::Y));
        assert_eq!(ribbon.at(99.0).0, DVec2::new(10.0, 5.0));
        assert_eq!(ribbon.piece(12.0, 5.0), [(10.0, 2.0), (10.0, 0.0), (5.0, 0.0)].map(DVec2::from));
        assert_eq!(Ribbon::new(vec![DVec2::ONE; 3]), None);
        assert_eq!(Ribbon::new(vec![DVec2::NAN, DVec2::ONE]), None);
    }

    #[test]
    fn a_smoothed_corner_is_rounder_and_never_far_off() {
        let corner = [(0.0, 0.0), (20.0, 0.0), (20.0, 20.0)].map(DVec2::from).to_vec();
        let smooth = Ribbon::smooth(corner.clone(), 4.0, 1.5).expect("it has length");
        let sharpest = smooth.points.windows(3).map(|w| (w[1] - w[0]).angle_to(w[2] - w[1]).abs()).fold(0.0, f64::max);
        assert!(sharpest < 0.6, "{sharpest}");
        let rough = Ribbon::new(corner).expect("it has length");
        let off = |p: &DVec2| (0..=400).map(|i| rough.at(f64::from(i) / 10.0).0.distance(*p)).fold(f64::INFINITY, f64::min);
        assert!(smooth.points.iter().all(|p| off(p) <= 1.5 + 0.05));
        assert_eq!((smooth.at(0.0).0, smooth.at(99.0).0), (DVec2::ZERO, DVec2::splat(20.0)));
    }

    #[test]
    fn beside_a_line_to_the_right_is_below_it() {
        assert_eq!(beside(&[DVec2::ZERO, DVec2::X], 2.0), [DVec2::new(0.0, 2.0), DVec2::new(1.0, 2.0)]);
    }
}
