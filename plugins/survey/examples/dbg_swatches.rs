//! Debug.
use veduta_survey::raster::*;
fn main() {
    for f in std::env::args().skip(1) {
        let b = std::fs::read(&f).unwrap();
        let p = match Picture::decode(&b, &f, &PictureLimits::default()) { Ok(p) => p, Err(e) => { println!("{e}"); continue } };
        let t = std::time::Instant::now();
        let g = guess(&p, None);
        println!("{f} {:?} outlined {}", t.elapsed(), g.is_outlined);
        for c in &g.legend.colours { println!("   {:?} {:?}", c.colour, c.class); }
        for c in &g.findings { println!("   - {c}"); }
    }
}
