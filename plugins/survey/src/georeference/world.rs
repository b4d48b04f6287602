use glam::DVec2;

use super::affine::Affine;
use crate::SurveyError;

/// More than this is no world file.
const LONGEST: usize = 4096;

/// A world file: six numbers, a line each. The step east and north of a column, the step of a row, and where the middle of
/// the first pixel lies.
pub(crate) fn world_file(text: &str, name: &str) -> Result<Affine, SurveyError> {
    let broken = |detail: String| SurveyError::Broken { name: name.to_owned(), format: "world file", detail };
    if text.len() > LONGEST {
        return Err(broken(format!("{} bytes instead of six lines with a number each", text.len())));
    }
    let text = text.trim_start_matches('\u{FEFF}');
    let mut numbers = [0.0; 6];
    let mut lines = text.lines().zip(1..).map(|(line, i)| (line.trim(), i)).filter(|(line, _)| !line.is_empty());
    for (at, slot) in numbers.iter_mut().enumerate() {
        let Some((line, i)) = lines.next() else {
            return Err(SurveyError::Cut {
                name: name.to_owned(),
                format: "world file",
                place: format!("after {at} of its six numbers"),
            });
        };
        let number = line.parse::<f64>().ok().filter(|n| n.is_finite());
        let hint = if line.contains(',') { " (decimals are written with a point)" } else { "" };
        *slot = number.ok_or_else(|| {
            broken(format!("line {i} holds `{}`, which is no number{hint}", line.chars().take(30).collect::<String>()))
        })?;
    }
    if let Some((line, i)) = lines.next() {
        return Err(broken(format!("line {i} holds `{}` after the six numbers", line.chars().take(30).collect::<String>())));
    }
    let [ax, ay, bx, by, x, y] = numbers;
    let affine = Affine::of_first_middle(DVec2::new(x, y), DVec2::new(ax, ay), DVec2::new(bx, by));
    if !affine.is_sound() {
        return Err(broken(format!("steps of ({ax}, {ay}) a column and ({bx}, {by}) a row span no area")));
    }
    Ok(affine)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_position_is_that_of_the_first_pixels_middle() {
        let affine = world_file("\u{FEFF}2.0\r\n0\r\n0\r\n-2.0\r\n1000.0\r\n5000.0\r\n\r\n", "a.pgw").unwrap();
        assert_eq!(affine.pos(DVec2::splat(0.5)), DVec2::new(1000.0, 5000.0));
        assert_eq!(affine.pos(DVec2::new(10.0, 20.0)), DVec2::new(1019.0, 4961.0));
        assert_eq!(affine.pixel(DVec2::new(1019.0, 4961.0)), DVec2::new(10.0, 20.0));
    }

    #[test]
    fn mistakes_are_told_with_their_line() {
        let error = |text: &str| world_file(text, "a.pgw").unwrap_err().to_string();
        assert!(
            error("1\n0\n0\n-0,5\n0\n0").contains("line 4 holds `-0,5`, which is no number (decimals are written with a point)")
        );
        assert!(error("1\n0\n0\n-1\n").contains("after 4 of its six numbers"));
        assert!(error("1\n0\n0\n-1\n0\n0\n7").contains("line 7"));
        assert!(error("1\n1\n1\n1\n0\n0").contains("no area"));
        assert!(error("1\n0\n0\nNaN\n0\n0").contains("line 4"));
    }

    proptest! {
        #[test]
        fn any_text_is_read_or_refused(text in "[-0-9eE.,\\n a]{0,60}") {
            if let Ok(affine) = world_file(&text, "a.wld") {
                prop_assert!(affine.is_sound());
            }
        }
    }
}
