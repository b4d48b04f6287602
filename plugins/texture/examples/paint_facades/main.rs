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

use easel::Easel;

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

/// What years leave where a wall is always alike: soot under the eaves, damp at the foot. Mottling and streaks are left to whoever draws the
/// wall: they are of no use in a picture, and most of its bytes.
fn age(easel: &mut Easel, strength: f32) {
    let (_, top) = easel.size_m;
    easel.weather(move |_, y| {
        let soot = (1.0 - (top - y) / 0.9).clamp(0.0, 1.0);
        let damp = (1.0 - y / 0.6).clamp(0.0, 1.0);
        let tone = 1.0 - strength * (0.14 * soot + 0.2 * damp);
        [tone, tone * (1.0 - 0.02 * damp), tone * (1.0 - 0.05 * damp)]
    });
}
