//! `veduta journal`: what a recorded walk downloaded, told and drawn.

use std::path::{Path, PathBuf};

use anstream::println;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use veduta::streaming::{BytesByKind, Downloads, Entry, Event, read_journal, replay};

use crate::Failure;

/// What to tell of a journal.
#[derive(Debug, Clone)]
pub struct JournalOrder {
    /// The journal's file.
    pub journal: PathBuf,
    /// The plots (SVG), if they are wanted.
    pub out: Option<PathBuf>,
}

/// Tells what came over a walk, and draws it: what had come by each second, level upon level, and what came in each cell on the way, with
/// their sum. Of a journal of several cities it is the last one's.
///
/// # Errors
/// If the journal cannot be read or the plots not be written.
pub fn journal(order: &JournalOrder) -> Result<(), Failure> {
    order.out.as_deref().map_or(Ok(()), check_name)?;
    let path = order.journal.display();
    let text = std::fs::read_to_string(&order.journal).map_err(|error| format!("{path}: {error}"))?;
    let mut entries = read_journal(&text).map_err(|error| format!("{path}: {error}"))?;
    let last = entries.iter().rposition(|entry| matches!(entry.event, Event::Opened { .. }));
    let Some(last) = last else {
        return Err(format!("{path}: no city was opened in it; `veduta walk --journal {path}` records a walk").into());
    };
    entries.drain(..last);
    let walk = Walk::of(&entries);
    println!("{}", walk.told());
    if let Some(out) = &order.out {
        let picture = walk.drawn().map_err(|error| format!("{}: {error}", out.display()))?;
        write(out, &picture)?;
        println!("{}", out.display());
    }
    Ok(())
}

fn check_name(out: &Path) -> Result<(), Failure> {
    let is_svg = out.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("svg"));
    if is_svg { Ok(()) } else { Err(format!("{}: plots are SVG; name a file that ends in .svg", out.display()).into()) }
}

fn write(out: &Path, picture: &str) -> Result<(), Failure> {
    if let Some(folder) = out.parent() {
        std::fs::create_dir_all(folder).map_err(|error| format!("{}: {error}", folder.display()))?;
    }
    std::fs::write(out, picture).map_err(|error| format!("{}: {error}", out.display()).into())
}

/// What a journal tells of one city.
struct Walk {
    place: String,
    began_s: f64,
    ended_s: f64,
    asked: usize,
    failed: usize,
    /// Cells that stand in the end.
    loaded: usize,
    downloads: Downloads,
}

/// Kinds of what comes, beginning with what is no packet, and their colours. Level 4 is made of the others and sends nothing.
const KINDS: [(&str, RGBColor); 4] = [
    ("index, houses, maps, guide", RGBColor(0x8C, 0x86, 0x7C)),
    ("level 1", RGBColor(0x4E, 0x9A, 0x6A)),
    ("level 2", RGBColor(0x3A, 0x7F, 0xC4)),
    ("level 3", RGBColor(0xD9, 0xA2, 0x2B)),
];
const PAPER: RGBColor = RGBColor(0xFB, 0xF7, 0xEE);
const INK: RGBColor = RGBColor(0x3A, 0x33, 0x2B);
const SUM: RGBColor = RGBColor(0x8C, 0x3E, 0x2C);

/// Pixels, which grow without loss.
const SIZE: (u32, u32) = (1_000, 860);
const FONT: &str = "sans-serif";

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

impl Walk {
    /// Of entries that begin with the opening of a city.
    fn of(entries: &[Entry]) -> Self {
        let at_s = |entry: Option<&Entry>| entry.map_or(0.0, |entry| entry.at_s);
        let count = |is: fn(&Event) -> bool| entries.iter().filter(|entry| is(&entry.event)).count();
        let place = match entries.first().map(|entry| &entry.event) {
            Some(Event::Opened { place }) => place.clone(),
            _ => String::new(),
        };
        Self {
            place,
            began_s: at_s(entries.first()),
            ended_s: at_s(entries.last()),
            asked: count(|event| matches!(event, Event::Asked { .. })),
            failed: count(|event| matches!(event, Event::Failed { .. })),
            loaded: replay(entries).len(),
            downloads: entries.iter().collect(),
        }
    }

    fn seconds(&self) -> f64 {
        self.ended_s - self.began_s
    }

    /// Cells on the way.
    fn cells(&self) -> usize {
        self.downloads.stays().iter().filter(|stay| stay.cell.is_some()).count()
    }

    fn told(&self) -> String {
        let sum = self.downloads.sum();
        let kinds = KINDS.iter().zip(sum.0).map(|((name, _), bytes)| format!("  {name:20}{:>12}\n", kilobytes(bytes)));
        format!(
            "{}: {:.0} s, {} cells on the way, {} requests, {} failed\n{}  {:20}{:>12}\n{} cells loaded in the end",
            self.place,
            self.seconds(),
            self.cells(),
            self.asked,
            self.failed,
            kinds.collect::<String>(),
            "all",
            kilobytes(sum.sum()),
            self.loaded
        )
    }

