use std::collections::BTreeSet;

use super::{Jet, Life, LifeKind, Tells};
use crate::{FARTHEST_M, HIGHEST_M};

/// Most things that a file may tell of.
const MOST_THINGS: usize = 20_000;

impl Life {
    /// Most pigeons of one flock.
    pub const MOST_PIGEONS: u32 = 64;

    /// What is wrong with it, a sentence each.
    #[must_use]
    pub fn validate(&self) -> Vec<String> {
        let mut wrong = Vec::new();
        if !(0.0..=1.0).contains(&self.rules.hearths) {
            wrong.push(format!("rules: hearths is {}; give a share from 0 to 1", self.rules.hearths));
        }
        if self.rules.pigeons > Self::MOST_PIGEONS {
            wrong.push(format!("rules: pigeons is {}; give 0 to {}", self.rules.pigeons, Self::MOST_PIGEONS));
        }
        if self.things.len() > MOST_THINGS {
            wrong.push(format!("{} things are more than {MOST_THINGS}", self.things.len()));
        }
        let mut told = BTreeSet::new();
        for (n, thing) in self.things.iter().enumerate() {
            if thing.name.trim().is_empty() {
                wrong.push(format!("thing {}: it has no name: write name: \"...\"", n + 1));
            } else if !told.insert(&thing.name) {
                wrong.push(format!("thing “{}” is told twice: give each a name of its own", thing.name));
            }
            let mut bounds = Bounds { of: format!("{} “{}”", thing.kind.word(), thing.name), wrong: &mut wrong };
            let at = thing.plan_pos(|_| Some(glam::DVec2::ZERO)).unwrap_or_default();
            bounds.within("its place east", at.x, (-FARTHEST_M, FARTHEST_M));
            bounds.within("its place north", at.y, (-FARTHEST_M, FARTHEST_M));
            bounds.within("height_m", thing.height_m, (-50.0, HIGHEST_M));
            bounds.within("heading_deg", thing.heading_deg, (-360.0, 360.0));
            check_kind(&thing.kind, &mut bounds);
        }
        wrong
    }
}

/// Tells of numbers that are out of bounds.
struct Bounds<'a> {
    of: String,
    wrong: &'a mut Vec<String>,
}

impl Bounds<'_> {
    fn within(&mut self, what: &str, value: f64, (least, most): (f64, f64)) {
        if !(least..=most).contains(&value) {
            self.wrong.push(format!("{}: {what} is {value}; give {least} to {most}", self.of));
        }
    }

    fn tell(&mut self, what: &str) {
        self.wrong.push(format!("{}: {what}", self.of));
    }
}

