//! ESRI Shapefiles (<https://www.esri.com/content/dam/esrisites/sitecore-archive/Files/Pdfs/library/whitepapers/pdfs/shapefile.pdf>):
//! points, polylines and polygons with or without heights and measures, which are passed over.

use glam::DVec2;

use super::codepage::CodePage;
use super::dbf;
use super::feature::{Content, Feature, Named, Shape};
use crate::SurveyError;
use crate::osm::MOST_ITEMS;
use crate::polygon::signed_area;

const HEADER: usize = 100;

/// Whether bytes look like a `.shp` file.
pub(super) fn looks_like_shapefile(bytes: &[u8]) -> bool {
    bytes.get(..4) == Some(&9994_u32.to_be_bytes()) && bytes.get(28..32) == Some(&1000_u32.to_le_bytes())
}

/// Reads the files of one Shapefile: `.shp`, and where they exist `.dbf`, `.prj` and `.cpg`.
pub(super) fn read(
    shp: &[u8],
    dbf: Option<&[u8]>,
    prj: Option<&[u8]>,
    cpg: Option<&[u8]>,
    name: &str,
) -> Result<Content, SurveyError> {
    let shapes = shapes(shp, name)?;
    let beside = |ending: &str| format!("{}.{ending}", name.rsplit_once('.').map_or(name, |(stem, _)| stem));
    let page = cpg.map(|cpg| CodePage::named(cpg, &beside("cpg"))).transpose()?;
    let rows = dbf.map(|dbf| dbf::read(dbf, page, &beside("dbf"))).transpose()?;
    if let Some(rows) = &rows
        && rows.len() != shapes.len()
    {
        let detail = format!("it has {} rows for the {} shapes of {name}", rows.len(), shapes.len());
        return Err(SurveyError::Broken { name: beside("dbf"), format: "dBASE table", detail });
    }
    let mut rows = rows.into_iter().flatten();
    let mut features = Vec::with_capacity(shapes.len());
    for shape in shapes {
        // A row marked as deleted takes its shape with it, as every program that reads Shapefiles has it.
        match rows.next() {
            Some(None) => {}
            row => {
                let attributes = row.flatten().unwrap_or_default();
                features.push(Feature { id: String::new(), attributes, shapes: shape.into_iter().collect() });
            }
        }
    }
    let crs = prj.map(|prj| Named::Text(String::from_utf8_lossy(prj).trim_matches('\u{feff}').trim().to_owned()));
    Ok(Content { features, crs, ..Content::default() })
}

/// A reader of fixed-size values that never reads past the end.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(taken)
    }

    fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.first_chunk().copied()
    }

    fn be(&mut self) -> Option<i32> {
        self.array().map(i32::from_be_bytes)
    }

    fn le(&mut self) -> Option<i32> {
        self.array().map(i32::from_le_bytes)
    }

    fn count(&mut self) -> Option<usize> {
        self.le().and_then(|n| usize::try_from(n).ok())
    }

    fn position(&mut self) -> Option<DVec2> {
        let x = self.array().map(f64::from_le_bytes)?;
        let y = self.array().map(f64::from_le_bytes)?;
        Some(DVec2::new(x, y))
    }
}

/// The shapes in order of their records; `None` for null shapes.
fn shapes(shp: &[u8], name: &str) -> Result<Vec<Option<Shape>>, SurveyError> {
    let broken = |detail: String| SurveyError::Broken { name: name.to_owned(), format: "Shapefile", detail };
    let cut = |place: String| SurveyError::Cut { name: name.to_owned(), format: "Shapefile", place };
    if !looks_like_shapefile(shp) {
        return Err(broken("it does not begin with the words of one (9994, version 1000)".to_owned()));
    }
    let mut length = Bytes(shp.get(24..HEADER).ok_or_else(|| cut("inside its header".to_owned()))?);
    let stated = length.be().and_then(|words| usize::try_from(words).ok()).unwrap_or(0).saturating_mul(2);
    let body = shp.get(HEADER..stated.max(HEADER)).ok_or_else(|| cut(format!("after {} of {stated} bytes", shp.len())))?;
    let (mut reader, mut out, mut items) = (Bytes(body), Vec::new(), 0_u64);
    while !reader.0.is_empty() {
        let record = out.len() + 1;
        let wrong = |what: &str| broken(format!("record {record} {what}"));
        let (_, words) = reader.be().zip(reader.be()).ok_or_else(|| wrong("has no whole header"))?;
        let len = usize::try_from(words).ok().and_then(|w| w.checked_mul(2)).ok_or_else(|| wrong("has a length below nought"))?;
        let content = reader.take(len).ok_or_else(|| wrong("is longer than the file"))?;
        let shape = shape(Bytes(content), name)?.map_err(|what| wrong(&what))?;
        items += 1 + shape.iter().flat_map(Shape::positions).count() as u64;
        if items > MOST_ITEMS {
            return Err(SurveyError::TooLarge { name: name.to_owned(), what: "shapes and vertices", limit: MOST_ITEMS });
        }
        out.push(shape);
    }
    Ok(out)
}

