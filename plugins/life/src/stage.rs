//! Who of the population is seen: near enough, where the city stands, within what it may cost.

use std::collections::{BTreeMap, BTreeSet};

use bevy::ecs::system::SystemParam;
use bevy::light::NotShadowCaster;
use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use veduta_city::{Id, Life, LifeKind};
use veduta_ecs::{City, Daylight, Eye, Ground, OpenCity, StandingCells, Subject, Viewer, Weather, WorldOrigin};

use crate::craft;
use crate::dial;
use crate::flock::Flock;
use crate::material::{LifeUniform, MistMaterial, SolidMaterial, solid};
use crate::pigeon;
use crate::population::{Dweller, Population, eye_pos, stands};
use crate::sculpt::Sculpt;
use crate::settings::LifeSettings;
use crate::spots::spots;
use crate::wind::Pendulum;

/// A mesh of something that lives; for whoever counts or hides them.
#[derive(Component, Debug, Clone, Copy, PartialEq, Eq)]
pub struct Living(
    /// Id of the thing.
    pub Id,
);

/// Something on stage.
#[derive(Debug)]
pub(crate) struct Actor {
    pub dweller: Dweller,
    /// Its foot above the city's zero, metres, and in the engine's world.
    pub z_m: f64,
    pub world: Vec3,
    /// Vertices that it draws.
    work: usize,
    entities: Vec<Entity>,
    pub part: Part,
}

/// What an actor does.
#[derive(Debug)]
pub(crate) enum Part {
    /// Nothing that the processor sees to: shaders move it.
    Still,
    /// A flock, its materials and how each bird is coloured.
    Flock {
        flock: Box<Flock>,
        birds: Handle<SolidMaterial>,
        shades: Handle<MistMaterial>,
        origin_m: DVec3,
        hues: Vec<f32>,
        /// Where its middle is, for whoever follows it.
        subject: Option<Entity>,
    },
    /// Hands, in the order of the dial's pointings.
    Clock { hands: Vec<Entity> },
    /// A board.
    Sign { board: Entity, pendulum: Pendulum },
    /// A figure for each window, and the bodies that they take.
    Figures { figures: Vec<Entity>, bodies: Vec<Handle<Mesh>> },
}

/// Those who are seen.
#[derive(Resource, Debug, Default)]
pub(crate) struct Stage {
    pub actors: BTreeMap<u64, Actor>,
    /// What was looked at when they were chosen.
    chosen: Option<Chosen>,
}

#[derive(Debug, Clone, PartialEq)]
struct Chosen {
    eyes: Vec<DVec2>,
    version: u64,
    settings: LifeSettings,
    standing: usize,
    is_night: bool,
    origin: WorldOrigin,
}

/// Materials that many share.
#[derive(Resource, Debug, Default)]
pub(crate) struct LifeMaterials {
    pub uniform: LifeUniform,
    pub solid: Handle<SolidMaterial>,
    pub water: Handle<MistMaterial>,
    pub smoke: Handle<MistMaterial>,
}

/// Viewers move so far before it is chosen again, metres.
const STEP_M: f64 = 6.0;
/// Who is on stage stays until it is so much farther off than its reach.
const LINGER: f64 = 1.08;
/// Share of pigeons that are still about at night.
const SLEEPLESS: f64 = 0.12;

/// Everything that actors are made with.
#[derive(SystemParam)]
pub(crate) struct Workshop<'w, 's> {
    pub commands: Commands<'w, 's>,
    meshes: ResMut<'w, Assets<Mesh>>,
    solids: ResMut<'w, Assets<SolidMaterial>>,
    mists: ResMut<'w, Assets<MistMaterial>>,
    materials: ResMut<'w, LifeMaterials>,
    ground: Ground<'w>,
    origin: Res<'w, WorldOrigin>,
    standing: Res<'w, StandingCells>,
    city: Option<Res<'w, City>>,
    time: Res<'w, Time>,
}

