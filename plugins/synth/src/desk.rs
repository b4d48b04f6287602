use core::f64::consts::FRAC_PI_4;

use crate::filter::share;
use crate::voice::Voice;

/// Frames that are mixed at a time: orders hold from one block to the next.
pub const BLOCK: usize = 128;
/// More channels than this never sound at once; a new one takes the place of the quietest that sounds once.
const MOST_CHANNELS: usize = 48;
/// Seconds in which a level comes two thirds of the way to what was ordered.
const GLIDE_S: f64 = 0.025;
/// The same of what is held or stopped: little of it is to be lost.
const LEAVE_S: f64 = 0.006;
/// Below this nothing is heard.
const SILENT: f64 = 3e-5;
/// No sample is louder.
const CEILING: f64 = 0.97;
/// Seconds in which the limiter gives back what it took.
const RELEASE_S: f64 = 0.4;
/// No sound is later than this: what is heard from farther away is not heard.
const LATEST_S: f64 = 30.0;

/// Name of a channel, chosen by whoever orders it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ChannelId(
    /// Any number.
    pub u64,
);

/// How a channel is heard.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Levels {
    /// Factor of its samples, 0 and up.
    pub gain: f32,
    /// From the left, −1, to the right, 1.
    pub pan: f32,
    /// Above this frequency it is dulled, hertz.
    pub cutoff_hz: f32,
}

impl Levels {
    /// Not heard.
    pub const SILENT: Self = Self { gain: 0.0, pan: 0.0, cutoff_hz: 20_000.0 };

    /// The same with numbers that do no harm.
    fn sound(self) -> Self {
        let within = |x: f32, least: f32, most: f32, otherwise: f32| if x.is_finite() { x.clamp(least, most) } else { otherwise };
        Self {
            gain: within(self.gain, 0.0, 16.0, 0.0),
            pan: within(self.pan, -1.0, 1.0, 0.0),
            cutoff_hz: within(self.cutoff_hz, 20.0, 20_000.0, 20_000.0),
        }
    }
}

/// What the desk is told to do.
pub enum Order {
    /// Opens a channel.
    Start {
        /// Its name; one of that name that sounds already is stopped.
        id: ChannelId,
        /// Its sound.
        voice: Box<dyn Voice>,
        /// How it is heard from the first.
        levels: Levels,
        /// Seconds until it begins.
        delay_s: f32,
        /// Whether it ends by itself: then it goes on though nothing is heard of it. Else it rests meanwhile.
        is_once: bool,
    },
    /// Changes how a channel is heard.
    Set(ChannelId, Levels),
    /// Lets a channel stand still, in silence, or go on.
    Hold(ChannelId, bool),
    /// Lets a channel fade, and closes it.
    Stop(ChannelId),
    /// Factor of all that is heard.
    Master(f32),
}

struct Channel {
    id: ChannelId,
    voice: Box<dyn Voice>,
    wanted: Levels,
    left: f64,
    right: f64,
    cutoff_hz: f64,
    low: [f64; 2],
    delay: usize,
    is_once: bool,
    is_held: bool,
    is_leaving: bool,
    is_over: bool,
}

impl Channel {
    /// What is heard on the left and on the right by order.
    fn goal(&self) -> (f64, f64) {
        if self.is_held || self.is_leaving {
            return (0.0, 0.0);
        }
        pan(self.wanted)
    }

    fn loudness(&self) -> f64 {
        self.left.max(self.right)
    }
}

/// Gains on the left and on the right: of one power wherever it comes from.
fn pan(levels: Levels) -> (f64, f64) {
    let angle = (f64::from(levels.pan) + 1.0) * FRAC_PI_4;
    (f64::from(levels.gain) * libm::cos(angle), f64::from(levels.gain) * libm::sin(angle))
}