/// The shape of one record; the inner error says in words what is wrong with it.
fn shape(mut content: Bytes<'_>, name: &str) -> Result<Result<Option<Shape>, String>, SurveyError> {
    let cut = || Err("ends within its shape".to_owned());
    let Some(kind) = content.le() else { return Ok(cut()) };
    let read = match kind {
        0 => Some(None),
        1 | 11 | 21 => content.position().map(|p| p.is_finite().then(|| Shape::Points(vec![p]))),
        8 | 18 | 28 => multipoint(content).map(Some),
        3 | 13 | 23 => parts(content).map(|lines| Some(Shape::Lines(lines))),
        // Outer rings run clockwise.
        5 | 15 | 25 => parts(content).map(|rings| {
            let ring = |r: Vec<DVec2>| {
                let is_inner = signed_area(&r) > 0.0;
                (r, is_inner)
            };
            Some(Shape::Rings(rings.into_iter().map(ring).collect()))
        }),
        31 => {
            return Err(SurveyError::Unsupported {
                name: name.to_owned(),
                feature: "multipatches (surfaces in space)".to_owned(),
                fix: "export footprints as polygons instead",
            });
        }
        other => return Ok(Err(format!("is of the unknown kind {other}"))),
    };
    Ok(read.map_or_else(cut, Ok))
}

fn multipoint(mut content: Bytes<'_>) -> Option<Shape> {
    content.take(32)?;
    let count = content.count()?;
    let mut points = Bytes(content.take(count.checked_mul(16)?)?);
    Some(Shape::Points((0..count).map_while(|_| points.position()).collect()))
}

