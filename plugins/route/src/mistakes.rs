//! Everything that is wrong with a tour, each with the part of it that it stands in.

use veduta_city::{LookAt, Step, Tour, Where};

use crate::{
    CompiledTour, Gazetteer, RouteError, StepKind, StepProblem, StreetNet, TourError,
    bounds::{DAY, KEY_SECONDS, numbers, settings, spots},
    compile,
};

/// Something that is wrong with a tour.
#[derive(Debug, Clone, PartialEq)]
pub struct TourMistake {
    /// The step's index, or `None` for what concerns the tour itself.
    pub step: Option<usize>,
    /// The part of the step or tour, as [`TourText::mistake_at`](veduta_city::TourText::mistake_at) takes it; empty for all of it.
    pub part: String,
    /// What is wrong.
    pub error: TourError,
}

/// After so many mistakes the rest is not looked at.
const MOST_MISTAKES: usize = 100;

/// Compiles a tour, or tells everything that is wrong with it, in the order of the steps: what follows a mistake is looked at as if
/// that were mended.
///
/// ```
/// use veduta_city::{Tour, file};
/// use veduta_route::{Gazetteer, StreetNet, mistakes};
///
/// let text = r#"(title: "t", city: "x", speed: 99, steps: [
///     Start(at: Place("Nowhere"), eye_m: -1),
///     Wait(seconds: -1),
/// ])"#;
/// let tour: Tour = file::parse(text, "t.tour.ron")?;
/// let told = mistakes(&tour, &StreetNet::new(&[]), &Gazetteer::default()).expect_err("four mistakes");
/// let parts: Vec<(Option<usize>, &str)> = told.iter().map(|one| (one.step, one.part.as_str())).collect();
/// assert_eq!(parts, [(None, "speed"), (Some(0), "at.0"), (Some(0), "eye_m"), (Some(1), "seconds")]);
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
///
/// # Errors
/// All mistakes, up to a hundred.
pub fn mistakes(tour: &Tour, net: &StreetNet, places: &Gazetteer) -> Result<CompiledTour, Vec<TourMistake>> {
    let mut search = Search { rest: tour.clone(), net, places, found: Vec::new() };
    search.numbers();
    search.places();
    let compiled = search.compiled();
    let mut found = search.found;
    found.sort_by(|a, b| (a.step, &a.part).cmp(&(b.step, &b.part)));
    match compiled {
        Some(compiled) if found.is_empty() => Ok(compiled),
        _ => Err(found),
    }
}

struct Search<'a> {
    /// The tour with what was found mended in some way.
    rest: Tour,
    net: &'a StreetNet,
    places: &'a Gazetteer,
    found: Vec<TourMistake>,
}

