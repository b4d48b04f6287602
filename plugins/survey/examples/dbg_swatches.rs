//! Debug.
use veduta_survey::raster::*;
fn main() {
    for f in std::env::args().skip(1) {
        let b = std::fs::read(&f).unwrap();
        let t = std::time::Instant::now();
        let p = match Picture::decode(&b, &f, &PictureLimits::default()) { Ok(p) => p, Err(e) => { println!("{e}"); continue } };
        let d = t.elapsed();
        let t = std::time::Instant::now();
        let s = swatches(&p, None);
        println!("{f} {}x{} decode {d:?} swatches {:?}", p.width, p.height, t.elapsed());
        for s in s { println!("   {:?} {:.2}%", s.colour, 100.0 * s.share); }
    }
}
