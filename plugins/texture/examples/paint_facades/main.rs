//! Paints the pictures of the sample city's painted houses, 2048 pixels on the longer side, as PNG:
//!
//! ```sh
//! cargo run --release -p veduta-texture --example paint_facades -- scenes/old_prague/facades
//! ```
//! The descriptions that cut them (`*.facade.ron`) lie beside them and are written by hand.

mod easel;
mod joinery;
mod minute;
mod snake;
mod storch;

use std::path::PathBuf;

use easel::{Easel, noise};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(std::env::args().nth(1).ok_or("which folder are the pictures to go to?")?);
    std::fs::create_dir_all(&folder)?;
    for (name, easel) in [("minute", minute::paint()), ("storch", storch::paint()), ("snake", snake::paint())] {
        let path = folder.join(format!("{name}.jpg"));
        let (width, height) = (easel.pixmap.width(), easel.pixmap.height());
        let mut stored = Vec::new();
        let encoder = jpeg_encoder::Encoder::new(&mut stored, 88);
        encoder.encode(&easel.bytes(), width as u16, height as u16, jpeg_encoder::ColorType::Rgb)?;
        std::fs::write(&path, &stored)?;
        println!("{}: {width} × {height}, {} kB", path.display(), stored.len() / 1000);
    }
    Ok(())
}

/// Years on a wall: mottling, streaks from sills, soot under the eaves, splashes at the foot.
fn age(easel: &mut Easel, sills: &[(f32, f32, f32)], strength: f32) {
    let (_, top) = easel.size_m;
    let sills = sills.to_vec();
    easel.weather(move |x, y| {
        let mottle = 0.5 * noise(x * 0.7, y * 0.5) + 0.3 * noise(x * 2.1 + 9.0, y * 1.7) + 0.2 * noise(x * 6.3, y * 5.1 + 4.0);
        let mut tone = 1.0 + strength * 0.34 * (mottle - 0.5);
        let streak = noise(x * 4.1, y * 0.25) * noise(x * 11.0, y * 0.4 + 3.0);
        tone -= strength * 0.18 * (streak - 0.3).max(0.0);
        for &(left, right, sill) in &sills {
            if x > left - 0.15 && x < right + 0.15 && y < sill && y > sill - 1.6 {
                let fade = (1.0 - (sill - y) / 1.6) * noise(x * 9.0, y * 0.6 + sill);
                tone -= strength * 0.16 * fade;
            }
        }
        tone -= strength * 0.16 * (1.0 - (top - y) / 0.9).clamp(0.0, 1.0);
        let damp = ((0.3 + 0.5 * noise(x * 0.9, 1.0) - y) / 0.5).clamp(0.0, 1.0);
        tone -= strength * 0.25 * damp;
        tone += 0.035 * (noise(x * 60.0, y * 60.0) - 0.5);
        [tone, tone * (1.0 - 0.02 * damp), tone * (1.0 - 0.05 * damp)]
    });
}
