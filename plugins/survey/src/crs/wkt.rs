//! Well-known text of coordinate reference systems: version 1 (OGC 01-009, and Esri's dialect of it in `.prj` files) and
//! version 2 (ISO 19162), as far as the systems read here are written in it.

use glam::{DVec2, DVec3};

use super::datum::{BESSEL, Datum, Ellipsoid, S_JTSK_TO_WGS84, Shift};
use super::{Crs, CrsError, Projection};

/// Deeper than this nothing is nested that makes sense.
const DEEPEST: usize = 16;
/// More text than this is no coordinate system.
const LONGEST: usize = 64 * 1024;

/// `WORD["text", 1.5, OTHER[...]]`.
#[derive(Debug, Default)]
pub(super) struct Item {
    /// Upper case.
    word: String,
    texts: Vec<String>,
    numbers: Vec<f64>,
    items: Vec<Item>,
}

impl Item {
    fn child(&self, words: &[&str]) -> Option<&Item> {
        self.items.iter().find(|item| words.contains(&item.word.as_str()))
    }

    /// The first item of one of the words, this one or below.
    fn find(&self, words: &[&str]) -> Option<&Item> {
        if words.contains(&self.word.as_str()) {
            return Some(self);
        }
        self.items.iter().find_map(|item| item.find(words))
    }

    fn name(&self) -> &str {
        self.texts.first().map_or("", String::as_str)
    }

    fn number(&self) -> Option<f64> {
        self.numbers.first().copied()
    }

    /// The code of the register that the item itself bears.
    fn code(&self) -> Option<u32> {
        let id = self.child(&["AUTHORITY", "ID"])?;
        let is_known = id.name().eq_ignore_ascii_case("EPSG") || id.name().eq_ignore_ascii_case("ESRI");
        let text = || id.texts.get(1).and_then(|t| t.parse().ok());
        is_known.then(|| id.number().map(|n| n as u32).or_else(text)).flatten()
    }
}

/// The tree of a text; `None` if it is no well-known text.
pub(super) fn parse(text: &str) -> Option<Item> {
    if text.len() > LONGEST {
        return None;
    }
    let mut rest = text.trim();
    let item = item(&mut rest, 0)?;
    (!item.items.is_empty()).then_some(item)
}

fn item(rest: &mut &str, depth: usize) -> Option<Item> {
    if depth > DEEPEST {
        return None;
    }
    let end = rest.find(|c: char| !(c.is_ascii_alphanumeric() || c == '_'))?;
    let (word, tail) = rest.split_at(end);
    *rest = tail.trim_start();
    let mut out = Item { word: word.to_ascii_uppercase(), ..Item::default() };
    let Some(tail) = rest.strip_prefix(['[', '(']) else {
        // A bare word, as in AXIS["x", EAST].
        return Some(out);
    };
    *rest = tail;
    loop {
        *rest = rest.trim_start();
        let first = rest.chars().next()?;
        match first {
            ']' | ')' => {
                *rest = rest.get(1..)?;
                return Some(out);
            }
            ',' => *rest = rest.get(1..)?,
            '"' => {
                let (text, tail) = rest.get(1..)?.split_once('"')?;
                out.texts.push(text.to_owned());
                *rest = tail;
            }
            '+' | '-' | '.' | '0'..='9' => {
                let end = rest.find(|c: char| matches!(c, ',' | ']' | ')') || c.is_whitespace())?;
                let (number, tail) = rest.split_at(end);
                out.numbers.push(number.parse().ok().filter(|n: &f64| n.is_finite())?);
                *rest = tail;
            }
            _ if first.is_ascii_alphabetic() => out.items.push(item(rest, depth + 1)?),
            _ => return None,
        }
    }
}

/// The system that a tree describes.
pub(super) fn crs_of(tree: &Item) -> Result<Crs, CrsError> {
    let projected = tree.find(&["PROJCS", "PROJCRS", "PROJECTEDCRS"]);
    let geographic = || tree.find(&["GEOGCS", "GEOGCRS", "GEODCRS", "GEODETICCRS", "GEOGRAPHICCRS"]);
    let Some(system) = projected.or_else(geographic) else {
        return Err(CrsError::Part(format!("the word {} and no PROJCS or GEOGCS", tree.word)));
    };
    if let Some(crs) = system.code().and_then(|code| Crs::from_epsg(code).ok()) {
        return Ok(crs);
    }
    let datum = datum_of(system)?;
    if projected.is_some() { projected_of(system, datum) } else { Ok(Crs { datum, epsg: 0, ..Crs::WGS84 }) }
}

