use veduta_city::Overview;

use crate::blob::{BlobKind, pack_with, unpack_with};
use crate::wire::WireOverview;
use crate::{BlobRef, CellEntry, CityIndex, Reader, RegionHouses, StoreError, valid};

/// What an overview need not tell, because its region does. It is read with what it was written with, as a packet is.
#[derive(Debug, Clone, Copy, Default)]
pub struct OverviewContext<'a> {
    /// Number of the region's first cell.
    pub first: u32,
    /// The region's cells.
    pub cells: &'a [CellEntry],
    /// The region's houses.
    pub houses: Option<&'a RegionHouses>,
}

/// Stored form of an overview. Outlines and heights must be multiples of [`veduta_city::MAP_STEP`].
#[must_use]
pub fn encode_overview(overview: &Overview, context: OverviewContext<'_>) -> Vec<u8> {
    pack_with(BlobKind::Overview, &WireOverview::of(overview, context))
}

/// The overview of a whole city, or of what its index tells so far, put together: waits for the reader. For tools; walkers read what they
/// come to.
///
/// # Errors
/// If a part of it cannot be read or understood; the error names the file.
pub fn read_overview(reader: &dyn Reader, index: &CityIndex) -> Result<Overview, StoreError> {
    let parts = index.regions_here().map(|(number, region)| {
        let context = index.overview_context(number);
        let stored = reader.read(&region.overview.path(), u64::from(region.overview.bytes))?;
        decode_overview(&stored, &region.overview, context)
            .map_err(|error| error.in_file(reader.describe(), &region.overview.path()))
    });
    Ok(Overview::joined(&parts.collect::<Result<Vec<_>, _>>()?))
}

