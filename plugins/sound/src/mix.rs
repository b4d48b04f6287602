//! How loud things are from somewhere: gains, places, dullness. No engine, no device.

use bevy::math::{DVec2, DVec3};
use veduta_city::{Bed, Follows, Heard, Season, Setting};
use veduta_ecs::Weather;
use veduta_synth::Levels;

use crate::Surroundings;

/// How fast sound travels in air of 20 °C, metres a second.
pub const SPEED_OF_SOUND_M_S: f64 = 343.0;

/// Where a listener is, and when.
#[derive(Debug, Clone, PartialEq)]
pub struct Listener {
    /// Plan metres, with the elevation of the ear.
    pub plan_pos: DVec3,
    /// Metres above the ground.
    pub eye_m: f64,
    /// Degrees clockwise from north.
    pub heading_deg: f64,
    /// Hour of the day.
    pub hour: f64,
    /// Season.
    pub season: Season,
    /// Weather.
    pub weather: Weather,
    /// What lies about.
    pub surroundings: Surroundings,
}

/// What a level in decibels multiplies by.
pub(crate) fn factor(db: f64) -> f64 {
    10_f64.powf(db / 20.0)
}

/// From the height of roofs up, a street is heard less and less: at so many metres half.
const ALOFT_M: f64 = 30.0;

/// A wind that is heard as loud as any, metres a second.
const FRESH_WIND_M_S: f64 = 7.0;

impl Listener {
    /// How hard it rains, 0 to 1: streets are wet and clouds hang over them.
    #[must_use]
    pub fn rain(&self) -> f64 {
        let share = |x: f32, from: f64, to: f64| ((f64::from(x) - from) / (to - from)).clamp(0.0, 1.0);
        share(self.weather.wet, 0.15, 0.7) * share(self.weather.clouds, 0.5, 0.8)
    }

    /// How hard the wind blows, 0 to 1: more in the open and aloft.
    #[must_use]
    pub fn wind(&self) -> f64 {
        let open = [Setting::Square, Setting::Park, Setting::Bridge].map(|setting| self.surroundings.share(setting));
        let open = f64::from(open.into_iter().fold(0.0, f32::max));
        let aloft = (self.eye_m / ALOFT_M).clamp(0.0, 1.0);
        let sky = (f64::from(self.weather.wind_m_s) / FRESH_WIND_M_S).clamp(0.0, 1.0);
        (sky * (0.35 + 0.35 * open) + 0.6 * aloft).min(1.0)
    }

    /// How much of something is heard now.
    fn share(&self, when: &Heard) -> f64 {
        let weather = match when.follows {
            Follows::Nothing => 1.0,
            Follows::Rain => self.rain(),
            Follows::Dry => 1.0 - self.rain(),
            Follows::Wind => self.wind(),
        };
        when.share(self.hour, self.season) * weather
    }
}

/// Gain of a bed for a listener.
#[must_use]
pub fn bed_gain(bed: &Bed, listener: &Listener) -> f32 {
    let here = if bed.at.is_empty() {
        1.0
    } else {
        bed.at.iter().map(|&setting| f64::from(listener.surroundings.share(setting))).sum::<f64>().min(1.0)
    };
    // Under a roof what comes from the sky is heard from outside.
    let sheltered = match bed.when.follows {
        Follows::Rain | Follows::Wind => 1.0 - 0.6 * f64::from(listener.surroundings.share(Setting::Arcade)),
        Follows::Nothing | Follows::Dry => 1.0,
    };
    // Wind is louder aloft, all else is left below.
    let height =
        if bed.when.follows == Follows::Wind { 1.0 } else { 1.0 / (1.0 + ((listener.eye_m - 3.0).max(0.0) / ALOFT_M).powi(2)) };
    (factor(bed.level_db) * here * sheltered * height * listener.share(&bed.when)) as f32
}

/// Each house between takes so many decibels, the first most.
const FIRST_WALL_DB: f64 = -6.0;
const FURTHER_WALL_DB: f64 = -2.5;

