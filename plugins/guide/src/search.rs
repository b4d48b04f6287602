use bevy::math::DVec2;
use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{
    self, Align2, Area, Id as EguiId, Key, Order, ScrollArea, Sense, TextEdit, Ui, Vec2 as EguiVec2, WidgetInfo, WidgetType,
};
use veduta_city::{PlaceKind, Viewpoint};
use veduta_ecs::{Around, City, Eye, Interface, JumpTo, OverviewWants, ShowOnMap, Viewer, WalkTo, Words};
use veduta_ui::{Look, Surface, Symbol, symbol_button};

use crate::near::Pin;
use crate::{CityGuide, Directory, Found, LeadSettings, OfferTaken};

/// The search box. Live: set `open` to open it.
#[derive(Resource, Debug, Clone, PartialEq, Default)]
pub struct SearchBox {
    /// Whether it is open.
    pub open: bool,
    /// What was typed.
    pub typed: String,
    /// Which of what was found is chosen, from 0.
    pub chosen: usize,
    hits: Vec<Row>,
    /// What the hits were found for: what was typed, how many things had a name, and by which of the guides.
    found_for: Option<(String, usize, u64, String)>,
    /// Whether the field has had the cursor since it was opened.
    is_focused: bool,
}

/// What is done with something found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchAction {
    /// Walk there along the streets.
    Walk,
    /// Be there at once.
    Jump,
    /// Show it on the map.
    Show,
}

/// Something found, as it is shown.
#[derive(Debug, Clone, PartialEq)]
struct Row {
    found: Found,
    /// Its name in the visitor's language.
    name: String,
    /// The name that was meant, where that is another.
    also: String,
    /// What it is.
    kind: String,
    /// How far off, metres.
    away_m: Option<f64>,
}

/// So many are shown.
const MOST: usize = 8;
/// So far about the visitor streets and places are made ready to be found, metres.
const REACH_M: f64 = 1_500.0;

impl SearchBox {
    /// Opens it with nothing typed.
    pub fn start(&mut self) {
        *self = Self { open: true, ..Self::default() };
    }

    /// Finds anew where something has changed.
    fn find(&mut self, directory: &Directory, guide: &CityGuide, words: &Words, here: DVec2) {
        let key = (self.typed.clone(), directory.len(), guide.version(), words.language().to_owned());
        if self.found_for.as_ref() == Some(&key) {
            return;
        }
        self.found_for = Some(key);
        self.chosen = 0;
        self.hits = directory
            .find(&self.typed, here, MOST)
            .into_iter()
            .map(|(found, matched)| row(found, matched, guide, words, here))
            .collect();
    }
}

fn row(found: Found, matched: String, guide: &CityGuide, words: &Words, here: DVec2) -> Row {
    let name = match &found {
        Found::Place(place) => guide.name(&place.name, words).to_owned(),
        other => other.name().to_owned(),
    };
    let kind = words.say(match &found {
        Found::Place(place) => match place.kind {
            PlaceKind::Viewpoint => "kind-viewpoint",
            PlaceKind::House => "kind-house",
            PlaceKind::Shop => "kind-shop",
            PlaceKind::Monument => "kind-monument",
            PlaceKind::Square => "kind-square",
            PlaceKind::Street => "kind-street",
            PlaceKind::Other => "kind-other",
        },
        Found::Street(..) => "search-street",
        Found::Offer(_) => "search-offer",
    });
    let away_m = found.plan_pos(here).map(|there| there.distance(here));
    Row { also: if matched == name { String::new() } else { matched }, name, kind, away_m, found }
}

