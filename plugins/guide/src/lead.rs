use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use bevy_egui::EguiContexts;
use bevy_egui::egui::{Align2, Area, Id as EguiId, Order, Ui, Vec2 as EguiVec2};
use veduta_city::{Overview, Viewpoint};
use veduta_ecs::{
    Around, Awaited, City, CityClock, CityFailed, Eye, Interface, Itinerary, JumpTo, OverviewWants, Route, Steering, Stop, Viewer,
    WalkTo, Words,
};
use veduta_route::{Pose, RouteError, StreetNet, WALK_EYE_M, Walk};
use veduta_ui::{Look, Surface, Symbol, symbol_button};

use crate::CityGuide;
use crate::obstacles::Obstacles;

/// How somebody is led. Live.
#[derive(Resource, Debug, Clone, Copy, PartialEq)]
pub struct LeadSettings {
    /// Walking speed, metres a second.
    pub walk_m_s: f64,
    /// Whether ways lead over no stairs.
    pub without_steps: bool,
}

impl Default for LeadSettings {
    fn default() -> Self {
        Self { walk_m_s: 2.2, without_steps: false }
    }
}

/// A walk that was asked for has ended.
#[derive(Message, Debug, Clone, PartialEq, Eq)]
pub struct WalkEnded {
    /// Where it led, as the visitor reads it.
    pub name: String,
    /// Whether its end was reached.
    pub arrived: bool,
}

/// The visitor is led along the streets to where he asked.
#[derive(Resource, Default)]
pub struct Lead(State);

#[derive(Default)]
enum State {
    #[default]
    Idle,
    /// Asked for; the streets between may be on their way.
    Asked(WalkTo),
    /// The way is being found, beside the frame.
    Finding(WalkTo, Task<Result<Walk, NoWay>>),
    /// Under way: how long, and whether it stands still until the street ahead does.
    Walking { to: WalkTo, walk: Arc<Walk>, t_s: f64, waits: bool },
}

impl Lead {
    /// Whether somebody is on the way, or about to be.
    #[must_use]
    pub fn is_under_way(&self) -> bool {
        !matches!(self.0, State::Idle)
    }

    /// Whether the walk stands still because what lies ahead has not come.
    #[must_use]
    pub fn waits(&self) -> bool {
        matches!(self.0, State::Walking { waits: true, .. })
    }
}

/// Why nobody is led.
#[derive(Debug, Clone, Copy, PartialEq)]
enum NoWay {
    /// There is no way at all.
    None(RouteError),
    /// There is one over stairs, which are to be left out.
    OverSteps,
}

/// Streets are looked for in a circle about both ends that reaches so far beyond them, as a share of their distance, and at least this.
const ROUND: f64 = 0.6;
const LEAST_ROUND_M: f64 = 150.0;

fn around(from: DVec2, to: DVec2) -> Around {
    let apart = from.distance(to);
    Around { middle: (from + to) / 2.0, radius_m: apart / 2.0 + (apart * ROUND).max(LEAST_ROUND_M) }
}

/// Takes walks that are asked for, and ends one when the visitor touches the controls.
pub(crate) fn set_out(
    mut asked: MessageReader<WalkTo>,
    mut jumps: MessageReader<JumpTo>,
    mut lead: ResMut<Lead>,
    mut route: ResMut<Route>,
    mut steering: ResMut<Steering>,
    mut ended: MessageWriter<WalkEnded>,
    mut wants: ResMut<OverviewWants>,
) {
    let jumped = jumps.read().count() > 0;
    let let_go = match lead.0 {
        State::Walking { .. } => *steering != Steering::Led,
        // A tour that begins meanwhile leads elsewhere.
        _ => *steering == Steering::Guided,
    };
    if (let_go || jumped) && lead.is_under_way() {
        stop(&mut lead, &mut route, &mut steering, &mut wants, &mut ended, false);
    }
    if let Some(to) = asked.read().last() {
        if lead.is_under_way() {
            stop(&mut lead, &mut route, &mut steering, &mut wants, &mut ended, false);
        }
        lead.0 = State::Asked(to.clone());
    }
}

