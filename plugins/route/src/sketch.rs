//! A tour that may have mistakes, as far as it can be played.

use veduta_city::{Step, Tour};

use crate::{
    CompiledTour, Gazetteer, Pose, StepKind, StreetNet, TourError,
    bounds::{Bounds, EYE, FOV, HOUR, WALK_SPEED},
    compile,
};

/// A tour under edit, compiled: what can be played, and what is wrong with the rest.
#[derive(Debug, Clone, Default)]
pub struct Sketch {
    /// The tour without the steps that cannot be played; `None` where nothing is left. Its [`StepSpan`](crate::StepSpan)s tell the indices of
    /// the tour with all steps.
    pub tour: Option<CompiledTour>,
    /// Where each step leaves the eye that sets it somewhere or turns it, by the step's index.
    pub views: Vec<(usize, Pose)>,
    /// What is wrong: the step's index, or `None` for what concerns the tour as a whole.
    pub mistakes: Vec<(Option<usize>, TourError)>,
}

/// After so many mistakes the rest is not looked at.
const MOST_MISTAKES: usize = 100;

/// Compiles what can be played of a tour.
///
/// ```
/// use veduta_city::{Tour, file};
/// use veduta_route::{Gazetteer, StreetNet, sketch};
///
/// let text = r#"(title: "t", city: "x", steps: [Start(at: At(0, 0)), Walk(to: Place("Nowhere")), Wait(seconds: 2)])"#;
/// let tour: Tour = file::parse(text, "t.tour.ron")?;
/// let sketch = sketch(&tour, &StreetNet::new(&[]), &Gazetteer::default());
/// assert_eq!(sketch.mistakes[0].0, Some(1));
/// assert_eq!(sketch.tour.map(|tour| tour.steps().iter().map(|span| span.index).collect()), Some(vec![0, 2]));
/// # Ok::<(), veduta_city::file::SyntaxError>(())
/// ```
#[must_use]
pub fn sketch(tour: &Tour, net: &StreetNet, places: &Gazetteer) -> Sketch {
    let mut sketch = Sketch::default();
    let mut rest = tour.clone();
    // Index in the tour of every step that is left.
    let mut indices: Vec<usize> = (0..tour.steps.len()).collect();
    while !indices.is_empty() && sketch.mistakes.len() < MOST_MISTAKES {
        match compile(&rest, net, places) {
            Ok(mut compiled) => {
                compiled.renumber(&indices);
                sketch.views = views(&compiled);
                sketch.tour = Some(compiled);
                break;
            }
            Err(error @ TourError::Setting(_)) => {
                sketch.mistakes.push((None, error));
                rest = with_usual_settings(rest);
            }
            Err(error) => {
                let Some(at) = error.step().map(|number| number - 1).filter(|at| *at < indices.len()) else {
                    sketch.mistakes.push((None, error));
                    break;
                };
                rest.steps.remove(at);
                let index = indices.remove(at);
                sketch.mistakes.push((Some(index), error.at_step(index + 1)));
            }
        }
    }
    sketch.mistakes.sort_by_key(|(index, _)| *index);
    sketch
}

/// With numbers that are out of bounds made what they are where none are given.
fn with_usual_settings(tour: Tour) -> Tour {
    let usual = Tour::new(String::new(), String::new());
    let otherwise = |bounds: Bounds, value: f64, usual: f64| bounds.range(value).unwrap_or(usual);
    Tour {
        speed: otherwise(WALK_SPEED, tour.speed, usual.speed),
        eye_m: otherwise(EYE, tour.eye_m, usual.eye_m),
        fov_deg: otherwise(FOV, tour.fov_deg, usual.fov_deg),
        hour: otherwise(HOUR, tour.hour, usual.hour),
        day: tour.day.clamp(1, 366),
        ..tour
    }
}

fn views(tour: &CompiledTour) -> Vec<(usize, Pose)> {
    let sets = |kind| matches!(kind, StepKind::Start | StepKind::Cut | StepKind::Walk | StepKind::Fly | StepKind::Look);
    tour.steps().iter().filter(|span| sets(span.kind)).map(|span| (span.index, tour.pose(span.end_s))).collect()
}

/// Whether a step takes no time of its own: it goes on beside those that follow.
#[must_use]
pub const fn is_aside(step: &Step) -> bool {
    matches!(
        step,
        Step::Say { .. }
            | Step::Narrate { .. }
            | Step::Sound { .. }
            | Step::Picture { .. }
            | Step::Chapter { .. }
            | Step::Mark { .. }
            | Step::Rain { .. }
            | Step::Fov { .. }
            | Step::Time { .. }
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::grid_town;

    fn tour(settings: &str, steps: &str) -> Tour {
        let text = format!("(title: \"t\", city: \"x\", {settings} steps: [{steps}])");
        veduta_city::file::parse(&text, "t.tour.ron").expect("no mistakes")
    }

    #[test]
    fn every_mistake_is_told_at_its_step_and_the_rest_plays() {
        let net = StreetNet::new(&grid_town(3, 50.0));
        let steps = "Start(at: At(0, 0)), Walk(to: Place(\"Nowhere\")), Say(text: \"a\"), Walk(to: At(50, 50)), Wait(seconds: -1), \
                     Fly(through: [], speed: 3), Look(at: Heading(deg: 90), seconds: 2)";
        let sketch = sketch(&tour("speed: 99,", steps), &net, &Gazetteer::default());
        let at: Vec<Option<usize>> = sketch.mistakes.iter().map(|(index, _)| *index).collect();
        assert_eq!(at, [None, Some(1), Some(4), Some(5)], "{:?}", sketch.mistakes);
        let compiled = sketch.tour.expect("the rest plays");
        let mut spans: Vec<usize> = compiled.steps().iter().map(|span| span.index).collect();
        spans.sort_unstable();
        assert_eq!(spans, [0, 2, 3, 6]);
        let views: Vec<usize> = sketch.views.iter().map(|(index, _)| *index).collect();
        assert_eq!(views, [0, 3, 6]);
        assert!(
            (sketch.views[2].1.heading_deg - 90.0).abs() < 2.0 && sketch.views[1].1.plan_pos.distance((50.0, 50.0).into()) < 0.1
        );
    }

    #[test]
    fn a_tour_that_stands_nowhere_has_a_mistake_at_every_step_that_needs_it() {
        let tour = tour("", "Chapter(title: \"a\"), Wait(seconds: 1), Wait(seconds: 1)");
        let sketch = sketch(&tour, &StreetNet::new(&[]), &Gazetteer::default());
        assert!(sketch.tour.is_none());
        assert!(sketch.mistakes.iter().filter(|(index, _)| index.is_some()).count() == 2, "{:?}", sketch.mistakes);
    }
}