/// Draws the box, at the top in the middle, and does what was chosen in it.
pub(crate) fn draw(
    mut contexts: EguiContexts,
    (city, directory, guide): (Option<Res<City>>, Res<Directory>, Res<CityGuide>),
    (words, interface): (Res<Words>, Res<Interface>),
    viewers: Query<&Eye, With<Viewer>>,
    (mut search, mut pin): (ResMut<SearchBox>, ResMut<Pin>),
    (mut wants, mut lead): (ResMut<OverviewWants>, ResMut<LeadSettings>),
    mut walks: MessageWriter<WalkTo>,
    mut jumps: MessageWriter<JumpTo>,
    mut shown: MessageWriter<ShowOnMap>,
    mut taken: MessageWriter<OfferTaken>,
) -> Result {
    let eye = viewers.iter().next().copied().unwrap_or_default();
    let reach = (search.open && city.is_some()).then(|| Around::coarsely(eye.plan_pos, REACH_M));
    OverviewWants::ask(&mut wants, "search", reach);
    if !search.open {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    search.find(&directory, &guide, &words, eye.plan_pos);
    let offset = EguiVec2::new(0.0, context.content_rect().height() * 0.1);
    let area = Area::new(EguiId::new("veduta search")).anchor(Align2::CENTER_TOP, offset).order(Order::Foreground);
    let mut next = *lead;
    let answer = area.show(context, |ui| {
        let frame = look.frame(Surface::Paper);
        frame.show(ui, |ui| show(ui, &look, &words, &mut search, &mut next.without_steps)).inner
    });
    lead.set_if_neq(next);
    let answer = answer.inner;
    match answer {
        Answer::Nothing => {}
        Answer::Close => search.open = false,
        Answer::Do(n, action) => {
            let Some(Row { found, name, .. }) = search.hits.get(n).cloned() else { return Ok(()) };
            search.open = false;
            if let Found::Offer(offer) = found {
                taken.write(OfferTaken { key: offer.key });
                return Ok(());
            }
            let Some(stand) = stand(&found, &eye) else { return Ok(()) };
            if let (Found::Place(place), SearchAction::Walk | SearchAction::Jump) = (&found, action) {
                *pin = Pin::there(place.clone(), stand.pos);
            }
            match action {
                SearchAction::Jump => drop(jumps.write(JumpTo(stand))),
                SearchAction::Show => {
                    let plan_pos = found.plan_pos(eye.plan_pos).unwrap_or(stand.pos);
                    shown.write(ShowOnMap { name, plan_pos });
                }
                SearchAction::Walk => {
                    // Up in the air nobody can be led.
                    let is_aloft = stand.eye_m > veduta_route::WALK_EYE_M;
                    if is_aloft {
                        jumps.write(JumpTo(stand));
                    } else {
                        walks.write(WalkTo { name: found.name().to_owned(), to: stand });
                    }
                }
            }
        }
    }
    Ok(())
}

/// From where to look at something found: the stand that was chosen for it, else where it is.
fn stand(found: &Found, eye: &Eye) -> Option<Viewpoint> {
    if let Found::Place(veduta_city::Place { view: Some(view), .. }) = found {
        return Some(*view);
    }
    let pos = found.plan_pos(eye.plan_pos)?;
    Some(Viewpoint { pos, heading_deg: crate::near::heading_to(eye.plan_pos, pos), ..Viewpoint::default() })
}

/// What was answered in the box.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Answer {
    Nothing,
    Close,
    Do(usize, SearchAction),
}

/// The box: a field, and what was found below it.
fn show(ui: &mut Ui, look: &Look, words: &Words, search: &mut SearchBox, without_steps: &mut bool) -> Answer {
    let surface = Surface::Paper;
    look.dress(ui, surface);
    ui.set_width((look.text * 36.0).min(ui.ctx().content_rect().width() * 0.8));
    let mut answer = Answer::Nothing;
    // Keys that the field would take for itself.
    let (up, down, escape) = ui.input_mut(|input| {
        let mut pressed = |key| input.count_and_consume_key(egui::Modifiers::NONE, key);
        (pressed(Key::ArrowUp), pressed(Key::ArrowDown), pressed(Key::Escape) > 0)
    });
    let enter = ui.input_mut(|input| {
        let modifiers = input.modifiers;
        let is_pressed = input.events.iter().any(|event| matches!(event, egui::Event::Key { key: Key::Enter, pressed: true, .. }));
        is_pressed.then_some(if modifiers.command {
            SearchAction::Show
        } else if modifiers.shift {
            SearchAction::Jump
        } else {
            SearchAction::Walk
        })
    });
    ui.horizontal(|ui| {
        let room = ui.available_width() - look.text * 2.6;
        let hint = look.words(words.say("search-hint"), 1.1, look.faint(surface));
        let field = TextEdit::singleline(&mut search.typed).font(look.font(1.1)).hint_text(hint).desired_width(room);
        let field = ui.add(field);
        // The key that opened the box is not meant as a letter.
        while search.typed.starts_with('/') {
            search.typed.remove(0);
        }
        field.widget_info(|| WidgetInfo::labeled(WidgetType::TextEdit, true, words.say("search-name")));
        // Escape in the field is the box's; elsewhere it is for whatever lies on top.
        if escape && field.lost_focus() {
            answer = Answer::Close;
        }
        if !search.is_focused || enter.is_some() {
            field.request_focus();
            search.is_focused = true;
        }
        if symbol_button(ui, look, surface, Symbol::Close, false, &words.say("search-close"), "Esc").clicked() {
            answer = Answer::Close;
        }
    });
    let last = search.hits.len().saturating_sub(1);
    search.chosen = (search.chosen + down).saturating_sub(up).min(last);
    let room = ui.ctx().content_rect().height() * 0.6;
    ScrollArea::vertical().max_height(room).min_scrolled_height(room).show(ui, |ui| {
        for (n, row) in search.hits.iter().enumerate() {
            match show_row(ui, look, words, row, n == search.chosen) {
                RowAnswer::Nothing => {}
                RowAnswer::Choose => search.chosen = n,
                RowAnswer::Do(action) => answer = Answer::Do(n, action),
            }
        }
    });
    if search.hits.is_empty() && !search.typed.trim().is_empty() {
        ui.label(look.words(words.say("search-nothing"), 1.0, look.faint(surface)));
    }
    ui.checkbox(without_steps, words.say("search-without-steps"));
    ui.label(look.words(words.say("search-keys"), 0.8, look.faint(surface)));
    match (answer, enter) {
        (Answer::Nothing, Some(action)) if !search.hits.is_empty() => Answer::Do(search.chosen, action),
        (answer, _) => answer,
    }
}