    /// Both plots, as SVG.
    fn drawn(&self) -> Result<String, Failure> {
        let mut svg = String::new();
        self.draw(&SVGBackend::with_string(&mut svg, SIZE).into_drawing_area())?;
        Ok(svg)
    }

    fn draw(&self, area: &Area<'_>) -> Result<(), Failure> {
        area.fill(&PAPER)?;
        let title = format!("{}: {}", self.place, kilobytes(self.downloads.sum().sum()));
        let below = area.titled(&title, (FONT, 22).into_font().color(&INK))?;
        let (upper, lower) = below.split_vertically(50.percent_height());
        self.draw_sums(&upper)?;
        self.draw_cells(&lower)?;
        area.present()?;
        Ok(())
    }

    /// What had come by each second, one kind upon another.
    fn draw_sums(&self, area: &Area<'_>) -> Result<(), Failure> {
        let most = axis_end(self.downloads.sum().sum());
        let mut chart = ChartBuilder::on(area)
            .margin(14)
            .margin_right(14 + 64)
            .x_label_area_size(40)
            .y_label_area_size(64)
            .caption("What had come by then, by level", (FONT, 16).into_font().color(&INK))
            .build_cartesian_2d(0.0..self.seconds().max(1.0), 0.0..most)?;
        mesh(&mut chart, "seconds")?;
        // The last kind lies upon all others: what is drawn first reaches highest. At the lower right all is covered.
        for (kind, &(name, ink)) in KINDS.iter().enumerate().rev() {
            let steps = self.steps(|bytes| bytes.0[..=kind].iter().sum());
            let mark = move |(x, y)| Rectangle::new([(x, y - 5), (x + 12, y + 5)], ink.filled());
            chart.draw_series(AreaSeries::new(steps, 0.0, ink))?.label(name).legend(mark);
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::LowerRight)
            .label_font((FONT, 14).into_font().color(&INK))
            .background_style(PAPER.mix(0.9))
            .draw()?;
        Ok(())
    }

    /// Seconds and kilobytes, a step for each frame that brought something.
    fn steps(&self, bytes: impl Fn(&BytesByKind) -> u64) -> Vec<(f64, f64)> {
        let mut steps = Vec::new();
        let mut high = 0.0;
        for (at_s, sum) in self.downloads.sums() {
            let x = at_s - self.began_s;
            steps.push((x, high));
            high = bytes(sum) as f64 / 1e3;
            steps.push((x, high));
        }
        steps.push((self.seconds(), high));
        steps
    }

    /// What came in each cell on the way, and by its end.
    fn draw_cells(&self, area: &Area<'_>) -> Result<(), Failure> {
        let stays = self.downloads.stays();
        let most = stays.iter().map(|stay| stay.bytes.sum()).max().unwrap_or_default();
        let mut chart = ChartBuilder::on(area)
            .margin(14)
            .x_label_area_size(40)
            .y_label_area_size(64)
            .right_y_label_area_size(64)
            .caption("What came in each cell on the way, and by then", (FONT, 16).into_font().color(&INK))
            .build_cartesian_2d(0.0..stays.len().max(1) as f64, 0.0..axis_end(most))?
            .set_secondary_coord(0.0..stays.len().max(1) as f64, 0.0..axis_end(self.downloads.sum().sum()));
        mesh(&mut chart, "cells, as they were entered; the first column is what came before")?;
        chart
            .configure_secondary_axes()
            .y_desc("all, kB")
            .y_label_formatter(&|y| format!("{y:.0}"))
            .axis_style(SUM)
            .label_style((FONT, 13).into_font().color(&SUM))
            .axis_desc_style((FONT, 14).into_font().color(&SUM))
            .draw()?;
        for (kind, &(_, ink)) in KINDS.iter().enumerate() {
            let columns = stays.iter().enumerate().map(|(n, stay)| {
                let foot = stay.bytes.0[..kind].iter().sum::<u64>() as f64 / 1e3;
                let head = foot + stay.bytes.0[kind] as f64 / 1e3;
                Rectangle::new([(n as f64 + 0.1, foot), (n as f64 + 0.9, head)], ink.filled())
            });
            chart.draw_series(columns)?;
        }
        let mut sum = 0;
        let sums = stays.iter().enumerate().map(|(n, stay)| {
            sum += stay.bytes.sum();
            (n as f64 + 1.0, sum as f64 / 1e3)
        });
        let sums = core::iter::once((0.0, 0.0)).chain(sums).collect::<Vec<_>>();
        chart.draw_secondary_series(LineSeries::new(sums, SUM.stroke_width(2)))?;
        Ok(())
    }
}

