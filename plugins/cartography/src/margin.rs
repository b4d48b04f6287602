//! What stands about a map: title, scale, north, legend, index, and whom to credit.

use glam::DVec2;

use crate::body::sign;
use crate::drawing::{Align, Group, Item, Stroke, Text};
use crate::gazette::{Entry, Fields};
use crate::{Area, Inks, Letters, MapWords, Sheet, Symbol};

/// How a margin is written.
pub(crate) struct Margin<'a> {
    pub sheet: Sheet,
    pub inks: &'a Inks,
    pub words: &'a MapWords,
    pub letters: &'a Letters,
}

/// Something that a legend explains.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Key {
    House,
    Notable,
    Monument,
    Park,
    Water,
    Railway,
    Steps,
    Arcade,
    Sign(Symbol),
    Led,
    Tour,
    Trail,
}

impl Key {
    const fn message(self) -> &'static str {
        match self {
            Self::House => "legend-house-any",
            Self::Notable => "legend-notable",
            Self::Monument => "legend-monument",
            Self::Park => "legend-park",
            Self::Water => "legend-water",
            Self::Railway => "legend-railway",
            Self::Steps => "legend-steps",
            Self::Arcade => "legend-arcade",
            Self::Sign(symbol) => symbol.message(),
            Self::Led => "legend-led",
            Self::Tour => "legend-tour",
            Self::Trail => "legend-trail",
        }
    }
}

/// Sizes of letters, millimetres.
const TITLE_MM: f64 = 6.2;
const TEXT_MM: f64 = 2.3;
const SMALL_MM: f64 = 1.8;
const INDEX_MM: f64 = 1.95;

