use std::collections::VecDeque;

use bevy::prelude::*;

use crate::LevelDistances;

/// As which share of [`LevelDistances`] levels reach, 0 to 1. [`AutoLevels`] sets it; without those it stays as it is set.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct LevelReach(pub f32);

impl Default for LevelReach {
    fn default() -> Self {
        Self(1.0)
    }
}

/// Makes levels reach as far as frames keep their time. Off unless this resource is there.
///
/// Frames are judged by the median of a second's, so that single long ones count for nothing. Where they are too slow for a second, levels
/// reach a fifth less far; where they have been fast for long, a tenth farther. How long that is doubles each time that it was too early, so a
/// scene that is nearly too much does not sway. Levels glide to their new distances.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct AutoLevels {
    /// A frame may take so long, seconds. A display that waits for its own 60 frames a second never shows what time is to spare: ask for a
    /// tenth more than its frames take, or longer.
    pub frame_s: f64,
    /// Levels reach at least this share of their distances.
    pub least: f32,
}

impl Default for AutoLevels {
    fn default() -> Self {
        Self { frame_s: 1.0 / 50.0, least: 0.2 }
    }
}

/// What [`AutoLevels`] remembers.
#[derive(Debug, Clone)]
pub(crate) struct Chooser {
    /// Of the last second, the latest last.
    frames: VecDeque<f64>,
    /// Their sum.
    seconds: f64,
    /// How long frames have been fast.
    fast_s: f64,
    /// How long they must have been.
    patience_s: f64,
    /// How long ago levels were let reach farther.
    grown_s: f64,
    /// Where levels glide.
    goal: f32,
}

impl Default for Chooser {
    fn default() -> Self {
        Self { frames: VecDeque::new(), seconds: 0.0, fast_s: 0.0, patience_s: Self::PATIENCE_S, grown_s: f64::INFINITY, goal: 1.0 }
    }
}

impl Chooser {
    /// Frames are judged by so many seconds of them, and at least [`Self::FRAMES`].
    const SPAN_S: f64 = 1.0;
    const FRAMES: usize = 5;
    /// So long frames must have been fast at first, and at most.
    const PATIENCE_S: f64 = 4.0;
    const MOST_PATIENCE_S: f64 = 64.0;
    /// Slow and fast, as shares of what a frame may take.
    const SLOW: f64 = 1.1;
    const FAST: f64 = 0.9;
    /// What levels change by.
    const LESS: f32 = 0.8;
    const MORE: f32 = 1.1;
    /// Farthest that levels glide in a frame.
    const STEP: f32 = 0.02;

    /// The reach after a frame that took so long.
    pub(crate) fn pass(&mut self, settings: &AutoLevels, reach: f32, frame_s: f64) -> f32 {
        self.frames.push_back(frame_s);
        self.seconds += frame_s;
        self.grown_s += frame_s;
        while self.frames.len() > Self::FRAMES && self.seconds - self.frames[0] >= Self::SPAN_S {
            self.seconds -= self.frames.pop_front().unwrap_or_default();
        }
        if self.frames.len() >= Self::FRAMES && self.seconds >= Self::SPAN_S {
            self.judge(settings, frame_s);
        }
        self.goal = self.goal.clamp(settings.least.min(1.0), 1.0);
        reach + (self.goal - reach).clamp(-Self::STEP, Self::STEP)
    }

    fn judge(&mut self, settings: &AutoLevels, frame_s: f64) {
        let mut sorted: Vec<f64> = self.frames.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let median = sorted[sorted.len() / 2];
        self.fast_s = if median < settings.frame_s * Self::FAST { self.fast_s + frame_s } else { 0.0 };
        if median > settings.frame_s * Self::SLOW && self.goal > settings.least {
            // It was too early: more patience the next time. What was fine for as long as one waits for was none.
            let was_early = self.grown_s < self.patience_s;
            self.patience_s = if was_early { (self.patience_s * 2.0).min(Self::MOST_PATIENCE_S) } else { Self::PATIENCE_S };
            self.goal *= Self::LESS;
            self.forget();
        } else if self.fast_s >= self.patience_s && self.goal < 1.0 {
            self.goal *= Self::MORE;
            self.grown_s = 0.0;
            self.forget();
        }
    }