/// How something is heard from where it is, as loud as it gets within a radius, with so many houses between. Sound spreads (6 dB at
/// twice the distance), air and houses take the high notes first, and what is behind the listener is a little duller.
#[must_use]
pub fn heard_from(plan_pos: DVec3, radius_m: f64, level_db: f64, houses: u32, listener: &Listener) -> Levels {
    let to = plan_pos - listener.plan_pos;
    let distance_m = to.length();
    let radius_m = radius_m.max(0.1);
    let spread = radius_m / distance_m.max(radius_m);
    let walls_db = match houses {
        0 => 0.0,
        n => FIRST_WALL_DB + FURTHER_WALL_DB * f64::from(n - 1),
    };
    let (pan, ahead) = direction(to.truncate(), listener.heading_deg);
    // What one stands in comes from everywhere.
    let beside = (to.truncate().length() / radius_m).min(1.0);
    let behind = 1.0 - 0.25 * (-ahead).max(0.0) * beside;
    let walls = if houses == 0 { 1.0 } else { 0.16 / f64::from(houses) };
    let cutoff_hz = 20_000.0 * (-distance_m / 350.0).exp() * behind * walls;
    Levels {
        gain: (factor(level_db + walls_db) * spread) as f32,
        pan: (pan * 0.9 * beside) as f32,
        cutoff_hz: cutoff_hz.clamp(350.0, 20_000.0) as f32,
    }
}

/// How far to the right something lies, and how far ahead, −1 to 1 each.
fn direction(to: DVec2, heading_deg: f64) -> (f64, f64) {
    let Some(to) = to.try_normalize() else { return (0.0, 1.0) };
    let (sin, cos) = heading_deg.to_radians().sin_cos();
    (to.dot(DVec2::new(cos, -sin)), to.dot(DVec2::new(sin, cos)))
}

/// Seconds until something is heard.
#[must_use]
pub fn delay_s(plan_pos: DVec3, listener: &Listener) -> f32 {
    (plan_pos.distance(listener.plan_pos) / SPEED_OF_SOUND_M_S) as f32
}

/// Levels of a source that sounds for ever.
pub(crate) fn source_levels(
    (plan_pos, radius_m, level_db): (DVec3, f64, f64),
    when: &Heard,
    houses: u32,
    listener: &Listener,
) -> Levels {
    let levels = heard_from(plan_pos, radius_m, level_db, houses, listener);
    Levels { gain: levels.gain * listener.share(when) as f32, ..levels }
}