impl Search<'_> {
    fn step(&mut self, index: usize, part: String, problem: StepProblem) {
        let kind = self.rest.steps.get(index).map_or(StepKind::Wait, StepKind::of);
        let error = TourError::Step { step: index + 1, kind, problem };
        self.found.push(TourMistake { step: Some(index), part, error });
    }

    /// Finds numbers out of bounds, and takes harmless ones instead.
    fn numbers(&mut self) {
        let mut found = Vec::new();
        for (part, bounds, value) in settings(&mut self.rest) {
            if let Err(range) = bounds.range(*value) {
                found.push(TourMistake { step: None, part: part.to_owned(), error: TourError::Setting(range) });
                *value = bounds.harmless();
            }
        }
        if let Err(range) = DAY.range(f64::from(self.rest.day)) {
            found.push(TourMistake { step: None, part: "day".to_owned(), error: TourError::Setting(range) });
            self.rest.day = self.rest.day.clamp(1, 366);
        }
        for (index, step) in self.rest.steps.iter_mut().enumerate() {
            let kind = StepKind::of(step);
            let mut are_keys_timed = true;
            for (part, bounds, value) in numbers(step) {
                if let Err(problem) = bounds.check(*value) {
                    are_keys_timed &= bounds != KEY_SECONDS;
                    let error = TourError::Step { step: index + 1, kind, problem };
                    found.push(TourMistake { step: Some(index), part, error });
                    *value = bounds.harmless();
                }
            }
            if let (Step::Track { keys }, false) = (step, are_keys_timed) {
                keys.iter_mut().zip(1..).for_each(|(key, second)| key.0 = f64::from(second));
            }
        }
        found.truncate(MOST_MISTAKES);
        self.found = found;
    }

    /// Finds names that no place has, and does without them.
    fn places(&mut self) {
        for index in 0..self.rest.steps.len() {
            let unknown: Vec<(String, String)> = spots(&self.rest.steps[index])
                .into_iter()
                .filter_map(|(part, spot)| match spot {
                    Where::Place(name) if self.places.find(name).is_none() => Some((format!("{part}.0"), name.clone())),
                    _ => None,
                })
                .collect();
            for (part, name) in unknown {
                if self.found.len() >= MOST_MISTAKES {
                    return;
                }
                let near = self.places.suggest(&name).into_iter().map(str::to_owned).collect();
                let name: String = name.chars().take(80).collect();
                self.step(index, part, StepProblem::UnknownPlace { name, near });
            }
            let (places, anywhere) = (self.places, self.anywhere());
            without_unknown(
                &mut self.rest.steps[index],
                &|spot| match spot {
                    Where::Place(name) => places.find(name).is_none(),
                    Where::At(..) => false,
                },
                anywhere,
            );
        }
    }

    /// A spot where one can stand.
    fn anywhere(&self) -> Where {
        let pos = self.net.nearest(glam::DVec2::ZERO).map_or(glam::DVec2::ZERO, |foot| foot.plan_pos);
        Where::At(pos.x, pos.y)
    }

    /// Finds all else, step by step, each mended as little as may be.
    fn compiled(&mut self) -> Option<CompiledTour> {
        while self.found.len() < MOST_MISTAKES {
            match compile(&self.rest, self.net, self.places) {
                Ok(compiled) => return Some(compiled),
                Err(TourError::Step { step, kind, problem }) if step <= self.rest.steps.len() => {
                    let index = step - 1;
                    let part = self.part_of(index, &problem);
                    let is_last = problem == StepProblem::TooLate;
                    self.rest.steps[index] = self.mended(index, &problem);
                    let error = TourError::Step { step, kind, problem };
                    self.found.push(TourMistake { step: Some(index), part, error });
                    if is_last {
                        return None;
                    }
                }
                Err(error) => {
                    let part = if error == TourError::Empty { "steps" } else { "" };
                    self.found.push(TourMistake { step: None, part: part.to_owned(), error });
                    return None;
                }
            }
        }
        None
    }

    /// The part of a step that a problem is about.
    fn part_of(&self, index: usize, problem: &StepProblem) -> String {
        match (problem, &self.rest.steps[index]) {
            (StepProblem::NoPoints | StepProblem::TooManyPoints(_), Step::Fly { .. }) => "through".to_owned(),
            (StepProblem::TooManyPoints(_), _) => "via".to_owned(),
            (StepProblem::NoKeys | StepProblem::TooManyKeys(_), _) => "keys".to_owned(),
            (StepProblem::KeysOutOfOrder { key, .. }, _) => format!("keys.{}.0", key - 1),
            (StepProblem::NoWay(RouteError::OffStreets { plan_pos, .. }), Step::Walk { via, to, .. }) => {
                let is_it = |spot: &Where| self.stand(spot).is_some_and(|pos| pos.distance(*plan_pos) < 0.1);
                let via = via.iter().position(is_it).map(|i| format!("via.{i}"));
                via.or_else(|| is_it(to).then(|| "to".to_owned())).unwrap_or_default()
            }
            (StepProblem::File { file, .. }, Step::Narrate { file: own, files, .. }) if file != own => {
                files.iter().find(|(_, name)| *name == file).map_or_else(String::new, |(code, _)| format!("files.{code}"))
            }
            (StepProblem::File { .. }, _) => "file".to_owned(),
            _ => String::new(),
        }
    }

    fn stand(&self, spot: &Where) -> Option<glam::DVec2> {
        match spot {
            Where::At(x, y) => Some(glam::DVec2::new(*x, *y)),
            Where::Place(name) => self.places.find(name).map(|place| place.view.map_or(place.pos, |view| view.pos)),
        }
    }

    /// A step in place of one that has a problem, so that what follows has none for that alone.
    fn mended(&self, index: usize, problem: &StepProblem) -> Step {
        let cut = |to: &Where| Step::Cut { to: to.clone(), eye_m: None, look: LookAt::Ahead, seconds: 1.0 };
        match (problem, &self.rest.steps[index]) {
            (StepProblem::NoStart, _) => Step::Start { at: self.anywhere(), eye_m: None, look: LookAt::Ahead },
            (StepProblem::NoWay(RouteError::OffStreets { plan_pos, .. }), Step::Walk { to, .. })
                if self.stand(to).is_some_and(|pos| pos.distance(*plan_pos) < 0.1) =>
            {
                Step::Wait { seconds: 0.0 }
            }
            (StepProblem::NoWay(_) | StepProblem::FromAbove { .. }, Step::Walk { to, .. }) => cut(to),
            _ => Step::Wait { seconds: 0.0 },
        }
    }
}