fn check_kind(kind: &LifeKind, bounds: &mut Bounds<'_>) {
    match kind {
        LifeKind::Fountain { radius_m, water_m, jets } => {
            bounds.within("radius_m", *radius_m, (0.1, 60.0));
            bounds.within("water_m", *water_m, (-5.0, 20.0));
            if jets.is_empty() {
                bounds.tell("it has no jets: write jets: [(height_m: 2, rise_m: 1, reach_m: 0.8)]");
            }
            for (n, jet) in jets.iter().enumerate() {
                check_jet(n + 1, jet, *water_m, bounds);
            }
        }
        LifeKind::Flag { pole_m, tilt_deg, size_m, fields, .. } => {
            bounds.within("pole_m", *pole_m, (0.2, 40.0));
            bounds.within("tilt_deg", *tilt_deg, (0.0, 90.0));
            bounds.within("size_m along the pole", size_m.0, (0.1, pole_m.max(0.1)));
            bounds.within("size_m away from it", size_m.1, (0.1, 15.0));
            if fields.is_empty() || fields.len() > 12 {
                bounds.tell("give one to twelve colours: fields: [\"#FFFFFF\", \"#D7141A\"]");
            }
        }
        LifeKind::Smoke { strength, .. } => bounds.within("strength", *strength, (0.05, 4.0)),
        LifeKind::Flock { radius_m, count, startle_m } => {
            bounds.within("radius_m", *radius_m, (1.0, 200.0));
            bounds.within("count", f64::from(*count), (1.0, f64::from(Life::MOST_PIGEONS)));
            bounds.within("startle_m", *startle_m, (0.0, 50.0));
        }
        LifeKind::Sign { size_m, arm_m, .. } => {
            bounds.within("size_m across", size_m.0, (0.05, 4.0));
            bounds.within("size_m down", size_m.1, (0.05, 4.0));
            bounds.within("arm_m", *arm_m, (size_m.0 / 2.0, 6.0));
        }
        LifeKind::Clock { radius_m, .. } => bounds.within("radius_m", *radius_m, (0.05, 20.0)),
        LifeKind::Figures { count, windows_m, size_m, seconds } => {
            bounds.within("count", f64::from(*count), (1.0, 24.0));
            bounds.within("size_m across", size_m.0, (0.1, 10.0));
            bounds.within("size_m up", size_m.1, (0.1, 10.0));
            bounds.within("seconds", *seconds, (4.0, 600.0));
            if windows_m.is_empty() || windows_m.len() > 4 {
                bounds.tell("give one to four windows: windows_m: [-0.98, 0.98]");
            }
            windows_m.iter().for_each(|&at| bounds.within("windows_m", at, (-50.0, 50.0)));
        }
        LifeKind::Bell { sound, tells, every_s, after_s, gain_db } => {
            if sound.is_empty() || sound.chars().any(char::is_whitespace) {
                bounds.tell("its sound must have a name without spaces, such as \"bell.great\"");
            }
            bounds.within("every_s", *every_s, (0.2, 20.0));
            bounds.within("after_s", *after_s, (0.0, 120.0));
            bounds.within("gain_db", *gain_db, (-60.0, 24.0));
            if let Tells::At { hours, strokes } = tells {
                bounds.within("strokes", f64::from(*strokes), (1.0, 120.0));
                if hours.is_empty() {
                    bounds.tell("it rings at no hour: write hours: [6, 12, 18]");
                }
                for &hour in hours {
                    bounds.within("hours", hour, (0.0, 24.0));
                    if (hour * 4.0).fract() != 0.0 {
                        bounds.tell(&format!(
                            "hours holds {hour}, which is no quarter of an hour: write 6.25 for a quarter past six"
                        ));
                    }
                }
            }
        }
    }
}