/// Chooses who is seen: the nearest first, until the settings' bounds are reached.
pub(crate) fn choose(
    population: Res<Population>,
    settings: Res<LifeSettings>,
    (light, opened): (Res<Daylight>, Option<Res<OpenCity>>),
    viewers: Query<&Eye, With<Viewer>>,
    mut stage: ResMut<Stage>,
    mut workshop: Workshop<'_, '_>,
) {
    let eyes: Vec<DVec3> = viewers.iter().map(eye_pos).collect();
    let now = Chosen {
        eyes: eyes.iter().map(|eye| (eye.truncate() / STEP_M).round()).collect(),
        version: population.version,
        settings: *settings,
        standing: workshop.standing.len(),
        is_night: light.night > 0.6,
        origin: *workshop.origin,
    };
    if stage.chosen.as_ref() == Some(&now) {
        return;
    }
    // Another plainness or origin, or another person's file: everything is made anew.
    let is_all_new = stage.chosen.as_ref().is_none_or(|last| {
        last.settings.plain_light != settings.plain_light
            || last.settings.most_drops != settings.most_drops
            || last.origin != now.origin
    });
    if is_all_new {
        workshop.dress(&settings);
    }
    let wanted = rank(&population, &settings, &eyes, now.is_night, &stage, |at| stands(at, &workshop.standing, opened.as_deref()));
    let stays: BTreeSet<u64> = wanted.iter().map(|(dweller, _)| dweller.id.0).collect();
    stage.actors.retain(|id, actor| {
        let is_same = wanted.iter().any(|(dweller, _)| dweller.id.0 == *id && dweller.kind == actor.dweller.kind);
        let stays = stays.contains(id) && is_same && !is_all_new;
        if !stays {
            actor.entities.iter().for_each(|&entity| workshop.commands.entity(entity).despawn());
        }
        stays
    });
    for (dweller, count) in wanted {
        stage.actors.entry(dweller.id.0).or_insert_with(|| workshop.make(dweller, count, &settings));
    }
    stage.chosen = Some(now);
}

/// Those who are seen, nearest first, and of flocks how many birds.
fn rank<'a>(
    population: &'a Population,
    settings: &LifeSettings,
    eyes: &[DVec3],
    is_night: bool,
    stage: &Stage,
    stands: impl Fn(DVec2) -> bool,
) -> Vec<(&'a Dweller, usize)> {
    let away = |dweller: &Dweller| eyes.iter().map(|eye| eye.truncate().distance(dweller.plan_pos)).fold(f64::INFINITY, f64::min);
    let mut near: Vec<(f64, &Dweller)> = population
        .dwellers()
        .filter(|dweller| settings.kinds.has(&dweller.kind) && is_drawn(&dweller.kind))
        .map(|dweller| (away(dweller), dweller))
        .filter(|(away, dweller)| {
            let linger = if stage.actors.contains_key(&dweller.id.0) { LINGER } else { 1.0 };
            *away < settings.reach_m(&dweller.kind) * linger && stands(dweller.plan_pos)
        })
        .collect();
    near.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.id.cmp(&b.1.id)));
    let (mut work, mut pigeons) = (settings.most_vertices as usize, settings.most_pigeons as usize);
    let mut wanted = Vec::new();
    for (_, dweller) in near {
        let mut count = 0;
        if let LifeKind::Flock { count: told, .. } = dweller.kind {
            let awake = if is_night { (f64::from(told) * SLEEPLESS).round() as usize } else { told as usize };
            // A flock that is on stage keeps its birds: none vanishes before somebody's eyes.
            let present = stage.actors.get(&dweller.id.0).and_then(|actor| match &actor.part {
                Part::Flock { flock, .. } => Some(flock.len()),
                _ => None,
            });
            count = present.unwrap_or(awake.min(pigeons)).min(pigeons);
            if count == 0 {
                continue;
            }
            pigeons -= count;
        }
        let costs = match stage.actors.get(&dweller.id.0) {
            Some(actor) => actor.work,
            None => estimate(&dweller.kind, count, settings),
        };
        if costs > work {
            continue;
        }
        work -= costs;
        wanted.push((dweller, count));
    }
    wanted
}

/// Whether it is a body: bells are only heard, and all smoke is one mesh.
const fn is_drawn(kind: &LifeKind) -> bool {
    !matches!(kind, LifeKind::Bell { .. } | LifeKind::Smoke { .. })
}