/// Vertices of polylines and polygons, part by part.
fn parts(mut content: Bytes<'_>) -> Option<Vec<Vec<DVec2>>> {
    content.take(32)?;
    let (parts, points) = (content.count()?, content.count()?);
    let mut starts = Bytes(content.take(parts.checked_mul(4)?)?);
    let mut positions = Bytes(content.take(points.checked_mul(16)?)?);
    let mut starts: Vec<usize> = (0..parts).map_while(|_| starts.count()).collect();
    if starts.len() != parts || starts.first().is_some_and(|&s| s != 0) {
        return None;
    }
    starts.push(points);
    let mut out = Vec::with_capacity(parts);
    for pair in starts.windows(2) {
        let &[from, to] = pair else { continue };
        let count = to.checked_sub(from)?;
        out.push((0..count).map_while(|_| positions.position()).collect());
    }
    Some(out)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use proptest::prelude::*;

    /// A record's content of a kind with parts.
    pub(in crate::vector) fn with_parts(kind: i32, parts: &[&[(f64, f64)]]) -> Vec<u8> {
        let mut out = kind.to_le_bytes().to_vec();
        out.extend([0; 32]);
        let points: usize = parts.iter().map(|p| p.len()).sum();
        out.extend((parts.len() as i32).to_le_bytes());
        out.extend((points as i32).to_le_bytes());
        let mut from = 0_i32;
        for part in parts {
            out.extend(from.to_le_bytes());
            from += part.len() as i32;
        }
        for (x, y) in parts.iter().flat_map(|p| *p) {
            out.extend(x.to_le_bytes());
            out.extend(y.to_le_bytes());
        }
        if kind > 10 {
            // Heights: range, then one a vertex.
            out.extend(vec![0; 16 + 8 * points]);
        }
        out
    }

    pub(in crate::vector) fn file(kind: i32, records: &[Vec<u8>]) -> Vec<u8> {
        let mut out = 9994_i32.to_be_bytes().to_vec();
        out.resize(24, 0);
        let len = HEADER + records.iter().map(|r| 8 + r.len()).sum::<usize>();
        out.extend((len as i32 / 2).to_be_bytes());
        out.extend(1000_i32.to_le_bytes());
        out.extend(kind.to_le_bytes());
        out.resize(HEADER, 0);
        for (i, record) in records.iter().enumerate() {
            out.extend((i as i32 + 1).to_be_bytes());
            out.extend((record.len() as i32 / 2).to_be_bytes());
            out.extend(record);
        }
        out
    }

    const LINE: &[(f64, f64)] = &[(14.0, 50.0), (14.1, 50.0)];
    const OUTER: &[(f64, f64)] = &[(0.0, 0.0), (0.0, 3.0), (3.0, 3.0), (3.0, 0.0), (0.0, 0.0)];
    const INNER: &[(f64, f64)] = &[(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 1.0)];

    fn sample() -> Vec<u8> {
        file(
            3,
            &[with_parts(3, &[LINE, LINE]), with_parts(13, &[LINE]), with_parts(15, &[OUTER, INNER]), 0_i32.to_le_bytes().to_vec()],
        )
    }

    fn content(shp: &[u8]) -> Result<Content, SurveyError> {
        read(shp, None, None, None, "roads.shp")
    }

    #[test]
    fn lines_and_polygons_are_read_with_and_without_heights() {
        let features = content(&sample()).unwrap().features;
        let counts: Vec<usize> = features.iter().map(|f| f.shapes.iter().flat_map(Shape::positions).count()).collect();
        assert_eq!(counts, [4, 2, 9, 0]);
        let Shape::Rings(rings) = &features[2].shapes[0] else { panic!("{features:?}") };
        assert_eq!(rings.iter().map(|r| r.1).collect::<Vec<_>>(), [false, true]);
        let mut point = 21_i32.to_le_bytes().to_vec();
        point.extend([7.5_f64, 8.0, 0.0].iter().flat_map(|v| v.to_le_bytes()));
        let points = content(&file(21, &[point])).unwrap().features;
        assert_eq!(points[0].shapes, [Shape::Points(vec![DVec2::new(7.5, 8.0)])]);
    }

    #[test]
    fn attributes_belong_to_the_shape_of_their_row() {
        let shp = file(3, &[with_parts(3, &[LINE]), with_parts(3, &[LINE]), with_parts(3, &[LINE])]);
        let rows: &[&[&str]] = &[&["First"], &[], &["Third"]];
        let dbf = dbf::tests::table(&[("FULLNAME", b'C', 10)], rows);
        let names = |c: Content| c.features.iter().map(|f| f.get("fullname").unwrap().to_owned()).collect::<Vec<_>>();
        assert_eq!(names(read(&shp, Some(&dbf), None, None, "a.shp").unwrap()), ["First", "Third"]);
        let short = dbf::tests::table(&[("FULLNAME", b'C', 10)], &rows[..2]);
        let error = read(&shp, Some(&short), None, None, "a.shp").unwrap_err().to_string();
        assert!(error.contains("a.dbf") && error.contains("2 rows for the 3 shapes of a.shp"), "{error}");
    }

    #[test]
    fn counts_that_lie_are_refused_before_anything_is_allocated() {
        let error = |bytes: &[u8]| content(bytes).unwrap_err().to_string();
        assert!(error(&sample()[..150]).contains("cut off"), "{}", error(&sample()[..150]));
        let mut points = sample();
        points[HEADER + 8 + 40..HEADER + 8 + 44].copy_from_slice(&i32::MAX.to_le_bytes());
        assert!(error(&points).contains("record 1 ends within its shape"), "{}", error(&points));
        let mut long = sample();
        long[HEADER + 4..HEADER + 8].copy_from_slice(&i32::MAX.to_be_bytes());
        assert!(error(&long).contains("record 1 is longer than the file"), "{}", error(&long));
        assert!(error(&file(31, &[with_parts(31, &[LINE])])).contains("multipatches"));
        assert!(error(&file(4, &[with_parts(4, &[LINE])])).contains("unknown kind 4"));
    }

    proptest! {
        #[test]
        fn mutated_bytes_never_panic(at in prop::collection::vec((0_usize..700, any::<u8>()), 1..8), cut in 0_usize..700) {
            let mut bytes = sample();
            for (i, byte) in at {
                if let Some(b) = bytes.get_mut(i) {
                    *b = byte;
                }
            }
            let _ = content(&bytes);
            let _ = content(&bytes[..cut.min(bytes.len())]);
        }
    }
}
