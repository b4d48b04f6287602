//! How a pigeon stands, pecks, walks, flies and lands: any moment as a function of time and what was drawn for the bird.

use core::f64::consts::{PI, TAU};

use bevy::math::{DVec2, DVec3};
use veduta_city::draw::Draw;

/// Where a bird may stand: plan metres with the elevation, and how the ground rises eastwards and northwards there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Its middle.
    pub pos: DVec3,
    /// Rise of the ground, metres a metre.
    pub slope: DVec2,
}

/// A bird at a moment.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Pose {
    /// Plan metres with the elevation: between its feet.
    pub pos: DVec3,
    /// Where its beak points, radians clockwise from north.
    pub heading: f64,
    /// How far its breast is raised, radians.
    pub pitch: f64,
    /// How far it leans to its right, radians.
    pub roll: f64,
    /// How far its wings are spread, 0 to 1.
    pub spread: f64,
    /// How far its wings are raised, radians.
    pub beat: f64,
    /// How far its left leg is ahead of its right, −1 to 1.
    pub stride: f64,
    /// How far its head is down at the ground, 0 to 1.
    pub peck: f64,
    /// How far its head is thrust forward, −1 to 1.
    pub nod: f64,
}

/// A time on the ground: from when, and looking where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Perch {
    pub spot: Spot,
    /// Draws of this stay.
    pub draw: Draw,
    pub since_s: f64,
    /// Heading with which it came down, radians.
    pub heading: f64,
}

/// What a bird does over and over: it walks for a while, then stands, looks and pecks; seconds.
const ROUND_S: f64 = 6.5;
const WALK_S: f64 = 2.6;
/// How far it walks about its spot, metres.
const STROLL_M: f64 = 0.85;
/// Length of two steps, metres.
const STRIDE_M: f64 = 0.16;
/// Wings are folded within this time, seconds.
const FOLD_S: f64 = 0.35;

/// Goes from 0 to 1 smoothly.
fn ease(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

fn heading_of(way: DVec2) -> f64 {
    way.x.atan2(way.y)
}

fn turned(from: f64, to: f64, share: f64) -> f64 {
    from + ((to - from + PI).rem_euclid(TAU) - PI) * share
}

impl Perch {
    /// The place that it walks to in a round; of the first round where it came down.
    fn place(&self, round: u64) -> DVec2 {
        if round == 0 {
            return DVec2::ZERO;
        }
        let of = self.draw.part(round);
        let angle = of.between("way", 0.0, TAU);
        DVec2::new(angle.sin(), angle.cos()) * STROLL_M * of.unit("far").sqrt()
    }

    /// Heading along the way of a round; before the first that with which it came.
    fn course(&self, round: Option<u64>) -> f64 {
        round.map_or(self.heading, |round| heading_of(self.place(round + 1) - self.place(round)))
    }

    /// The bird so long after it came down.
    pub fn pose(&self, time_s: f64) -> Pose {
        let since = (time_s - self.since_s).max(0.0);
        let late = self.draw.between("late", 0.0, ROUND_S - WALK_S);
        // First it stands a while, as if it had done a round.
        let t = since + ROUND_S - late;
        let (count, within) = ((t / ROUND_S).floor(), t % ROUND_S);
        let round = (count as u64).checked_sub(1);
        let (from, to) = round.map_or((DVec2::ZERO, DVec2::ZERO), |round| (self.place(round), self.place(round + 1)));
        let of = self.draw.part(1_000_000 + count as u64);
        let share = within / WALK_S;
        let gone = from.lerp(to, ease(share.min(1.0)));
        let offset = if round.is_some() { gone } else { DVec2::ZERO };
        let is_walking = round.is_some() && share < 1.0;
        let rise = self.spot.slope.dot(offset);
        let mut pose = Pose { pos: self.spot.pos + offset.extend(rise), ..Pose::default() };
        let (now, next) = (self.course(round), self.course(Some(round.map_or(0, |round| round + 1))));
        let turning = ease((within - (ROUND_S - 1.1)) / 1.0);
        pose.heading = turned(now, next, turning);
        if is_walking {
            let steps = from.distance(to) * ease(share) / STRIDE_M * TAU;
            let pace = (share * (1.0 - share) * 4.0).sqrt();
            pose.stride = steps.sin() * pace;
            // The head stays behind and is thrust forward, twice in two steps.
            pose.nod = (2.0 * steps).sin() * pace;
        } else {
            self.stand(&mut pose, within - if round.is_some() { WALK_S } else { 0.0 }, of);
        }
        let fold = 1.0 - ease(since / FOLD_S);
        pose.spread = fold;
        pose.beat = 0.5 * fold;
        pose.pitch += 0.45 * fold;
        pose
    }

    /// Pecks and looks about while it stands.
    fn stand(&self, pose: &mut Pose, since_s: f64, of: Draw) {
        let pecks = of.below("pecks", 4);
        for n in 0..pecks as u64 {
            let begins = 0.3 + of.part(n).between("when", 0.0, 0.35) + 0.72 * n as f64;
            let phase = (since_s - begins) / 0.5;
            if (0.0..1.0).contains(&phase) {
                pose.peck = (PI * phase).sin().powf(0.7);
            }
        }
        let look = of.between("look", -0.25, 0.25);
        pose.nod = 0.2 * (since_s * 1.7 + look * 9.0).sin() * (1.0 - pose.peck);
        pose.pitch = -0.22 * pose.peck;
    }
}

/// A flight from one stay to another: up, round the square, and down.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flight {
    pub from: DVec3,
    /// Heading with which it stands before it flies up.
    pub heading: f64,
    pub to: DVec3,
    pub start_s: f64,
    /// What it flies round.
    pub middle: DVec2,
    pub draw: Draw,
}