/// A mixing desk: voices on channels, each with gain, place and dullness, to stereo that never clips.
///
/// ```
/// use veduta_city::Sound;
/// use veduta_synth::{ChannelId, Desk, Levels, Order, voice};
/// let mut desk = Desk::new(48_000);
/// let voice = voice(&Sound::FOUNTAIN, 1, desk.rate_hz().into()).expect("it is made");
/// let levels = Levels { gain: 1.0, pan: -0.5, cutoff_hz: 8_000.0 };
/// desk.obey(Order::Start { id: ChannelId(1), voice, levels, delay_s: 0.0, is_once: false });
/// let mut stereo = vec![0.0; 2 * 48_000];
/// desk.fill(&mut stereo);
/// assert!(stereo.iter().any(|x| x.abs() > 0.05));
/// ```
pub struct Desk {
    rate_hz: u32,
    channels: Vec<Channel>,
    master: f64,
    wanted_master: f64,
    /// The block that is mixed and waits for the next one to be known, so that the limiter sees it coming.
    ahead: [f64; 2 * BLOCK],
    /// The block that is given out, and how much of it is left.
    ready: [f32; 2 * BLOCK],
    left: usize,
    limit: f64,
    need_ahead: f64,
}

impl Desk {
    /// A desk without channels for so many frames a second, 8,000 to 192,000.
    #[must_use]
    pub fn new(rate_hz: u32) -> Self {
        Self {
            rate_hz: rate_hz.clamp(8_000, 192_000),
            channels: Vec::new(),
            master: 1.0,
            wanted_master: 1.0,
            ahead: [0.0; 2 * BLOCK],
            ready: [0.0; 2 * BLOCK],
            left: 0,
            limit: 1.0,
            need_ahead: 1.0,
        }
    }

    /// Frames a second.
    #[must_use]
    pub fn rate_hz(&self) -> u32 {
        self.rate_hz
    }

    /// How many channels are open.
    #[must_use]
    pub fn channels(&self) -> usize {
        self.channels.len()
    }

    /// Does as it is told; what names no open channel is passed over.
    pub fn obey(&mut self, order: Order) {
        let mut on = |id: ChannelId, change: &dyn Fn(&mut Channel)| {
            self.channels.iter_mut().filter(|channel| channel.id == id && !channel.is_leaving).for_each(change);
        };
        match order {
            Order::Set(id, levels) => on(id, &|channel| channel.wanted = levels.sound()),
            Order::Hold(id, is_held) => on(id, &|channel| channel.is_held = is_held),
            Order::Stop(id) => on(id, &|channel| channel.is_leaving = true),
            Order::Master(gain) => self.wanted_master = if gain.is_finite() { f64::from(gain.clamp(0.0, 16.0)) } else { 0.0 },
            Order::Start { id, voice, levels, delay_s, is_once } => {
                on(id, &|channel| channel.is_leaving = true);
                self.make_room();
                let wanted = levels.sound();
                let (left, right) = pan(wanted);
                let delay_s = f64::from(delay_s);
                let delay_s = if delay_s.is_finite() { delay_s.clamp(0.0, LATEST_S) } else { 0.0 };
                self.channels.push(Channel {
                    id,
                    voice,
                    wanted,
                    left,
                    right,
                    cutoff_hz: wanted.cutoff_hz.into(),
                    low: [0.0; 2],
                    delay: (delay_s * f64::from(self.rate_hz)) as usize,
                    is_once,
                    is_held: false,
                    is_leaving: false,
                    is_over: false,
                });
            }
        }
    }

