//! Writes what is made as WAV files, and tells how loud each is and how many times faster than real time it was made on one core.
//!
//! ```sh
//! cargo run --release -p veduta-synth --example voices -- out/voices
//! ```

use std::path::PathBuf;
use std::time::Instant;

use veduta_city::{Footfall, Sound};
use veduta_synth::{voice, wav};

const RATE_HZ: u32 = 48_000;
const SECONDS: usize = 20;

fn main() -> std::io::Result<()> {
    let folder = std::env::args().nth(1).map(PathBuf::from);
    let mut sounds = vec![
        ("bell-great", Sound::Bell { strike_hz: 110.0, weight_kg: 9_000.0 }),
        ("bell-small", Sound::Bell { strike_hz: 587.0, weight_kg: 120.0 }),
        ("fountain", Sound::FOUNTAIN),
        ("river", Sound::RIVER),
        ("weir", Sound::WEIR),
        ("draught", Sound::Wind { strength: 0.1 }),
        ("wind", Sound::Wind { strength: 0.4 }),
        ("gale", Sound::Wind { strength: 1.0 }),
        ("drizzle", Sound::Rain { strength: 0.1 }),
        ("rain", Sound::Rain { strength: 0.5 }),
        ("cloudburst", Sound::Rain { strength: 1.0 }),
        ("one-voice", Sound::Murmur { people: 1 }),
        ("murmur", Sound::Murmur { people: 4 }),
        ("crowd", Sound::Murmur { people: 12 }),
        ("few-birds", Sound::Birds { calls: 14.0 }),
        ("birds", Sound::Birds { calls: 60.0 }),
        ("wing", Sound::Wings { birds: 1 }),
        ("wings", Sound::Wings { birds: 8 }),
        ("cricket", Sound::Night { crickets: 1, dog: false }),
        ("night", Sound::Night { crickets: 5, dog: true }),
    ];
    sounds.extend(Footfall::ALL.map(|on| (on.cue(), Sound::Step { on })));
    if let Some(folder) = &folder {
        std::fs::create_dir_all(folder)?;
    }
    println!("{:<16} {:>7} {:>7} {:>7} {:>9}", "voice", "s", "peak", "mean dB", "× real");
    for (name, sound) in sounds {
        let Some(mut voice) = voice(&sound, 1, RATE_HZ.into()) else { continue };
        let mut out = vec![0.0; SECONDS * RATE_HZ as usize];
        let began = Instant::now();
        let n = voice.fill(&mut out);
        let took_s = began.elapsed().as_secs_f64();
        out.truncate(n);
        let peak = out.iter().fold(0.0, |most: f32, x| most.max(x.abs()));
        let power = out.iter().map(|x| f64::from(x * x)).sum::<f64>() / n.max(1) as f64;
        let seconds = n as f64 / f64::from(RATE_HZ);
        println!("{name:<16} {seconds:>7.2} {peak:>7.3} {:>7.1} {:>9.0}", 10.0 * power.log10(), seconds / took_s);
        if let Some(folder) = &folder {
            let stereo: Vec<f32> = out.iter().flat_map(|&x| [x, x]).collect();
            std::fs::write(folder.join(format!("{name}.wav")), wav(&stereo, RATE_HZ))?;
        }
    }
    Ok(())
}
