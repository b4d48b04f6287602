use bevy::prelude::*;

/// Date and solar hour in the city. Tours, settings and films write it; the sky follows.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct CityClock {
    /// Day of the year, 1 to 366.
    pub day: u16,
    /// Local solar time, hours, 0 to 24.
    pub hour: f64,
    /// How many city seconds pass in a second; 0 stands still.
    pub pace: f64,
}

impl Default for CityClock {
    fn default() -> Self {
        Self { day: 160, hour: 10.0, pace: 0.0 }
    }
}
