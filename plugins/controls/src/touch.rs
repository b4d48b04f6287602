use std::collections::BTreeMap;

use bevy::input::touch::{TouchInput, TouchPhase};
use bevy::prelude::*;
use bevy::window::PrimaryWindow;
use veduta_ecs::PointersTaken;

/// What fingers do on the picture of the city, in this frame.
///
/// A finger that begins on the left half is a stick, one on the right looks around; two on the right pinch; one that is lifted soon where it
/// began taps, on either half.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub struct Touching {
    /// The stick under a finger: right and up, no longer than 1.
    pub stick: Vec2,
    /// Where that finger began, and where it is; for drawing.
    pub stick_at: Option<(Vec2, Vec2)>,
    /// So far looking has been dragged, logical pixels right and down.
    pub look_px: Vec2,
    /// So much farther apart two fingers are than in the frame before: over 1 they spread. 0 where there are not two.
    pub pinch: f32,
}

/// A finger has tapped on the picture of the city.
#[derive(Message, Debug, Clone, Copy, PartialEq)]
pub struct Tap {
    /// Where, logical pixels from the upper left.
    pub at: Vec2,
}

/// A finger that has moved so far, logical pixels, or is down so long, seconds, does not tap.
const SLOP_PX: f32 = 12.0;
const TAP_S: f64 = 0.35;
/// So far the stick is pushed the whole way, logical pixels.
const REACH_PX: f32 = 64.0;

#[derive(Debug, Clone, Copy)]
struct Finger {
    from: Vec2,
    at: Vec2,
    since_s: f64,
    has_moved: bool,
    is_left: bool,
}

/// Fingers that are down.
#[derive(Debug, Default)]
pub(crate) struct Fingers(BTreeMap<u64, Finger>);

impl Fingers {
    /// A finger begins; whether it may do so is known to whoever calls.
    fn begin(&mut self, id: u64, at: Vec2, now_s: f64, half_px: f32) {
        self.0.insert(id, Finger { from: at, at, since_s: now_s, has_moved: false, is_left: at.x < half_px });
    }

    /// A finger moves; so far it looks around. A finger that has just passed its slop does not leap.
    fn shift(&mut self, id: u64, to: Vec2) -> Vec2 {
        let looks = self.0.values().filter(|finger| !finger.is_left).count();
        let Some(finger) = self.0.get_mut(&id) else { return Vec2::ZERO };
        let by = to - finger.at;
        finger.at = to;
        let had_moved = finger.has_moved;
        finger.has_moved |= finger.from.distance(to) > SLOP_PX;
        if had_moved && !finger.is_left && looks == 1 { by } else { Vec2::ZERO }
    }

    /// A finger is lifted; where it has tapped.
    fn end(&mut self, id: u64, now_s: f64) -> Option<Vec2> {
        let finger = self.0.remove(&id)?;
        (!finger.has_moved && now_s - finger.since_s <= TAP_S).then_some(finger.from)
    }

    /// The finger that is a stick: the first that has moved or stays.
    fn stick(&self, now_s: f64) -> Option<&Finger> {
        self.0.values().find(|finger| finger.is_left && (finger.has_moved || now_s - finger.since_s > TAP_S))
    }

    /// How far apart two fingers on the right are.
    fn span_px(&self) -> Option<f32> {
        let mut right = self.0.values().filter(|finger| !finger.is_left);
        let (one, other) = (right.next()?, right.next()?);
        Some(one.at.distance(other.at).max(1.0))
    }
}

