use bevy::math::DVec2;
use bevy::prelude::*;
use veduta_city::Portal;
use veduta_ecs::{Eye, Stop, Viewer};

use crate::CurrentCell;
use crate::fetch::Store;

/// How a viewer moves, as streaming measures it: what comes into sight next is read by it. Streaming adds it to viewers.
#[derive(Component, Debug, Clone, PartialEq, Default)]
pub struct Motion {
    /// Metres a second in plan, evened out over some frames; zero after a jump.
    pub velocity_m_s: DVec2,
    /// Cells that lie straight ahead, as far as is walked or flown in [`Motion::AHEAD_S`] seconds, each with the metres to it; the nearest
    /// first, without the one that the viewer is in.
    pub ahead: Vec<(u32, f64)>,
    last: Option<DVec2>,
}

impl Motion {
    /// So many seconds ahead is read.
    pub const AHEAD_S: f64 = 8.0;
    /// Nobody counts as slower, metres a second: who stands may walk on.
    pub const PACE_M_S: f64 = 1.4;
    /// A velocity is evened out over so many seconds.
    const EVEN_S: f64 = 0.5;
    /// Whoever is faster has jumped, metres a second.
    const JUMP_M_S: f64 = 100.0;
    /// Most cells ahead.
    const MOST: usize = 8;

    /// Metres a second, at least [`Motion::PACE_M_S`].
    #[must_use]
    pub fn pace_m_s(&self) -> f64 {
        self.velocity_m_s.length().max(Self::PACE_M_S)
    }

    /// Where an eye will be if it goes on like this.
    #[must_use]
    pub fn stop(&self, eye: &Eye) -> Stop {
        Stop { in_s: Self::AHEAD_S, plan_pos: eye.plan_pos + self.velocity_m_s * Self::AHEAD_S, eye_m: eye.eye_m }
    }

    /// Whether it moves at all.
    pub(crate) fn is_moving(&self) -> bool {
        self.velocity_m_s.length() >= Self::PACE_M_S / 2.0
    }

    /// A direction in plan, of length 1: where one goes, or looks as long as one stands.
    pub(crate) fn direction(&self, eye: &Eye) -> DVec2 {
        let (sin, cos) = eye.heading_deg.to_radians().sin_cos();
        if self.is_moving() { self.velocity_m_s.normalize() } else { DVec2::new(sin, cos) }
    }

    /// Takes a viewer's place down, `dt_s` after the last.
    fn note(&mut self, plan_pos: DVec2, dt_s: f64) {
        let Some(last) = self.last.replace(plan_pos) else { return };
        if dt_s <= 0.0 {
            return;
        }
        let now = (plan_pos - last) / dt_s;
        let is_jump = now.length() > Self::JUMP_M_S;
        let share = 1.0 - (-dt_s / Self::EVEN_S).exp();
        self.velocity_m_s = if is_jump { DVec2::ZERO } else { self.velocity_m_s.lerp(now, share) };
    }
}

/// Measures how viewers move, and finds the cells ahead of them.
pub(crate) fn measure(
    mut commands: Commands,
    store: Option<Res<Store>>,
    time: Res<Time>,
    mut viewers: Query<(Entity, &Eye, Option<&CurrentCell>, Option<&mut Motion>), With<Viewer>>,
) {
    let index = store.as_ref().and_then(|store| store.client.index());
    for (viewer, eye, current, motion) in &mut viewers {
        let Some(mut motion) = motion else {
            commands.entity(viewer).insert(Motion { last: Some(eye.plan_pos), ..default() });
            continue;
        };
        motion.note(eye.plan_pos, time.delta_secs_f64());
        let here = index.zip(current.and_then(|current| current.0));
        let to = motion.stop(eye).plan_pos;
        motion.ahead = here.map_or_else(Vec::new, |(index, cell)| crossed(|cell| index.portals(cell), cell, (eye.plan_pos, to)));
    }
}

/// The cells that a way crosses from where it begins in one, each with the metres to it.
fn crossed<'a, P: Iterator<Item = &'a Portal>>(
    portals: impl Fn(u32) -> P,
    mut cell: u32,
    (from, to): (DVec2, DVec2),
) -> Vec<(u32, f64)> {
    let (way, mut last, mut ahead) = (to - from, 0.0, Vec::new());
    while ahead.len() < Motion::MOST {
        let beyond = portals(cell).filter_map(|portal| {
            let (t, _) = portal.meets(from, way).filter(|(t, _)| last < *t && *t <= 1.0)?;
            Some((t, portal.other(cell)?))
        });
        let Some((t, next)) = beyond.min_by(|a, b| a.0.total_cmp(&b.0)) else { break };
        ahead.push((next, t * way.length()));
        (cell, last) = (next, t);
    }
    ahead
}

#[cfg(test)]
mod tests {
    use veduta_city::{GridPos, PortalSide};

    use super::*;

    /// Cells in a row from west to east, ten metres long and four broad, with portals between them.
    fn row(portals: u32) -> Vec<Portal> {
        let portal = |n: u32| Portal {
            ends: (
                GridPos::from_metres(DVec2::new(10.0 * f64::from(n + 1), -2.0)),
                GridPos::from_metres(DVec2::new(10.0 * f64::from(n + 1), 2.0)),
            ),
            cell: n,
            beyond: PortalSide::Cell(n + 1),
        };
        (0..portals).map(portal).collect()
    }

    fn ahead(portals: &[Portal], from: DVec2, to: DVec2) -> Vec<(u32, f64)> {
        let of = |cell: u32| portals.iter().filter(move |portal| portal.cell == cell || portal.other(portal.cell) == Some(cell));
        crossed(of, 0, (from, to))
    }

    #[test]
    fn a_way_crosses_cell_after_cell_and_ends_at_walls() {
        let portals = row(20);
        let at = DVec2::new(4.0, 0.0);
        assert_eq!(ahead(&portals, at, DVec2::new(9.0, 0.0)), [], "it ends before the portal");
        assert_eq!(ahead(&portals, at, DVec2::new(24.0, 0.0)), [(1, 6.0), (2, 16.0)]);
        assert_eq!(ahead(&portals, at, DVec2::new(-30.0, 0.0)), [], "nothing lies to the west");
        assert_eq!(ahead(&portals, at, DVec2::new(16.0, 6.0)), [], "it meets the wall beside the portal");
        assert_eq!(ahead(&portals, at, DVec2::new(500.0, 0.0)).len(), Motion::MOST);
        let blind = Portal { beyond: PortalSide::Edge, ..portals[0] };
        assert_eq!(ahead(&[blind], at, DVec2::new(24.0, 0.0)), [], "nobody walks out of the city");
    }

    #[test]
    fn a_velocity_is_evened_out_and_a_jump_is_none() {
        let mut motion = Motion::default();
        let mut at = DVec2::ZERO;
        for _ in 0..60 {
            motion.note(at, 0.05);
            at += DVec2::new(0.0, 0.3);
        }
        assert!((motion.velocity_m_s - DVec2::new(0.0, 6.0)).length() < 0.1, "{motion:?}");
        let eye = Eye { heading_deg: 90.0, ..Eye::default() };
        assert!((motion.direction(&eye) - DVec2::Y).length() < 1e-6, "one goes north, whatever one looks at");
        motion.note(at + DVec2::new(80.0, 0.0), 0.05);
        assert_eq!(motion.velocity_m_s, DVec2::ZERO);
        assert!((motion.direction(&eye) - DVec2::X).length() < 1e-6, "who stands may go where he looks");
        assert!((motion.pace_m_s() - Motion::PACE_M_S).abs() < 1e-9);
    }
}