/// The overview of stored bytes that the reference stands for.
///
/// # Errors
/// If the bytes are not those, cannot be decoded, or contradict themselves.
pub fn decode_overview(stored: &[u8], blob: &BlobRef, context: OverviewContext<'_>) -> Result<Overview, StoreError> {
    let what = BlobKind::Overview.words();
    let overview = unpack_with(BlobKind::Overview, stored, blob, |wire: WireOverview, outlines| wire.pull(context, outlines))?;
    valid::check_overview(&overview).map_err(|reason| StoreError::Invalid { what, reason })?;
    Ok(overview)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use veduta_city::{
        District, GridPolygon, GridPos, GroundPatch, HouseName, Id, MAP_STEP, Massing, Place, PlaceKind, PlanRoof, PlanStreet,
        PlanTerrain, Rgb, RoofShape, SpanForm, SpanStation, StreetClass, SurfaceKind, Viewpoint, WaySpan,
    };

    use super::*;

    fn outline(x: i32) -> GridPolygon {
        GridPolygon::simple([(x, 0), (x + 40, 0), (x + 40, 50), (x, 50)].map(|(x, y)| GridPos(x * MAP_STEP, y * MAP_STEP)).to_vec())
    }

    /// Something of everything.
    fn full() -> Overview {
        let massing = |(n, shape): (i32, RoofShape)| {
            let (outline, height) = (outline(40 * n), 3 * MAP_STEP);
            let direction = Massing::quarter_deg(&outline, n as u8 % 4);
            let roof = PlanRoof { shape, height, direction, colour: Rgb(170, 68, 51) };
            Massing { outline, height: 30 * MAP_STEP, roof, colour: Rgb(17 * n as u8, 204, 153) }
        };
        let patch = |surface| GroundPatch { surface, outline: outline(-40), z: -77, course: None };
        let station = |x| SpanStation { left: GridPos(x, 9), right: GridPos(x, -9), z: 5_000 };
        let span = WaySpan {
            id: Id(5),
            form: SpanForm::Girder,
            surface: SurfaceKind::Asphalt,
            pavements: (900, 0),
            parapets: (true, false),
            stations: vec![station(0), station(900)],
            springing: -40,
            piers: (None, Some(-5_000)),
            markings: Vec::new(),
        };
        let view = Viewpoint { pos: DVec2::new(-3.25, 17.0), eye_m: 1.65, heading_deg: 271.5, pitch_deg: -3.0 };
        let place = |view| Place {
            id: Id(7 << 58),
            name: "Týn".into(),
            kind: PlaceKind::Monument,
            pos: DVec2::new(12.34, -0.01),
            radius_m: 25.5,
            text: "Two towers.".into(),
            view,
        };
        let street = PlanStreet {
            id: Id(9),
            name: "Celetná".into(),
            line: vec![GridPos(5, 6), GridPos(7_000, 8)],
            width: 8_192,
            walkable: true,
            layer: -1,
            class: StreetClass::Steps,
        };
        let houses: Vec<Massing> =
            (0..).zip([RoofShape::Flat, RoofShape::Gabled, RoofShape::Hipped, RoofShape::Dome]).map(massing).collect();
        Overview {
            terrain: PlanTerrain { origin: GridPos(-9, 9), step: 4_096, columns: 2, heights: vec![1, 2, 3, 5] },
            streets: vec![street],
            ground: vec![patch(SurfaceKind::Cobbles), patch(SurfaceKind::Water)],
            names: vec![HouseName { house: 2, name: "U Minuty".into(), number: "3".into(), parts: 2 }],
            houses,
            spans: vec![span],
            places: vec![place(Some(view)), place(None)],
            districts: vec![
                District { cell: 70, ground: 2, houses: 3, spans: 0 },
                District { cell: 72, ground: 0, houses: 1, spans: 1 },
            ],
        }
    }

    fn read(overview: &Overview) -> Result<Overview, StoreError> {
        let context = OverviewContext::default();
        let stored = encode_overview(overview, context);
        decode_overview(&stored, &BlobRef::of(&stored), context)
    }

    #[test]
    fn everything_survives() {
        assert_eq!(read(&full()), Ok(full()));
    }

    #[test]
    fn a_form_that_changed_has_a_new_version() {
        let form = blake3::hash(&encode_overview(&full(), OverviewContext::default())).to_hex();
        assert_eq!((crate::FORMAT_VERSION, &form[..16]), (22, "b1bcf56ffc032b90"), "raise FORMAT_VERSION if this is on purpose");
    }

    #[test]
    fn districts_that_do_not_add_up_are_refused() {
        let refused = |spoil: fn(&mut Overview)| {
            let mut overview = full();
            spoil(&mut overview);
            read(&overview).expect_err("refused").to_string()
        };
        let error = refused(|overview| overview.districts[0].houses = 9);
        assert!(error.contains("its districts have 10 houses of 4"), "{error}");
        for parts in [0, 3] {
            let mut overview = full();
            overview.names[0].parts = parts;
            let error = read(&overview).expect_err("refused").to_string();
            assert!(error.contains(&format!("`U Minuty` has {parts} parts")), "{error}");
        }
        let error = refused(|overview| overview.districts.truncate(1));
        assert!(error.contains("3 houses of 4"), "{error}");
        let error = refused(|overview| overview.houses[0].roof.height = i32::MAX);
        assert!(error.contains("its roof is at a height"), "{error}");
    }

    #[test]
    fn ground_on_too_many_squares_is_refused() {
        let wide = GridPolygon::simple(vec![GridPos(0, 0), GridPos(1 << 28, 0), GridPos(1 << 28, 1 << 28)]);
        let overview = Overview {
            terrain: PlanTerrain { origin: GridPos(0, 0), step: 1_024, columns: 1_000, heights: vec![7; 1_000_000] },
            ground: vec![GroundPatch { outline: wide, ..full().ground[0].clone() }; 5],
            ..Overview::default()
        };
        let error = read(&overview).expect_err("refused").to_string();
        assert!(error.contains("squares of its terrain"), "{error}");
    }
}