/// Axes and faint lines.
fn mesh(chart: &mut Chart<'_, '_>, along: &str) -> Result<(), Failure> {
    chart
        .configure_mesh()
        .x_desc(along)
        .y_desc("kB")
        .x_label_formatter(&|x| format!("{x:.0}"))
        .y_label_formatter(&|y| format!("{y:.0}"))
        .axis_style(INK)
        .light_line_style(PAPER)
        .bold_line_style(INK.mix(0.12))
        .label_style((FONT, 13).into_font().color(&INK))
        .axis_desc_style((FONT, 14).into_font().color(&INK))
        .draw()?;
    Ok(())
}

/// The upper end of an axis for so many bytes, kilobytes.
fn axis_end(bytes: u64) -> f64 {
    (bytes as f64 / 1e3).max(0.1) * 1.08
}

fn kilobytes(bytes: u64) -> String {
    format!("{:.1} kB", bytes as f64 / 1e3)
}

#[cfg(test)]
mod tests {
    use veduta::city::Level;
    use veduta::streaming::{What, write_journal};

    use super::*;

    /// A walk of 200 s through ten cells, 1.3 kB each, after 500 bytes.
    fn walk() -> Vec<Entry> {
        let mut walk = vec![(0.0, Event::Opened { place: "<old> & new.city".to_owned() })];
        walk.push((0.5, Event::Arrived { what: What::Index, bytes: 500 }));
        for cell in 0..10 {
            let at_s = 1.0 + 20.0 * f64::from(cell);
            let packet = |level, bytes| Event::Arrived { what: What::Packet { cell, level }, bytes };
            walk.push((at_s, Event::Entered { viewer: 1, cell: Some(cell) }));
            walk.push((at_s, Event::Asked { what: What::Packet { cell, level: Level::One }, bytes: 100, why: None }));
            walk.push((at_s + 1.0, packet(Level::One, 100)));
            walk.push((at_s + 2.0, packet(Level::Two, 1_200)));
        }
        walk.into_iter().map(|(at_s, event)| Entry { at_s: at_s + 7.0, event }).collect()
    }

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("veduta-journal-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        folder
    }

    #[test]
    fn a_walk_is_told() {
        let told = Walk::of(&walk()).told();
        assert!(told.starts_with("<old> & new.city: 183 s, 10 cells on the way, 10 requests, 0 failed\n"), "{told}");
        for line in ["level 1                   1.0 kB", "level 2                  12.0 kB", "all                      13.5 kB"] {
            assert!(told.contains(line), "{line}: {told}");
        }
        assert!(told.ends_with("10 cells loaded in the end"), "{told}");
    }

    #[test]
    fn a_walk_is_drawn() {
        let svg = Walk::of(&walk()).drawn().expect("drawn");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"), "{svg}");
        assert!(svg.contains("&lt;old&gt; &amp; new.city: 13.5 kB"), "its name is text, not markup");
        let count = |ink: RGBColor| {
            let RGBColor(r, g, b) = ink;
            svg.matches(&format!("fill=\"#{r:02X}{g:02X}{b:02X}\"")).count()
        };
        // An area, a mark of the legend and a column for each stay.
        for (_, ink) in KINDS {
            assert_eq!(count(ink), 2 + 11, "{ink:?}");
        }
        let nothing = [Entry { at_s: 1.0, event: Event::Opened { place: String::new() } }];
        assert!(Walk::of(&nothing).drawn().expect("an empty one").contains("0.0 kB"));
    }

    #[test]
    fn of_several_cities_the_last_is_told() {
        let folder = folder("last");
        let (path, out) = (folder.join("walk.ron"), folder.join("new/walk.svg"));
        let mut twice = walk();
        twice.extend(walk().into_iter().take(4));
        std::fs::write(&path, write_journal(&twice)).expect("written");
        journal(&JournalOrder { journal: path.clone(), out: Some(out.clone()) }).expect("told and drawn");
        assert!(std::fs::read_to_string(&out).expect("drawn").contains("0.5 kB"), "the last one's bytes");

        let fails = |text: &str, out: Option<PathBuf>| {
            std::fs::write(&path, text).expect("written");
            journal(&JournalOrder { journal: path.clone(), out }).expect_err(text).to_string()
        };
        assert!(fails("(at_s: 1, event: Opned)", None).contains("walk.ron: line 1 is no line of a journal"));
        assert!(fails("", None).contains("no city was opened in it"));
        assert!(fails("no journal", Some(folder.join("walk.png"))).contains("ends in .svg"), "told before anything is read");
        std::fs::remove_dir_all(&folder).expect("our own");
    }
}