pub(crate) fn feel(
    time: Res<Time<Real>>,
    taken: Res<PointersTaken>,
    windows: Query<&Window, With<PrimaryWindow>>,
    mut inputs: MessageReader<TouchInput>,
    mut taps: MessageWriter<Tap>,
    mut fingers: Local<Fingers>,
    mut span_px: Local<Option<f32>>,
    mut touching: ResMut<Touching>,
) {
    let now_s = time.elapsed_secs_f64();
    let half_px = windows.iter().next().map_or(640.0, |window| window.width() / 2.0);
    let mut look_px = Vec2::ZERO;
    for input in inputs.read() {
        match input.phase {
            TouchPhase::Started if !taken.touches.contains(&input.id) => {
                fingers.begin(input.id, input.position, now_s, half_px);
            }
            TouchPhase::Started => {}
            TouchPhase::Moved => look_px += fingers.shift(input.id, input.position),
            TouchPhase::Ended => {
                if let Some(at) = fingers.end(input.id, now_s) {
                    taps.write(Tap { at });
                }
            }
            TouchPhase::Canceled => {
                fingers.0.remove(&input.id);
            }
        }
    }
    let before_px = core::mem::replace(&mut *span_px, fingers.span_px());
    let stick = fingers.stick(now_s).map(|finger| {
        let by = (finger.at - finger.from) * Vec2::new(1.0, -1.0) / REACH_PX;
        (by.clamp_length_max(1.0), (finger.from, finger.at))
    });
    touching.set_if_neq(Touching {
        stick: stick.map_or(Vec2::ZERO, |(push, _)| push),
        stick_at: stick.map(|(_, at)| at),
        look_px,
        pinch: before_px.zip(*span_px).map_or(0.0, |(before, now)| now / before),
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::app;

    fn send(app: &mut App, id: u64, phase: TouchPhase, x: f32, y: f32) {
        let window = Entity::PLACEHOLDER;
        app.world_mut().write_message(TouchInput { phase, position: Vec2::new(x, y), window, force: None, id });
    }

    fn frame(app: &mut App) -> (Touching, Vec<Vec2>) {
        app.update();
        let taps = app.world_mut().resource_mut::<Messages<Tap>>().drain().map(|tap| tap.at).collect();
        (*app.world().resource::<Touching>(), taps)
    }

    #[test]
    fn a_finger_on_the_left_is_a_stick_until_it_is_lifted() {
        let mut app = app();
        send(&mut app, 1, TouchPhase::Started, 100.0, 500.0);
        assert_eq!(frame(&mut app).0.stick, Vec2::ZERO);
        send(&mut app, 1, TouchPhase::Moved, 100.0, 468.0);
        assert_eq!(frame(&mut app).0.stick, Vec2::new(0.0, 0.5));
        send(&mut app, 1, TouchPhase::Moved, 400.0, 500.0);
        assert_eq!(frame(&mut app).0.stick, Vec2::X, "no farther than the whole way");
        send(&mut app, 1, TouchPhase::Ended, 400.0, 500.0);
        let (touching, taps) = frame(&mut app);
        assert_eq!((touching, taps), (Touching::default(), vec![]));
    }

    #[test]
    fn one_on_the_right_looks_and_two_pinch() {
        let mut app = app();
        send(&mut app, 1, TouchPhase::Started, 900.0, 300.0);
        send(&mut app, 1, TouchPhase::Moved, 920.0, 300.0);
        assert_eq!(frame(&mut app).0.look_px, Vec2::ZERO, "it does not leap when it begins");
        send(&mut app, 1, TouchPhase::Moved, 930.0, 295.0);
        assert_eq!(frame(&mut app).0.look_px, Vec2::new(10.0, -5.0));
        assert_eq!(frame(&mut app).0.look_px, Vec2::ZERO, "only while it moves");
        send(&mut app, 2, TouchPhase::Started, 1030.0, 295.0);
        frame(&mut app);
        send(&mut app, 2, TouchPhase::Moved, 1080.0, 295.0);
        let touching = frame(&mut app).0;
        assert!((touching.pinch - 1.5).abs() < 1e-6 && touching.look_px == Vec2::ZERO, "{touching:?}");
        send(&mut app, 2, TouchPhase::Canceled, 1080.0, 295.0);
        assert_eq!(frame(&mut app).0.pinch, 0.0);
    }

    #[test]
    fn what_is_lifted_soon_where_it_began_taps() {
        let mut app = app();
        send(&mut app, 1, TouchPhase::Started, 900.0, 300.0);
        send(&mut app, 1, TouchPhase::Moved, 903.0, 302.0);
        send(&mut app, 1, TouchPhase::Ended, 903.0, 302.0);
        assert_eq!(frame(&mut app).1, [Vec2::new(900.0, 300.0)]);
        send(&mut app, 1, TouchPhase::Started, 100.0, 300.0);
        for _ in 0..8 {
            frame(&mut app);
        }
        send(&mut app, 1, TouchPhase::Ended, 100.0, 300.0);
        assert_eq!(frame(&mut app).1, [], "who rests a finger has not tapped");
    }

    #[test]
    fn fingers_on_windows_are_the_windows() {
        let mut app = app();
        app.world_mut().resource_mut::<PointersTaken>().touches.insert(5);
        send(&mut app, 5, TouchPhase::Started, 100.0, 500.0);
        send(&mut app, 5, TouchPhase::Moved, 100.0, 400.0);
        assert_eq!(frame(&mut app).0, Touching::default());
        send(&mut app, 5, TouchPhase::Ended, 100.0, 400.0);
        assert_eq!(frame(&mut app), (Touching::default(), vec![]));
    }
}
