//! dBASE tables, the attributes of a Shapefile (`.dbf`; <https://www.clicketyclick.dk/databases/xbase/format/dbf.html>).

use super::codepage::CodePage;
use crate::SurveyError;
use crate::osm::MOST_ITEMS;

/// A row: names and values, or `None` where it is marked as deleted.
pub(super) type Row = Option<Vec<(String, String)>>;

/// A column.
struct Field {
    name: String,
    kind: u8,
    from: usize,
    len: usize,
}

/// Reads a whole table. `page` is what a `.cpg` file beside it says.
pub(super) fn read(bytes: &[u8], page: Option<CodePage>, name: &str) -> Result<Vec<Row>, SurveyError> {
    let broken = |detail: String| SurveyError::Broken { name: name.to_owned(), format: "dBASE table", detail };
    let cut = |place: String| SurveyError::Cut { name: name.to_owned(), format: "dBASE table", place };
    let head: &[u8; 32] = bytes.first_chunk().ok_or_else(|| cut("inside its header".to_owned()))?;
    if !matches!(head[0] & 0x07, 3 | 4) {
        return Err(broken(format!("its first byte is {:#04x}, which is no version of dBASE", head[0])));
    }
    let rows = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
    let header_len = usize::from(u16::from_le_bytes([head[8], head[9]]));
    let row_len = usize::from(u16::from_le_bytes([head[10], head[11]]));
    let header = bytes.get(32..header_len).ok_or_else(|| cut("inside its list of columns".to_owned()))?;
    let fields = fields(header);
    if fields.is_empty() || row_len == 0 || fields.iter().any(|f| f.from + f.len > row_len) {
        return Err(broken(format!("its {} columns do not fit rows of {row_len} bytes", fields.len())));
    }
    let body = bytes.get(header_len..).unwrap_or_default();
    // Checked before anything is allocated by the header's word.
    if body.len() / row_len < rows {
        return Err(cut(format!("after {} of {rows} rows", body.len() / row_len)));
    }
    if (rows as u64).saturating_mul(fields.len() as u64) > MOST_ITEMS {
        return Err(SurveyError::TooLarge { name: name.to_owned(), what: "attributes", limit: MOST_ITEMS });
    }
    let page = page.unwrap_or_else(|| CodePage::of_language_byte(head[29]));
    Ok(body.chunks_exact(row_len).take(rows).map(|row| row_of(row, &fields, page)).collect())
}

fn fields(header: &[u8]) -> Vec<Field> {
    // The first byte of a row is its mark of deletion.
    let (mut out, mut from) = (Vec::new(), 1);
    for descriptor in header.chunks_exact(32).take_while(|d| d[0] != 0x0D) {
        let name: &[u8] = descriptor[..11].split(|&b| b == 0).next().unwrap_or_default();
        let kind = descriptor[11];
        // Long texts have the upper half of their length where numbers have their decimals.
        let len = usize::from(descriptor[16]) + if kind == b'C' { usize::from(descriptor[17]) << 8 } else { 0 };
        out.push(Field { name: String::from_utf8_lossy(name).trim().to_owned(), kind, from, len });
        from += len;
    }
    out
}

fn row_of(row: &[u8], fields: &[Field], page: CodePage) -> Row {
    if row.first() == Some(&b'*') {
        return None;
    }
    let value = |f: &Field| Some((f.name.clone(), value(row.get(f.from..f.from + f.len)?, f.kind, page)?));
    Some(fields.iter().filter_map(value).collect())
}

