use bevy::prelude::*;
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id, Order, Sense, StrokeKind, Ui, Vec2, WidgetInfo};
use veduta_controls::{KeyNames, Layers};
use veduta_ecs::{Interface, Steering, Words};
use veduta_route::CompiledTour;
use veduta_ui::{Look, Surface, Symbol, symbol_button};

use crate::controls::{TourEdit, TourPause};
use crate::{EditorCommand, TourCommand, TourEditor, TourPlayer, TourState};

/// The strip of a tour's time and chapters. Live.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct StripSettings {
    /// Whether it is shown at all. While the tour plays it hides itself.
    pub visible: bool,
    idle_s: f32,
}

impl Default for StripSettings {
    fn default() -> Self {
        Self { visible: true, idle_s: 0.0 }
    }
}

/// What was done on the strip.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Press {
    Toggle,
    Stop,
    Edit,
    Seek(f64),
}

/// While the tour plays the strip stays so long, seconds.
const STAYS_S: f32 = 5.0;
/// The pointer is near the strip in this share of the window.
const NEAR: f32 = 0.2;

/// Draws the strip, at the top in the middle.
pub(crate) fn draw(
    mut contexts: EguiContexts,
    time: Res<Time<Real>>,
    player: Res<TourPlayer>,
    (words, interface, keys): (Res<Words>, Res<Interface>, Res<KeyNames>),
    (steering, editor, layers): (Res<Steering>, Res<TourEditor>, Res<Layers>),
    mut settings: ResMut<StripSettings>,
    (mut commands, mut edits): (MessageWriter<TourCommand>, MessageWriter<EditorCommand>),
) -> Result {
    let is_shown = settings.visible && !editor.is_open() && !layers.has_page();
    let Some(tour) = player.tour().filter(|_| is_shown && player.state() != TourState::Idle && *steering != Steering::Led) else {
        return Ok(());
    };
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let screen = context.content_rect();
    let is_near = context.pointer_latest_pos().is_some_and(|at| at.y < screen.top() + screen.height() * NEAR)
        && context.input(|input| input.pointer.time_since_last_movement() < STAYS_S);
    let stays = is_near || player.waits() || !matches!(player.state(), TourState::Playing | TourState::Returning);
    settings.idle_s = if stays { 0.0 } else { settings.idle_s + time.delta_secs() };
    if settings.idle_s > STAYS_S {
        return Ok(());
    }
    let area = Area::new(Id::new("veduta tour")).anchor(Align2::CENTER_TOP, Vec2::new(0.0, screen.height() * 0.03));
    let press = area.order(Order::Middle).show(context, |ui| {
        let frame = look.frame(Surface::Dusk);
        frame.show(ui, |ui| show(ui, &look, (&words, &keys), tour, player.state(), (player.time_s(), player.waits()))).inner
    });
    match press.inner {
        Some(Press::Toggle) => drop(commands.write(TourCommand::Toggle)),
        Some(Press::Stop) => drop(commands.write(TourCommand::Stop)),
        Some(Press::Edit) => drop(edits.write(EditorCommand::Open)),
        Some(Press::Seek(t_s)) => drop(commands.write(TourCommand::Seek(t_s))),
        None => {}
    }
    Ok(())
}

/// Minutes and seconds.
fn clock(t_s: f64) -> String {
    let seconds = t_s.max(0.0) as u64;
    format!("{}:{:02}", seconds / 60, seconds % 60)
}

/// The strip: title or chapter, a line of time with the chapters' beginnings, and what can be done.
fn show(
    ui: &mut Ui,
    look: &Look,
    (words, keys): (&Words, &KeyNames),
    tour: &CompiledTour,
    state: TourState,
    (t_s, waits): (f64, bool),
) -> Option<Press> {
    let surface = Surface::Dusk;
    look.dress(ui, surface);
    let mut press = None;
    let now = tour.chapter(t_s);
    let title = now
        .and_then(|n| tour.chapters().get(n))
        .map_or_else(|| tour.title_in(words.language()), |c| c.title.within(words.language()));
    ui.horizontal(|ui| {
        ui.label(look.words(title, 1.0, look.ink(surface)));
        ui.label(look.words(format!("{} / {}", clock(t_s), clock(tour.duration_s())), 0.85, look.faint(surface)));
        if waits {
            ui.label(look.words(words.say("tour-waits"), 0.85, look.accent(surface)));
        }
    });
    ui.horizontal(|ui| {
        let (symbol, name) = match state {
            TourState::Playing | TourState::Returning => (Symbol::Pause, "tour-pause"),
            _ => (Symbol::Play, "tour-play"),
        };
        if symbol_button(ui, look, surface, symbol, false, &words.say(name), keys.first::<TourPause>()).clicked() {
            press = Some(Press::Toggle);
        }
        press = line(ui, look, words, tour, t_s).or(press);
        if symbol_button(ui, look, surface, Symbol::Edit, false, &words.say("tour-edit"), keys.first::<TourEdit>()).clicked() {
            press = Some(Press::Edit);
        }
        if symbol_button(ui, look, surface, Symbol::Close, false, &words.say("tour-stop"), "").clicked() {
            press = Some(Press::Stop);
        }
    });
    press
}

