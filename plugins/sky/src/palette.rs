use bevy::math::Vec3;

/// Colours (linear) and strengths of the light, for one altitude of the sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Palette {
    /// Sky overhead.
    pub zenith: Vec3,
    /// Sky at the horizon, also the fog's colour.
    pub horizon: Vec3,
    /// Colour of the key light.
    pub key: Vec3,
    /// Key light on a surface that faces it, lux.
    pub key_lux: f32,
    /// Light from the ground and lit walls.
    pub bounce: Vec3,
    /// Strength of the fill, candela per square metre of white sky.
    pub fill: f32,
    /// Radiance of the dome's colours, candela per square metre.
    pub sky: f32,
    /// Exposure.
    pub ev100: f32,
    /// 0 by day, 1 at night: lamps and windows.
    pub night: f32,
}

/// The palettes between which the light moves, by altitude of the sun in degrees.
const STOPS: [(f32, Palette); 7] = [
    (
        -18.0,
        Palette {
            zenith: Vec3::new(0.010, 0.016, 0.040),
            horizon: Vec3::new(0.045, 0.055, 0.095),
            key: Vec3::new(0.55, 0.68, 1.0),
            key_lux: 55.0,
            bounce: Vec3::new(0.05, 0.045, 0.05),
            fill: 100.0,
            sky: 150.0,
            ev100: 6.6,
            night: 1.0,
        },
    ),
    (
        -12.0,
        Palette {
            zenith: Vec3::new(0.014, 0.026, 0.070),
            horizon: Vec3::new(0.085, 0.090, 0.150),
            key: Vec3::new(0.56, 0.66, 1.0),
            key_lux: 58.0,
            bounce: Vec3::new(0.08, 0.07, 0.075),
            fill: 125.0,
            sky: 200.0,
            ev100: 6.8,
            night: 1.0,
        },
    ),
    (
        -6.0,
        Palette {
            zenith: Vec3::new(0.035, 0.060, 0.150),
            horizon: Vec3::new(0.42, 0.26, 0.22),
            key: Vec3::new(0.60, 0.62, 0.95),
            key_lux: 70.0,
            bounce: Vec3::new(0.16, 0.13, 0.14),
            fill: 200.0,
            sky: 380.0,
            ev100: 7.5,
            night: 0.9,
        },
    ),
    (
        0.0,
        Palette {
            zenith: Vec3::new(0.09, 0.16, 0.36),
            horizon: Vec3::new(0.98, 0.50, 0.25),
            key: Vec3::new(1.0, 0.42, 0.18),
            key_lux: 900.0,
            bounce: Vec3::new(0.30, 0.22, 0.18),
            fill: 400.0,
            sky: 950.0,
            ev100: 8.9,
            night: 0.55,
        },
    ),
    (
        8.0,
        Palette {
            zenith: Vec3::new(0.14, 0.27, 0.56),
            horizon: Vec3::new(0.86, 0.68, 0.50),
            key: Vec3::new(1.0, 0.70, 0.42),
            key_lux: 8_500.0,
            bounce: Vec3::new(0.42, 0.34, 0.27),
            fill: 520.0,
            sky: 1_900.0,
            ev100: 9.9,
            night: 0.0,
        },
    ),
    (
        25.0,
        Palette {
            zenith: Vec3::new(0.13, 0.29, 0.62),
            horizon: Vec3::new(0.60, 0.71, 0.84),
            key: Vec3::new(1.0, 0.88, 0.70),
            key_lux: 12_500.0,
            bounce: Vec3::new(0.46, 0.40, 0.33),
            fill: 640.0,
            sky: 2_900.0,
            ev100: 10.6,
            night: 0.0,
        },
    ),
    (
        60.0,
        Palette {
            zenith: Vec3::new(0.11, 0.27, 0.62),
            horizon: Vec3::new(0.55, 0.68, 0.86),
            key: Vec3::new(1.0, 0.94, 0.82),
            key_lux: 13_000.0,
            bounce: Vec3::new(0.48, 0.43, 0.36),
            fill: 700.0,
            sky: 3_100.0,
            ev100: 10.85,
            night: 0.0,
        },
    ),
];

impl Palette {
    /// The palette at an altitude of the sun in degrees: the stops, mixed; continuous.
    #[must_use]
    pub fn for_altitude(altitude_deg: f64) -> Self {
        let altitude = altitude_deg as f32;
        let after = STOPS.iter().position(|(at, _)| altitude < *at).unwrap_or(STOPS.len());
        if after == 0 {
            return STOPS[0].1;
        }
        let Some((high_at, high)) = STOPS.get(after) else { return STOPS[STOPS.len() - 1].1 };
        let (low_at, low) = &STOPS[after - 1];
        let t = (altitude - low_at) / (high_at - low_at);
        let mix = |a: f32, b: f32| a + (b - a) * t;
        Self {
            zenith: low.zenith.lerp(high.zenith, t),
            horizon: low.horizon.lerp(high.horizon, t),
            key: low.key.lerp(high.key, t),
            key_lux: mix(low.key_lux, high.key_lux),
            bounce: low.bounce.lerp(high.bounce, t),
            fill: mix(low.fill, high.fill),
            sky: mix(low.sky, high.sky),
            ev100: mix(low.ev100, high.ev100),
            night: mix(low.night, high.night),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_changes_without_jumps() {
        let mut before = Palette::for_altitude(-30.0);
        for i in -300..900 {
            let now = Palette::for_altitude(f64::from(i) / 10.0);
            assert!((now.ev100 - before.ev100).abs() < 0.05, "at {} degrees", f64::from(i) / 10.0);
            assert!((now.horizon - before.horizon).length() < 0.03);
            before = now;
        }
    }

    #[test]
    fn fill_is_a_fifth_to_a_third_of_the_key_by_day() {
        let noon = Palette::for_altitude(45.0);
        let ratio = noon.fill * core::f32::consts::PI / noon.key_lux;
        assert!((0.15..0.34).contains(&ratio), "{ratio}");
    }
}