/// Vertices that something will draw.
fn estimate(kind: &LifeKind, count: usize, settings: &LifeSettings) -> usize {
    match kind {
        LifeKind::Fountain { jets, .. } => {
            let threads: usize = jets.iter().map(|jet| jet.count as usize).sum();
            threads * (26 + 8) + 4 * settings.most_drops as usize
        }
        LifeKind::Flag { .. } => 700,
        LifeKind::Flock { .. } => count * (pigeon::vertices() + 4),
        LifeKind::Sign { .. } => 900,
        LifeKind::Clock { .. } => 4_000,
        LifeKind::Figures { windows_m, .. } => 700 * windows_m.len(),
        LifeKind::Smoke { .. } | LifeKind::Bell { .. } => 0,
    }
}

impl Workshop<'_, '_> {
    /// Materials that many share, as the settings want them.
    fn dress(&mut self, settings: &LifeSettings) {
        let life = self.materials.uniform;
        self.materials.solid = self.solids.add(solid(life, false, settings.plain_light));
        self.materials.water = self.mists.add(MistMaterial { life, ..default() });
        if self.materials.smoke == Handle::default() {
            self.materials.smoke = self.mists.add(MistMaterial { life, ..default() });
        }
    }

    fn stiff(&mut self, id: Id, sculpt: Sculpt, at: Transform) -> Entity {
        let mesh = self.meshes.add(sculpt.mesh());
        self.commands.spawn((Living(id), Mesh3d(mesh), MeshMaterial3d(self.materials.solid.clone()), at)).id()
    }

    fn make(&mut self, dweller: &Dweller, count: usize, settings: &LifeSettings) -> Actor {
        let z_m = self.ground.at(dweller.plan_pos, f64::INFINITY) + dweller.height_m;
        let turn = Quat::from_rotation_y(core::f32::consts::PI - dweller.heading_deg.to_radians() as f32);
        let at = Transform::from_translation(self.origin.world_from_plan(dweller.plan_pos, z_m)).with_rotation(turn);
        let (id, phase) = (dweller.id, (dweller.id.0 % 1009) as f32 / 1009.0);
        let (work, entities, part) = match &dweller.kind {
            LifeKind::Fountain { radius_m, water_m, jets } => {
                let sculpt = craft::fountain(jets, (*radius_m, *water_m), settings.most_drops as usize);
                let work = sculpt.vertices();
                let mesh = self.meshes.add(sculpt.mesh());
                let water = MeshMaterial3d(self.materials.water.clone());
                let highest = jets.iter().map(|jet| jet.height_m + jet.rise_m).fold(*water_m, f64::max);
                let bounds = bounds(Vec3::new(0.0, (highest / 2.0) as f32, 0.0), (radius_m * 1.6 + highest) as f32);
                (work, vec![self.commands.spawn((Living(id), Mesh3d(mesh), water, at, bounds, NotShadowCaster)).id()], Part::Still)
            }
            LifeKind::Flag { pole_m, tilt_deg, size_m, fields, wedge } => {
                let sculpt = craft::flag(*pole_m, *tilt_deg, *size_m, fields, *wedge, phase);
                let work = sculpt.vertices();
                let entity = self.stiff(id, sculpt, at);
                self.commands.entity(entity).insert(bounds(Vec3::ZERO, (pole_m + size_m.0 + size_m.1) as f32));
                (work, vec![entity], Part::Still)
            }
            LifeKind::Flock { radius_m, startle_m, .. } => {
                return self.make_flock(dweller, count, (*radius_m, *startle_m), settings);
            }
            LifeKind::Sign { shape, size_m, arm_m, colour, trim } => {
                let (bracket, hung) = craft::sign(*shape, *size_m, *arm_m, (*colour, *trim));
                let work = bracket.vertices() + hung.vertices();
                let hinge = at * Transform::from_xyz(0.0, -0.016, (arm_m - size_m.0 / 2.0 - 0.04) as f32);
                let entities = vec![self.stiff(id, bracket, at), self.stiff(id, hung, hinge)];
                let part = Part::Sign { board: entities[1], pendulum: Pendulum::hanging(0.12 + size_m.1 / 2.0) };
                (work, entities, part)
            }
            LifeKind::Clock { radius_m, dial, face, gold } => {
                let lat_deg = self.city.as_ref().map_or(50.0, |city| city.anchor.lat);
                let cut = dial::cut(*dial, *radius_m, (*face, *gold), lat_deg);
                let work = cut.dial.vertices() + cut.hands.iter().map(Sculpt::vertices).sum::<usize>();
                let mut entities = vec![self.stiff(id, cut.dial, at)];
                let hands: Vec<Entity> = cut.hands.into_iter().map(|hand| self.stiff(id, hand, at)).collect();
                entities.extend(&hands);
                (work, entities, Part::Clock { hands })
            }
            LifeKind::Figures { count, windows_m, size_m, .. } => {
                let bodies: Vec<Sculpt> = (0..*count as usize).map(|n| craft::figure(n, (size_m.1 * 0.86) as f32)).collect();
                let work = bodies.iter().map(Sculpt::vertices).max().unwrap_or(0) * windows_m.len();
                let bodies: Vec<Handle<Mesh>> = bodies.into_iter().map(|body| self.meshes.add(body.mesh())).collect();
                let solid = MeshMaterial3d(self.materials.solid.clone());
                let spawn = |_| {
                    let body = Mesh3d(bodies.first().cloned().unwrap_or_default());
                    self.commands.spawn((Living(id), body, solid.clone(), at, Visibility::Hidden)).id()
                };
                let figures: Vec<Entity> = windows_m.iter().map(spawn).collect();
                (work, figures.clone(), Part::Figures { figures, bodies })
            }
            LifeKind::Smoke { .. } | LifeKind::Bell { .. } => (0, Vec::new(), Part::Still),
        };
        if let Some(&first) = entities.get(usize::from(matches!(part, Part::Sign { .. }))).filter(|_| !dweller.name.is_empty()) {
            self.commands.entity(first).insert(Subject(dweller.name.clone()));
        }
        Actor { dweller: dweller.clone(), z_m, world: at.translation, work, entities, part }
    }

