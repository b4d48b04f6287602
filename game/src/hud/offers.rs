use std::path::{Path, PathBuf};

use bevy::prelude::*;
use clap::ValueEnum;
use veduta::city::{Tour, file};
use veduta::ecs::{CITY_SOURCE, Words, WordsValue};
use veduta::guide::{Offer, OfferTaken, Offers};
use veduta::minimap::MapView;
use veduta::prelude::*;
use veduta::tour::{EditorCommand, TourAsset};

use super::Open;
use crate::profile::Profile;
use crate::settings::Settings;
use crate::walk::FirstTour;

/// The tours of the city: their files, or the asset server's paths of those that travel with it, and titles.
#[derive(Resource, Debug, Clone, PartialEq, Eq, Default)]
pub(crate) struct TourFiles(pub Vec<(PathBuf, String)>);

impl TourFiles {
    /// The tours of a folder, by name; those that cannot be read are left out.
    pub fn in_folder(folder: &Path) -> Self {
        let files = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path());
        let tours = files.filter(|path| path.file_name().is_some_and(|name| name.to_string_lossy().ends_with(".tour.ron")));
        let titled = |path: PathBuf| file::read::<Tour>(&path).ok().map(|tour| (path, tour.title));
        let mut tours: Vec<(PathBuf, String)> = tours.filter_map(titled).collect();
        tours.sort();
        Self(tours)
    }
}

/// Path for the asset server of a tour: as it is where it names its source, else in the scene's folder.
pub(crate) fn asset_path(tour: &Path) -> String {
    let path = tour.to_string_lossy();
    if path.contains("://") {
        path.into_owned()
    } else {
        format!("tours://{}", tour.file_name().unwrap_or_default().to_string_lossy())
    }
}

/// Where no tours lie beside a city that opens, those that travel with it are offered as they come.
pub(super) fn meet(
    mut opened: MessageReader<CityOpened>,
    (city, server, loaded): (Option<Res<City>>, Option<Res<AssetServer>>, Option<Res<Assets<TourAsset>>>),
    mut coming: Local<Vec<Handle<TourAsset>>>,
    mut tours: ResMut<TourFiles>,
    first: Option<Res<FirstTour>>,
    mut commands: Commands,
) {
    let (Some(city), Some(server), Some(loaded)) = (city, server, loaded) else { return };
    if opened.read().count() > 0 {
        let of_city = |path: &Path| path.to_string_lossy().starts_with(CITY_SOURCE);
        if tours.0.iter().any(|(path, _)| of_city(path)) {
            tours.0.retain(|(path, _)| !of_city(path));
        }
        if tours.0.is_empty() {
            let own = city.files.iter().filter(|path| path.ends_with(".tour.ron"));
            *coming = own.map(|path| server.load(format!("{CITY_SOURCE}://{path}"))).collect();
        }
    }
    coming.retain(|handle| {
        let (Some(asset), Some(path)) = (loaded.get(handle), handle.path()) else { return !server.load_state(handle).is_failed() };
        let path = PathBuf::from(path.to_string());
        if first.is_none() && tours.0.is_empty() {
            commands.insert_resource(FirstTour { path: path.clone(), at_once: false });
        }
        tours.0.push((path, asset.tour.title.clone()));
        tours.0.sort();
        false
    });
}

/// What can be asked for by name: a key, and the message that names it.
const COMMANDS: [(&str, &str); 19] = [
    ("quality low", "offer-quality-low"),
    ("quality medium", "offer-quality-medium"),
    ("quality high", "offer-quality-high"),
    ("quality ultra", "offer-quality-ultra"),
    ("hour 12", "offer-noon"),
    ("hour 20.2", "offer-dusk"),
    ("hour 23", "offer-night"),
    ("wet 1", "offer-rain"),
    ("wet 0", "offer-dry"),
    ("day 115", "offer-spring"),
    ("day 196", "offer-summer"),
    ("day 290", "offer-autumn"),
    ("day 15", "offer-winter"),
    ("map", "offer-map"),
    ("settings", "offer-settings"),
    ("help", "offer-help"),
    ("record", "offer-record"),
    ("edit", "offer-edit"),
    ("new", "offer-new"),
];

/// Languages: their codes, and their names in themselves and in English.
const LANGUAGES: [(&str, &str, &str); 3] =
    [("en", "English", "English"), ("cs", "Čeština", "Czech"), ("it", "Italiano", "Italian")];

/// Keeps what is offered in the visitor's language.
pub(super) fn offer(words: Res<Words>, tours: Res<TourFiles>, mut offers: ResMut<Offers>) {
    if !(words.is_changed() || tours.is_changed()) {
        return;
    }
    let tour = |(path, title): &(PathBuf, String)| Offer {
        key: format!("tour {}", path.display()),
        names: vec![words.say_with("offer-tour", &[("title", WordsValue::from(title.clone()))]), title.clone()],
    };
    let command = |&(key, message): &(&str, &str)| {
        let mut names = vec![words.say(message)];
        // Whoever types English is understood too.
        names.extend(words.said_in("en", message).filter(|name| *name != names[0]));
        Offer { key: key.to_owned(), names }
    };
    let language = |&(code, own, english): &(&str, &str, &str)| Offer {
        key: format!("language {code}"),
        names: vec![own.to_owned(), english.to_owned()],
    };
    let all = tours.0.iter().map(tour).chain(LANGUAGES.iter().map(language)).chain(COMMANDS.iter().map(command));
    offers.set_if_neq(Offers(all.collect()));
}

