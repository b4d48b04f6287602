use std::time::Duration;

use bevy::ecs::system::RunSystemOnce;
use bevy::math::DVec2;
use bevy::time::TimeUpdateStrategy;
use bevy_egui::egui::{self, Key, Modifiers, Pos2, Vec2 as EguiVec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use veduta_city::{GridPos, Id, Overview, Place, PlanStreet, Step, StreetClass};
use veduta_ecs::{Around, City, Docks, Eye, Overviews, PlaceNames, Steering, TourPath, Viewer, Words};
use veduta_route::{Pose, StepKind, sketch};
use veduta_ui::Look;

use super::act::Act;
use super::bench::{Acts, Bench};
use super::*;
use crate::{TourPlayer, TourState};

const TEXT: &str = r#"// A walk that a person wrote.
(
  title: "A walk",
  city: "village.city", // beside this file
  steps: [
    // At the gate.
    Start(at: Place("Gate")),
    Chapter(title: "The street"), // the first
    Wait(seconds: 4), // long enough
    Walk(to: Place("Well")),
    Wait(seconds: 2),
  ],
)
"#;

fn village() -> Overview {
    let street = |id, from: (i32, i32), to: (i32, i32)| PlanStreet {
        id: Id(id),
        name: "Street".into(),
        line: [from, to].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec(),
        width: 6 * 1024,
        walkable: true,
        layer: 0,
        class: StreetClass::Street,
    };
    let place = |name: &str, x: f64, y: f64| Place { name: name.into(), pos: DVec2::new(x, y), ..Place::default() };
    let streets = vec![street(1, (0, 0), (60, 0)), street(2, (60, 0), (60, 40))];
    Overview { streets, places: vec![place("Gate", 0.0, 0.0), place("Well", 60.0, 40.0)], ..Overview::default() }
}

/// The editor's windows without an engine.
struct Desk {
    editor: TourEditor,
    words: Words,
    streets: Streets,
    here: Pose,
    t_s: f64,
    /// What concerns more than the tour.
    beyond: Vec<Act>,
}

impl Desk {
    fn new(text: &str) -> Self {
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        let document = Document::parse(text, "village.tour.ron").expect("no mistakes");
        let around = Around { middle: DVec2::ZERO, radius_m: f64::INFINITY };
        let here = Pose { plan_pos: DVec2::new(30.0, 1.0), eye_m: 1.65, heading_deg: 45.0, fov_deg: 55.0, ..Pose::default() };
        let editor = TourEditor { is_open: true, document: Some(document), ..TourEditor::default() };
        let streets = Streets::of(&[Arc::new(village())], around);
        let mut desk = Self { editor, words, streets, here, t_s: 0.0, beyond: Vec::new() };
        desk.compile();
        desk
    }

    fn compile(&mut self) {
        let document = self.editor.document.as_mut().expect("one is open");
        document.sketch = Arc::new(sketch(document.edit.tour(), &self.streets.net, &self.streets.places));
    }

    fn edit(&self) -> &TourEdit {
        &self.editor.document.as_ref().expect("one is open").edit
    }

    fn kinds(&self) -> Vec<StepKind> {
        self.edit().tour().steps.iter().map(StepKind::of).collect()
    }

    fn show(&mut self, ui: &mut egui::Ui) {
        let look = Look { text: 15.0, high_contrast: false, reduced_motion: true };
        let docks = Docks { left: 280.0, right: 300.0, bottom: 150.0 };
        let mut acts = Acts::new();
        let document = self.editor.document.as_ref().expect("one is open");
        let names = PlaceNames::default();
        let bench = Bench {
            look,
            words: &self.words,
            names: &names,
            edit: &document.edit,
            sketch: &document.sketch,
            streets: Some(&self.streets),
            here: self.here,
            t_s: self.t_s,
            is_playing: false,
            is_recording: false,
            approach: self.editor.approach,
            notice: &self.editor.notice,
            can_save: true,
            can_copy: false,
            is_changed_elsewhere: false,
        };
        draw::windows(ui.ctx(), &bench, &docks, &mut self.editor.time, &mut self.editor.listed, &mut acts);
        acts.extend(keys::shortcut(ui.ctx(), &document.edit.selected()));
        for act in acts {
            if let Act::Visit(steps) = &act {
                self.editor.edit(&Act::Select(steps.clone()), &self.here);
            } else if !self.editor.edit(&act, &self.here) {
                self.beyond.push(act);
            }
        }
        self.compile();
    }
}

fn desk(text: &str) -> Harness<'static, Desk> {
    let mut harness = Harness::builder()
        .with_size(EguiVec2::new(1280.0, 720.0))
        .build_ui_state(|ui, desk: &mut Desk| desk.show(ui), Desk::new(text));
    harness.run();
    harness
}