fn stop(
    lead: &mut Lead,
    route: &mut ResMut<Route>,
    steering: &mut ResMut<Steering>,
    wants: &mut ResMut<OverviewWants>,
    ended: &mut MessageWriter<WalkEnded>,
    arrived: bool,
) {
    if let State::Asked(to) | State::Finding(to, _) | State::Walking { to, .. } = core::mem::take(&mut lead.0) {
        ended.write(WalkEnded { name: to.name, arrived });
    }
    route.set_if_neq(Route::default());
    if **steering == Steering::Led {
        **steering = Steering::Visitor;
    }
    OverviewWants::ask(wants, "lead", None);
}

/// Finds the way once the streets between are here.
pub(crate) fn find_way(
    city: Option<Res<City>>,
    viewers: Query<&Eye, With<Viewer>>,
    settings: Res<LeadSettings>,
    clock: Res<CityClock>,
    words: Res<Words>,
    mut lead: ResMut<Lead>,
    mut route: ResMut<Route>,
    mut steering: ResMut<Steering>,
    mut wants: ResMut<OverviewWants>,
    mut jumps: MessageWriter<JumpTo>,
    mut ended: MessageWriter<WalkEnded>,
    mut failed: MessageWriter<CityFailed>,
) {
    let (Some(city), Some(eye)) = (city, viewers.iter().next()) else { return };
    match &mut lead.0 {
        State::Asked(to) => {
            let to = to.clone();
            // From the air nobody walks.
            if eye.eye_m > WALK_EYE_M {
                jumps.write(JumpTo(to.to));
                stop(&mut lead, &mut route, &mut steering, &mut wants, &mut ended, true);
                return;
            }
            let around = around(eye.plan_pos, to.to.pos);
            OverviewWants::ask(&mut wants, "lead", Some(around));
            if !city.overviews.has(around) {
                return;
            }
            let parts: Vec<Arc<Overview>> = city.overviews.near(around).map(Arc::clone).collect();
            let (from, goal, settings) = (pose_of(eye, clock.hour), to.to, *settings);
            let task = AsyncComputeTaskPool::get().spawn(async move { way(&parts, from, goal, settings) });
            lead.0 = State::Finding(to, task);
        }
        State::Finding(to, task) => match block_on(poll_once(task)) {
            None => {}
            Some(Ok(walk)) => {
                let (to, walk) = (to.clone(), Arc::new(walk));
                let (left_m, left_s) = (walk.length_m(), walk.duration_s());
                route.set_if_neq(Route { way: walk.way().to_vec(), name: to.name.clone(), left_m, left_s });
                steering.set_if_neq(Steering::Led);
                lead.0 = State::Walking { to, walk, t_s: 0.0, waits: false };
            }
            Some(Err(why)) => {
                let told = |message| words.say_with(message, &[("name", to.name.clone().into())]);
                let message = match why {
                    NoWay::None(error) => format!("{} ({error})", told("lead-no-way")),
                    NoWay::OverSteps => told("lead-over-steps"),
                };
                failed.write(CityFailed { message, will_retry: false });
                stop(&mut lead, &mut route, &mut steering, &mut wants, &mut ended, false);
            }
        },
        State::Idle | State::Walking { .. } => {}
    }
}

fn pose_of(eye: &Eye, hour: f64) -> Pose {
    Pose {
        plan_pos: eye.plan_pos,
        eye_m: eye.eye_m,
        heading_deg: eye.heading_deg,
        pitch_deg: eye.pitch_deg,
        fov_deg: eye.fov_deg,
        hour,
        fade: 0.0,
    }
}

fn way(parts: &[Arc<Overview>], from: Pose, to: Viewpoint, settings: LeadSettings) -> Result<Walk, NoWay> {
    let joined;
    let overview = match parts {
        [one] => one.as_ref(),
        parts => {
            joined = Overview::joined(parts.iter().map(AsRef::as_ref));
            &joined
        }
    };
    let obstacles = Obstacles::of(overview);
    let free = |a: DVec2, b: DVec2| obstacles.leave_free(a, b);
    let there = Pose { plan_pos: to.pos, heading_deg: to.heading_deg, pitch_deg: to.pitch_deg, ..from };
    let walk = |net: StreetNet| Walk::new(&net.on(&overview.terrain), from, there, settings.walk_m_s, Some(&free));
    if !settings.without_steps {
        return walk(StreetNet::new(&overview.streets)).map_err(NoWay::None);
    }
    walk(StreetNet::without_steps(&overview.streets)).map_err(|error| match walk(StreetNet::new(&overview.streets)) {
        Ok(_) => NoWay::OverSteps,
        Err(_) => NoWay::None(error),
    })
}

