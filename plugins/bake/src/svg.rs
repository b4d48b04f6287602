use core::fmt::Write;

use veduta_city::{CityPlan, GridPolygon, GridPos, SurfaceKind};

/// A plan as an SVG map, one metre to one unit, north up.
#[must_use]
pub fn map_svg(plan: &CityPlan) -> String {
    let (low, high) = plan.extent.bounds().unwrap_or_default();
    let (low, high) = (low.to_metres(), high.to_metres());
    let size = high - low;
    let mut svg = String::new();
    // Writing to a string cannot fail.
    let _ = writeln!(
        svg,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.1} {:.1} {:.1} {:.1}\">\n<title>{}</title>",
        low.x,
        -high.y,
        size.x,
        size.y,
        escape(&plan.name)
    );
    let _ = writeln!(
        svg,
        "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#e9e2d3\"/>",
        low.x, -high.y, size.x, size.y
    );
    for patch in &plan.ground {
        if let Some(ink) = ink(patch.surface) {
            path(&mut svg, &patch.outline, ink);
        }
    }
    for span in plan.spans.iter().filter(|span| !span.is_bore()) {
        if let Some(ink) = ink(span.surface) {
            path(&mut svg, &span.outline(), ink);
        }
    }
    for house in &plan.houses {
        for volume in &house.volumes {
            path(&mut svg, &volume.footprint, "#c9b094");
        }
    }
    for object in &plan.objects {
        let p = object.pos.to_metres();
        let _ = writeln!(svg, "<circle cx=\"{:.2}\" cy=\"{:.2}\" r=\"0.6\" fill=\"#5d6b4a\"/>", p.x, -p.y);
    }
    for place in plan.places.iter().filter(|p| !matches!(p.kind, veduta_city::PlaceKind::Street)) {
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"7\" font-family=\"sans-serif\" text-anchor=\"middle\" fill=\"#4a4035\">{}</text>",
            place.pos.x,
            -place.pos.y,
            escape(&place.name)
        );
    }
    svg.push_str("</svg>\n");
    svg
}

const fn ink(surface: SurfaceKind) -> Option<&'static str> {
    match surface {
        SurfaceKind::Asphalt | SurfaceKind::Cobbles => Some("#fbf8f1"),
        SurfaceKind::Mosaic | SurfaceKind::Flagstones => Some("#f3eee2"),
        SurfaceKind::Gravel => Some("#f1eada"),
        SurfaceKind::Grass => Some("#c4d3a6"),
        SurfaceKind::Water => Some("#9fc0ce"),
        SurfaceKind::Ballast => Some("#c9c4bc"),
        SurfaceKind::Yard | SurfaceKind::Opening => None,
    }
}

fn path(svg: &mut String, polygon: &GridPolygon, ink: &str) {
    svg.push_str("<path d=\"");
    for ring in polygon.rings() {
        for (i, &GridPos(x, y)) in ring.iter().enumerate() {
            let p = GridPos(x, y).to_metres();
            let _ = write!(svg, "{}{:.2} {:.2}", if i == 0 { 'M' } else { 'L' }, p.x, -p.y);
        }
        svg.push('Z');
    }
    let _ = writeln!(svg, "\" fill=\"{ink}\" fill-rule=\"evenodd\"/>");
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