impl Margin<'_> {
    fn text(&self, words: impl Into<String>, size: f64, at: DVec2, align: Align) -> Text {
        Text::plain(words, size, self.inks.name, at, align)
    }

    /// The frame and, with an index, the letters and numbers of its fields.
    pub fn frame(&self, fields: Option<&Fields>) -> [Group; 2] {
        let map = self.sheet.map;
        let mut grid = Group::new("grid", Some(map));
        let mut frame = Group::new("frame", None);
        if let Some(fields) = fields {
            let (size, ink) = (fields.size(), self.inks.stone);
            let mut line = |a: DVec2, b: DVec2| {
                let stroke = Stroke { dashes: vec![0.6, 0.9], ..Stroke::plain(ink, 0.09) };
                grid.items.push(Item::Line { points: vec![a, b], stroke });
            };
            for column in 1..fields.count.0 {
                let x = map.min.x + size.x * f64::from(column);
                line(DVec2::new(x, map.min.y), DVec2::new(x, map.max.y));
            }
            for row in 1..fields.count.1 {
                let y = map.min.y + size.y * f64::from(row);
                line(DVec2::new(map.min.x, y), DVec2::new(map.max.x, y));
            }
            for column in 0..fields.count.0 {
                let x = map.min.x + size.x * (f64::from(column) + 0.5);
                let letter = Fields::letter(column).to_string();
                for y in [map.min.y - 1.2, map.max.y + 3.0] {
                    frame.items.push(Item::Text(self.text(letter.clone(), TEXT_MM, DVec2::new(x, y), Align::Middle).bold()));
                }
            }
            for row in 0..fields.count.1 {
                let y = map.min.y + size.y * (f64::from(row) + 0.5) + TEXT_MM * 0.35;
                let number = (row + 1).to_string();
                for (x, align) in [(map.min.x - 1.2, Align::End), (map.max.x + 1.0, Align::Start)] {
                    frame.items.push(Item::Text(self.text(number.clone(), TEXT_MM, DVec2::new(x, y), align).bold()));
                }
            }
        }
        let ring = |area: Area| vec![area.min, DVec2::new(area.max.x, area.min.y), area.max, DVec2::new(area.min.x, area.max.y)];
        let edge = Some(Stroke::plain(self.inks.name, 0.4));
        frame.items.push(Item::Area { rings: vec![ring(map)], fill: None, edge });
        [grid, frame]
    }

    /// Title, and below the map scale, north, legend and credit.
    pub fn notes(&self, title: &str, denominator: f64, up_deg: f64, keys: &[Key], credit: &str, date: Option<&str>) -> Group {
        let mut group = Group::new("notes", None);
        let (head, foot) = (self.sheet.head, self.sheet.foot);
        let width = self.letters.width(title) * TITLE_MM;
        let size = TITLE_MM * (head.size().x * 0.8 / width.max(1e-6)).min(1.0);
        group.items.push(Item::Text(self.text(title, size, head.min + DVec2::new(0.0, 7.2), Align::Start).bold()));
        let scale = self.words.say_number("map-scale", denominator.max(0.0) as u64);
        let right = DVec2::new(head.max.x, head.min.y + 7.2);
        group.items.push(Item::Text(self.text(scale, TEXT_MM * 1.25, right, Align::End)));
        let bar = self.scale_bar(denominator, foot.min + DVec2::new(0.0, 5.0), &mut group);
        let north = foot.min + DVec2::new(bar + 9.0, 6.0);
        self.north(up_deg, north, &mut group);
        let from = north.x + 8.0;
        self.legend(keys, Area { min: DVec2::new(from, foot.min.y), max: foot.max }, &mut group);
        let drawn = self.words.say("map-drawn");
        let told = if credit.is_empty() { String::new() } else { self.words.say_credit("map-credit", credit) };
        let parts = [told.as_str(), drawn.as_str(), date.unwrap_or_default()];
        let line: Vec<&str> = parts.into_iter().filter(|part| !part.is_empty()).collect();
        let line = line.join(" · ");
        let width = self.letters.width(&line) * SMALL_MM;
        let size = SMALL_MM * (foot.size().x / width.max(1e-6)).min(1.0);
        group.items.push(Item::Text(self.text(line, size, DVec2::new(foot.min.x, foot.max.y - 0.4), Align::Start)));
        group
    }

    /// A bar of a round length in five pieces; answers how wide it is.
    fn scale_bar(&self, denominator: f64, at: DVec2, group: &mut Group) -> f64 {
        let length_m = round_length(40.0 * denominator / 1000.0);
        let piece = length_m * 1000.0 / denominator / 5.0;
        let ink = self.inks.name;
        for n in 0..5 {
            let from = at + DVec2::new(piece * f64::from(n), 0.0);
            let ring = vec![from, from + DVec2::new(piece, 0.0), from + DVec2::new(piece, 1.3), from + DVec2::new(0.0, 1.3)];
            let fill = Some(if n % 2 == 0 { ink } else { self.inks.paper });
            group.items.push(Item::Area { rings: vec![ring], fill, edge: Some(Stroke::plain(ink, 0.15)) });
        }
        let whole = match length_m >= 1_000.0 {
            true => self.words.say_number("map-kilometres", (length_m / 1_000.0) as u64),
            false => self.words.say_number("map-metres", length_m as u64),
        };
        let above = |share: f64| at + DVec2::new(piece * 5.0 * share, -1.0);
        group.items.push(Item::Text(self.text("0", SMALL_MM, above(0.0), Align::Middle)));
        group.items.push(Item::Text(self.text(whole, SMALL_MM, above(1.0), Align::Middle)));
        piece * 5.0
    }

    fn north(&self, up_deg: f64, at: DVec2, group: &mut Group) {
        let turn = -up_deg.to_radians();
        let north = DVec2::new(libm::sin(turn), -libm::cos(turn));
        let tip = |along: f64, across: f64| at + north * along + north.perp() * across;
        let half = |side: f64| vec![tip(5.0, 0.0), tip(-3.2, side), tip(-1.6, 0.0)];
        let edge = || Some(Stroke::round(self.inks.name, 0.15));
        group.items.push(Item::Area { rings: vec![half(-2.0)], fill: Some(self.inks.name), edge: edge() });
        group.items.push(Item::Area { rings: vec![half(2.0)], fill: Some(self.inks.paper), edge: edge() });
        let letter = at - north * 5.6 + DVec2::new(0.0, TEXT_MM * 0.35);
        group.items.push(Item::Text(self.text(self.words.say("map-north"), TEXT_MM, letter, Align::Middle).bold()));
    }

    /// Pictures and words in columns, from the top down.
    fn legend(&self, keys: &[Key], area: Area, group: &mut Group) {
        const ROWS: usize = 3;
        const ROW_MM: f64 = 4.2;
        const SAMPLE_MM: f64 = 5.0;
        let mut x = area.min.x;
        for column in keys.chunks(ROWS) {
            let words: Vec<String> = column.iter().map(|key| self.words.say(key.message())).collect();
            let width = words.iter().map(|words| self.letters.width(words) * TEXT_MM).fold(0.0, f64::max);
            if x + SAMPLE_MM + 1.4 + width > area.max.x {
                return;
            }
            for (row, (key, words)) in column.iter().zip(words).enumerate() {
                let at = DVec2::new(x, area.min.y + 2.4 + ROW_MM * row as f64);
                self.sample(*key, Area { min: at - DVec2::new(0.0, 1.5), max: at + DVec2::new(SAMPLE_MM, 1.5) }, group);
                let beside = at + DVec2::new(SAMPLE_MM + 1.4, TEXT_MM * 0.35);
                group.items.push(Item::Text(self.text(words, TEXT_MM, beside, Align::Start)));
            }
            x += SAMPLE_MM + 1.4 + width + 5.0;
        }
    }

    fn sample(&self, key: Key, area: Area, group: &mut Group) {
        let inks = self.inks;
        let middle = area.middle();
        let across = vec![DVec2::new(area.min.x, middle.y), DVec2::new(area.max.x, middle.y)];
        let ring = vec![area.min, DVec2::new(area.max.x, area.min.y), area.max, DVec2::new(area.min.x, area.max.y)];
        let mut filled = |fill, edge| {
            let edge = Some(Stroke::round(edge, 0.15));
            group.items.push(Item::Area { rings: vec![ring.clone()], fill: Some(fill), edge });
        };
        match key {
            Key::House => filled(inks.house, inks.wall),
            Key::Notable => filled(inks.notable, inks.wall),
            Key::Monument => filled(inks.monument, inks.wall),
            Key::Park => filled(inks.grass, inks.grass),
            Key::Water => filled(inks.water, inks.bank),
            Key::Railway => filled(inks.ballast, inks.ballast),
            Key::Steps => {
                let stroke = Stroke { dashes: vec![0.2, 0.4], ..Stroke::plain(inks.stone, 2.0) };
                group.items.push(Item::Line { points: across, stroke });
            }
            Key::Arcade => {
                let stroke = Stroke { dashes: vec![0.01, 0.75], ..Stroke::round(inks.stone, 0.42) };
                group.items.push(Item::Line { points: across, stroke });
            }
            Key::Sign(symbol) => group.items.push(sign(symbol, middle, 3.0, inks)),
            Key::Led => group.items.push(Item::Line { points: across, stroke: Stroke::round(inks.led, 0.95) }),
            Key::Tour => {
                let stroke = Stroke { dashes: vec![2.0, 1.0], ..Stroke::plain(inks.tour, 0.75) };
                group.items.push(Item::Line { points: across, stroke });
            }
            Key::Trail => {
                let stroke = Stroke { dashes: vec![0.01, 1.1], ..Stroke::round(inks.trail, 0.6) };
                group.items.push(Item::Line { points: across, stroke });
            }
        }
    }

    /// The index in columns; answers how many entries found no room.
    pub fn index(&self, area: Area, entries: &[Entry]) -> (Group, usize) {
        let mut group = Group::new("index", None);
        let title = self.text(self.words.say("map-index"), TEXT_MM * 1.3, area.min + DVec2::new(0.0, 3.0), Align::Start).bold();
        group.items.push(Item::Text(title));
        let first = area.min + DVec2::new(0.0, 6.8);
        let row_mm = INDEX_MM * 1.32;
        let rows = (libm::floor((area.max.y - first.y - row_mm) / row_mm) as usize).max(1);
        let columns = (libm::round(area.size().x / COLUMN_MM) as usize).max(1);
        let width = area.size().x / columns as f64;
        // Columns of one length, as long as there is room.
        let rows = rows.min(entries.len().div_ceil(columns).max(1));
        for (n, entry) in entries.iter().take(rows * columns).enumerate() {
            let at = first + DVec2::new(width * (n / rows) as f64, row_mm * (n % rows) as f64);
            let room = width - 3.0 - self.letters.width(&entry.field) * INDEX_MM - 1.5;
            let name = shortened(&entry.name, room / INDEX_MM, self.letters);
            group.items.push(Item::Text(self.text(name, INDEX_MM, at, Align::Start)));
            let right = at + DVec2::new(width - 3.0, 0.0);
            group.items.push(Item::Text(self.text(entry.field.clone(), INDEX_MM, right, Align::End).bold()));
        }
        let left = entries.len().saturating_sub(rows * columns);
        if left > 0 {
            let more = self.words.say_number("map-index-more", left as u64);
            let at = DVec2::new(area.min.x, area.max.y);
            group.items.push(Item::Text(self.text(more, SMALL_MM, at, Align::Start)));
        }
        (group, left)
    }
}