    /// Frames before a change tell nothing of those after it.
    fn forget(&mut self) {
        self.frames.clear();
        (self.seconds, self.fast_s) = (0.0, 0.0);
    }
}

/// Lets levels reach as far as frames keep their time.
pub(crate) fn choose_reach(
    settings: Res<AutoLevels>,
    time: Res<Time<Real>>,
    mut chooser: Local<Chooser>,
    mut reach: ResMut<LevelReach>,
) {
    let chosen = chooser.pass(&settings, reach.0, time.delta_secs_f64());
    reach.set_if_neq(LevelReach(chosen));
}

impl LevelDistances {
    /// As far as levels reach.
    #[must_use]
    pub fn within(&self, reach: LevelReach) -> Self {
        let scaled = |distances: [f32; 3]| distances.map(|distance| distance * reach.0);
        Self { near: scaled(self.near), far: scaled(self.far) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scene whose frames take longer the farther levels reach.
    struct Scene {
        chooser: Chooser,
        reach: f32,
        /// Seconds of a frame without any, and of one in which they reach all the way.
        frame_s: [f64; 2],
        reaches: Vec<f32>,
    }

    impl Scene {
        fn new(bare_s: f64, full_s: f64) -> Self {
            Self { chooser: Chooser::default(), reach: 1.0, frame_s: [bare_s, full_s], reaches: Vec::new() }
        }

        fn run(&mut self, seconds: f64) -> f32 {
            let mut passed_s = 0.0;
            while passed_s < seconds {
                let [bare_s, full_s] = self.frame_s;
                let frame_s = bare_s + (full_s - bare_s) * f64::from(self.reach).powi(2);
                passed_s += frame_s;
                self.reach = self.chooser.pass(&AutoLevels::default(), self.reach, frame_s);
                self.reaches.push(self.reach);
            }
            self.reach
        }
    }

    #[test]
    fn levels_reach_all_the_way_where_there_is_time() {
        assert_eq!(Scene::new(0.004, 0.017).run(60.0), 1.0);
    }

    #[test]
    fn levels_draw_in_until_frames_keep_their_time_and_stay_there() {
        let mut scene = Scene::new(0.005, 0.05);
        let reach = f64::from(scene.run(10.0));
        let frame_s = 0.005 + 0.045 * reach * reach;
        assert!(frame_s <= 0.02 * 1.1, "{frame_s} s at {reach}");
        scene.reaches.clear();
        scene.run(300.0);
        let changes = scene.reaches.windows(2).filter(|pair| pair[0] != pair[1]).count();
        // Each change is a glide of some steps; more and more seldom.
        assert!(changes < 120, "{changes} changes of {} frames", scene.reaches.len());
        let (least, most) = scene.reaches.iter().fold((1.0_f32, 0.0_f32), |(a, b), &r| (a.min(r), b.max(r)));
        assert!(least > 0.4 && most < 0.75, "from {least} to {most}");
    }

    #[test]
    fn where_nothing_helps_the_least_remains_and_comes_back_when_it_is_over() {
        let mut scene = Scene::new(0.1, 0.2);
        assert_eq!(scene.run(60.0), AutoLevels::default().least);
        scene.frame_s = [0.002, 0.01];
        assert_eq!(scene.run(120.0), 1.0);
    }

    #[test]
    fn single_long_frames_count_for_nothing() {
        let mut chooser = Chooser::default();
        let reach = (0..3_000)
            .fold(1.0, |reach, frame| chooser.pass(&AutoLevels::default(), reach, if frame % 40 == 0 { 0.7 } else { 0.016 }));
        assert_eq!(reach, 1.0);
    }

    #[test]
    fn levels_glide() {
        let mut scene = Scene::new(0.005, 0.05);
        scene.run(60.0);
        let longest = scene.reaches.windows(2).map(|pair| (pair[0] - pair[1]).abs()).fold(0.0, f32::max);
        assert!(longest <= Chooser::STEP + 1e-6, "{longest}");
    }
}
