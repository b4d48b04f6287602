use glam::DVec2;
use serde::{Deserialize, Serialize};
use veduta_city::{Place, PlaceKind, Viewpoint};

use super::{
    Malformed,
    columns::{Ids, Pull, Texts},
};

/// [`Place`]s in columns.
#[derive(Serialize, Deserialize)]
pub(super) struct WirePlaces {
    ids: Ids,
    kinds: Vec<PlaceKind>,
    marks: Vec<(DVec2, f64, Option<Viewpoint>)>,
    /// Name and text of each.
    texts: Texts,
}

impl WirePlaces {
    pub(super) fn of(places: &[Place]) -> Self {
        let mut ids = Ids::default();
        places.iter().for_each(|place| ids.push(place.id));
        Self {
            ids,
            kinds: places.iter().map(|place| place.kind).collect(),
            marks: places.iter().map(|place| (place.pos, place.radius_m, place.view)).collect(),
            texts: Texts::of(places.iter().flat_map(|place| [place.name.as_str(), place.text.as_str()])),
        }
    }

    pub(super) fn pull(self) -> Result<Vec<Place>, Malformed> {
        let mut ids = self.ids.pull();
        let mut kinds = Pull::new("kinds of places", self.kinds);
        let mut texts = self.texts.pull()?;
        let mut places = Vec::with_capacity(self.marks.len());
        for (pos, radius_m, view) in self.marks {
            let (id, kind) = (ids.take()?, kinds.take()?);
            places.push(Place { id, kind, pos, radius_m, view, name: texts.take()?, text: texts.take()? });
        }
        ids.finish()?;
        kinds.finish()?;
        texts.finish()?;
        Ok(places)
    }
}
