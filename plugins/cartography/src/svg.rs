//! A drawing as SVG 1.1: shapes as paths, names as text, those along streets as text on paths, so that it can be searched and set in
//! other letters.

use core::fmt::Write;

use glam::DVec2;

use crate::drawing::{Align, Baseline, Drawing, Group, Item, Stroke, Text};

/// What letters are set in: the font of PNGs first, and what is near to it.
const FAMILY: &str = "Ubuntu, 'Noto Sans', 'DejaVu Sans', sans-serif";

/// The drawing as an SVG document in millimetres.
#[must_use]
pub fn to_svg(drawing: &Drawing) -> String {
    let mut writer = Writer { svg: String::new(), paths: 0 };
    let size = drawing.size_mm;
    let out = &mut writer.svg;
    // Writing to a string cannot fail.
    let _ = writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>");
    let (width, height) = (number(size.x), number(size.y));
    let _ = writeln!(
        out,
        "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" version=\"1.1\" width=\"{width}mm\" \
         height=\"{height}mm\" viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILY}\">"
    );
    let _ = writeln!(out, "<title>{}</title>", escape(&drawing.title));
    if !drawing.credit.is_empty() {
        let _ = writeln!(out, "<desc>{}</desc>", escape(&drawing.credit));
    }
    let _ = writeln!(out, "<rect width=\"{width}\" height=\"{height}\" fill=\"{}\"/>", drawing.paper);
    for (n, group) in drawing.groups.iter().enumerate().filter(|(_, group)| !group.items.is_empty()) {
        writer.group(n, group);
    }
    writer.svg.push_str("</svg>\n");
    writer.svg
}

struct Writer {
    svg: String,
    paths: usize,
}

impl Writer {
    fn group(&mut self, n: usize, group: &Group) {
        let mut clip = String::new();
        if let Some(area) = group.clip {
            let (at, size) = (area.min, area.size());
            let _ = writeln!(
                self.svg,
                "<clipPath id=\"clip{n}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath>",
                number(at.x),
                number(at.y),
                number(size.x),
                number(size.y)
            );
            clip = format!(" clip-path=\"url(#clip{n})\"");
        }
        let _ = writeln!(self.svg, "<g id=\"{}\"{clip}>", group.name);
        for item in &group.items {
            self.item(item);
        }
        self.svg.push_str("</g>\n");
    }

    fn item(&mut self, item: &Item) {
        match item {
            Item::Area { rings, fill, edge } => {
                self.svg.push_str("<path d=\"");
                rings.iter().for_each(|ring| self.line(ring, true));
                let fill = fill.map_or_else(|| "none".to_owned(), |fill| fill.to_string());
                let rule = if rings.len() > 1 { " fill-rule=\"evenodd\"" } else { "" };
                let edge = edge.as_ref().map(pen).unwrap_or_default();
                let _ = writeln!(self.svg, "\" fill=\"{fill}\"{rule}{edge}/>");
            }
            Item::Line { points, stroke } => {
                self.svg.push_str("<path d=\"");
                self.line(points, false);
                let _ = writeln!(self.svg, "\" fill=\"none\"{}/>", pen(stroke));
            }
            Item::Text(text) => self.text(text),
        }
    }

    fn line(&mut self, points: &[DVec2], is_closed: bool) {
        for (i, p) in points.iter().enumerate() {
            let _ = write!(self.svg, "{}{} {}", if i == 0 { "M" } else { "L" }, number(p.x), number(p.y));
        }
        if is_closed {
            self.svg.push('Z');
        }
    }

