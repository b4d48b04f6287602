use bevy::math::DVec2;
use veduta_city::bounds::Bounds;

/// How high a city rises near its edge, by direction from its middle: what lies beyond, and is not modelled, is thought to go on like it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Rim {
    /// Elevations of what is highest there, metres: the first to the north, the others clockwise. None where nothing is known.
    pub tops_m: Option<[f64; Rim::DIRECTIONS]>,
}

impl Rim {
    /// So many directions are told apart.
    pub const DIRECTIONS: usize = 32;
    /// So many parts of a city in a direction, the outermost, are its edge there.
    const PARTS: usize = 3;
    /// Parts up to so many directions to the left and right of one count for it.
    const ASIDE: usize = 2;

    /// Of a city in parts, each with its bounds and the elevation of what is highest in it, metres.
    #[must_use]
    pub fn of(parts: impl Iterator<Item = (Bounds, f64)>) -> Self {
        let parts: Vec<(DVec2, f64)> =
            parts.map(|((low, high), top_m)| ((low.to_metres() + high.to_metres()) / 2.0, top_m)).collect();
        if parts.is_empty() {
            return Self::default();
        }
        let middle = parts.iter().map(|part| part.0).sum::<DVec2>() / parts.len() as f64;
        let all = median(parts.iter().map(|part| part.1).collect()).unwrap_or_default();
        // The outermost of each direction with how far out they lie, the farthest first.
        let mut outermost = [const { Vec::<(f64, f64)>::new() }; Self::DIRECTIONS];
        for (pos, top_m) in &parts {
            let (out_m, direction) = ((pos - middle).length(), Self::direction(pos - middle));
            for aside in 0..=2 * Self::ASIDE {
                let there = &mut outermost[(direction + Self::DIRECTIONS + aside - Self::ASIDE) % Self::DIRECTIONS];
                let rank = there.partition_point(|other| other.0 >= out_m);
                there.insert(rank, (out_m, *top_m));
                there.truncate(Self::PARTS);
            }
        }
        let tops_m = outermost.map(|there| median(there.into_iter().map(|(_, top_m)| top_m).collect()).unwrap_or(all));
        Self { tops_m: Some(tops_m) }
    }

    /// The direction of a way in plan.
    fn direction(way: DVec2) -> usize {
        let turns = way.x.atan2(way.y) / core::f64::consts::TAU;
        (turns * Self::DIRECTIONS as f64).round().rem_euclid(Self::DIRECTIONS as f64) as usize
    }
}

/// The middle one of some values, the lower of two.
fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len().saturating_sub(1) / 2).copied()
}

#[cfg(test)]
mod tests {
    use veduta_city::GridPos;

    use super::*;

    /// A square part ten metres broad about a place.
    fn part(x: f64, y: f64, top_m: f64) -> (Bounds, f64) {
        let corner = |d: f64| GridPos::from_metres(DVec2::new(x + d, y + d));
        ((corner(-5.0), corner(5.0)), top_m)
    }

    #[test]
    fn what_rises_in_the_north_stands_in_the_north() {
        let low = (0..7).flat_map(|i| (0..7).map(move |k| (f64::from(i - 3) * 100.0, f64::from(k - 3) * 100.0)));
        let parts = low.map(|(x, y)| part(x, y, if y > 250.0 { 80.0 } else { 12.0 }));
        let tops_m = Rim::of(parts).tops_m.expect("there are parts");
        assert_eq!(tops_m[0], 80.0);
        for (name, direction) in [("east", 8), ("south", 16), ("west", 24)] {
            assert_eq!(tops_m[direction], 12.0, "{name}");
        }
    }

    #[test]
    fn one_tower_is_no_edge_and_no_city_has_none() {
        let row = [part(0.0, 0.0, 10.0), part(0.0, 100.0, 10.0), part(0.0, 200.0, 90.0), part(0.0, 300.0, 10.0)];
        let tops_m = Rim::of(row.into_iter()).tops_m.expect("there are parts");
        assert!(tops_m.iter().all(|&top| top == 10.0), "{tops_m:?}");
        assert_eq!(Rim::of(core::iter::empty()), Rim::default());
    }
}