fn projected_of(system: &Item, datum: Datum) -> Result<Crs, CrsError> {
    let method = system.find(&["PROJECTION", "METHOD"]).map_or("", Item::name);
    let unit_m = unit_of(system);
    let plain = words(method);
    if plain.contains("mercatorauxiliarysphere") || plain.contains("popularvisualisation") {
        return Ok(Crs::from_epsg(3857)?.in_units_of(unit_m));
    }
    let value = |names: &[&str]| parameter(system, names);
    if plain.starts_with("krovak") {
        return krovak(system, datum, unit_m);
    }
    if plain != "transversemercator" && plain != "gausskruger" {
        return Err(CrsError::Part(format!("the projection \"{method}\"")));
    }
    let latitude = value(&["latitudeoforigin", "latitudeofnaturalorigin"]).unwrap_or(0.0);
    let longitude = value(&["centralmeridian", "longitudeofnaturalorigin", "longitudeoforigin"]);
    let Some(longitude) = longitude else {
        return Err(CrsError::Part("a transverse Mercator without its central meridian".into()));
    };
    let scale = value(&["scalefactor", "scalefactoratnaturalorigin"]).unwrap_or(1.0);
    let false_pos = DVec2::new(value(&["falseeasting"]).unwrap_or(0.0), value(&["falsenorthing"]).unwrap_or(0.0));
    if !(latitude.abs() <= 90.0 && longitude.abs() <= 360.0 && scale > 0.1 && scale < 10.0) {
        return Err(CrsError::Part("a transverse Mercator whose parameters are out of range".into()));
    }
    Ok(Crs::transverse_mercator(datum, unit_m, (latitude, longitude), scale, false_pos * unit_m))
}

/// Only the two countries' own parameters, in the form with axes east and north.
fn krovak(system: &Item, datum: Datum, unit_m: f64) -> Result<Crs, CrsError> {
    let is = |names: &[&str], wanted: f64| parameter(system, names).is_none_or(|v| (v - wanted).abs() < 1e-6);
    let is_usual = is(&["latitudeofcenter", "latitudeofprojectioncentre"], 49.5)
        && is(&["longitudeofcenter", "longitudeoforigin"], 24.0 + 50.0 / 60.0)
        && is(&["falseeasting"], 0.0)
        && is(&["falsenorthing"], 0.0);
    if !is_usual {
        return Err(CrsError::Part("a Krovak projection of other parameters than those of EPSG:5514".into()));
    }
    let is_east_north = is(&["xscale"], -1.0) && is(&["yscale"], 1.0) && is(&["xyplanerotation"], 90.0);
    let has_south = system.items.iter().any(|i| i.word == "AXIS" && i.items.iter().any(|d| d.word == "SOUTH"));
    if !is_east_north || has_south {
        return Err(CrsError::Part("a Krovak projection with axes south and west".into()));
    }
    let krovak = Crs::from_epsg(5514)?;
    debug_assert!(matches!(krovak.projection, Projection::Krovak(_)));
    Ok(Crs { datum, ..krovak.in_units_of(unit_m) })
}

/// A parameter of the projection, by its name in small letters without spaces and underscores.
fn parameter(system: &Item, names: &[&str]) -> Option<f64> {
    let holder = system.child(&["CONVERSION"]).unwrap_or(system);
    let all = holder.items.iter().filter(|item| item.word == "PARAMETER");
    all.filter(|item| names.contains(&words(item.name()).as_str())).find_map(Item::number)
}

fn words(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).collect::<String>().to_ascii_lowercase()
}

/// Metres in the unit of a projected system: its own unit, or that of its axes.
fn unit_of(system: &Item) -> f64 {
    let axes = || system.items.iter().find(|i| i.word == "AXIS").and_then(|axis| axis.child(&["LENGTHUNIT", "UNIT"]));
    let unit = system.child(&["UNIT", "LENGTHUNIT"]).or_else(axes);
    unit.and_then(Item::number).filter(|&m| m > 1e-4 && m < 1e4).unwrap_or(1.0)
}

