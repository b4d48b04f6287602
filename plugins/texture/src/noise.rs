//! Noise that tiles: lattices filled from a key, read with basic arithmetic only, so that every platform sees the same.

/// The finaliser of SplitMix64: scatters neighbouring keys.
const fn scatter(mut x: u64) -> u64 {
    x = x.wrapping_add(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// 64 bits for a place on a lattice.
pub(crate) const fn hash(key: u64, x: i32, y: i32) -> u64 {
    scatter(key ^ scatter((x as u32 as u64) << 32 | y as u32 as u64))
}

/// A lattice node brought into `0..n`; most are there already, so the division is rare.
#[inline]
fn wrap(i: i32, n: i32) -> i32 {
    if (i as u32) < (n as u32) { i } else { i.rem_euclid(n) }
}

/// A number in [0, 1) from one of the four 16-bit words of a hash.
pub(crate) fn word(hash: u64, which: u32) -> f32 {
    f32::from((hash >> (16 * (which & 3))) as u16) / 65_536.0
}

/// The integer below; a library call on some targets if left to `f32::floor`.
#[inline]
pub(crate) fn floor(x: f32) -> i32 {
    let i = x as i32;
    i - i32::from(x < i as f32)
}

/// 0 below `low`, 1 above `high`, an S-curve between. `low` may exceed `high`: then it falls.
#[inline]
pub(crate) fn smoothstep(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// 1 at and below a distance of 0, fading softly to 0 at `reach`.
#[inline]
pub(crate) fn falloff(distance: f32, reach: f32) -> f32 {
    smoothstep(reach, 0.0, distance)
}

/// Gradient noise (Perlin 1985) on a lattice of `nx` × `ny` nodes a tile; about −1 to 1, mean 0, repeats with period 1 in
/// both arguments.
pub(crate) struct Noise {
    nx: i32,
    ny: i32,
    lattice: Vec<[f32; 2]>,
}

impl Noise {
    pub(crate) fn new(key: u64, nx: u32, ny: u32) -> Self {
        let (nx, ny) = (nx.max(1) as i32, ny.max(1) as i32);
        let gradient = |x, y| {
            let bits = hash(key, x, y);
            [(word(bits, 0) - 0.5) * 3.6, (word(bits, 1) - 0.5) * 3.6]
        };
        let lattice = (0..ny).flat_map(|y| (0..nx).map(move |x| gradient(x, y))).collect();
        Self { nx, ny, lattice }
    }

    /// The noise at a place given in tiles.
    #[inline]
    pub(crate) fn at(&self, u: f32, v: f32) -> f32 {
        let (x, y) = (u * self.nx as f32, v * self.ny as f32);
        let (ix, iy) = (floor(x), floor(y));
        let (fx, fy) = (x - ix as f32, y - iy as f32);
        let (x0, y0) = (wrap(ix, self.nx), wrap(iy, self.ny));
        let x1 = if x0 + 1 == self.nx { 0 } else { x0 + 1 };
        let y1 = if y0 + 1 == self.ny { 0 } else { y0 + 1 };
        let dot = |cx: i32, cy: i32, dx: f32, dy: f32| {
            let [gx, gy] = self.lattice[(cy * self.nx + cx) as usize];
            gx * dx + gy * dy
        };
        let (sx, sy) = (fade(fx), fade(fy));
        let low = mix(dot(x0, y0, fx, fy), dot(x1, y0, fx - 1.0, fy), sx);
        let high = mix(dot(x0, y1, fx, fy - 1.0), dot(x1, y1, fx - 1.0, fy - 1.0), sx);
        mix(low, high, sy)
    }
}

/// Perlin's quintic (2002).
#[inline]
fn fade(t: f32) -> f32 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

#[inline]
pub(crate) fn mix(a: f32, b: f32, t: f32) -> f32 {
    a + (b - a) * t
}

/// Octaves of noise, each twice as fine and `gain` as strong; about −1 to 1.
pub(crate) struct Fractal {
    octaves: Vec<(Noise, f32)>,
}

impl Fractal {
    pub(crate) fn new(key: u64, nx: u32, ny: u32, octaves: u32, gain: f32) -> Self {
        let mut strength = 1.0;
        let mut made: Vec<(Noise, f32)> = Vec::new();
        for i in 0..octaves {
            made.push((Noise::new(hash(key, i as i32, 77), nx << i, ny << i), strength));
            strength *= gain;
        }
        let sum: f32 = made.iter().map(|(_, s)| s * s).sum::<f32>().sqrt();
        made.iter_mut().for_each(|(_, s)| *s /= sum);
        Self { octaves: made }
    }

    #[inline]
    pub(crate) fn at(&self, u: f32, v: f32) -> f32 {
        self.octaves.iter().map(|(noise, strength)| noise.at(u, v) * strength).sum()
    }
}

/// One jittered point in every square of an `nx` × `ny` grid (Worley 1996), repeating with period 1.
pub(crate) struct Pebbles {
    nx: i32,
    ny: i32,
    points: Vec<([f32; 2], u64)>,
}

/// The pebble nearest to a place. Lengths are in squares of the grid.
pub(crate) struct Nearest {
    /// Distance to its point.
    pub(crate) near: f32,
    /// Distance to the second nearest less that: 0 on the border between two.
    pub(crate) margin: f32,
    /// From its point to the place.
    pub(crate) offset: (f32, f32),
    /// Its hash.
    pub(crate) bits: u64,
}

impl Pebbles {
    pub(crate) fn new(key: u64, nx: u32, ny: u32, jitter: f32) -> Self {
        let (nx, ny) = (nx.max(1) as i32, ny.max(1) as i32);
        let point = |x, y| {
            let bits = hash(key, x, y);
            let off = |which| 0.5 + (word(bits, which) - 0.5) * jitter;
            ([off(0), off(1)], scatter(bits))
        };
        let points = (0..ny).flat_map(|y| (0..nx).map(move |x| point(x, y))).collect();
        Self { nx, ny, points }
    }

    pub(crate) fn at(&self, u: f32, v: f32) -> Nearest {
        let (x, y) = (u * self.nx as f32, v * self.ny as f32);
        let (ix, iy) = (floor(x), floor(y));
        let (mut first, mut second) = (f32::MAX, f32::MAX);
        let (mut offset, mut bits) = ((0.0, 0.0), 0);
        for cy in iy - 1..=iy + 1 {
            let row = wrap(cy, self.ny) * self.nx;
            for cx in ix - 1..=ix + 1 {
                let ([px, py], point_bits) = self.points[(row + wrap(cx, self.nx)) as usize];
                let (dx, dy) = (x - cx as f32 - px, y - cy as f32 - py);
                let square = dx * dx + dy * dy;
                if square < first {
                    (second, first, offset, bits) = (first, square, (dx, dy), point_bits);
                } else if square < second {
                    second = square;
                }
            }
        }
        let near = first.sqrt();
        Nearest { near, margin: second.sqrt() - near, offset, bits }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_repeats_with_period_one_and_averages_nought() {
        let noise = Fractal::new(5, 4, 6, 4, 0.5);
        let (mut sum, mut peak) = (0.0, 0.0_f32);
        for i in 0..4096 {
            let (u, v) = ((i % 64) as f32 / 64.0, (i / 64) as f32 / 64.0);
            let here = noise.at(u, v);
            assert!((here - noise.at(u + 1.0, v)).abs() < 1e-4 && (here - noise.at(u, v - 1.0)).abs() < 1e-4);
            sum += here;
            peak = peak.max(here.abs());
        }
        assert!((sum / 4096.0).abs() < 0.05, "mean {}", sum / 4096.0);
        assert!((0.4..2.0).contains(&peak), "peak {peak}");
    }

    #[test]
    fn the_nearest_pebble_is_the_nearest() {
        let pebbles = Pebbles::new(9, 5, 5, 0.9);
        for i in 0..400 {
            let (u, v) = ((i % 20) as f32 / 20.0, (i / 20) as f32 / 20.0);
            let here = pebbles.at(u, v);
            assert!(here.margin >= 0.0 && here.near < 1.5);
            assert_eq!(here.bits, pebbles.at(u + 1.0 - here.offset.0 / 500.0, v + 1.0 - here.offset.1 / 500.0).bits);
        }
    }

    #[test]
    fn floor_is_floor() {
        for (x, below) in [(1.5, 1), (-0.5, -1), (-2.0, -2), (0.0, 0), (3.0, 3)] {
            assert_eq!(floor(x), below);
        }
    }
}