/// The text of a value; `None` where it is blank or of a kind that is not text, number, date or truth.
fn value(bytes: &[u8], kind: u8, page: CodePage) -> Option<String> {
    let ascii = || Some(String::from_utf8_lossy(bytes.split(|&b| b == 0).next()?).trim().to_owned());
    let text = match kind {
        b'C' => page.text(bytes.split(|&b| b == 0).next()?).trim().to_owned(),
        // Numbers may be written with exponents, which no reader of maps' units knows; stars are an overflow.
        b'N' | b'F' => {
            let text = ascii()?;
            match text.parse::<f64>() {
                Ok(number) if number.is_finite() => number.to_string(),
                _ if text.starts_with('*') => return None,
                _ => text,
            }
        }
        b'D' => {
            let text = ascii()?;
            match (text.get(..4), text.get(4..6), text.get(6..8)) {
                (Some(year), Some(month), Some(day)) if text.len() == 8 && year != "0000" => format!("{year}-{month}-{day}"),
                _ => return None,
            }
        }
        b'L' => match bytes.first()? {
            b'T' | b't' | b'Y' | b'y' => "yes".to_owned(),
            b'F' | b'f' | b'N' | b'n' => "no".to_owned(),
            _ => return None,
        },
        b'I' => i32::from_le_bytes(*bytes.first_chunk()?).to_string(),
        b'O' => f64::from_le_bytes(*bytes.first_chunk()?).to_string(),
        _ => return None,
    };
    (!text.is_empty()).then_some(text)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A table of columns (name, kind, length) and rows of texts.
    pub(in crate::vector) fn table(fields: &[(&str, u8, u8)], rows: &[&[&str]]) -> Vec<u8> {
        let row_len = 1 + fields.iter().map(|f| u16::from(f.2)).sum::<u16>();
        let mut out = vec![3, 126, 1, 1];
        out.extend((rows.len() as u32).to_le_bytes());
        out.extend((33 + 32 * fields.len() as u16).to_le_bytes());
        out.extend(row_len.to_le_bytes());
        out.resize(32, 0);
        for &(name, kind, len) in fields {
            let mut descriptor = [0_u8; 32];
            descriptor[..name.len()].copy_from_slice(name.as_bytes());
            (descriptor[11], descriptor[16]) = (kind, len);
            out.extend(descriptor);
        }
        out.push(0x0D);
        for row in rows {
            out.push(if row.is_empty() { b'*' } else { b' ' });
            for (i, &(_, _, len)) in fields.iter().enumerate() {
                let text = row.get(i).copied().unwrap_or_default();
                out.extend(text.as_bytes().iter().copied().chain(core::iter::repeat(b' ')).take(usize::from(len)));
            }
        }
        out.push(0x1A);
        out
    }

    fn sample() -> Vec<u8> {
        let fields = [("FULLNAME", b'C', 20), ("HEIGHT", b'F', 19), ("BUILT", b'D', 8), ("OPEN", b'L', 1)];
        table(&fields, &[&["Main St", "1.25000000000e+01", "19020301", "T"], &[], &["", "", "", "?"]])
    }

    #[test]
    fn values_are_read_by_kind_and_blank_ones_are_not_there() {
        let rows = read(&sample(), None, "a.dbf").unwrap();
        let pairs: Vec<_> = rows[0].as_ref().unwrap().iter().map(|(k, v)| (k.as_str(), v.as_str())).collect();
        assert_eq!(pairs, [("FULLNAME", "Main St"), ("HEIGHT", "12.5"), ("BUILT", "1902-03-01"), ("OPEN", "yes")]);
        assert_eq!((rows[1].is_none(), rows[2].as_deref()), (true, Some(&[][..])));
    }

    #[test]
    fn a_header_that_lies_is_refused_before_anything_is_allocated() {
        let mut lying = sample();
        lying[4..8].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = read(&lying, None, "a.dbf").unwrap_err().to_string();
        assert!(error.contains("ends after 3 of 4294967295 rows"), "{error}");
        let mut narrow = sample();
        narrow[10..12].copy_from_slice(&5_u16.to_le_bytes());
        assert!(read(&narrow, None, "a.dbf").unwrap_err().to_string().contains("4 columns do not fit rows of 5 bytes"));
        assert!(matches!(read(&sample()[..60], None, "a.dbf"), Err(SurveyError::Cut { .. })));
    }

    proptest! {
        #[test]
        fn mutated_bytes_never_panic(at in prop::collection::vec((0_usize..240, any::<u8>()), 1..8), cut in 0_usize..240) {
            let mut bytes = sample();
            for (i, byte) in at {
                if let Some(b) = bytes.get_mut(i) {
                    *b = byte;
                }
            }
            let _ = read(&bytes, None, "a");
            let _ = read(&bytes[..cut.min(bytes.len())], None, "a");
        }
    }
}