/// What was drawn for a flight.
struct Plan {
    radius_m: f64,
    height_m: f64,
    up_s: f64,
    down_s: f64,
    whole_s: f64,
    /// Turn a second; the sign is its sense.
    turn: f64,
    /// Angle at which it begins, counter-clockwise from east.
    angle: f64,
}

/// Speed round the square, metres a second.
const CRUISE_M_S: f64 = 8.5;
/// Wing beats a second.
const BEATS: f64 = 6.2;

impl Flight {
    fn plan(&self) -> Plan {
        let out = self.from.truncate() - self.middle;
        let radius_m = self.draw.between("radius", 11.0, 16.0);
        let turns = self.draw.between("turns", 0.9, 1.45);
        // Most of a flock wheel the same way: it is drawn for the start alone.
        let sense = if self.start_s.floor() as i64 / 3 % 2 == 0 { 1.0 } else { -1.0 };
        let (up_s, down_s) = (self.draw.between("up", 3.0, 4.0), self.draw.between("down", 4.4, 5.4));
        let round_s = TAU * turns * radius_m / CRUISE_M_S;
        Plan {
            radius_m,
            height_m: self.draw.between("height", 8.0, 14.0),
            up_s,
            down_s,
            whole_s: round_s + 0.5 * (up_s + down_s),
            turn: sense * CRUISE_M_S / radius_m,
            angle: out.y.atan2(out.x) + sense * 0.5,
        }
    }

    /// When it is over.
    pub fn end_s(&self) -> f64 {
        self.start_s + self.plan().whole_s
    }

    fn at(&self, plan: &Plan, age_s: f64) -> DVec3 {
        let age_s = age_s.clamp(0.0, plan.whole_s);
        let (up, down) = (ease(age_s / plan.up_s), ease((age_s - plan.whole_s + plan.down_s) / plan.down_s));
        let (sin, cos) = (plan.angle + plan.turn * age_s).sin_cos();
        let wheel = self.middle + DVec2::new(cos, sin) * plan.radius_m * (1.0 + 0.08 * (0.9 * age_s).sin());
        let level = self.from.truncate().lerp(wheel, up).lerp(self.to.truncate(), down);
        let ground = self.from.z + (self.to.z - self.from.z) * down;
        let bob = 0.5 * (1.3 * age_s + plan.angle).sin();
        // They spring up steeply and come down on a long slope.
        let lift = 1.0 - (1.0 - (age_s / plan.up_s).clamp(0.0, 1.0)).powf(1.6);
        level.extend(ground + (plan.height_m + bob) * lift * (1.0 - down))
    }

    /// The bird at a time, for which it must be in the air.
    pub fn pose(&self, time_s: f64) -> Pose {
        let plan = self.plan();
        let age = time_s - self.start_s;
        let (h, left) = (0.05, plan.whole_s - age);
        let (before, here, after) = (self.at(&plan, age - h), self.at(&plan, age), self.at(&plan, age + h));
        let way = (after - before) / (2.0 * h);
        let bend = (after - here * 2.0 + before) / (h * h);
        let speed = way.truncate().length();
        let heading = turned(self.heading, heading_of(way.truncate()), ease(age / 0.35));
        let right = DVec2::new(heading.cos(), -heading.sin());
        let climb = way.z.atan2(speed.max(2.0));
        // Bursts of beats, gliding between them; hard beats at both ends.
        let burst = ease(0.5 + 1.2 * (0.85 * age + self.draw.between("bursts", 0.0, TAU)).sin());
        let hard = (1.0 - ease((age - 1.6) / 1.0)).max(1.0 - ease(left / 1.5));
        let swing = 0.95 * hard.max(0.75 * burst);
        let phase = TAU * (BEATS * age + self.draw.unit("phase"));
        let flare = 1.0 - ease(left / 1.1);
        Pose {
            pos: here,
            heading,
            pitch: (0.5 * climb).clamp(-0.35, 0.6) + 0.65 * flare,
            roll: (bend.truncate().dot(right) / 9.81).atan().clamp(-0.9, 0.9) * (1.0 - flare),
            spread: ease(age / 0.16),
            beat: 0.22 + swing * phase.sin(),
            ..Pose::default()
        }
    }

