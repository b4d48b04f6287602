use glam::DVec2;
use serde::{Deserialize, Serialize};
use veduta_city::{Id, Place, PlaceKind, Viewpoint};

use super::{
    Malformed,
    columns::{Ids, Pull, Texts},
    expecting,
};

/// [Rounded](Place::rounded) [`Place`]s in columns; lengths in centimetres, angles in hundredths of degrees.
#[derive(Serialize, Deserialize)]
pub(super) struct WirePlaces {
    /// What differs from those that places have by where they lie.
    ids: Ids,
    kinds: Vec<PlaceKind>,
    marks: Vec<WireMark>,
    /// Name and text of each.
    texts: Texts,
}

#[derive(Serialize, Deserialize)]
struct WireMark {
    /// From the place before.
    step: (i32, i32),
    radius: i32,
    view: Option<WireView>,
}

#[derive(Serialize, Deserialize)]
struct WireView {
    /// From the place.
    step: (i32, i32),
    eye: i32,
    heading: i32,
    pitch: i32,
}

fn usual_id(pos: DVec2) -> Id {
    Id::from_place("place", pos)
}

const fn hundredths(n: f64) -> i32 {
    (n * 100.0).round() as i32
}

fn whole(hundredths: i32) -> f64 {
    f64::from(hundredths) / 100.0
}

/// A position, from another or from where steps lead from it; wraps.
fn steps(from: (i32, i32), to: DVec2) -> (i32, i32) {
    (hundredths(to.x).wrapping_sub(from.0), hundredths(to.y).wrapping_sub(from.1))
}

fn place(from: (i32, i32), step: (i32, i32)) -> ((i32, i32), DVec2) {
    let at = (from.0.wrapping_add(step.0), from.1.wrapping_add(step.1));
    (at, DVec2::new(whole(at.0), whole(at.1)))
}

impl WirePlaces {
    pub(super) fn of(places: &[Place]) -> Self {
        let mut ids = Ids::default();
        places.iter().for_each(|place| ids.push(Id(place.id.0 ^ usual_id(place.pos).0)));
        let mut last = (0, 0);
        let mark = |place: &Place| {
            let at = (hundredths(place.pos.x), hundredths(place.pos.y));
            let step = steps(core::mem::replace(&mut last, at), place.pos);
            let view = place.view.map(|view| WireView {
                step: steps(at, view.pos),
                eye: hundredths(view.eye_m),
                heading: hundredths(view.heading_deg),
                pitch: hundredths(view.pitch_deg),
            });
            WireMark { step, radius: hundredths(place.radius_m), view }
        };
        Self {
            ids,
            kinds: places.iter().map(|place| place.kind).collect(),
            marks: places.iter().map(mark).collect(),
            texts: Texts::of(places.iter().flat_map(|place| [place.name.as_str(), place.text.as_str()])),
        }
    }

    pub(super) fn pull(self) -> Result<Vec<Place>, Malformed> {
        let mut ids = self.ids.pull();
        let mut kinds = Pull::new("kinds of places", self.kinds);
        let mut texts = self.texts.pull()?;
        let mut places = expecting(self.marks.len());
        let mut last = (0, 0);
        for WireMark { step, radius, view } in self.marks {
            let (at, pos) = place(last, step);
            last = at;
            let view = view.map(|view| Viewpoint {
                pos: place(at, view.step).1,
                eye_m: whole(view.eye),
                heading_deg: whole(view.heading),
                pitch_deg: whole(view.pitch),
            });
            let (id, kind) = (Id(ids.take()?.0 ^ usual_id(pos).0), kinds.take()?);
            places.push(Place { id, kind, pos, radius_m: whole(radius), view, name: texts.take()?, text: texts.take()? });
        }
        ids.finish()?;
        kinds.finish()?;
        texts.finish()?;
        Ok(places)
    }
}