/// Carries the walk on.
pub(crate) fn go(
    time: Res<Time>,
    awaited: Res<Awaited>,
    mut lead: ResMut<Lead>,
    mut route: ResMut<Route>,
    mut steering: ResMut<Steering>,
    mut wants: ResMut<OverviewWants>,
    mut viewers: Query<(&mut Eye, &mut Itinerary), With<Viewer>>,
    mut ended: MessageWriter<WalkEnded>,
    mut has_told: Local<bool>,
) {
    let State::Walking { walk, t_s, waits, .. } = &mut lead.0 else {
        if core::mem::take(&mut *has_told) {
            viewers.iter_mut().for_each(|(_, mut itinerary)| _ = itinerary.set_if_neq(Itinerary::default()));
        }
        return;
    };
    *has_told = true;
    let dt = time.delta_secs_f64();
    // The street ahead stands before it is walked into.
    *waits = awaited.cells > 0 || awaited.ahead > 0;
    if !*waits {
        *t_s = (*t_s + dt).min(walk.duration_s());
    }
    let pose = walk.pose(*t_s);
    let stops = Itinerary::AHEAD_S.map(|in_s| {
        let pose = walk.pose(*t_s + in_s);
        Stop { in_s, plan_pos: pose.plan_pos, eye_m: pose.eye_m }
    });
    let (has_arrived, left_m, left_s) = (*t_s >= walk.duration_s(), walk.left_m(pose.plan_pos), walk.duration_s() - *t_s);
    for (mut eye, mut itinerary) in &mut viewers {
        let (ground_m, fov_deg, fade) = (eye.ground_m, eye.fov_deg, eye.fade);
        eye.set_if_neq(Eye {
            plan_pos: pose.plan_pos,
            ground_m,
            eye_m: pose.eye_m,
            heading_deg: pose.heading_deg,
            pitch_deg: pose.pitch_deg,
            fov_deg,
            fade,
        });
        itinerary.set_if_neq(Itinerary(if has_arrived { Vec::new() } else { stops.to_vec() }));
    }
    if has_arrived {
        stop(&mut lead, &mut route, &mut steering, &mut wants, &mut ended, true);
    } else {
        (route.left_m, route.left_s) = (left_m, left_s);
    }
}

/// Where the way leads and how long it takes yet, at the top in the middle.
pub(crate) fn draw(
    mut contexts: EguiContexts,
    lead: Res<Lead>,
    route: Res<Route>,
    words: Res<Words>,
    interface: Res<Interface>,
    guide: Res<CityGuide>,
    mut steering: ResMut<Steering>,
) -> Result {
    if !matches!(lead.0, State::Walking { .. }) {
        return Ok(());
    }
    let context = contexts.ctx_mut()?;
    let look = Look::of(&interface, context);
    let offset = EguiVec2::new(0.0, context.content_rect().height() * 0.03);
    let stops = Area::new(EguiId::new("veduta lead")).anchor(Align2::CENTER_TOP, offset).order(Order::Middle).show(context, |ui| {
        let frame = look.frame(Surface::Dusk);
        frame.show(ui, |ui| show(ui, &look, &words, guide.name(&route.name, &words), &route, lead.waits())).inner
    });
    if stops.inner {
        steering.set_if_neq(Steering::Visitor);
    }
    Ok(())
}

