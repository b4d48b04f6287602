//! SRTM tiles: a degree square of big-endian 16-bit metres, 1201 (three seconds) or 3601 (one second) to a side, the posts of
//! the outermost rows and columns on the square's border. The name tells which square.

use glam::{DMat2, DVec2};

use super::Cells;
use crate::SurveyError;
use crate::crs::Crs;
use crate::georeference::Affine;

/// Posts a side.
const SIDES: [u32; 2] = [1201, 3601];
/// A post without data.
const HOLE: i16 = i16::MIN;

/// Latitude and longitude of the south-west corner that a name tells, as in `N49E011.hgt` or `s34w059.SRTMGL1.hgt`.
fn corner(name: &str) -> Option<(f64, f64)> {
    let file = name.rsplit(['/', '\\']).next()?.to_ascii_uppercase();
    let number = |digits: &str| digits.bytes().all(|b| b.is_ascii_digit()).then(|| digits.parse::<f64>().ok()).flatten();
    let (lat, lon) = (number(file.get(1..3)?)?, number(file.get(4..7)?)?);
    let lat = match file.get(..1)? {
        "N" => lat,
        "S" => -lat,
        _ => return None,
    };
    let lon = match file.get(3..4)? {
        "E" => lon,
        "W" => -lon,
        _ => return None,
    };
    (lat.abs() < 90.0 && lon.abs() <= 180.0).then_some((lat, lon))
}

/// Whether length or name say that it is a tile: the content itself bears no mark.
pub(super) fn is_hgt(bytes: &[u8], name: &str) -> bool {
    let has_length = SIDES.iter().any(|&n| bytes.len() as u64 == 2 * u64::from(n) * u64::from(n));
    has_length || (name.to_ascii_lowercase().ends_with(".hgt") && corner(name).is_some())
}

/// Reads a whole tile.
pub(super) fn read(bytes: &[u8], name: &str) -> Result<Cells, SurveyError> {
    let Some(side) = SIDES.into_iter().find(|&n| bytes.len() as u64 == 2 * u64::from(n) * u64::from(n)) else {
        return Err(SurveyError::Cut {
            name: name.to_owned(),
            format: "SRTM tile",
            place: format!("after {} bytes (whole ones have 2884802 or 25934402)", bytes.len()),
        });
    };
    let Some((south, west)) = corner(name) else {
        let detail = "an SRTM tile tells where it lies by its name alone; name it as in N49E011.hgt".to_owned();
        return Err(SurveyError::Unplaced { name: name.to_owned(), detail });
    };
    let step = 1.0 / f64::from(side - 1);
    let (column, row) = (DVec2::new(step, 0.0), DVec2::new(0.0, -step));
    let affine = Affine::of_first_middle(DVec2::new(west, south + 1.0), column, row);
    debug_assert_eq!(affine.step, DMat2::from_cols(column, row));
    let height = |pair: &[u8; 2]| match i16::from_be_bytes(*pair) {
        HOLE => f32::NAN,
        metres => f32::from(metres),
    };
    let heights = bytes.as_chunks::<2>().0.iter().map(height).collect();
    Ok(Cells { columns: side, rows: side, affine: Some(affine), crs: Some(Crs::WGS84), heights })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_name_tells_the_place() {
        assert_eq!(corner("dem/N49E011.hgt"), Some((49.0, 11.0)));
        assert_eq!(corner("s34w059.SRTMGL1.hgt"), Some((-34.0, -59.0)));
        for wrong in ["elevation.hgt", "N4", "N99E011.hgt", "X49E011.hgt", "N49E0é1.hgt", "N+9E011.hgt"] {
            assert_eq!(corner(wrong), None, "{wrong}");
        }
        let tile = vec![0; 2 * 1201 * 1201];
        assert!(matches!(read(&tile, "tile.hgt"), Err(SurveyError::Unplaced { .. })));
        assert!(matches!(read(&tile[2..], "N49E011.hgt"), Err(SurveyError::Cut { .. })));
    }

    #[test]
    fn posts_lie_on_the_border_of_the_square() {
        let mut tile = vec![0; 2 * 1201 * 1201];
        tile[..4].copy_from_slice(&[0x01, 0x02, 0x80, 0x00]);
        let cells = read(&tile, "N49E011.hgt").unwrap();
        assert!(cells.heights[0] == 258.0 && cells.heights[1].is_nan());
        let middle = cells.affine.unwrap().pos(DVec2::new(1200.5, 1200.5));
        assert!(middle.distance(DVec2::new(12.0, 49.0)) < 1e-12, "{middle}");
    }
}