enum RowAnswer {
    Nothing,
    Choose,
    Do(SearchAction),
}

/// A line of what was found; the chosen one with what can be done.
fn show_row(ui: &mut Ui, look: &Look, words: &Words, row: &Row, is_chosen: bool) -> RowAnswer {
    let surface = Surface::Paper;
    let mut answer = RowAnswer::Nothing;
    let fill = if is_chosen { look.accent(surface).gamma_multiply(0.16) } else { egui::Color32::TRANSPARENT };
    let line = egui::Frame::new().fill(fill).corner_radius(4.0).inner_margin(look.text * 0.25).show(ui, |ui| {
        ui.set_width(ui.available_width());
        ui.horizontal(|ui| {
            ui.vertical(|ui| {
                ui.set_width(ui.available_width() - look.text * 8.5);
                let name = ui
                    .add(egui::Label::new(look.words(&row.name, 1.05, look.ink(surface))).sense(Sense::click()).selectable(false));
                name.widget_info(|| WidgetInfo::selected(WidgetType::SelectableLabel, true, is_chosen, &row.name));
                if name.double_clicked() {
                    answer = RowAnswer::Do(SearchAction::Walk);
                } else if name.clicked() {
                    answer = RowAnswer::Choose;
                }
                let about =
                    [row.kind.clone(), row.also.clone(), away(words, row.away_m)].into_iter().filter(|part| !part.is_empty());
                ui.label(look.words(about.collect::<Vec<_>>().join(" · "), 0.85, look.faint(surface)));
            });
            if is_chosen {
                let is_offer = matches!(row.found, Found::Offer(_));
                let mut button = |symbol, name: &str, keys, action| {
                    if symbol_button(ui, look, surface, symbol, false, &words.say(name), keys).clicked() {
                        answer = RowAnswer::Do(action);
                    }
                };
                if is_offer {
                    button(Symbol::Play, "search-do", "Enter", SearchAction::Walk);
                } else {
                    button(Symbol::Walk, "search-walk", "Enter", SearchAction::Walk);
                    button(Symbol::Jump, "search-jump", "Shift+Enter", SearchAction::Jump);
                    button(Symbol::Map, "search-show", "Ctrl+Enter", SearchAction::Show);
                }
            }
        });
    });
    if is_chosen && line.response.rect.width() > 0.0 {
        line.response.scroll_to_me(None);
    }
    answer
}