/// The line of time: a click or a drag goes there; by the keyboard, five seconds at a time.
fn line(ui: &mut Ui, look: &Look, words: &Words, tour: &CompiledTour, t_s: f64) -> Option<Press> {
    let surface = Surface::Dusk;
    let whole_s = tour.duration_s().max(0.001);
    let (rect, response) = ui.allocate_exact_size(Vec2::new(look.text * 24.0, look.text * 1.9), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::slider(true, t_s, words.say("tour-time")));
    let bar = rect.shrink2(Vec2::new(look.text * 0.3, look.text * 0.75));
    let x = |t_s: f64| bar.left() + bar.width() * (t_s / whole_s).clamp(0.0, 1.0) as f32;
    let painter = ui.painter();
    painter.rect_filled(bar, 3.0, look.faint(surface).gamma_multiply(0.35));
    let mut gone = bar;
    gone.set_right(x(t_s));
    painter.rect_filled(gone, 3.0, look.accent(surface));
    for chapter in tour.chapters() {
        let at = x(chapter.start_s);
        painter.vline(at, rect.shrink(look.text * 0.45).y_range(), (look.text * 0.1, look.ink(surface)));
    }
    painter.circle_filled(bar.left_center() + Vec2::new(x(t_s) - bar.left(), 0.0), look.text * 0.42, look.ink(surface));
    if response.has_focus() {
        painter.rect_stroke(rect, 4.0, (1.5, look.ink(surface)), StrokeKind::Inside);
    }
    let time_at = |at: f32| f64::from(((at - bar.left()) / bar.width()).clamp(0.0, 1.0)) * whole_s;
    let pointed = response.interact_pointer_pos().map(|at| time_at(at.x));
    let mut press = None;
    if let Some(t_s) = pointed.filter(|_| response.clicked() || response.drag_stopped()) {
        // A click near a chapter's beginning means that.
        let near =
            tour.chapters().iter().map(|chapter| chapter.start_s).find(|start_s| (x(*start_s) - x(t_s)).abs() < look.text * 0.4);
        press = Some(Press::Seek(near.unwrap_or(t_s)));
    }
    if response.has_focus() {
        use bevy_egui::egui::{EventFilter, Key};
        // Arrows go along the line, not to the next control.
        let filter = EventFilter { horizontal_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
        let (left, right) = ui.input(|input| (input.key_pressed(Key::ArrowLeft), input.key_pressed(Key::ArrowRight)));
        if left || right {
            press = Some(Press::Seek((t_s + if right { 5.0 } else { -5.0 }).clamp(0.0, whole_s)));
        }
    }
    if let Some(at) = response.hover_pos() {
        let t_s = time_at(at.x);
        let chapter = tour.chapter(t_s).and_then(|n| tour.chapters().get(n));
        let told = chapter.map_or_else(String::new, |chapter| format!("{} · ", chapter.title.within(words.language())));
        response.on_hover_text_at_pointer(format!("{told}{}", clock(t_s)));
    }
    press
}

#[cfg(test)]
mod tests {
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use veduta_city::{Tour, file};
    use veduta_route::{Gazetteer, StreetNet, compile};

    use super::*;

    fn tour() -> CompiledTour {
        let text = r#"(title: "A walk", city: "x", steps: [
            Start(at: At(0, 0)),
            Wait(seconds: 9.2),
            Chapter(title: "The tower", translations: {"cs": "Věž"}),
            Wait(seconds: 70),
        ])"#;
        let tour: Tour = file::parse(text, "a.tour.ron").expect("no mistakes");
        compile(&tour, &StreetNet::new(&[]), &Gazetteer::default()).expect("no mistakes")
    }

    fn words(language: &str) -> Words {
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, file)| words.add(code, file).expect("no mistakes"));
        words.speak(language);
        words
    }

    #[test]
    fn the_strip_tells_chapter_and_time_and_can_be_pressed() {
        let (look, tour, words) = (Look { text: 16.0, high_contrast: false, reduced_motion: true }, tour(), words("cs"));
        let mut harness = Harness::builder().with_size(Vec2::new(700.0, 200.0)).build_ui_state(
            |ui, pressed: &mut Vec<Press>| {
                pressed.extend(show(ui, &look, (&words, &KeyNames::default()), &tour, TourState::Playing, (65.0, true)))
            },
            Vec::new(),
        );
        harness.get_by_label("Věž");
        harness.get_by_label("1:05 / 1:20");
        harness.get_by_label(&words.say("tour-waits"));
        for (name, press) in [("tour-pause", Press::Toggle), ("tour-edit", Press::Edit), ("tour-stop", Press::Stop)] {
            harness.get_by_label(&words.say(name)).click();
            harness.run();
            assert_eq!(harness.state_mut().pop(), Some(press), "{name}");
        }
        harness.get_by_label(&words.say("tour-time")).click();
        harness.run();
        assert!(matches!(harness.state_mut().pop(), Some(Press::Seek(t)) if (39.0..41.0).contains(&t)), "the middle of the line");
        harness.get_by_label(&words.say("tour-time")).focus();
        harness.run();
        harness.key_press(bevy_egui::egui::Key::ArrowRight);
        harness.run();
        assert_eq!(harness.state_mut().pop(), Some(Press::Seek(70.0)));
        harness.key_press(bevy_egui::egui::Key::ArrowLeft);
        harness.run();
        assert_eq!(harness.state_mut().pop(), Some(Press::Seek(60.0)), "the line keeps the keys");
    }

    #[test]
    fn before_its_first_chapter_the_tours_title_stands() {
        let (look, tour, words) = (Look { text: 16.0, high_contrast: false, reduced_motion: true }, tour(), words("en"));
        let harness =
            Harness::new_ui(|ui| _ = show(ui, &look, (&words, &KeyNames::default()), &tour, TourState::Paused, (1.0, false)));
        harness.get_by_label("A walk");
        harness.get_by_label(&words.say("tour-play"));
    }
}
