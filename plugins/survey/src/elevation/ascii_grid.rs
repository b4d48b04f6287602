//! ESRI ASCII grid: six lines of header, then the rows from north to south.

use glam::DVec2;

use super::{Cells, check_size};
use crate::SurveyError;
use crate::georeference::Affine;

/// How far into a file its first words are looked for.
const HEAD: usize = 1024;
/// A header has at most so many words.
const MOST_WORDS: usize = 32;

const KEYS: &[&str] =
    &["ncols", "nrows", "xllcorner", "yllcorner", "xllcenter", "yllcenter", "cellsize", "dx", "dy", "nodata_value"];

/// Whether the first word is one of the header's.
pub(super) fn is_ascii_grid(bytes: &[u8]) -> bool {
    let head = bytes.get(..HEAD).unwrap_or(bytes);
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(head);
    let first = head.split(u8::is_ascii_whitespace).find(|word| !word.is_empty());
    first.is_some_and(|word| KEYS.iter().any(|key| word.eq_ignore_ascii_case(key.as_bytes())))
}

#[derive(Debug, Default)]
struct Header {
    columns: Option<u64>,
    rows: Option<u64>,
    /// Lower left corner, or middle of the lower left cell.
    x: Option<(f64, bool)>,
    y: Option<(f64, bool)>,
    dx: Option<f64>,
    dy: Option<f64>,
    no_data: Option<f64>,
}

/// Words with the line that each stands on.
struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Iterator for Words<'a> {
    type Item = (&'a [u8], usize);

    fn next(&mut self) -> Option<Self::Item> {
        let start = self.rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let (blank, rest) = self.rest.split_at(start);
        self.line += blank.iter().filter(|&&b| b == b'\n').count();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let (word, rest) = rest.split_at(end);
        self.rest = rest;
        Some((word, self.line))
    }
}

/// Reads a whole file.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<Cells, SurveyError> {
    let broken = |detail: String| SurveyError::Broken { name: name.to_owned(), format: "ASCII grid", detail };
    let mut words = Words { rest: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), line: 1 };
    let header = header(&mut words, &broken)?;
    let (Some(columns), Some(rows)) = (header.columns, header.rows) else {
        return Err(broken("its header lacks ncols or nrows".into()));
    };
    let (columns, rows) = check_size(name, columns, rows)?;
    let affine = header
        .affine(rows)
        .ok_or_else(|| broken("its header lacks xllcorner, yllcorner or cellsize, or they span no area".into()))?;
    let count = columns as usize * rows as usize;
    let cut = |got: usize| SurveyError::Cut {
        name: name.to_owned(),
        format: "ASCII grid",
        place: format!("after {got} of its {count} values"),
    };
    // A value takes two bytes at least: what is too short is refused before room is made for it.
    if words.rest.len().div_ceil(2) < count {
        return Err(cut(words.rest.len().div_ceil(2)));
    }
    let mut heights = Vec::with_capacity(count);
    for (word, line) in words.by_ref().take(count) {
        let value = number(word).ok_or_else(|| broken(format!("line {line} holds `{}` where a number should be", text(word))))?;
        let is_hole = header.no_data.is_some_and(|hole| (value - hole).abs() <= 1e-6 * hole.abs());
        heights.push(if is_hole { f32::NAN } else { value as f32 });
    }
    if heights.len() < count {
        return Err(cut(heights.len()));
    }
    if let Some((word, line)) = words.next() {
        return Err(broken(format!("line {line} holds `{}` after the last of its {count} values", text(word))));
    }
    Ok(Cells { columns, rows, affine: Some(affine), crs: None, heights })
}

fn text(word: &[u8]) -> String {
    String::from_utf8_lossy(word.get(..24).unwrap_or(word)).into_owned()
}

/// A number; `nan` is a hole.
fn number(word: &[u8]) -> Option<f64> {
    core::str::from_utf8(word).ok()?.parse().ok()
}

