use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use veduta_city::{Guide, Id, Overview, Place, PlaceKind, Viewpoint};
use veduta_ecs::City;
use veduta_route::{Finder, Named, StreetNet};

use crate::CityGuide;
use crate::near::heading_to;

/// Something besides places and streets that can be found: a tour, a command.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Offer {
    /// What a game knows it by.
    pub key: String,
    /// Its names, the one to show first.
    pub names: Vec<String>,
}

/// What a game offers in the search box. Live.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub struct Offers(
    /// In no order.
    pub Vec<Offer>,
);

/// Something offered was chosen.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct OfferTaken {
    /// What the game knows it by.
    pub key: String,
}

/// What a name stands for.
#[derive(Debug, Clone, PartialEq)]
pub enum Found {
    /// A place.
    Place(Place),
    /// A street: its name, and the middles of its pieces in plan metres.
    Street(String, Vec<DVec2>),
    /// Something that a game offers.
    Offer(Offer),
}

impl Found {
    /// Its name in the map.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Place(place) => &place.name,
            Self::Street(name, _) => name,
            Self::Offer(offer) => offer.names.first().map_or("", String::as_str),
        }
    }

    /// Where it is, or is nearest to somebody; plan metres.
    #[must_use]
    pub fn plan_pos(&self, near: DVec2) -> Option<DVec2> {
        match self {
            Self::Place(place) => Some(place.pos),
            Self::Street(_, pieces) => {
                pieces.iter().copied().min_by(|a, b| a.distance_squared(near).total_cmp(&b.distance_squared(near)))
            }
            Self::Offer(_) => None,
        }
    }
}

/// All that has a name, to be searched.
#[derive(Resource, Default)]
pub struct Directory {
    index: Arc<Index>,
    /// Of what it was made.
    source: Source,
    task: Option<(Source, Task<Index>)>,
}

#[derive(Default)]
struct Index {
    finder: Finder,
    found: Vec<Found>,
}

/// What a directory is made of, told apart by what does not change without it.
#[derive(Debug, Clone, PartialEq, Default)]
struct Source {
    parts: Vec<(u32, usize)>,
    guide: u64,
    offers: Offers,
}

impl Directory {
    /// What fits what was typed, best first, `most` at most; near `near` sooner. Each with its name that fits best.
    #[must_use]
    pub fn find(&self, typed: &str, near: DVec2, most: usize) -> Vec<(Found, String)> {
        let hits = self.index.finder.find(typed, Some(near), most);
        let told = |index: usize, name: usize| {
            let matched = self.index.finder.named().get(index)?.names.get(name)?;
            Some((self.index.found.get(index)?.clone(), matched.clone()))
        };
        hits.into_iter().filter_map(|hit| told(hit.index, hit.name)).collect()
    }

    /// How many things have a name.
    #[must_use]
    pub fn len(&self) -> usize {
        self.index.found.len()
    }

    /// Whether nothing has a name.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.index.found.is_empty()
    }

    /// A directory of some parts of a city.
    #[must_use]
    pub fn of<'a>(parts: impl IntoIterator<Item = &'a Overview>, guide: &Guide, offers: &Offers) -> Self {
        Self { index: Arc::new(Index::of(parts, guide, offers)), ..Self::default() }
    }
}

/// A house stands beside a street no farther off than this, metres.
const BESIDE_M: f64 = 40.0;

impl Index {
    fn of<'a>(parts: impl IntoIterator<Item = &'a Overview>, guide: &Guide, offers: &Offers) -> Self {
        let parts: Vec<&Overview> = parts.into_iter().collect();
        let told: BTreeMap<&str, _> = guide.places.iter().map(|place| (place.name.as_str(), place)).collect();
        let mut streets: BTreeMap<&str, Vec<DVec2>> = BTreeMap::new();
        let mut index = Self::default();
        let mut named = Vec::new();
        let mut seen = std::collections::BTreeSet::new();
        for part in &parts {
            for place in part.places.iter().filter(|place| !place.name.trim().is_empty()) {
                // A place at the border of two parts stands in both.
                if seen.insert((place.id, &place.name)) {
                    named.push(Named::place(place, told.get(place.name.as_str()).copied()));
                    index.found.push(Found::Place(place.clone()));
                }
            }
            for street in part.streets.iter().filter(|street| street.walkable && !street.name.is_empty()) {
                let middle = street.line.get(street.line.len() / 2).map(|p| p.to_metres());
                streets.entry(&street.name).or_default().extend(middle);
            }
        }
        for (name, pieces) in streets {
            let is_known = seen.iter().any(|(_, known)| *known == name);
            if let (false, Some(&first)) = (is_known, pieces.get(pieces.len() / 2)) {
                named.push(Named::street(name, first));
                index.found.push(Found::Street(name.to_owned(), pieces));
            }
        }
        index.add_houses(parts.iter().copied(), &mut named);
        for offer in &offers.0 {
            named.push(Named { names: offer.names.clone(), plan_pos: None, renown: 0.2 });
            index.found.push(Found::Offer(offer.clone()));
        }
        index.finder = Finder::new(named);
        index
    }

    /// Houses by number and street.
    fn add_houses<'a>(&mut self, parts: impl Iterator<Item = &'a Overview>, named: &mut Vec<Named>) {
        for part in parts.filter(|part| part.names.iter().any(|name| !name.number.is_empty())) {
            let net = StreetNet::new(&part.streets);
            for house in part.names.iter().filter(|name| !name.number.is_empty()) {
                let Some(outline) = part.houses.get(house.house as usize).map(|massing| &massing.outline) else { continue };
                let pos = outline.centroid();
                let foot = net.nearest(pos).filter(|foot| foot.distance_m < BESIDE_M);
                let Some(street) = foot.and_then(|foot| part.streets.get(foot.street)).filter(|s| !s.name.is_empty()) else {
                    continue;
                };
                let name = format!("{} {}", street.name, house.number);
                named.push(Named { names: vec![name.clone()], plan_pos: Some(pos), renown: 0.1 });
                let view = foot.map(|foot| Viewpoint {
                    pos: foot.plan_pos,
                    heading_deg: heading_to(foot.plan_pos, pos),
                    ..Viewpoint::default()
                });
                let id = Id(name
                    .bytes()
                    .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3)));
                self.found.push(Found::Place(Place { id, name, kind: PlaceKind::House, pos, view, ..Place::default() }));
            }
        }
    }
}