/// Does what was chosen.
pub(super) fn take(
    mut taken: MessageReader<OfferTaken>,
    mut commands: Commands,
    mut clock: ResMut<CityClock>,
    mut weather: ResMut<Weather>,
    (mut open, mut map, mut settings): (ResMut<Open>, ResMut<MapView>, ResMut<Settings>),
    (mut tour, mut editor): (MessageWriter<TourCommand>, MessageWriter<EditorCommand>),
) {
    for OfferTaken { key } in taken.read() {
        let (what, value) = key.split_once(' ').unwrap_or((key, ""));
        match what {
            "hour" => clock.hour = value.parse().unwrap_or(clock.hour),
            "day" => clock.day = value.parse().unwrap_or(clock.day),
            "wet" => {
                let wet = value.parse().unwrap_or(weather.wet);
                *weather = Weather { wet, clouds: if wet > 0.5 { 0.85 } else { Weather::default().clouds }, ..*weather };
            }
            "language" => settings.language = Some(value.to_owned()),
            "quality" => settings.profile = Profile::from_str(value, true).ok(),
            "map" => (map.open, map.radius_m) = (true, map.radius_m.max(320.0)),
            "settings" => open.settings = true,
            "help" => open.help = true,
            "record" => _ = editor.write(EditorCommand::Record),
            "edit" => _ = editor.write(EditorCommand::Open),
            "new" => _ = editor.write(EditorCommand::New),
            "tour" => {
                let path = PathBuf::from(value);
                tour.write(TourCommand::Open(asset_path(&path)));
                commands.insert_resource(FirstTour { path, at_once: false });
            }
            _ => warn!("nothing is known by {key:?}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn app() -> App {
        let mut app = App::new();
        app.add_message::<OfferTaken>()
            .add_message::<TourCommand>()
            .add_message::<EditorCommand>()
            .init_resource::<CityClock>()
            .init_resource::<Weather>()
            .init_resource::<Open>()
            .init_resource::<MapView>()
            .init_resource::<Offers>()
            .init_resource::<Words>()
            .insert_resource(Settings::default())
            .insert_resource(TourFiles(vec![("scenes/x.tour.ron".into(), "A walk".into())]))
            .add_systems(Update, (offer, take).chain());
        Words::bring(&mut app, &super::super::WORDS);
        app
    }

    #[test]
    fn all_that_is_offered_is_done() {
        let mut app = app();
        app.world_mut().resource_mut::<Words>().speak("cs");
        app.update();
        let offers = app.world().resource::<Offers>().0.clone();
        assert_eq!(offers.len(), COMMANDS.len() + LANGUAGES.len() + 1);
        let named = |name: &str| offers.iter().find(|offer| offer.names.iter().any(|n| n == name)).map(|offer| offer.key.clone());
        for name in [
            "Nahrát procházku",
            "Nová prohlídka",
            "Prohlídka: A walk",
            "Noc",
            "Night",
            "Déšť",
            "Zima",
            "Italiano",
            "Kvalita: vysoká",
            "Mapa",
            "Nastavení",
            "Nápověda",
        ] {
            let key = named(name).unwrap_or_else(|| panic!("{name} is not offered"));
            app.world_mut().write_message(OfferTaken { key });
        }
        app.update();
        let world = app.world();
        assert_eq!((world.resource::<CityClock>().hour, world.resource::<CityClock>().day), (23.0, 15));
        assert_eq!(world.resource::<Weather>().wet, 1.0);
        let settings = world.resource::<Settings>();
        assert_eq!((settings.language.as_deref(), settings.profile), (Some("it"), Some(Profile::High)));
        assert!(world.resource::<MapView>().open && *world.resource::<Open>() == Open { help: true, settings: true });
        let asked: Vec<EditorCommand> = app.world_mut().resource_mut::<Messages<EditorCommand>>().drain().collect();
        assert_eq!(asked, [EditorCommand::Record, EditorCommand::New]);
        let tours: Vec<TourCommand> = app.world_mut().resource_mut::<Messages<TourCommand>>().drain().collect();
        assert_eq!(tours, [TourCommand::Open("tours://x.tour.ron".into())]);
    }

    #[test]
    fn the_sample_citys_tours_are_found_with_their_titles() {
        let tours = TourFiles::in_folder(&crate::cities::sample_scene());
        assert!(tours.0.len() >= 3 && tours.0.iter().all(|(_, title)| !title.is_empty()), "{tours:?}");
    }
}