fn away(words: &Words, away_m: Option<f64>) -> String {
    match away_m {
        Some(metres) if metres < 995.0 => {
            words.say_with("search-metres", &[("metres", words.number((metres / 5.0).round() * 5.0, 0).into())])
        }
        Some(metres) => words.say_with("search-kilometres", &[("kilometres", words.number(metres / 1000.0, 1).into())]),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use veduta_city::{Guide, GuidePlace, Id, Overview, Place};

    use super::*;
    use crate::{Offer, Offers};

    struct Bench {
        directory: Directory,
        guide: CityGuide,
        words: Words,
    }

    fn bench(language: &str) -> Bench {
        let place = |id, name: &str, x: f64| Place { id: Id(id), name: name.into(), pos: DVec2::new(x, 0.0), ..Place::default() };
        let overview =
            Overview { places: vec![place(1, "Old Town Hall", 40.0), place(2, "Old Town Square", 2_000.0)], ..Overview::default() };
        let names = [("cs".to_owned(), "Staroměstská radnice".to_owned())].into();
        let guide =
            Guide { places: vec![GuidePlace { name: "Old Town Hall".into(), names, ..GuidePlace::default() }], ..Guide::default() };
        let offers = Offers(vec![Offer { key: "night".into(), names: vec!["Old lamps".into()] }]);
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, messages)| words.add(code, messages).expect("no mistakes"));
        words.speak(language);
        Bench { directory: Directory::of([&overview], &guide, &offers), guide: CityGuide::of(guide), words }
    }

    struct Shown {
        search: SearchBox,
        answers: Vec<Answer>,
        without_steps: bool,
    }

    fn harness(bench: &Bench) -> Harness<'_, Shown> {
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: true };
        let mut search = SearchBox::default();
        search.start();
        Harness::builder().with_size(egui::vec2(900.0, 600.0)).build_ui_state(
            move |ui, shown: &mut Shown| {
                shown.search.find(&bench.directory, &bench.guide, &bench.words, DVec2::ZERO);
                match show(ui, &look, &bench.words, &mut shown.search, &mut shown.without_steps) {
                    Answer::Nothing => {}
                    answer => shown.answers.push(answer),
                }
            },
            Shown { search, answers: Vec::new(), without_steps: false },
        )
    }

    #[test]
    fn the_key_that_opens_the_box_is_no_letter() {
        let bench = bench("en");
        let mut harness = harness(&bench);
        type_in(&mut harness, "//old");
        assert_eq!(harness.state().search.typed, "old");
    }

    fn type_in(harness: &mut Harness<'_, Shown>, text: &str) {
        harness.run();
        harness.get_by_label("Search").type_text(text);
        harness.run();
    }

    #[test]
    fn what_is_typed_is_found_chosen_by_arrows_and_done_by_enter() {
        let bench = bench("en");
        let mut harness = harness(&bench);
        type_in(&mut harness, "old");
        let names: Vec<String> = harness.state().search.hits.iter().map(|row| row.name.clone()).collect();
        assert_eq!(names.len(), 3, "{names:?}");
        harness.get_by_label("Old Town Hall");
        harness.get_by_label_contains("2.0 km");
        harness.key_press(Key::ArrowDown);
        harness.run();
        assert_eq!(harness.state().search.chosen, 1);
        harness.key_press(Key::Enter);
        harness.run();
        assert_eq!(harness.state_mut().answers.pop(), Some(Answer::Do(1, SearchAction::Walk)));
        harness.key_press_modifiers(egui::Modifiers::SHIFT, Key::Enter);
        harness.run();
        assert_eq!(harness.state_mut().answers.pop(), Some(Answer::Do(1, SearchAction::Jump)));
        harness.key_press(Key::Escape);
        harness.run();
        assert_eq!(harness.state_mut().answers.pop(), Some(Answer::Close));
    }

    #[test]
    fn every_action_has_a_button_with_a_name() {
        let bench = bench("en");
        let mut harness = harness(&bench);
        type_in(&mut harness, "town hall");
        for (name, action) in
            [("Walk there", SearchAction::Walk), ("Be there", SearchAction::Jump), ("Show on the map", SearchAction::Show)]
        {
            harness.get_by_label(name).click();
            harness.run();
            assert_eq!(harness.state_mut().answers.pop(), Some(Answer::Do(0, action)), "{name}");
        }
    }

    #[test]
    fn stairs_are_left_out_on_request() {
        let bench = bench("en");
        let mut harness = harness(&bench);
        harness.run();
        harness.get_by_label("Without stairs").click();
        harness.run();
        assert!(harness.state().without_steps);
    }

    #[test]
    fn names_come_in_the_visitors_language_with_what_was_meant() {
        let bench = bench("cs");
        let mut harness = harness(&bench);
        harness.run();
        harness.get_by_label("Hledání").type_text("town hall");
        harness.run();
        harness.get_by_label("Staroměstská radnice");
        harness.get_by_label_contains("Old Town Hall");
    }

    #[test]
    fn where_nothing_is_found_it_is_said() {
        let bench = bench("en");
        let mut harness = harness(&bench);
        type_in(&mut harness, "xyzzy");
        harness.get_by_label_contains("Nothing has a name like that");
        harness.key_press(Key::Enter);
        harness.run();
        assert_eq!(harness.state().answers, []);
    }
}
