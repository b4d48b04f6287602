//! Time against pixels, drawn as SVG with both axes logarithmic.

use core::fmt::Write;

use super::Timed;
use super::figures::Kind;
use super::programs::Reader;

/// Size of the picture and its margins, in its own units.
const SIZE: (f64, f64) = (640.0, 400.0);
const MARGIN: (f64, f64) = (70.0, 45.0);

/// A value's place between two others on a logarithmic axis, 0 to 1.
fn share(value: f64, low: f64, high: f64) -> f64 {
    if high > low { (value / low).ln() / (high / low).ln() } else { 0.5 }
}

/// The plot of all runs.
pub(super) fn svg(timed: &[Timed]) -> String {
    let sizes: Vec<f64> = timed.iter().map(|row| f64::from(row.map.size)).collect();
    let totals = timed.iter().flat_map(|row| Reader::ALL.map(|reader| row.total(reader) * 1e3)).filter(|ms| *ms > 0.0);
    let (low, high) = totals.fold((f64::MAX, f64::MIN), |(low, high), ms| (low.min(ms), high.max(ms)));
    let (low, high) = (10f64.powf(low.log10().floor()), 10f64.powf(high.log10().ceil()));
    let (least, most) = sizes.iter().fold((f64::MAX, f64::MIN), |(least, most), &size| (least.min(size), most.max(size)));
    let x = |size: f64| MARGIN.0 + share(size, least, most) * (SIZE.0 - 2.0 * MARGIN.0);
    let y = |ms: f64| SIZE.1 - MARGIN.1 - share(ms, low, high) * (SIZE.1 - 2.0 * MARGIN.1);
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <title>Time from a decoded picture to its city graph</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>",
        SIZE.0, SIZE.1
    );
    let mut ms = low;
    while ms <= high * 1.001 {
        let _ = writeln!(
            svg,
            "<path d=\"M{:.1} {y:.1}H{:.1}\" stroke=\"#ddd\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{ms} ms</text>",
            MARGIN.0,
            SIZE.0 - MARGIN.0,
            MARGIN.0 - 6.0,
            y(ms) + 4.0,
            y = y(ms)
        );
        ms *= 10.0;
    }
    let mut marks: Vec<u32> = timed.iter().map(|row| row.map.size).collect();
    marks.sort_unstable();
    marks.dedup();
    for size in marks {
        let at = x(f64::from(size));
        let _ = writeln!(svg, "<text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{size}² px</text>", SIZE.1 - MARGIN.1 + 20.0);
    }
    for (kind, reader, ink, dash) in [
        (Kind::Plain, Reader::Veduta, "#a5432a", "none"),
        (Kind::Hard, Reader::Veduta, "#a5432a", "6 4"),
        (Kind::Plain, Reader::Peer, "#4a6078", "none"),
        (Kind::Hard, Reader::Peer, "#4a6078", "6 4"),
    ] {
        let points: Vec<(f64, f64)> = timed
            .iter()
            .filter(|row| row.map.kind == kind)
            .map(|row| (x(f64::from(row.map.size)), y(row.total(reader) * 1e3)))
            .collect();
        let Some(&(end_x, end_y)) = points.last() else { continue };
        let line: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{ink}\" stroke-width=\"2\" stroke-dasharray=\"{dash}\"/>",
            line.join(" ")
        );
        let shift = if kind == Kind::Hard { -8.0 } else { 16.0 };
        let _ = writeln!(
            svg,
            "<text x=\"{end_x:.1}\" y=\"{:.1}\" text-anchor=\"end\" fill=\"{ink}\">{reader}, {kind}</text>",
            end_y + shift
        );
    }
    svg.push_str("</svg>\n");
    svg
}
