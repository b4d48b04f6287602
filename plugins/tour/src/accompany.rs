use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use veduta_ecs::{Accompany, Part, Words};
use veduta_route::CompiledTour;

use crate::{TourMark, TourPlayer, TourState};

/// To whom moments of the tour are told.
#[derive(SystemParam)]
pub(crate) struct Moments<'w> {
    marks: MessageWriter<'w, TourMark>,
    accompany: MessageWriter<'w, Accompany>,
    words: Res<'w, Words>,
}

impl Moments<'_> {
    /// Tells what comes after a moment and up to now.
    pub fn tell(&mut self, player: &TourPlayer, tour: &CompiledTour, after_s: f64) {
        self.marks.write_batch(tour.marks(after_s, player.time_s()).iter().map(|mark| TourMark { name: mark.name.clone() }));
        // Of several, who passes over them fast hears the last.
        if let Some(narration) = tour.narrations(after_s, player.time_s()).last() {
            let file = player.beside(narration.within(self.words.language()));
            self.accompany.write(Accompany::Play { file, part: Part::Narration });
        }
    }
}

/// What was told of the tour's sound.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Told {
    version: u64,
    seeks: u64,
    ambience: Option<String>,
    is_held: bool,
}

/// Sees to what is heard with the tour beside narration as it comes: nothing while it stands, nothing of before after going
/// elsewhere in time, and beneath all else what the moment has.
pub(crate) fn accompany(
    player: Res<TourPlayer>,
    words: Res<Words>,
    mut told: Local<Told>,
    mut accompany: MessageWriter<Accompany>,
) {
    if told.version != player.version() {
        accompany.write(Accompany::Stop);
        *told = Told { version: player.version(), seeks: player.seeks(), ..Told::default() };
        for file in player.tour().into_iter().flat_map(|tour| tour.recordings(words.language())) {
            accompany.write(Accompany::Prepare(player.beside(file)));
        }
    }
    let Some(tour) = player.tour() else { return };
    if told.seeks != player.seeks() {
        told.seeks = player.seeks();
        accompany.write(Accompany::End(Part::Narration));
    }
    // At the end of the tour the last words are heard out.
    let is_over = player.time_s() >= tour.duration_s();
    let is_held = (player.state() != TourState::Playing || player.waits()) && !is_over;
    if told.is_held != is_held {
        told.is_held = is_held;
        accompany.write(if is_held { Accompany::Hold } else { Accompany::GoOn });
    }
    let ambience = if is_over { None } else { tour.ambience(player.time_s()).map(|file| player.beside(file)) };
    if told.ambience != ambience {
        accompany.write(match &ambience {
            Some(file) => Accompany::Play { file: file.clone(), part: Part::Ambience },
            None => Accompany::End(Part::Ambience),
        });
        told.ambience = ambience;
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use veduta_city::Tour;
    use veduta_ecs::{Awaited, City, Viewer};

    use super::*;
    use crate::{TourCommand, TourPlugin};

    fn tour() -> App {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), TourPlugin { interface: false }))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)))
            .insert_resource(City::default());
        app.world_mut().spawn(Viewer);
        let text = r#"(title: "t", city: "", steps: [
            Start(at: At(0, 0)),
            Sound(file: "organ.ogg"),
            Wait(seconds: 2),
            Narrate(file: "one.ogg", files: {"cs": "jedna.ogg"}, text: "One."),
            Wait(seconds: 2),
            Sound(),
            Narrate(file: "two.ogg", text: "Two."),
            Wait(seconds: 4),
        ])"#;
        let tour: Tour = veduta_city::file::parse(text, "t.tour.ron").expect("no mistakes");
        app.world_mut().write_message(TourCommand::Give(Box::new(tour)));
        app
    }

    /// What is told in so many frames.
    fn told(app: &mut App, frames: usize) -> Vec<Accompany> {
        (0..frames)
            .flat_map(|_| {
                app.update();
                app.world_mut().resource_mut::<Messages<Accompany>>().drain().collect::<Vec<_>>()
            })
            .collect()
    }

    fn play(file: &str, part: Part) -> Accompany {
        Accompany::Play { file: file.to_owned(), part }
    }

    #[test]
    fn a_tour_is_heard_as_it_goes() {
        let heard = told(&mut tour(), 120);
        let heard: Vec<_> = heard.into_iter().filter(|wish| *wish != Accompany::Stop).collect();
        let prepared = ["one.ogg", "two.ogg", "organ.ogg"].map(|file| Accompany::Prepare(file.into()));
        assert_eq!(heard[..3], prepared);
        assert_eq!(
            heard[3..],
            [
                play("organ.ogg", Part::Ambience),
                play("one.ogg", Part::Narration),
                play("two.ogg", Part::Narration),
                Accompany::End(Part::Ambience),
            ]
        );
    }

    #[test]
    fn it_is_silent_while_it_stands_and_after_a_seek_nothing_of_before_is_heard() {
        let mut app = tour();
        told(&mut app, 30);
        app.world_mut().write_message(TourCommand::Pause);
        assert_eq!(told(&mut app, 5), [Accompany::Hold]);
        app.world_mut().write_message(TourCommand::Play);
        assert_eq!(told(&mut app, 1), [Accompany::GoOn]);
        for (ahead, heard) in [(1, Accompany::Hold), (0, Accompany::GoOn)] {
            app.insert_resource(Awaited { cells: 0, ahead });
            assert_eq!(told(&mut app, 5), [heard], "{ahead} cells are awaited");
        }
        app.world_mut().write_message(TourCommand::Seek(0.0));
        let heard = told(&mut app, 5);
        assert!(
            heard.contains(&Accompany::End(Part::Narration)) && !heard.contains(&play("one.ogg", Part::Narration)),
            "{heard:?}"
        );
        app.world_mut().write_message(TourCommand::Stop);
        assert_eq!(told(&mut app, 3), [Accompany::Stop]);
    }

    #[test]
    fn it_speaks_the_visitors_language() {
        let mut app = tour();
        let mut words = app.world_mut().resource_mut::<Words>();
        words.add("cs", "a = b").expect("no mistakes");
        words.speak("cs");
        assert!(told(&mut app, 60).contains(&play("jedna.ogg", Part::Narration)));
    }
}