/// Clicks what has a name.
fn click(harness: &mut Harness<'_, Desk>, name: &str) {
    harness.get_by_label(name).click();
    harness.run();
}

#[test]
fn a_view_is_added_steps_are_moved_seconds_changed_undone_and_all_is_saved_with_its_comments() {
    let mut harness = desk(TEXT);
    // A view after the first wait.
    click(&mut harness, "3 · Wait");
    click(&mut harness, "Add this view");
    use StepKind as K;
    assert_eq!(harness.state().kinds(), [K::Start, K::Chapter, K::Wait, K::Walk, K::Look, K::Walk, K::Wait]);
    // The last step to before it.
    click(&mut harness, "7 · Wait");
    for _ in 0..3 {
        click(&mut harness, "Edit");
        harness.get_by_label_contains("Move up").click();
        harness.run();
    }
    assert_eq!(harness.state().kinds(), [K::Start, K::Chapter, K::Wait, K::Wait, K::Walk, K::Look, K::Walk]);
    assert_eq!(harness.state().edit().selected(), 3..4);
    // Its seconds by the keyboard, and back.
    harness.get_by_label("Length").focus();
    harness.run();
    harness.key_press(Key::ArrowUp);
    harness.run();
    assert_eq!(harness.state().edit().tour().steps[3], Step::Wait { seconds: 2.1 });
    click(&mut harness, "Undo");
    assert_eq!(harness.state().edit().tour().steps[3], Step::Wait { seconds: 2.0 });
    harness.key_press_modifiers(Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    harness.run();
    assert_eq!(harness.state().edit().tour().steps[3], Step::Wait { seconds: 2.1 });
    harness.key_press_modifiers(Modifiers::COMMAND, Key::S);
    harness.run();
    assert_eq!(harness.state().beyond.last(), Some(&Act::Save));
    let text = r#"// A walk that a person wrote.
(
  title: "A walk",
  city: "village.city", // beside this file
  steps: [
    // At the gate.
    Start(at: Place("Gate")),
    Chapter(title: "The street"), // the first
    Wait(seconds: 4), // long enough
    Wait(seconds: 2.1),
    Walk(to: At(30, 1)),
    Look(at: Heading(deg: 45), seconds: 1.5),
    Walk(to: Place("Well")),
  ],
)
"#;
    assert_eq!(harness.state().edit().text(), text);
}

#[test]
fn blocks_of_time_are_dragged_to_move_and_by_their_edges_to_last_longer() {
    let mut harness = desk(TEXT);
    let centre = |harness: &Harness<'_, Desk>, part: &str| {
        harness.get_all_by_label_contains(part).next().unwrap_or_else(|| panic!("{part} is not there")).rect().center()
    };
    let drag = |harness: &mut Harness<'_, Desk>, from: Pos2, to: Pos2| {
        harness.hover_at(from);
        harness.run();
        harness.drag_at(from);
        harness.run();
        for share in [0.3, 0.7, 1.0] {
            harness.hover_at(from.lerp(to, share));
            harness.run();
        }
        harness.drop_at(to);
        harness.run();
    };
    let first = centre(&harness, "Step 3 in time");
    let last = centre(&harness, "Step 5 in time");
    drag(&mut harness, first, last + EguiVec2::new(8.0, 0.0));
    use StepKind as K;
    assert_eq!(harness.state().kinds(), [K::Start, K::Chapter, K::Walk, K::Wait, K::Wait]);
    assert_eq!(harness.state().edit().tour().steps[4], Step::Wait { seconds: 4.0 });
    let edge = centre(&harness, "Length of step 5");
    drag(&mut harness, edge, edge - EguiVec2::new(20.0, 0.0));
    let Step::Wait { seconds } = harness.state().edit().tour().steps[4] else { panic!("it is a wait") };
    assert!((1.0..3.9).contains(&seconds), "{seconds}");
    // One drag, one undo.
    click(&mut harness, "Undo");
    assert_eq!(harness.state().edit().tour().steps[4], Step::Wait { seconds: 4.0 });
    click(&mut harness, "Undo");
    assert_eq!(harness.state().edit().text(), TEXT);
}

#[test]
fn a_mistake_shows_at_its_step_and_a_name_is_completed() {
    let mut harness = desk(&TEXT.replace("Place(\"Well\")", "Place(\"Wel\")"));
    click(&mut harness, "1 mistake");
    assert_eq!(harness.state().edit().selected(), 3..4, "the mistake leads to its step");
    harness.get_by_label_contains("there is no place named \"Wel\"");
    click(&mut harness, "Well");
    assert!(harness.query_by_label("1 mistake").is_none());
    assert!(
        matches!(&harness.state().edit().tour().steps[3], Step::Walk { to, .. } if *to == veduta_city::Where::Place("Well".into()))
    );
}

