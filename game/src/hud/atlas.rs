use std::path::PathBuf;
use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use veduta::city::{Overview, file};
use veduta::ecs::{Around, PlaceNames, Route, TourPath, Words};
use veduta::minimap::{ExportMap, MapFormat, Trail};
use veduta::prelude::*;
use veduta_cartography::{Detail, MapWords, Order, Paper, Ways, draw, to_png, to_svg};
use veduta_route::fold;

use super::diary::StillsFolder;
use super::notes::Notes;

/// Maps that are being drawn and written, beside the frame.
#[derive(Resource, Default)]
pub(super) struct Saving(Vec<Task<Result<PathBuf, String>>>);

/// Pixels an inch of a saved picture.
const DPI: f64 = 200.0;

/// What a saved map is made of.
struct Job {
    parts: Vec<Arc<Overview>>,
    title: String,
    credit: String,
    language: String,
    written: PlaceNames,
    ways: Ways,
    asked: ExportMap,
}

/// Saves what the large map shows, where it is asked for, and tells where it lies.
pub(super) fn save_maps(
    mut asked: MessageReader<ExportMap>,
    (city, route, tour, trail): (Option<Res<City>>, Option<Res<Route>>, Option<Res<TourPath>>, Option<Res<Trail>>),
    (words, written, folder): (Res<Words>, Option<Res<PlaceNames>>, Res<StillsFolder>),
    time: Res<Time<Real>>,
    mut saving: ResMut<Saving>,
    mut notes: ResMut<Notes>,
) {
    for asked in asked.read() {
        let Some(city) = &city else { continue };
        let around = Around { middle: asked.middle, radius_m: asked.size_m.length() / 2.0 };
        let way = route.as_ref().map(|route| route.way.clone()).filter(|way| way.len() > 1);
        let job = Job {
            parts: city.overviews.near(around).map(Arc::clone).collect(),
            title: city.name.clone(),
            credit: city.attribution.clone(),
            language: words.language().to_owned(),
            written: written.as_ref().map(|names| (**names).clone()).unwrap_or_default(),
            ways: Ways {
                led: way.into_iter().collect(),
                tour: tour.as_ref().map(|tour| tour.0.clone()).unwrap_or_default(),
                trail: trail.as_ref().map(|trail| trail.0.clone()).unwrap_or_default(),
            },
            asked: asked.clone(),
        };
        let folder = folder.clone();
        saving.0.push(AsyncComputeTaskPool::get().spawn(async move { job.save(&folder) }));
    }
    if saving.0.is_empty() {
        return;
    }
    let now_s = time.elapsed_secs_f64();
    saving.0.retain_mut(|task| match block_on(poll_once(task)) {
        None => true,
        Some(Ok(path)) => {
            let path = path.display().to_string();
            info!("visit: map {path}");
            notes.add(words.say_with("map-saved", &[("path", path.into())]), false, now_s);
            false
        }
        Some(Err(why)) => {
            notes.add(words.say_with("map-not-saved", &[("why", why.into())]), true, now_s);
            false
        }
    });
}

impl Job {
    fn save(&self, folder: &StillsFolder) -> Result<PathBuf, String> {
        let bytes = self.draw()?;
        std::fs::create_dir_all(&folder.0).map_err(|error| format!("{}: {error}", folder.0.display()))?;
        let path = folder.next_named("map", if self.asked.format == MapFormat::Svg { "svg" } else { "png" });
        file::write_bytes(&bytes, &path).map_err(|error| error.to_string())?;
        Ok(path)
    }

    fn draw(&self) -> Result<Vec<u8>, String> {
        let asked = &self.asked;
        let overview = Overview::joined(self.parts.iter().map(AsRef::as_ref));
        let words = MapWords::of(&self.language).or_else(|_| MapWords::of("en")).map_err(|error| error.to_string())?;
        // What is shown on the screen, on the sheet whose side it fits.
        let paper = if asked.size_m.x >= asked.size_m.y { A3_MM } else { DVec2::new(A3_MM.y, A3_MM.x) };
        let room = paper - DVec2::new(16.0, 49.0);
        let denominator = (asked.size_m * 1000.0 / room).max_element();
        let drawn = draw(&Order {
            overview: &overview,
            detail: &Detail::default(),
            extent: None,
            title: &self.title,
            credit: &self.credit,
            date: None,
            paper: Paper { size_mm: paper, may_turn: false },
            denominator: Some((denominator / 50.0).ceil().max(2.0) * 50.0),
            middle: Some(asked.middle),
            up_deg: asked.up_deg,
            layers: asked.layers,
            colours: asked.colours,
            has_index: false,
            ways: &self.ways,
            words: &words,
            written: &|name| self.written.of(name).to_owned(),
            sorted_by: &fold,
        });
        let drawing = drawn.map_err(|error| error.to_string())?.drawing;
        match asked.format {
            MapFormat::Svg => Ok(to_svg(&drawing).into_bytes()),
            MapFormat::Png => to_png(&drawing, DPI).map_err(|error| error.to_string()),
        }
    }
}

/// A sheet across, millimetres.
const A3_MM: DVec2 = DVec2::new(420.0, 297.0);

#[cfg(test)]
mod tests {
    use veduta::city::{GridPos, Id, PlanStreet};
    use veduta_cartography::{Colours, Layers};

    use super::*;

    fn job(format: MapFormat) -> Job {
        let line = [(0, 0), (300, 0)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec();
        let street = PlanStreet { id: Id(1), name: "Long".into(), line, width: 9 * 1024, walkable: true, ..PlanStreet::default() };
        let part = Arc::new(Overview { streets: vec![street], ..Overview::default() });
        let asked = ExportMap {
            format,
            middle: DVec2::new(150.0, 0.0),
            size_m: DVec2::new(400.0, 225.0),
            up_deg: 0.0,
            layers: Layers::ALL,
            colours: Colours::Paper,
        };
        let written = PlaceNames([("Long".to_owned(), "Dlouhá".to_owned())].into());
        let (title, credit, language) = ("Town".into(), "© somebody".into(), "cs".into());
        Job { parts: vec![part], title, credit, language, written, ways: Ways::default(), asked }
    }

    #[test]
    fn maps_are_written_one_after_another_and_over_none() {
        let dir = std::env::temp_dir().join(format!("veduta-maps-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&dir);
        let folder = StillsFolder(dir.clone());
        let first = job(MapFormat::Svg).save(&folder).expect("room");
        assert!(first.ends_with("map_0001.svg"));
        assert!(job(MapFormat::Svg).save(&folder).is_ok_and(|path| path.ends_with("map_0002.svg")));
        let svg = std::fs::read_to_string(first).expect("it was written");
        assert!(svg.contains("Long</textPath>") && svg.contains("Data: © somebody") && svg.contains("1 : 1\u{a0}000"), "{svg}");
        let png = job(MapFormat::Png).save(&folder).expect("room");
        assert!(std::fs::read(png).is_ok_and(|bytes| bytes.starts_with(b"\x89PNG")));
        let _ = std::fs::remove_dir_all(dir);
    }

    #[test]
    fn where_nothing_can_be_drawn_or_written_it_is_told() {
        let mut empty = job(MapFormat::Png);
        empty.parts.clear();
        let nowhere = StillsFolder(PathBuf::from("Cargo.toml/beneath"));
        assert!(empty.save(&nowhere).is_err_and(|why| why.contains("nothing to draw")));
        assert!(job(MapFormat::Svg).save(&nowhere).is_err_and(|why| why.contains("beneath")));
    }
}