    fn text(&mut self, text: &Text) {
        let mut style = format!(" font-size=\"{}\"", number(text.size));
        if text.is_slanted {
            style.push_str(" font-style=\"italic\"");
        }
        if text.weight > 0.045 {
            style.push_str(" font-weight=\"500\"");
        }
        if text.spacing > 0.0 {
            let _ = write!(style, " letter-spacing=\"{}\"", number(text.spacing * text.size));
        }
        let words = escape(&text.words);
        let (place, body) = match &text.on {
            Baseline::At(at, align) => {
                let anchor = match align {
                    Align::Start => "start",
                    Align::Middle => "middle",
                    Align::End => "end",
                };
                (format!(" x=\"{}\" y=\"{}\" text-anchor=\"{anchor}\"", number(at.x), number(at.y)), words)
            }
            Baseline::Along(line) => {
                self.paths += 1;
                let id = self.paths;
                let _ = write!(self.svg, "<path id=\"p{id}\" fill=\"none\" d=\"");
                self.line(line, false);
                self.svg.push_str("\"/>\n");
                let body = format!("<textPath xlink:href=\"#p{id}\" startOffset=\"50%\">{words}</textPath>");
                (" text-anchor=\"middle\"".to_owned(), body)
            }
        };
        // Two texts rather than `paint-order`, which not every program knows.
        if let Some((ink, width)) = text.halo {
            let width = number(width * 2.0);
            let _ = writeln!(
                self.svg,
                "<text{place}{style} fill=\"{ink}\" stroke=\"{ink}\" stroke-width=\"{width}\" stroke-linejoin=\"round\" \
                 aria-hidden=\"true\">{body}</text>"
            );
        }
        let _ = writeln!(self.svg, "<text{place}{style} fill=\"{}\">{body}</text>", text.ink);
    }
}

fn pen(stroke: &Stroke) -> String {
    let mut pen = format!(" stroke=\"{}\" stroke-width=\"{}\"", stroke.ink, number(stroke.width));
    if !stroke.dashes.is_empty() {
        let dashes: Vec<String> = stroke.dashes.iter().map(|&dash| number(dash)).collect();
        let _ = write!(pen, " stroke-dasharray=\"{}\"", dashes.join(" "));
    }
    if stroke.is_round {
        pen.push_str(" stroke-linecap=\"round\" stroke-linejoin=\"round\"");
    }
    pen
}

/// A length to hundredths of a millimetre, as short as it can be written.
fn number(value: f64) -> String {
    let hundredths = if value.is_finite() { libm::round(value * 100.0).clamp(-1e12, 1e12) as i64 } else { 0 };
    let sign = if hundredths < 0 { "-" } else { "" };
    let (whole, rest) = (hundredths.unsigned_abs() / 100, hundredths.unsigned_abs() % 100);
    match rest {
        0 => format!("{sign}{whole}"),
        tenths if tenths % 10 == 0 => format!("{sign}{whole}.{}", tenths / 10),
        _ => format!("{sign}{whole}.{rest:02}"),
    }
}

/// Text as XML has it; what no XML may hold is left out.
fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' | '\r' | '\t' => escaped.push(' '),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => {}
            letter => escaped.push(letter),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use veduta_city::Rgb;

    use super::*;

    #[test]
    fn numbers_are_short() {
        let written = [0.0, -0.001, 1.0, 2.5, -3.25, 1e20, f64::NAN].map(number);
        assert_eq!(written, ["0", "0", "1", "2.5", "-3.25", "10000000000", "0"]);
    }

    #[test]
    fn names_are_escaped_and_the_document_is_well_formed() {
        let odd = "U & <\"Černých\" řek> \u{1}'";
        let at = Text { halo: Some((Rgb(255, 255, 255), 0.3)), ..Text::plain(odd, 2.0, Rgb(0, 0, 0), DVec2::ONE, Align::Middle) };
        let along = Text { on: Baseline::Along(vec![DVec2::ZERO, DVec2::X]), ..at.clone() };
        let items = vec![Item::Text(at), Item::Text(along)];
        let groups = vec![Group { name: "names", clip: Some(crate::Area::default()), items }];
        let drawing = Drawing { size_mm: DVec2::splat(10.0), title: odd.into(), credit: odd.into(), groups, ..Drawing::default() };
        let svg = to_svg(&drawing);
        let mut reader = quick_xml::Reader::from_str(&svg);
        let mut told = Vec::new();
        loop {
            match reader.read_event().expect("well formed") {
                quick_xml::events::Event::Text(text) => told.push(text.into_inner().trim().to_owned()),
                quick_xml::events::Event::GeneralRef(entity) => {
                    told.push(format!("&{};", entity.into_inner()));
                }
                quick_xml::events::Event::Eof => break,
                _ => {}
            }
        }
        let told = told.concat();
        assert_eq!(told.matches("Černých").count(), 6, "title, credit, twice two names: {told}");
        assert!(told.contains("U&amp;&lt;&quot;Černých&quot;řek&gt;'"), "{told}");
    }
}