/// Takes unknown spots out of a step, or puts another in their place where there must be one.
fn without_unknown(step: &mut Step, is_unknown: &dyn Fn(&Where) -> bool, anywhere: Where) {
    match step {
        Step::Start { at: spot, look, .. } | Step::Cut { to: spot, look, .. } => {
            if is_unknown(spot) {
                *spot = anywhere;
            }
            ahead_if_unknown(look, is_unknown);
        }
        Step::Walk { to, via, look, .. } => {
            via.retain(|spot| !is_unknown(spot));
            ahead_if_unknown(look, is_unknown);
            if is_unknown(to) {
                *step = Step::Cut { to: anywhere, eye_m: None, look: LookAt::Ahead, seconds: 1.0 };
            }
        }
        Step::Fly { look, .. } | Step::Look { at: look, .. } => ahead_if_unknown(look, is_unknown),
        _ => {}
    }
}

fn ahead_if_unknown(look: &mut LookAt, is_unknown: &dyn Fn(&Where) -> bool) {
    if matches!(look, LookAt::Spot { at, .. } if is_unknown(at)) {
        *look = LookAt::Ahead;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::grid_town;

    fn told(steps: &str) -> Vec<(Option<usize>, String, String)> {
        let text = format!("(title: \"t\", city: \"x\", steps: [{steps}])");
        let tour: Tour = veduta_city::file::parse(&text, "t.tour.ron").unwrap_or_else(|e| panic!("{e}"));
        let net = StreetNet::new(&grid_town(3, 50.0));
        let found = mistakes(&tour, &net, &Gazetteer::default()).map(|_| ()).err().unwrap_or_default();
        found.into_iter().map(|one| (one.step, one.part, one.error.to_string())).collect()
    }

    fn places(steps: &str) -> Vec<(usize, String)> {
        told(steps).into_iter().map(|(step, part, _)| (step.unwrap_or(usize::MAX), part)).collect()
    }

    #[test]
    fn every_number_and_name_is_told_at_its_part() {
        let steps = "Start(at: At(0, 0), look: Spot(at: Place(\"A\"), height_m: 9999)), Fov(deg: 500, seconds: -2), \
                     Walk(to: Place(\"B\"), via: [At(50, 0), Place(\"C\")], speed: 99), Walk(to: At(50, 50)), \
                     Fly(through: [(0, 0, 9), (0, 0, -9)], speed: 0), Look(at: Heading(deg: 0, pitch_deg: 99), seconds: -1)";
        let expected = [
            (0, "look.at.0"),
            (0, "look.height_m"),
            (1, "deg"),
            (1, "seconds"),
            (2, "speed"),
            (2, "to.0"),
            (2, "via.1.0"),
            (4, "speed"),
            (4, "through.1.2"),
            (5, "at.pitch_deg"),
            (5, "seconds"),
        ];
        assert_eq!(places(steps), expected.map(|(step, part)| (step, part.to_owned())));
    }

    #[test]
    fn one_mistake_does_not_make_others() {
        assert_eq!(
            places("Wait(seconds: 1), Wait(seconds: 1), Walk(to: At(50, 50))"),
            [(0, String::new())],
            "it stands nowhere once"
        );
        let outside = "Start(at: At(0, 0)), Walk(to: At(9000, 0)), Walk(to: At(50, 50)), Walk(to: At(50, 50), via: [At(0, 9000)])";
        assert_eq!(places(outside), [(1, "to".to_owned()), (3, "via.0".to_owned())]);
        let above = "Start(at: At(0, 0), eye_m: 50), Walk(to: At(50, 50)), Walk(to: At(0, 0)), Fly(through: [], speed: 3)";
        assert_eq!(places(above), [(1, String::new()), (3, "through".to_owned())]);
        let late =
            "Start(at: At(0, 0)), Track(keys: [(2, 0, 0, 2, 0, 0), (1, 0, 0, 2, 0, 0)]), Wait(seconds: 21600), Wait(seconds: 1)";
        assert_eq!(places(late), [(1, "keys.1.0".to_owned()), (2, String::new())]);
        assert_eq!(told("")[0].1, "steps");
        assert_eq!(told("Start(at: At(0, 0)), Walk(to: At(50, 50))"), []);
    }

    #[test]
    fn every_number_of_every_step_has_bounds() {
        let steps = "Start(at: At(inf, 0), eye_m: inf), Cut(to: At(0, inf), seconds: inf), Say(text: \"\", seconds: inf), \
                     Narrate(file: \"a.ogg\", text: \"\", seconds: inf), Picture(file: \"a.png\", seconds: inf), Wait(seconds: inf), \
                     Rain(wet: inf, seconds: inf), Fov(deg: inf, seconds: inf), Time(hour: inf, seconds: inf), \
                     Track(keys: [(inf, inf, inf, inf, inf, inf)]), Look(at: Spot(at: At(inf, inf), height_m: inf), seconds: inf)";
        // Each of them is told, and none makes the compiler find more.
        assert_eq!(told(steps).len(), steps.matches("inf").count(), "{:#?}", told(steps));
    }
}