    /// Takes the quietest of the channels that sound once away if all are taken; else the first.
    fn make_room(&mut self) {
        if self.channels.len() < MOST_CHANNELS {
            return;
        }
        let ranked = |channel: &Channel| (!channel.is_once, channel.loudness());
        let quietest = (0..self.channels.len()).min_by(|&a, &b| {
            let (a, b) = (ranked(&self.channels[a]), ranked(&self.channels[b]));
            a.0.cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        if let Some(quietest) = quietest {
            self.channels.remove(quietest);
        }
    }

    /// Fills with interleaved stereo that follows, left first; of an odd length the last is left as it was.
    pub fn fill(&mut self, stereo: &mut [f32]) {
        let mut rest = stereo;
        loop {
            let n = (rest.len() / 2 * 2).min(self.left);
            let from = 2 * BLOCK - self.left;
            let (now, later) = rest.split_at_mut(n);
            now.copy_from_slice(&self.ready[from..from + n]);
            self.left -= n;
            rest = later;
            if rest.len() < 2 {
                return;
            }
            self.next_block();
        }
    }

    /// Mixes a block, and makes the one before it ready.
    fn next_block(&mut self) {
        let mut mixed = [0.0; 2 * BLOCK];
        let rate_hz = f64::from(self.rate_hz);
        let share_in = |seconds: f64| 1.0 - libm::exp(-(BLOCK as f64) / (seconds * rate_hz));
        let (glide, leave) = (share_in(GLIDE_S), share_in(LEAVE_S));
        for channel in &mut self.channels {
            let leaves = channel.is_held || channel.is_leaving;
            add(channel, &mut mixed, if leaves { leave } else { glide }, rate_hz);
        }
        self.channels.retain(|channel| !channel.is_over);
        let before = self.master;
        self.master += (self.wanted_master - self.master) * glide;
        for (n, frame) in mixed.chunks_exact_mut(2).enumerate() {
            let master = before + (self.master - before) * (n + 1) as f64 / BLOCK as f64;
            frame.iter_mut().for_each(|x| *x *= master);
        }
        let peak = mixed.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let need = if peak > CEILING { CEILING / peak } else { 1.0 };
        // Within the block that is given out, the gain goes in a line to what both it and the next allow.
        let release = BLOCK as f64 / (RELEASE_S * rate_hz);
        let goal = self.need_ahead.min(need).min(self.limit + release);
        for (n, (frame, ready)) in self.ahead.chunks_exact(2).zip(self.ready.chunks_exact_mut(2)).enumerate() {
            let limit = self.limit + (goal - self.limit) * (n + 1) as f64 / BLOCK as f64;
            for (x, ready) in frame.iter().zip(ready) {
                *ready = (x * limit) as f32;
            }
        }
        (self.limit, self.need_ahead, self.ahead, self.left) = (goal, need, mixed, 2 * BLOCK);
    }
}

/// Adds a block of a channel to the mix.
fn add(channel: &mut Channel, mixed: &mut [f64; 2 * BLOCK], glide: f64, rate_hz: f64) {
    let (goal_left, goal_right) = channel.goal();
    let is_silent = channel.loudness().max(goal_left).max(goal_right) < SILENT;
    if is_silent && channel.is_leaving {
        channel.is_over = true;
    }
    if channel.is_over || is_silent && (channel.is_held || !channel.is_once) {
        (channel.left, channel.right) = (goal_left, goal_right);
        return;
    }
    let late = channel.delay.min(BLOCK);
    channel.delay -= late;
    let mut samples = [0.0_f32; BLOCK];
    let asked = BLOCK - late;
    if asked > 0 && channel.voice.fill(&mut samples[late..]) < asked {
        channel.is_over = true;
    }
    // Ears hear pitches by their ratios: so glides what is dulled.
    let ratio = f64::from(channel.wanted.cutoff_hz) / channel.cutoff_hz;
    channel.cutoff_hz *= libm::pow(ratio, glide);
    let a = if channel.cutoff_hz > 18_000.0 { 1.0 } else { share(channel.cutoff_hz, rate_hz) };
    let (left, right) = (channel.left, channel.right);
    channel.left += (goal_left - left) * glide;
    channel.right += (goal_right - right) * glide;
    let (step_left, step_right) = ((channel.left - left) / BLOCK as f64, (channel.right - right) / BLOCK as f64);
    for (n, (frame, x)) in mixed.chunks_exact_mut(2).zip(samples).enumerate() {
        let x = if x.is_finite() { f64::from(x) } else { 0.0 };
        channel.low[0] += a * (x - channel.low[0]);
        channel.low[1] += a * (channel.low[0] - channel.low[1]);
        let n = (n + 1) as f64;
        frame[0] += channel.low[1] * (left + step_left * n);
        frame[1] += channel.low[1] * (right + step_right * n);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::{peak, rms, share_between};

    /// A sine for so many samples, or for ever.
    struct Sine(u64, Option<u64>, f64);

    impl Voice for Sine {
        fn fill(&mut self, out: &mut [f32]) -> usize {
            for (n, slot) in out.iter_mut().enumerate() {
                if self.1.is_some_and(|end| self.0 >= end) {
                    return n;
                }
                *slot = (0.5 * libm::sin(self.0 as f64 * self.2)) as f32;
                self.0 += 1;
            }
            out.len()
        }
    }

    fn start(desk: &mut Desk, id: u64, levels: Levels, delay_s: f32, length: Option<u64>) {
        let voice = Box::new(Sine(0, length, 0.0628));
        desk.obey(Order::Start { id: ChannelId(id), voice, levels, delay_s, is_once: length.is_some() });
    }

    const FULL: Levels = Levels { gain: 1.0, pan: 0.0, cutoff_hz: 20_000.0 };

    fn frames(desk: &mut Desk, count: usize) -> (Vec<f32>, Vec<f32>) {
        let mut out = vec![0.0; 2 * count];
        desk.fill(&mut out);
        (out.iter().step_by(2).copied().collect(), out.iter().skip(1).step_by(2).copied().collect())
    }

    #[test]
    fn a_place_is_a_ratio_of_gains() {
        for (pan, left, right) in [(-1.0, 0.5, 0.0), (0.0, 0.354, 0.354), (1.0, 0.0, 0.5)] {
            let mut desk = Desk::new(48_000);
            start(&mut desk, 1, Levels { pan, ..FULL }, 0.0, None);
            let (l, r) = frames(&mut desk, 4_800);
            assert!((peak(&l) - left).abs() < 0.005 && (peak(&r) - right).abs() < 0.005, "{pan}: {} {}", peak(&l), peak(&r));
        }
    }

    #[test]
    fn pieces_of_any_size_are_the_same_mix() {
        let mut whole = Desk::new(48_000);
        let mut pieces = Desk::new(48_000);
        for desk in [&mut whole, &mut pieces] {
            start(desk, 1, FULL, 0.01, None);
        }
        let (left, _) = frames(&mut whole, 3_000);
        let parts: Vec<f32> = [1, 500, 7, 128, 2_000, 364].iter().flat_map(|&n| frames(&mut pieces, n).0).collect();
        assert_eq!(left, parts);
    }

    #[test]
    fn nothing_clips_however_much_sounds_and_quiet_things_are_left_alone() {
        let mut desk = Desk::new(48_000);
        for id in 0..40 {
            start(&mut desk, id, FULL, 0.0, None);
        }
        let (left, right) = frames(&mut desk, 48_000);
        assert!(peak(&left) <= 0.9701 && peak(&right) <= 0.9701, "{}", peak(&left));
        assert!(rms(&left) > 0.2);
        let mut desk = Desk::new(48_000);
        start(&mut desk, 1, FULL, 0.0, None);
        let (left, _) = frames(&mut desk, 4_800);
        let expected = 0.5 * core::f64::consts::FRAC_1_SQRT_2 * libm::sin(0.0628 * 1_000.0);
        assert!((f64::from(left[1_000 + BLOCK]) - expected).abs() < 1e-6, "one block late and otherwise as it is");
    }

    #[test]
    fn levels_glide_without_a_click() {
        let mut desk = Desk::new(48_000);
        start(&mut desk, 1, Levels { pan: -1.0, ..FULL }, 0.0, None);
        let mut out = frames(&mut desk, 4_800).0;
        for order in [
            Order::Set(ChannelId(1), Levels::SILENT),
            Order::Set(ChannelId(1), FULL),
            Order::Hold(ChannelId(1), true),
            Order::Hold(ChannelId(1), false),
            Order::Master(0.1),
            Order::Stop(ChannelId(1)),
        ] {
            desk.obey(order);
            out.extend(frames(&mut desk, 9_600).0);
        }
        // A sine of 0.0628 a sample at 0.5 moves at most 0.0314 a sample.
        let jump = out.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f32::max);
        assert!(jump < 0.036, "{jump}");
        assert_eq!(desk.channels(), 0, "what is stopped is closed");
        assert_eq!(frames(&mut desk, 4_800).0[BLOCK..], [0.0; 4_800 - BLOCK]);
    }

    #[test]
    fn what_is_held_goes_on_where_it_was() {
        let mut desk = Desk::new(48_000);
        let voice = Box::new(Sine(0, Some(4_800), 0.0628));
        desk.obey(Order::Start { id: ChannelId(1), voice, levels: FULL, delay_s: 0.0, is_once: true });
        frames(&mut desk, 1_000);
        desk.obey(Order::Hold(ChannelId(1), true));
        frames(&mut desk, 200_000);
        assert_eq!(desk.channels(), 1, "it has not run out meanwhile");
        desk.obey(Order::Hold(ChannelId(1), false));
        frames(&mut desk, 200_000);
        assert_eq!(desk.channels(), 0);
    }

    #[test]
    fn sound_is_late_by_its_delay_and_dull_by_its_cutoff() {
        let mut desk = Desk::new(48_000);
        start(&mut desk, 1, FULL, 0.1, Some(9_600));
        let (left, _) = frames(&mut desk, 24_000);
        let first = left.iter().position(|x| x.abs() > 1e-4).expect("it sounds");
        assert!((4_800..4_800 + 2 * BLOCK + 8).contains(&first), "{first}");
        let noise = |cutoff_hz| {
            let mut desk = Desk::new(32_768);
            let voice = crate::voice(&veduta_city::Sound::Rain { strength: 0.6 }, 1, 32_768.0).expect("it is made");
            desk.obey(Order::Start { id: ChannelId(1), voice, levels: Levels { cutoff_hz, ..FULL }, delay_s: 0.0, is_once: false });
            share_between(&frames(&mut desk, 32_768).0, (2_000.0, 16_000.0), 32_768.0)
        };
        assert!(noise(20_000.0) > 0.6 && noise(400.0) < 0.1, "{} {}", noise(20_000.0), noise(400.0));
    }

    #[test]
    fn when_all_channels_are_taken_the_quietest_makes_room() {
        let mut desk = Desk::new(48_000);
        start(&mut desk, 1_000, FULL, 0.0, None);
        for id in 0..500 {
            start(&mut desk, id, FULL, 0.0, Some(u64::MAX));
        }
        assert_eq!(desk.channels(), MOST_CHANNELS);
        assert!(desk.channels.iter().any(|channel| channel.id == ChannelId(1_000)), "what is always there stays");
    }

    #[test]
    fn numbers_that_are_none_do_no_harm() {
        let mut desk = Desk::new(0);
        let bad = Levels { gain: f32::NAN, pan: f32::INFINITY, cutoff_hz: -1.0 };
        start(&mut desk, 1, bad, f32::NAN, None);
        desk.obey(Order::Set(ChannelId(1), Levels { gain: f32::INFINITY, ..bad }));
        desk.obey(Order::Master(f32::NAN));
        desk.obey(Order::Set(ChannelId(99), FULL));
        assert!(frames(&mut desk, 1_000).0.iter().all(|x| x.is_finite()));
        let mut odd = [7.0; 3];
        desk.fill(&mut odd);
        assert_eq!(odd[2], 7.0);
    }
}
