use bevy::prelude::*;

/// The weather. Settings, tours and films write it; sky and surfaces follow.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct Weather {
    /// Share of the sky that clouds cover, 0 to 1.
    pub clouds: f32,
    /// How wet streets and roofs are, 0 (dry) to 1 (puddles after rain).
    pub wet: f32,
    /// Mean speed of the wind, metres a second.
    pub wind_m_s: f32,
    /// Where it comes from, degrees clockwise from north.
    pub wind_from_deg: f32,
}

impl Default for Weather {
    fn default() -> Self {
        Self { clouds: 0.45, wet: 0.0, wind_m_s: 3.2, wind_from_deg: 255.0 }
    }
}

/// What surfaces and lamps know of the light. The sky writes it from [`CityClock`](crate::CityClock) and [`Weather`]; without a sky it is
/// noon.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct Daylight {
    /// Luminance of the sky overhead, linear red, green and blue, candela per square metre: what glass and water mirror.
    pub zenith: Vec3,
    /// Luminance of the sky at the horizon.
    pub horizon: Vec3,
    /// Mean luminance of all that surfaces see that look up, level and down, without what the key light itself sends.
    pub fill: [Vec3; 3],
    /// 0 by day, 1 at night: lamps burn and windows are lit.
    pub night: f32,
}

impl Default for Daylight {
    fn default() -> Self {
        let (zenith, horizon) = (Vec3::new(260.0, 650.0, 1_500.0), Vec3::new(1_400.0, 1_700.0, 2_000.0));
        Self { zenith, horizon, fill: [zenith.lerp(horizon, 0.7), horizon * 0.6, horizon * 0.3], night: 0.0 }
    }
}