/// The line of a walk; whether to stop.
fn show(ui: &mut Ui, look: &Look, words: &Words, name: &str, route: &Route, waits: bool) -> bool {
    look.dress(ui, Surface::Dusk);
    ui.horizontal(|ui| {
        ui.label(match name {
            "" => words.say("lead-to-spot"),
            name => words.say_with("lead-to", &[("name", name.to_owned().into())]),
        });
        let told = if waits {
            words.say("lead-waits")
        } else {
            let minutes = (route.left_s / 60.0).round() as u32;
            let metres = (route.left_m / 5.0).round() as u32 * 5;
            words.say_with("lead-left", &[("metres", metres.into()), ("minutes", minutes.into())])
        };
        ui.label(look.words(told, 1.0, look.accent(Surface::Dusk)));
        symbol_button(ui, look, Surface::Dusk, Symbol::Close, false, &words.say("lead-stop"), "").clicked()
    })
    .inner
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use bevy::time::TimeUpdateStrategy;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;
    use veduta_city::{GridPolygon, GridPos, GroundPatch, Id, PlanStreet, StreetClass, SurfaceKind};
    use veduta_ecs::Overviews;

    use super::*;

    fn led() -> (App, Entity) {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), crate::GuidePlugin { interface: false }))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_millis(50)));
        let line = [(0, 0), (200, 0)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec();
        let street = PlanStreet { id: Id(1), name: "Long".into(), line, width: 6 * 1024, walkable: true, ..PlanStreet::default() };
        let overview = Overview { streets: vec![street], ..Overview::default() };
        app.insert_resource(City { overviews: Overviews::whole(overview), ..City::default() });
        let viewer = app.world_mut().spawn((Viewer, Eye { plan_pos: DVec2::new(5.0, 0.0), ..Eye::default() })).id();
        (app, viewer)
    }

    fn ask(app: &mut App, x: f64) {
        let to = Viewpoint { pos: DVec2::new(x, 0.0), heading_deg: 180.0, pitch_deg: 10.0, ..Viewpoint::default() };
        app.world_mut().write_message(WalkTo { name: "There".into(), to });
    }

    fn until(app: &mut App, what: &str, holds: impl Fn(&World) -> bool) {
        for _ in 0..5_000 {
            app.update();
            if holds(app.world()) {
                return;
            }
            if matches!(app.world().resource::<Lead>().0, State::Finding(..)) {
                std::thread::sleep(Duration::from_millis(1));
            }
        }
        panic!("never: {what}");
    }

    fn ended(app: &mut App) -> Vec<WalkEnded> {
        app.world_mut().resource_mut::<Messages<WalkEnded>>().drain().collect()
    }

    #[test]
    fn the_visitor_is_led_there_and_the_way_is_shown() {
        let (mut app, viewer) = led();
        ask(&mut app, 105.0);
        until(&mut app, "on the way", |world| *world.resource::<Steering>() == Steering::Led);
        let route = app.world().resource::<Route>().clone();
        assert!(route.way.len() >= 2 && route.name == "There" && (95.0..=100.5).contains(&route.left_m), "{route:?}");
        until(&mut app, "there", |world| !world.resource::<Lead>().is_under_way());
        let eye = *app.world().get::<Eye>(viewer).expect("spawned above");
        assert!(eye.plan_pos.distance(DVec2::new(105.0, 0.0)) < 0.1 && (eye.heading_deg - 180.0).abs() < 0.5, "{eye:?}");
        assert_eq!(*app.world().resource::<Steering>(), Steering::Visitor);
        assert!(app.world().resource::<Route>().way.is_empty());
        assert_eq!(ended(&mut app), [WalkEnded { name: "There".into(), arrived: true }]);
    }

    #[test]
    fn who_touches_the_controls_walks_on_by_himself() {
        let (mut app, viewer) = led();
        ask(&mut app, 150.0);
        until(&mut app, "on the way", |world| {
            world.resource::<Route>().left_m.clamp(1.0, 120.0) == world.resource::<Route>().left_m
        });
        app.insert_resource(Steering::Visitor);
        app.update();
        assert_eq!(ended(&mut app), [WalkEnded { name: "There".into(), arrived: false }]);
        let here = app.world().get::<Eye>(viewer).expect("spawned above").plan_pos;
        (0..20).for_each(|_| app.update());
        assert_eq!(app.world().get::<Eye>(viewer).expect("spawned above").plan_pos, here);
        assert!(app.world().get::<Itinerary>(viewer).is_some_and(|ahead| ahead.0.is_empty()), "nothing is read ahead any more");
    }

    #[test]
    fn it_waits_for_the_street_ahead() {
        let (mut app, viewer) = led();
        ask(&mut app, 150.0);
        until(&mut app, "on the way", |world| {
            world.resource::<Route>().left_m.clamp(1.0, 130.0) == world.resource::<Route>().left_m
        });
        let here = app.world().get::<Eye>(viewer).expect("spawned above").plan_pos;
        for awaited in [Awaited { cells: 2, ahead: 0 }, Awaited { cells: 0, ahead: 1 }] {
            app.insert_resource(awaited);
            (0..3_000).for_each(|_| app.update());
            assert_eq!(app.world().get::<Eye>(viewer).expect("spawned above").plan_pos, here, "{awaited:?}");
            assert!(app.world().resource::<Lead>().waits());
        }
        app.insert_resource(Awaited::default());
        until(&mut app, "there", |world| !world.resource::<Lead>().is_under_way());
    }

    #[test]
    fn where_no_way_leads_it_is_said() {
        let (mut app, _) = led();
        ask(&mut app, 9_000.0);
        until(&mut app, "given up", |world| !world.resource::<Lead>().is_under_way());
        let told: Vec<CityFailed> = app.world_mut().resource_mut::<Messages<CityFailed>>().drain().collect();
        assert!(told.iter().any(|failed| failed.message.contains("There")), "{told:?}");
        assert_eq!(*app.world().resource::<Steering>(), Steering::Visitor);
    }

    #[test]
    fn where_only_stairs_lead_who_will_have_none_is_told_so() {
        let (mut app, _) = led();
        let street = |id: u64, line: [(i32, i32); 2], class| PlanStreet {
            id: Id(id),
            line: line.map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec(),
            width: 4 * 1024,
            walkable: true,
            class,
            ..PlanStreet::default()
        };
        let streets = vec![
            street(1, [(0, 0), (100, 0)], StreetClass::Lane),
            street(2, [(100, 0), (200, 0)], StreetClass::Steps),
            street(3, [(200, 0), (400, 0)], StreetClass::Lane),
        ];
        // No square: who leaves the stairs aside gets wet.
        let banks = [(120, -300), (180, -300), (180, 300), (120, 300)].map(|(x, y)| GridPos(x * 1024, y * 1024)).to_vec();
        let water = GroundPatch { surface: SurfaceKind::Water, outline: GridPolygon::simple(banks), z: 0, course: None };
        let overview = Overview { streets, ground: vec![water], ..Overview::default() };
        app.insert_resource(City { overviews: Overviews::whole(overview), ..City::default() });
        app.insert_resource(LeadSettings { without_steps: true, ..LeadSettings::default() });
        ask(&mut app, 390.0);
        until(&mut app, "told", |world| !world.resource::<Messages<CityFailed>>().is_empty());
        let told: Vec<CityFailed> = app.world_mut().resource_mut::<Messages<CityFailed>>().drain().collect();
        assert!(told.iter().any(|failed| failed.message.contains("stairs")), "{told:?}");
        assert!(!app.world().resource::<Lead>().is_under_way());
        app.insert_resource(LeadSettings::default());
        ask(&mut app, 390.0);
        until(&mut app, "on the way", |world| *world.resource::<Steering>() == Steering::Led);
    }

    #[test]
    fn the_line_of_a_walk_can_be_stopped() {
        let mut words = Words::default();
        crate::WORDS.iter().for_each(|(code, messages)| words.add(code, messages).expect("no mistakes"));
        let look = Look { text: 16.0, high_contrast: false, reduced_motion: false };
        let route = Route { name: "Powder Tower".into(), left_m: 413.0, left_s: 187.0, ..Route::default() };
        let mut harness =
            Harness::new_ui_state(|ui, stops: &mut bool| *stops |= show(ui, &look, &words, &route.name, &route, false), false);
        harness.get_by_label("To Powder Tower");
        harness.get_by_label("415 m, about 3 minutes");
        harness.get_by_label("Stop here").click();
        harness.run();
        assert!(*harness.state());
    }
}