/// Makes the directory anew, beside the frame, when what it is made of has changed.
pub(crate) fn keep(city: Option<Res<City>>, guide: Res<CityGuide>, offers: Res<Offers>, mut directory: ResMut<Directory>) {
    if let Some((_, task)) = &mut directory.task {
        let Some(index) = block_on(poll_once(task)) else { return };
        if let Some((source, _)) = directory.task.take() {
            (directory.index, directory.source) = (Arc::new(index), source);
        }
    }
    let parts = || city.iter().flat_map(|city| city.overviews.iter());
    let is_same = directory.source.guide == guide.version()
        && directory.source.offers == *offers
        && parts().map(|(part, overview)| (part, Arc::as_ptr(overview) as usize)).eq(directory.source.parts.iter().copied());
    if is_same {
        return;
    }
    let source = Source {
        parts: parts().map(|(part, overview)| (part, Arc::as_ptr(overview) as usize)).collect(),
        guide: guide.version(),
        offers: offers.clone(),
    };
    let overviews: Vec<Arc<Overview>> = parts().map(|(_, overview)| Arc::clone(overview)).collect();
    let (told, offered) = (guide.guide().clone(), offers.clone());
    let task = AsyncComputeTaskPool::get().spawn(async move { Index::of(overviews.iter().map(AsRef::as_ref), &told, &offered) });
    directory.task = Some((source, task));
}

#[cfg(test)]
mod tests {
    use veduta_city::{GridPolygon, GridPos, GuidePlace, HouseName, Massing, PlanStreet};
    use veduta_ecs::Overviews;

    use super::*;

    fn town() -> Overview {
        let line = [(0, 0), (50, 0), (100, 0)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec();
        let street = |name: &str| PlanStreet {
            id: Id(7),
            name: name.into(),
            line: line.clone(),
            width: 6 * 1024,
            walkable: true,
            ..PlanStreet::default()
        };
        let place = |id, name: &str, kind| Place { id: Id(id), name: name.into(), kind, ..Place::default() };
        Overview {
            streets: vec![street("Celetná"), street("Karlova")],
            places: vec![place(1, "Powder Tower", PlaceKind::Monument), place(2, "Celetná", PlaceKind::Street)],
            ..Overview::default()
        }
    }

    fn guide() -> Guide {
        let names = [("cs".to_owned(), "Prašná brána".to_owned())].into();
        Guide { places: vec![GuidePlace { name: "Powder Tower".into(), names, ..GuidePlace::default() }], ..Guide::default() }
    }

    #[test]
    fn places_streets_and_offers_are_found_each_once() {
        let offers = Offers(vec![Offer { key: "night".into(), names: vec!["Night".into()] }]);
        let directory = Directory::of([&town(), &town()], &guide(), &offers);
        assert_eq!(directory.len(), 4, "a street that is a place is told once, and so is a place in two parts");
        let first = |typed: &str| directory.find(typed, DVec2::ZERO, 5).into_iter().next();
        assert!(
            matches!(first("prasna"), Some((Found::Place(place), name)) if place.name == "Powder Tower" && name == "Prašná brána")
        );
        assert!(matches!(first("karlov"), Some((Found::Street(name, _), _)) if name == "Karlova"));
        assert!(matches!(first("night"), Some((Found::Offer(offer), _)) if offer.key == "night"));
    }

    #[test]
    fn houses_are_found_by_street_and_number() {
        let corner = |x: i32, y: i32| GridPos((40 + x) * 1024, (12 + y) * 1024);
        let outline = GridPolygon::simple(vec![corner(-5, -5), corner(5, -5), corner(5, 5), corner(-5, 5)]);
        let names = vec![HouseName { house: 0, name: String::new(), number: "12a".into(), parts: 1 }];
        let part = Overview { houses: vec![Massing::block(outline, 9 * 1024)], names, ..town() };
        let directory = Directory::of([&part], &Guide::default(), &Offers::default());
        let (found, name) = directory.find("celetna 12a", DVec2::ZERO, 1).remove(0);
        let Found::Place(place) = found else { panic!("a house") };
        assert_eq!(name, "Celetná 12a");
        assert_ne!(place.id, Id::NONE, "houses are told apart");
        let view = place.view.expect("a stand in the street");
        assert!(view.pos.distance(DVec2::new(40.0, 0.0)) < 0.1 && view.heading_deg.abs() < 0.1, "{view:?}");
    }

    #[test]
    fn it_is_made_anew_when_the_city_comes() {
        AsyncComputeTaskPool::get_or_init(Default::default);
        let mut app = App::new();
        app.init_resource::<Directory>()
            .init_resource::<Offers>()
            .insert_resource(CityGuide::of(guide()))
            .add_systems(Update, keep);
        app.update();
        app.insert_resource(City { overviews: Overviews::whole(town()), ..City::default() });
        for _ in 0..2_000 {
            app.update();
            if app.world().resource::<Directory>().len() == 3 {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        panic!("{} things have a name", app.world().resource::<Directory>().len());
    }
}