fn check_jet(n: usize, jet: &Jet, water_m: f64, bounds: &mut Bounds<'_>) {
    let mut within = |what: &str, value: f64, span: (f64, f64)| bounds.within(&format!("jet {n}: {what}"), value, span);
    within("count", f64::from(jet.count), (1.0, 64.0));
    within("radius_m", jet.radius_m, (0.0, 60.0));
    within("height_m", jet.height_m, (-5.0, 60.0));
    within("rise_m", jet.rise_m, (0.0, 60.0));
    within("reach_m", jet.reach_m, (0.0, 60.0));
    within("width_m", jet.width_m, (0.002, 1.0));
    let lands_m = jet.lands_m.unwrap_or(water_m);
    if lands_m >= jet.height_m + jet.rise_m {
        bounds.tell(&format!("jet {n}: it lands at {lands_m} m, but rises no higher than {} m", jet.height_m + jet.rise_m));
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::{Dial, LivingThing, Rgb, SignShape, Where, file};

    fn thing(name: &str, kind: LifeKind) -> LivingThing {
        let (at, by) = (Where::Place("A".to_owned()), DVec2::ZERO);
        LivingThing { name: name.to_owned(), at, by, height_m: 3.0, heading_deg: 0.0, kind }
    }

    #[test]
    fn a_file_says_as_little_as_it_likes() {
        let life: Life = file::parse("()", "empty.life.ron").unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(life, Life::default());
        assert!(life.rules.pigeons > 0 && life.rules.hearths > 0.0 && life.rules.fountains, "it lives by rule");
        assert!(life.validate().is_empty());
    }

    #[test]
    fn a_slip_is_shown_with_its_line() {
        let text = "(\n things: [\n  (name: \"x\", at: At(0, 0), kind: Clock(radius: 1)),\n ],\n)";
        let error = file::parse::<Life>(text, "a.life.ron").expect_err("`radius` is no field");
        assert_eq!((error.line, error.file.as_str()), (3, "a.life.ron"));
        assert!(error.to_string().contains("radius_m"), "{error}");
    }

    #[test]
    fn every_mistake_is_told_with_its_thing_and_its_bounds() {
        let dry = Jet { count: 1, radius_m: 0.0, height_m: 1.0, rise_m: 0.0, reach_m: 0.5, lands_m: Some(2.0), width_m: 0.02 };
        let bell = |sound: &str, tells| LifeKind::Bell { sound: sound.to_owned(), tells, every_s: 2.0, after_s: 0.0, gain_db: 0.0 };
        let clock = |radius_m| LifeKind::Clock { radius_m, dial: Dial::Twelve, face: Rgb(0, 0, 0), gold: Rgb(9, 9, 9) };
        let sign = LifeKind::Sign {
            shape: SignShape::Round,
            size_m: (0.6, f64::INFINITY),
            arm_m: 0.1,
            colour: Rgb(0, 0, 0),
            trim: Rgb(0, 0, 0),
        };
        let life = Life {
            things: vec![
                thing("a", clock(1.0)),
                thing("a", clock(f64::NAN)),
                thing(" ", clock(0.0)),
                thing("b", LifeKind::Fountain { radius_m: 1.0, water_m: 0.5, jets: vec![dry] }),
                thing("c", LifeKind::Fountain { radius_m: 1.0, water_m: 0.5, jets: Vec::new() }),
                thing("d", bell("great bell", Tells::At { hours: vec![6.0, 6.1], strokes: 9 })),
                thing("e", LifeKind::Flock { radius_m: 9.0, count: 65, startle_m: 3.0 }),
                thing("f", LifeKind::Flag { pole_m: 2.0, tilt_deg: 0.0, size_m: (3.0, 1.0), fields: Vec::new(), wedge: None }),
                thing("g", sign),
            ],
            ..Life::default()
        };
        let wrong = life.validate();
        for told in [
            "thing “a” is told twice",
            "clock “a”: radius_m is NaN; give 0.05 to 20",
            "thing 3: it has no name",
            "clock “ ”: radius_m is 0; give",
            "fountain “b”: jet 1: it lands at 2 m, but rises no higher than 1 m",
            "fountain “c”: it has no jets",
            "bell “d”: its sound must have a name without spaces",
            "bell “d”: hours holds 6.1, which is no quarter",
            "flock “e”: count is 65; give 1 to 64",
            "flag “f”: size_m along the pole is 3; give 0.1 to 2",
            "flag “f”: give one to twelve colours",
            "sign “g”: size_m down is inf; give 0.05 to 4",
            "sign “g”: arm_m is 0.1; give 0.3 to 6",
        ] {
            assert!(wrong.iter().any(|sentence| sentence.contains(told)), "{told}: {wrong:#?}");
        }
        assert_eq!(wrong.len(), 13, "{wrong:#?}");
    }

    #[test]
    fn things_stand_beside_places() {
        let beside = LivingThing { by: DVec2::new(2.0, -1.0), ..thing("x", LifeKind::Smoke { strength: 1.0, always: false }) };
        assert_eq!(beside.plan_pos(|name| (name == "A").then_some(DVec2::new(10.0, 20.0))), Some(DVec2::new(12.0, 19.0)));
        assert_eq!(beside.plan_pos(|_| None), None);
        let plain = LivingThing { at: Where::At(1.0, 2.0), ..beside };
        assert_eq!(plain.plan_pos(|_| None), Some(DVec2::new(3.0, 1.0)));
    }
}