#[test]
fn every_field_of_every_kind_can_be_seen_in_every_language() {
    let steps = r#"Start(at: At(0, 0), eye_m: 1.7, look: Spot(at: Place("Well"), height_m: 3)),
        Walk(to: Place("Well"), via: [At(60, 0)], speed: 1.2, look: Heading(deg: 90)),
        Fly(through: [(60, 20, 9), (0, 0, 4)], speed: 8),
        Look(at: Ahead, seconds: 1), Wait(seconds: 1), Say(text: "Words", translations: {"de": "Worte"}, seconds: 3),
        Chapter(title: "A part"), Mark(name: "bells"), Rain(wet: 0.5, seconds: 1), Fov(deg: 40, seconds: 1),
        Time(hour: 18.5, seconds: 1), Cut(to: At(0, 0), seconds: 2)"#;
    let mut harness = desk(&format!("(title: \"All\", city: \"x\", steps: [{steps}])"));
    let fields: [&[&str]; 12] = [
        &["field-at", "field-eye", "field-look", "look-at", "look-height"],
        &["field-to", "field-via", "field-add-via", "field-speed", "field-ease", "look-deg", "look-pitch"],
        &["field-speed", "field-ease", "field-through", "field-add-point"],
        &["field-look", "field-seconds"],
        &["field-seconds"],
        &["field-text", "field-seconds"],
        &["field-title"],
        &["field-name"],
        &["field-wet", "field-seconds"],
        &["field-fov", "field-seconds"],
        &["field-hour", "field-seconds"],
        &["field-to", "field-seconds", "field-look"],
    ];
    for language in ["en", "cs", "it"] {
        harness.state_mut().words.speak(language);
        for (index, names) in fields.iter().enumerate() {
            harness.state_mut().editor.edit(&Act::Select(index..index + 1), &Pose::default());
            harness.run();
            for name in *names {
                let said = harness.state().words.say(name);
                assert!(harness.query_all_by_label(&said).next().is_some(), "{language}, step {}: {said}", index + 1);
            }
        }
        harness.state_mut().editor.edit(&Act::Select(0..0), &Pose::default());
        harness.run();
        for name in ["field-title", "field-city", "field-speed", "field-eye", "field-fov", "field-hour", "field-day"] {
            let said = harness.state().words.say(name);
            assert!(harness.query_all_by_label(&said).next().is_some(), "{language}: {said}");
        }
    }
    assert_eq!(harness.state().edit().can(), (false, false), "to look at it changes nothing");
    assert!(
        harness
            .state()
            .edit()
            .tour()
            .steps
            .iter()
            .any(|step| matches!(step, Step::Say { translations, .. } if translations.len() == 1))
    );
}

#[test]
fn every_language_says_everything() {
    let messages = |file: &'static str| -> Vec<&'static str> {
        let is_name = |line: &&str| line.starts_with(|c: char| c.is_ascii_lowercase());
        file.lines().filter(is_name).filter_map(|line| line.split_once(" =").map(|(name, _)| name)).collect()
    };
    let all = messages(crate::WORDS[0].1);
    assert!(all.len() > 100, "{}", all.len());
    for (language, file) in crate::WORDS {
        assert_eq!(messages(file), all, "{language}: the same messages in the same order");
    }
}

/// An app with the village, the player and the editor, but no windows.
fn app() -> App {
    let mut app = App::new();
    app.add_plugins((MinimalPlugins, AssetPlugin::default(), crate::TourPlugin { interface: false }))
        .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(100)))
        .insert_resource(City { overviews: Overviews::whole(village()), ..City::default() });
    build(&mut app);
    app.insert_resource(EditorSettings { city: "village.city".into(), can_save: true, can_copy: false });
    app.world_mut().spawn((Viewer, Eye { plan_pos: DVec2::new(1.0, 0.5), heading_deg: 90.0, ..Eye::default() }));
    app.update();
    app
}

/// Frames until something holds; jobs run beside them.
fn until(app: &mut App, holds: impl Fn(&World) -> bool) {
    for _ in 0..2_000 {
        if holds(app.world()) {
            return;
        }
        app.update();
        std::thread::sleep(Duration::from_millis(1));
    }
    panic!("it never came to that");
}

fn command(app: &mut App, command: EditorCommand) {
    app.world_mut().write_message(command);
    app.update();
}

fn editor(world: &World) -> &TourEditor {
    world.resource::<TourEditor>()
}