    /// The heading with which it comes down.
    pub fn last_heading(&self) -> f64 {
        let plan = self.plan();
        heading_of((self.at(&plan, plan.whole_s) - self.at(&plan, plan.whole_s - 0.1)).truncate())
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::Id;

    use super::*;

    fn perch(n: u64) -> Perch {
        let spot = Spot { pos: DVec3::new(3.0, -2.0, 5.0), slope: DVec2::new(0.05, 0.0) };
        Perch { spot, draw: Draw::new(1, Id(n), "test"), since_s: 2.0, heading: 1.0 }
    }

    fn flight(n: u64) -> Flight {
        let (from, to) = (DVec3::new(3.0, -2.0, 5.0), DVec3::new(-9.0, 6.0, 4.5));
        Flight { from, to, heading: 0.3, start_s: 7.0, middle: DVec2::ZERO, draw: Draw::new(1, Id(n), "test") }
    }

    #[test]
    fn on_the_ground_birds_go_in_little_steps_and_never_jump() {
        for n in 0..20 {
            let perch = perch(n);
            let (mut last, mut walked, mut pecked) = (perch.pose(2.0), 0.0, 0);
            for step in 1..9_000 {
                let pose = perch.pose(2.0 + f64::from(step) * 0.01);
                let moved = (pose.pos - last.pos).length();
                assert!(moved < 0.012, "bird {n} goes {moved} m in a hundredth of a second at step {step}");
                let turn = (pose.heading - last.heading + PI).rem_euclid(TAU) - PI;
                assert!(turn.abs() < 0.06, "bird {n} turns {turn} at step {step}");
                let off = (pose.pos - perch.spot.pos).truncate();
                assert!(off.length() < 1.0 && (pose.pos.z - 5.0 - 0.05 * off.x).abs() < 1e-9, "it keeps to its ground");
                walked += moved;
                pecked += u32::from(pose.peck > 0.9);
                last = pose;
            }
            assert!(walked > 2.0 && pecked > 20, "bird {n} walks {walked} m and pecks {pecked}");
            assert!(last.spread == 0.0 && last.beat == 0.0, "its wings are folded");
        }
    }

    #[test]
    fn flights_begin_and_end_on_the_ground_and_go_at_a_birds_speed() {
        for n in 0..30 {
            let flight = flight(n);
            let end = flight.end_s();
            assert!((6.0..25.0).contains(&(end - flight.start_s)));
            let (first, last) = (flight.pose(flight.start_s), flight.pose(end));
            assert!((first.pos - flight.from).length() < 1e-9 && (last.pos - flight.to).length() < 1e-9);
            assert!((first.heading - flight.heading).abs() < 1e-9);
            let (mut before, mut highest) = (first, 0.0_f64);
            let steps = ((end - flight.start_s) / 0.01) as u32;
            for step in 1..=steps {
                let pose = flight.pose(flight.start_s + f64::from(step) * 0.01);
                let speed = (pose.pos - before.pos).length() / 0.01;
                assert!(speed < 22.0, "bird {n} flies {speed} m/s");
                assert!(pose.pos.z > 4.4, "bird {n} flies below the ground");
                highest = highest.max(pose.pos.z);
                before = pose;
            }
            assert!((11.0..21.0).contains(&highest), "{highest}");
        }
    }

    #[test]
    fn where_a_flight_ends_the_stay_goes_on() {
        let flight = flight(3);
        let end = flight.end_s();
        let spot = Spot { pos: flight.to, slope: DVec2::ZERO };
        let stay = Perch { spot, draw: flight.draw, since_s: end, heading: flight.last_heading() };
        let (air, ground) = (flight.pose(end - 1e-6), stay.pose(end));
        assert!((air.pos - ground.pos).length() < 1e-3);
        let turn = (air.heading - ground.heading + PI).rem_euclid(TAU) - PI;
        assert!(turn.abs() < 0.35 && ground.spread == 1.0, "{turn}");
    }
}