fn header(words: &mut Words, broken: &impl Fn(String) -> SurveyError) -> Result<Header, SurveyError> {
    let mut header = Header::default();
    for _ in 0..MOST_WORDS / 2 {
        let before = (words.rest, words.line);
        let Some((key, line)) = words.next() else { break };
        if !key.first().is_some_and(u8::is_ascii_alphabetic) || key.eq_ignore_ascii_case(b"nan") {
            (words.rest, words.line) = before;
            break;
        }
        let key = text(key).to_ascii_lowercase();
        let value = words.next().and_then(|(word, _)| number(word)).filter(|v| v.is_finite());
        let value =
            value.ok_or_else(|| broken(format!("`{key}` on line {line} has no number; decimals are written with a point")))?;
        let whole = || ((1.0..=1e12).contains(&value) && value.fract() == 0.0).then_some(value as u64);
        match key.as_str() {
            "ncols" => header.columns = whole(),
            "nrows" => header.rows = whole(),
            "xllcorner" => header.x = Some((value, false)),
            "yllcorner" => header.y = Some((value, false)),
            "xllcenter" => header.x = Some((value, true)),
            "yllcenter" => header.y = Some((value, true)),
            "cellsize" => (header.dx, header.dy) = (Some(value), Some(value)),
            "dx" => header.dx = Some(value),
            "dy" => header.dy = Some(value),
            "nodata_value" => header.no_data = Some(value),
            _ => return Err(broken(format!("line {line} holds `{key}`, which is no word of its header"))),
        }
    }
    Ok(header)
}

impl Header {
    fn affine(&self, rows: u32) -> Option<Affine> {
        let ((x, is_x_middle), (y, is_y_middle)) = (self.x?, self.y?);
        let (dx, dy) = (self.dx.filter(|&d| d > 0.0)?, self.dy.filter(|&d| d > 0.0)?);
        let west = if is_x_middle { x - dx / 2.0 } else { x };
        let south = if is_y_middle { y - dy / 2.0 } else { y };
        let step = glam::DMat2::from_diagonal(DVec2::new(dx, -dy));
        Some(Affine { origin: DVec2::new(west, south + f64::from(rows) * dy), step }).filter(Affine::is_sound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SMALL: &str = "NCOLS 3\nnrows 2\nXLLCORNER 100\nyllcorner 200\ncellsize 10\nNODATA_value -9999\n1 2 3\n4 -9999 6\n";

    #[test]
    fn rows_run_from_north_to_south() {
        let cells = read(SMALL.as_bytes(), "a.asc").unwrap();
        assert_eq!((cells.columns, cells.rows), (3, 2));
        assert!(cells.heights[4].is_nan() && cells.heights[5] == 6.0);
        assert_eq!(cells.affine.unwrap().pos(DVec2::ZERO), DVec2::new(100.0, 220.0), "the first value lies in the north-west");
        let centred = read(SMALL.to_lowercase().replace("corner", "center").as_bytes(), "a.asc").unwrap();
        assert_eq!(centred.affine.unwrap().pos(DVec2::ZERO), DVec2::new(95.0, 215.0));
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let error = |text: String| read(text.as_bytes(), "a.asc").unwrap_err().to_string();
        assert!(error(SMALL.replace("4 ", "4,5 ")).contains("line 8 holds `4,5`"));
        assert!(error(SMALL.replace(" 6", "")).contains("after 5 of its 6 values"));
        assert!(error(SMALL.to_owned() + "7").contains("line 9 holds `7` after the last"));
        assert!(error(SMALL.replace("cellsize 10", "cellsize 0")).contains("cellsize"));
        assert!(error(SMALL.replace("nrows 2\n", "")).contains("lacks ncols or nrows"));
        assert!(error(SMALL.replace("cellsize", "cell_size")).contains("line 5 holds `cell_size`"));
        assert!(error(SMALL.replace("nrows 2", "nrows 1000000000")).contains("3 x 1000000000 cells"));
        assert!(
            error(SMALL.replace("nrows 2", "nrows 10000000")).contains("of its 30000000 values"),
            "refused before room is made"
        );
    }
}