/// The datum of a system: one that lies on WGS 84, S-JTSK, or one whose shift is given.
fn datum_of(system: &Item) -> Result<Datum, CrsError> {
    let Some(spheroid) = system.find(&["SPHEROID", "ELLIPSOID"]) else {
        return Err(CrsError::Part("no ellipsoid".into()));
    };
    if let Some(meridian) = system.find(&["PRIMEM", "PRIMEMERIDIAN"]).filter(|m| m.number().is_some_and(|lon| lon != 0.0)) {
        return Err(CrsError::Part(format!("the prime meridian \"{}\"", meridian.name())));
    }
    let &[a, inverse_f, ..] = spheroid.numbers.as_slice() else {
        return Err(CrsError::Part(format!("the ellipsoid \"{}\" without its numbers", spheroid.name())));
    };
    if !((6.3e6..6.4e6).contains(&a) && (250.0..350.0).contains(&inverse_f)) {
        return Err(CrsError::Part(format!("the ellipsoid \"{}\"", spheroid.name())));
    }
    let ellipsoid = Ellipsoid { a, f: 1.0 / inverse_f };
    if let Some(&[x, y, z, ref turn @ ..]) = system.find(&["TOWGS84"]).map(|t| t.numbers.as_slice()) {
        let turn: [f64; 4] = turn.try_into().unwrap_or_default();
        let shift = Shift { metres: DVec3::new(x, y, z), seconds: DVec3::new(turn[0], turn[1], turn[2]), ppm: turn[3] };
        return Ok(Datum { ellipsoid, shift: (shift.metres != DVec3::ZERO).then_some(shift) });
    }
    let name = system.find(&["DATUM", "ENSEMBLE", "GEODETICDATUM"]).map_or("", Item::name);
    let plain = words(name);
    if a == BESSEL.a && (plain.contains("jtsk") || plain.contains("unifiedtrigonometrical")) {
        return Ok(Datum { ellipsoid: BESSEL, shift: Some(S_JTSK_TO_WGS84) });
    }
    // The ellipsoids of the age of satellites; datums on them lie within two metres of WGS 84.
    let is_modern = a == 6_378_137.0 && (298.25..298.26).contains(&inverse_f);
    if is_modern { Ok(Datum { ellipsoid, shift: None }) } else { Err(CrsError::Part(format!("the datum \"{name}\""))) }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::Crs;
    use super::*;

    /// As Esri writes it; only the parameters tell what it is.
    const ESRI_KROVAK: &str = r#"PROJCS["S-JTSK_Krovak_East_North",GEOGCS["GCS_S_JTSK",DATUM["D_S_JTSK",SPHEROID["Bessel_1841",6377397.155,299.1528128]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Krovak"],PARAMETER["False_Easting",0.0],PARAMETER["False_Northing",0.0],PARAMETER["Pseudo_Standard_Parallel_1",78.5],PARAMETER["Scale_Factor",0.9999],PARAMETER["Azimuth",30.28813975277778],PARAMETER["Longitude_Of_Center",24.83333333333333],PARAMETER["Latitude_Of_Center",49.5],PARAMETER["X_Scale",-1.0],PARAMETER["Y_Scale",1.0],PARAMETER["XY_Plane_Rotation",90.0],UNIT["Meter",1.0]]"#;
    const ESRI_UTM: &str = r#"PROJCS["ETRS_1989_UTM_Zone_33N",GEOGCS["GCS_ETRS_1989",DATUM["D_ETRS_1989",SPHEROID["GRS_1980",6378137.0,298.257222101]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",15.0],PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]]"#;
    const GDAL_KROVAK: &str = r#"PROJCS["S-JTSK / Krovak East North",GEOGCS["S-JTSK",DATUM["System_of_the_Unified_Trigonometrical_Cadastral_Network",SPHEROID["Bessel 1841",6377397.155,299.1528128,AUTHORITY["EPSG","7004"]],AUTHORITY["EPSG","6156"]],PRIMEM["Greenwich",0,AUTHORITY["EPSG","8901"]],UNIT["degree",0.0174532925199433,AUTHORITY["EPSG","9122"]],AUTHORITY["EPSG","4156"]],PROJECTION["Krovak"],UNIT["metre",1,AUTHORITY["EPSG","9001"]],AXIS["Easting",EAST],AXIS["Northing",NORTH],AUTHORITY["EPSG","5514"]]"#;
    const WKT2_UTM: &str = r#"PROJCRS["WGS 84 / UTM zone 33N",BASEGEOGCRS["WGS 84",ENSEMBLE["World Geodetic System 1984 ensemble",MEMBER["World Geodetic System 1984 (Transit)"],ELLIPSOID["WGS 84",6378137,298.257223563,LENGTHUNIT["metre",1]],ENSEMBLEACCURACY[2.0]],PRIMEM["Greenwich",0]],CONVERSION["UTM zone 33N",METHOD["Transverse Mercator",ID["EPSG",9807]],PARAMETER["Latitude of natural origin",0],PARAMETER["Longitude of natural origin",15],PARAMETER["Scale factor at natural origin",0.9996],PARAMETER["False easting",500000],PARAMETER["False northing",0]],CS[Cartesian,2],AXIS["(E)",east,ORDER[1],LENGTHUNIT["metre",1]],AXIS["(N)",north,ORDER[2],LENGTHUNIT["metre",1]]]"#;
    const DHDN_ZONE_4: &str = r#"PROJCS["DHDN / Gauss-Kruger zone 4",GEOGCS["DHDN",DATUM["Deutsches_Hauptdreiecksnetz",SPHEROID["Bessel 1841",6377397.155,299.1528128],TOWGS84[598.1,73.7,418.2,0.202,0.045,-2.455,6.7]],PRIMEM["Greenwich",0],UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",12],PARAMETER["scale_factor",1],PARAMETER["false_easting",4500000],PARAMETER["false_northing",0],UNIT["metre",1]]"#;

    fn pos(text: &str, lat: f64, lon: f64) -> DVec2 {
        Crs::from_text(text).unwrap_or_else(|e| panic!("{e}")).pos_from_geo(lat, lon).unwrap()
    }

    #[test]
    fn systems_in_words_are_those_of_their_codes() {
        for (text, code) in [(ESRI_KROVAK, 5514), (GDAL_KROVAK, 5514), (ESRI_UTM, 25_833), (WKT2_UTM, 32_633)] {
            let by_code = Crs::from_epsg(code).unwrap().pos_from_geo(50.1, 14.4).unwrap();
            assert!(pos(text, 50.1, 14.4).distance(by_code) < 1e-6, "EPSG:{code}");
        }
        assert_eq!(
            Crs::from_text(r#"GEOGCS["NAD83",DATUM["x",SPHEROID["GRS 1980",6378137,298.257222101]]]"#)
                .unwrap()
                .pos_from_geo(45.5, -122.5),
            Some(DVec2::new(-122.5, 45.5))
        );
    }

    #[test]
    fn a_shift_in_the_text_is_applied() {
        // PROJ 9.5, the same parameters.
        assert!(
            pos(DHDN_ZONE_4, 49.5, 11.28).distance(DVec2::new(4_447_952.337, 5_485_041.889)) < 0.02,
            "{}",
            pos(DHDN_ZONE_4, 49.5, 11.28)
        );
    }

    #[test]
    fn what_is_not_read_is_named() {
        let error = |text: &str| Crs::from_text(text).unwrap_err().to_string();
        assert!(error(&ESRI_UTM.replace("Transverse_Mercator", "Lambert_Conformal_Conic")).contains("Lambert_Conformal_Conic"));
        assert!(error(&DHDN_ZONE_4.replace("TOWGS84", "NOTHING")).contains("Deutsches_Hauptdreiecksnetz"));
        assert!(error(&ESRI_KROVAK.replace("90.0", "0.0")).contains("south and west"));
        assert!(error(&ESRI_KROVAK.replace("PRIMEM[\"Greenwich\",0.0]", "PRIMEM[\"Ferro\",-17.6666666666667]")).contains("Ferro"));
        assert!(error(r#"LOCAL_CS["site",UNIT["m",1]]"#).contains("LOCAL_CS"));
    }

    #[test]
    fn feet_are_metres() {
        let feet = ESRI_UTM
            .replace("UNIT[\"Meter\",1.0]]", "UNIT[\"Foot_US\",0.3048006096012192]]")
            .replace("500000.0", "1640416.666666667");
        let metres = pos(&feet, 50.1, 14.4) * 0.304_800_609_601_219_2;
        assert!(metres.distance(pos(ESRI_UTM, 50.1, 14.4)) < 1e-4);
    }

    proptest! {
        #[test]
        fn broken_text_gives_an_error_and_no_panic(at in 0usize..900, with in "\\PC{0,6}", cut in 0usize..900) {
            for whole in [ESRI_KROVAK, WKT2_UTM, DHDN_ZONE_4] {
                let mut chars: Vec<char> = whole.chars().collect();
                let at = at.min(chars.len());
                chars.splice(at..(at + 3).min(chars.len()), with.chars());
                chars.truncate(cut.max(10));
                let text: String = chars.into_iter().collect();
                if let Ok(crs) = Crs::from_text(&text) {
                    let _ = crs.pos_from_geo(50.0, 14.0).map(|p| crs.geo_from_pos(p));
                }
            }
            let deep = "A[".repeat(cut * 100);
            prop_assert!(Crs::from_text(&deep).is_err());
        }
    }
}