/// A step of levels towards others in a time, of which two thirds are gone after `in_s`.
pub(crate) fn towards(now: Levels, wanted: Levels, seconds: f32, in_s: f32) -> Levels {
    let share = 1.0 - (-seconds / in_s).exp();
    let step = |a: f32, b: f32| a + (b - a) * share;
    Levels {
        gain: step(now.gain, wanted.gain),
        // Places follow the head at once: the desk takes off the edge.
        pan: wanted.pan,
        cutoff_hz: step(now.cutoff_hz, wanted.cutoff_hz),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::Soundscape;

    fn listener(shares: [f32; 6]) -> Listener {
        Listener {
            plan_pos: DVec3::new(0.0, 0.0, 1.6),
            eye_m: 1.6,
            heading_deg: 0.0,
            hour: 12.0,
            season: Season::Summer,
            weather: Weather::default(),
            surroundings: Surroundings { shares, ..Surroundings::default() },
        }
    }

    const LANE: [f32; 6] = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    const SQUARE: [f32; 6] = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0];

    fn loudest(listener: &Listener) -> String {
        let beds = Soundscape::usual_beds();
        let best = beds.iter().max_by(|a, b| bed_gain(a, listener).total_cmp(&bed_gain(b, listener)));
        format!("{:?}", best.expect("there are beds").sound)
    }

    #[test]
    fn each_setting_has_its_own_sound() {
        let by = |n: usize| {
            let mut shares = [0.0; 6];
            shares[n] = 1.0;
            listener(shares)
        };
        for (n, sound) in [(1, "Murmur"), (2, "Birds"), (3, "Water"), (4, "Water")] {
            assert!(loudest(&by(n)).starts_with(sound), "{:?}: {}", Setting::ALL[n], loudest(&by(n)));
        }
        let rain = Listener { weather: Weather { clouds: 1.0, wet: 1.0, ..Weather::default() }, ..listener(SQUARE) };
        assert!(loudest(&rain).starts_with("Rain"));
        let night = Listener { hour: 1.0, ..listener(SQUARE) };
        assert!(!loudest(&night).starts_with("Murmur"), "at night people are gone");
        let aloft = Listener { eye_m: 90.0, ..listener(SQUARE) };
        assert!(loudest(&aloft).starts_with("Wind"), "{}", loudest(&aloft));
    }

    #[test]
    fn the_whole_of_the_beds_leaves_room() {
        for n in 0..6 {
            for (hour, wet) in [(12.0, 0.0), (12.0, 1.0), (1.0, 0.0)] {
                let mut shares = [0.0; 6];
                shares[n] = 1.0;
                let listener = Listener { hour, weather: Weather { clouds: 0.9, wet, ..Weather::default() }, ..listener(shares) };
                // Voices have a root mean square of 0.1 each and know nothing of one another.
                let power: f32 = Soundscape::usual_beds().iter().map(|bed| (0.1 * bed_gain(bed, &listener)).powi(2)).sum();
                let level_db = 10.0 * power.log10();
                assert!((-48.0..-18.0).contains(&level_db), "{:?} at {hour}, wet {wet}: {level_db:.1} dB", Setting::ALL[n]);
            }
        }
    }

    #[test]
    fn sound_spreads_turns_and_dulls() {
        let listener = listener(LANE);
        let at = |x: f64, y: f64, houses| heard_from(DVec3::new(x, y, 1.6), 2.0, 0.0, houses, &listener);
        let (near, far) = (at(0.0, 10.0, 0), at(0.0, 20.0, 0));
        assert!((near.gain / far.gain - 2.0).abs() < 1e-3 && near.cutoff_hz > far.cutoff_hz);
        assert_eq!(at(0.0, 1.0, 0).gain, 1.0, "within its radius it is as loud as it gets");
        assert!(at(10.0, 0.0, 0).pan > 0.8 && at(-10.0, 0.0, 0).pan < -0.8 && at(0.0, 10.0, 0).pan.abs() < 1e-6);
        assert!(at(0.2, 0.0, 0).pan < 0.1, "what is here comes from everywhere");
        assert!(at(0.0, -10.0, 0).cutoff_hz < near.cutoff_hz, "what is behind is duller");
        let (one, three) = (at(0.0, 10.0, 1), at(0.0, 10.0, 3));
        assert!(one.gain < 0.6 * near.gain && one.cutoff_hz < 4_000.0 && three.gain < one.gain && three.cutoff_hz < one.cutoff_hz);
        let turned = Listener { heading_deg: 90.0, ..listener.clone() };
        assert!(heard_from(DVec3::new(0.0, 10.0, 1.6), 2.0, 0.0, 0, &turned).pan < -0.8, "north is left of who looks east");
    }

    #[test]
    fn thunder_follows_lightning() {
        let listener = listener(LANE);
        assert!((delay_s(DVec3::new(343.0, 0.0, 1.6), &listener) - 1.0).abs() < 1e-3);
    }

    #[test]
    fn levels_come_smoothly_and_arrive() {
        let wanted = Levels { gain: 1.0, pan: 0.5, cutoff_hz: 1_000.0 };
        let mut now = Levels::SILENT;
        let mut most = 0.0_f32;
        for _ in 0..600 {
            let next = towards(now, wanted, 1.0 / 60.0, 0.6);
            most = most.max((next.gain - now.gain).abs());
            now = next;
        }
        assert!(most < 0.03 && (now.gain - 1.0).abs() < 1e-3 && (now.cutoff_hz - 1_000.0).abs() < 1.0);
        // Half the frames in the same time come as far.
        let coarse = (0..30).fold(Levels::SILENT, |now, _| towards(now, wanted, 1.0 / 30.0, 0.6));
        let fine = (0..60).fold(Levels::SILENT, |now, _| towards(now, wanted, 1.0 / 60.0, 0.6));
        assert!((coarse.gain - fine.gain).abs() < 1e-4);
    }
}