    fn make_flock(&mut self, dweller: &Dweller, count: usize, (radius_m, startle_m): (f64, f64), settings: &LifeSettings) -> Actor {
        let (id, middle) = (dweller.id, dweller.plan_pos);
        let free = spots(id, middle, radius_m, self.city.as_deref(), &self.standing, &self.ground);
        let flock = Flock::new(id, middle, count, startle_m, free, self.time.elapsed_secs_f64());
        let z_m = self.ground.at(middle, f64::INFINITY);
        let life = self.materials.uniform;
        let birds = self.solids.add(solid(life, true, settings.plain_light));
        let shades = self.mists.add(MistMaterial { life, ..default() });
        let at = Transform::from_translation(self.origin.world_from_plan(middle, z_m));
        let body = pigeon::flock(flock.len());
        let work = body.vertices() + 4 * flock.len();
        let around = bounds(Vec3::Y * 6.0, (radius_m + 24.0) as f32);
        let mut entities = vec![
            self.commands.spawn((Living(id), Mesh3d(self.meshes.add(body.mesh())), MeshMaterial3d(birds.clone()), at, around)).id(),
            self.commands
                .spawn((
                    Living(id),
                    Mesh3d(self.meshes.add(craft::shades(flock.len()).mesh())),
                    MeshMaterial3d(shades.clone()),
                    at,
                    around,
                    NotShadowCaster,
                ))
                .id(),
        ];
        let draw = veduta_city::draw::Draw::new(0, id, "plumage");
        let hues = (0..Life::MOST_PIGEONS as u64).map(|n| draw.part(n).unit("hue") as f32).collect();
        let is_named = !dweller.name.is_empty() && flock.len() > 0;
        let subject = is_named.then(|| self.commands.spawn((Subject(dweller.name.clone()), at)).id());
        entities.extend(subject);
        let part = Part::Flock { flock: Box::new(flock), birds, shades, origin_m: middle.extend(z_m), hues, subject };
        Actor { dweller: dweller.clone(), z_m, world: at.translation, work, entities, part }
    }
}

/// What is moved by its shader tells where it may be.
fn bounds(middle: Vec3, radius: f32) -> bevy::camera::primitives::Aabb {
    bevy::camera::primitives::Aabb { center: middle.into(), half_extents: Vec3::splat(radius).into() }
}

