use bevy::math::Vec3;

/// Where the sun stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPosition {
    /// Degrees above the horizon, negative below.
    pub altitude_deg: f64,
    /// Degrees clockwise from north.
    pub azimuth_deg: f64,
}

impl SunPosition {
    /// Direction to the sun in world axes (x east, y up, z south).
    #[must_use]
    pub fn direction(self) -> Vec3 {
        let (alt, az) = (self.altitude_deg.to_radians(), self.azimuth_deg.to_radians());
        Vec3::new((alt.cos() * az.sin()) as f32, alt.sin() as f32, -(alt.cos() * az.cos()) as f32)
    }
}

/// Sun at a latitude (degrees), a day of the year and a local solar hour. Declination by Cooper's formula, good to half a
/// degree.
#[must_use]
pub fn sun_position(lat_deg: f64, day: u16, hour: f64) -> SunPosition {
    let lat = lat_deg.to_radians();
    let declination = 23.45_f64.to_radians() * (core::f64::consts::TAU * (284.0 + f64::from(day)) / 365.0).sin();
    let hour_angle = (15.0 * (hour - 12.0)).to_radians();
    let sin_alt = lat.sin() * declination.sin() + lat.cos() * declination.cos() * hour_angle.cos();
    let altitude = sin_alt.clamp(-1.0, 1.0).asin();
    let east = -declination.cos() * hour_angle.sin();
    let north = declination.sin() * lat.cos() - declination.cos() * lat.sin() * hour_angle.cos();
    SunPosition { altitude_deg: altitude.to_degrees(), azimuth_deg: east.atan2(north).to_degrees().rem_euclid(360.0) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noon_in_prague_through_the_year() {
        for (day, altitude) in [(172, 63.4), (80, 40.0), (355, 16.5)] {
            let sun = sun_position(50.09, day, 12.0);
            assert!((sun.altitude_deg - altitude).abs() < 1.0, "day {day}: {sun:?}");
            assert!((sun.azimuth_deg - 180.0).abs() < 1e-6, "the noon sun stands in the south: {sun:?}");
        }
    }

    #[test]
    fn the_sun_rises_in_the_east_and_sets_in_the_west() {
        let (morning, evening) = (sun_position(50.0, 80, 7.0), sun_position(50.0, 80, 17.0));
        assert!((60.0..130.0).contains(&morning.azimuth_deg), "{morning:?}");
        assert!((230.0..300.0).contains(&evening.azimuth_deg), "{evening:?}");
        assert!(morning.direction().x > 0.0 && evening.direction().x < 0.0);
    }

    #[test]
    fn at_midnight_it_is_dark() {
        assert!(sun_position(50.0, 172, 0.0).altitude_deg < -10.0);
    }
}