/// Breadth of a column of the index, millimetres.
pub(crate) const COLUMN_MM: f64 = 46.0;

/// How wide an index of so many entries is on a sheet so high, millimetres.
pub(crate) fn index_width(count: usize, sheet_height: f64) -> f64 {
    let rows = ((sheet_height - 62.0) / (INDEX_MM * 1.32)).max(1.0);
    COLUMN_MM * libm::ceil(count as f64 / rows).max(1.0)
}

/// A name cut off where there is no more room, in parts of the size.
fn shortened(name: &str, room: f64, letters: &Letters) -> String {
    if letters.width(name) <= room {
        return name.to_owned();
    }
    let mut kept = name.to_owned();
    while letters.width(&kept) + letters.advance('…') > room && kept.pop().is_some() {}
    format!("{}…", kept.trim_end())
}

/// The largest of 1, 2, 2.5 and 5 times a power of ten that is not longer: round metres.
fn round_length(most_m: f64) -> f64 {
    let power = libm::pow(10.0, libm::floor(libm::log10(most_m.max(1.0))));
    [5.0, 2.5, 2.0, 1.0].into_iter().map(|n| n * power).find(|n| *n <= most_m && libm::fmod(*n, 5.0) == 0.0).unwrap_or(power)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scale_bars_have_round_lengths_that_five_pieces_share() {
        for (most, round) in [(100.0, 100.0), (99.0, 50.0), (260.0, 250.0), (240.0, 200.0), (12.0, 10.0), (7_000.0, 5_000.0)] {
            assert_eq!(round_length(most), round, "{most}");
        }
    }

    #[test]
    fn long_names_are_cut_to_their_room() {
        let letters = Letters::new().expect("the font is part of the program");
        let name = "Náměstí Franze Kafky";
        assert_eq!(shortened(name, 99.0, &letters), name);
        let cut = shortened(name, 6.0, &letters);
        assert!(cut.ends_with('…') && letters.width(&cut) <= 6.0 && cut.starts_with("Náměstí"), "{cut}");
        assert_eq!(shortened(name, 0.0, &letters), "…");
    }
}