/// Tells materials of light and wind when they have visibly changed.
pub(crate) fn tell_light(
    (light, weather): (Res<Daylight>, Res<Weather>),
    stage: Res<Stage>,
    mut materials: ResMut<LifeMaterials>,
    mut solids: ResMut<Assets<SolidMaterial>>,
    mut mists: ResMut<Assets<MistMaterial>>,
) {
    let now = LifeUniform::of(&light, &weather);
    if !now.differs(&materials.uniform) {
        return;
    }
    materials.uniform = now;
    let mut of_solids = vec![&materials.solid];
    let mut of_mists = vec![&materials.water, &materials.smoke];
    for actor in stage.actors.values() {
        if let Part::Flock { birds, shades, .. } = &actor.part {
            of_solids.push(birds);
            of_mists.push(shades);
        }
    }
    for handle in of_solids {
        if let Some(mut material) = solids.get_mut(handle) {
            material.extension.life = now;
        }
    }
    for handle in of_mists {
        if let Some(mut material) = mists.get_mut(handle) {
            material.life = now;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::LifeKinds;

    fn population() -> Population {
        let dweller = |n: u64, x: f64, kind: LifeKind| Dweller {
            id: Id(n),
            name: String::new(),
            plan_pos: DVec2::new(x, 0.0),
            height_m: 0.0,
            heading_deg: 0.0,
            kind,
        };
        let flock = |count| LifeKind::Flock { radius_m: 10.0, count, startle_m: 4.0 };
        let flag =
            LifeKind::Flag { pole_m: 3.0, tilt_deg: 0.0, size_m: (1.0, 1.5), fields: vec![veduta_city::Rgb(1, 2, 3)], wedge: None };
        Population {
            told: vec![
                dweller(1, 10.0, flock(40)),
                dweller(2, 50.0, flock(40)),
                dweller(3, 30.0, flag.clone()),
                dweller(4, 5_000.0, flag),
            ],
            ..Population::default()
        }
    }

    fn ranked(settings: &LifeSettings, is_night: bool) -> Vec<(u64, usize)> {
        let (population, eyes) = (population(), [DVec3::ZERO]);
        let all = rank(&population, settings, &eyes, is_night, &Stage::default(), |at| at.x < 100.0);
        all.into_iter().map(|(dweller, count)| (dweller.id.0, count)).collect()
    }

    #[test]
    fn the_nearest_come_first_and_the_caps_hold() {
        let all = LifeSettings::default();
        assert_eq!(ranked(&all, false), [(1, 40), (3, 0), (2, 40)]);
        assert_eq!(ranked(&LifeSettings { most_pigeons: 55, ..all }, false), [(1, 40), (3, 0), (2, 15)]);
        assert_eq!(ranked(&LifeSettings { most_vertices: 800, ..all }, false), [(3, 0)], "what costs more is left out");
        assert_eq!(ranked(&all, true), [(1, 5), (3, 0), (2, 5)], "most pigeons sleep at night");
        assert_eq!(ranked(&LifeSettings { kinds: LifeKinds { pigeons: false, ..LifeKinds::ALL }, ..all }, false), [(3, 0)]);
        assert_eq!(ranked(&LifeSettings { reach: 0.1, ..all }, false), [(1, 40)]);
        assert!(ranked(&LifeSettings { kinds: LifeKinds::NONE, ..all }, false).is_empty());
    }

    #[test]
    fn estimates_are_not_below_what_is_made() {
        let settings = LifeSettings::default();
        let (white, red) = (veduta_city::Rgb(255, 255, 255), veduta_city::Rgb(200, 0, 0));
        let made = craft::flag(3.0, 0.0, (1.0, 1.5), &[white, red], Some(red), 0.0).vertices();
        let flag = LifeKind::Flag { pole_m: 3.0, tilt_deg: 0.0, size_m: (1.0, 1.5), fields: vec![white, red], wedge: Some(red) };
        assert!(made <= estimate(&flag, 0, &settings), "{made}");
        let (bracket, board) = craft::sign(veduta_city::SignShape::Round, (0.6, 0.6), 0.9, (white, red));
        let sign =
            LifeKind::Sign { shape: veduta_city::SignShape::Round, size_m: (0.6, 0.6), arm_m: 0.9, colour: white, trim: red };
        assert!(
            bracket.vertices() + board.vertices() <= estimate(&sign, 0, &settings),
            "{}",
            bracket.vertices() + board.vertices()
        );
        let clock = LifeKind::Clock { radius_m: 1.5, dial: veduta_city::Dial::Astrolabe, face: white, gold: red };
        let cut = dial::cut(veduta_city::Dial::Astrolabe, 1.5, (white, red), 50.0);
        let made = cut.dial.vertices() + cut.hands.iter().map(Sculpt::vertices).sum::<usize>();
        assert!(made <= estimate(&clock, 0, &settings), "{made}");
    }
}
