use bevy::prelude::*;

/// How loud things are: each a factor, 0 (silent) to 1 (as designed); up to 2. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct SoundSettings {
    /// All of it.
    pub master: f32,
    /// What is heard of the city: people, birds, water, wind, rain, and whatever happens in it but bells.
    pub ambience: f32,
    /// The walker's steps.
    pub steps: f32,
    /// Bells.
    pub bells: f32,
    /// What tours tell and play.
    pub narration: f32,
    /// Nothing is heard.
    pub is_muted: bool,
    /// Nothing is heard while the window is not in front.
    pub rests_without_focus: bool,
}

impl Default for SoundSettings {
    fn default() -> Self {
        Self { master: 0.8, ambience: 1.0, steps: 1.0, bells: 1.0, narration: 1.0, is_muted: false, rests_without_focus: true }
    }
}

/// What of the settings bears on a sound.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(crate) enum Fader {
    Ambience,
    Steps,
    Bells,
    Narration,
}

impl Fader {
    /// The fader of a cue.
    pub fn of_cue(name: &str) -> Self {
        match name.split('.').next() {
            Some("bell") => Self::Bells,
            Some("step") => Self::Steps,
            _ => Self::Ambience,
        }
    }
}

impl SoundSettings {
    /// The factor of a sound, the master's apart.
    pub(crate) fn fader(&self, fader: Fader) -> f32 {
        let factor = match fader {
            Fader::Ambience => self.ambience,
            Fader::Steps => self.steps,
            Fader::Bells => self.bells,
            Fader::Narration => self.narration,
        };
        within(factor)
    }

    /// The factor of all that is heard.
    pub(crate) fn whole(&self, has_focus: bool) -> f32 {
        if self.is_muted || (self.rests_without_focus && !has_focus) { 0.0 } else { within(self.master) }
    }
}

/// A factor within bounds; none that is no number.
fn within(factor: f32) -> f32 {
    if factor.is_finite() { factor.clamp(0.0, 2.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_muted_or_out_of_sight_is_silent() {
        let settings = SoundSettings { master: 0.5, ..default() };
        assert_eq!((settings.whole(true), settings.whole(false)), (0.5, 0.0));
        assert_eq!(SoundSettings { rests_without_focus: false, ..settings }.whole(false), 0.5);
        assert_eq!(SoundSettings { is_muted: true, ..settings }.whole(true), 0.0);
        assert_eq!(SoundSettings { master: f32::NAN, ..settings }.whole(true), 0.0);
        assert_eq!(SoundSettings { steps: 90.0, ..settings }.fader(Fader::Steps), 2.0);
    }

    #[test]
    fn cues_belong_to_faders_by_the_first_part_of_their_names() {
        for (name, fader) in [
            ("bell.tyn", Fader::Bells),
            ("bell", Fader::Bells),
            ("step.grass", Fader::Steps),
            ("wings", Fader::Ambience),
            ("bells", Fader::Ambience),
        ] {
            assert_eq!(Fader::of_cue(name), fader, "{name}");
        }
    }
}