fn steps(world: &World) -> usize {
    editor(world).tour().map_or(0, |tour| tour.steps.len())
}

/// Has the visitor walk along the first street while it is recorded.
fn record(app: &mut App) {
    command(app, EditorCommand::Record);
    for _ in 0..300 {
        let world = app.world_mut();
        let mut eyes = world.query_filtered::<&mut Eye, With<Viewer>>();
        for mut eye in eyes.iter_mut(world) {
            eye.plan_pos.x += 0.14;
        }
        app.update();
    }
    assert!((app.world().resource::<Recorder>().length_m() - 42.0).abs() < 1.0);
    command(app, EditorCommand::Record);
    until(app, |world| steps(world) > 0 && world.resource::<TourPlayer>().tour().is_some());
}

fn answer(app: &mut App, answer: TourSaved) {
    app.world_mut().write_message(answer);
    app.update();
}

fn save(app: &mut App) -> SaveTour {
    let asked = app.world_mut().run_system_once(|mut editor: ResMut<TourEditor>, mut saves: MessageWriter<SaveTour>| {
        editor.save(false, None, &mut saves);
    });
    asked.expect("it runs");
    app.world_mut().resource_mut::<Messages<SaveTour>>().drain().last().expect("it was asked for")
}

#[test]
fn a_recorded_walk_is_a_tour_at_once_and_is_played_from_where_it_begins() {
    let mut app = app();
    record(&mut app);
    let world = app.world();
    assert!(editor(world).is_open() && editor(world).is_unsaved());
    assert!(steps(world) <= 3, "{:#?}", editor(world).tour());
    let player = world.resource::<TourPlayer>();
    let end = player.tour().expect("it can be played").pose(f64::INFINITY);
    assert!(end.plan_pos.distance(DVec2::new(43.0, 0.5)) < 3.0, "{end:?}");
    assert_eq!(
        (player.state(), *world.resource::<Steering>()),
        (TourState::Wandering, Steering::Visitor),
        "the visitor keeps the eye"
    );
    app.update();
    assert_eq!(app.world().resource::<TourPath>().0.len(), 1, "maps know of it");
    // A second one goes on from there.
    let count = steps(app.world());
    let world = app.world_mut();
    world.resource_mut::<TourEditor>().document.as_mut().expect("one is open").edit.select(count - 1..count);
    let mut eyes = world.query::<&mut Eye>();
    eyes.iter_mut(world).for_each(|mut eye| eye.plan_pos = DVec2::new(0.0, 0.0));
    record(&mut app);
    until(&mut app, |world| steps(world) > count);
    let tour = editor(app.world()).tour().expect("one is open").clone();
    assert!(matches!(tour.steps[count], Step::Cut { .. }), "{tour:#?}");
}

#[test]
fn what_is_not_saved_is_asked_about_before_it_is_lost() {
    let mut app = app();
    command(&mut app, EditorCommand::New);
    command(&mut app, EditorCommand::AddView);
    assert_eq!(steps(app.world()), 1);
    command(&mut app, EditorCommand::Leave);
    assert!(matches!(editor(app.world()).question, Some(Question::Unsaved(Then::Leave))));
    assert!(app.world().resource::<Messages<EditorLeft>>().is_empty());
    let order = save(&mut app);
    assert_eq!((order.path.as_deref(), &order.how), (None, &SaveHow::New));
    assert!(order.text.contains("city: \"village.city\"") && order.text.contains("Start("), "{}", order.text);
    answer(&mut app, TourSaved::Done { path: "my_tour.tour.ron".into(), text: order.text });
    assert!(!editor(app.world()).is_unsaved() && editor(app.world()).question.is_none());
    assert_eq!(app.world().resource::<Messages<EditorLeft>>().len(), 1, "it was saved, and the program may end");
    // The next time it is written over what was written, and nothing else.
    command(&mut app, EditorCommand::AddView);
    let order = save(&mut app);
    assert_eq!(order.path.as_deref(), Some("my_tour.tour.ron"));
    assert!(matches!(&order.how, SaveHow::Over(text) if !text.contains("Walk(")));
    answer(&mut app, TourSaved::Changed { text: "(title: \"Theirs\", city: \"x\", steps: [])".into() });
    assert!(matches!(editor(app.world()).question, Some(Question::Changed(_))));
    app.world_mut().resource_mut::<TourEditor>().take_other("(title: \"Theirs\", city: \"x\", steps: [])");
    assert_eq!(editor(app.world()).tour().map(|tour| tour.title.as_str()), Some("Theirs"));
    command(&mut app, EditorCommand::Close);
    assert!(!editor(app.world()).is_open());
}
