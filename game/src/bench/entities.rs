//! `veduta bench entities`: a cell's level as one mesh, beside the same houses with an entity for each of their parts: walls, openings,
//! roofs, chimneys, dormers, eaves, mouldings, objects. Such a city has no levels: what ours shows of a house from near is there from afar
//! too.

use std::collections::{BTreeMap, BTreeSet};
use std::f32::consts::FRAC_PI_2;
use std::path::Path;

use anstream::eprintln;
use bevy::camera::RenderTarget;
use bevy::ecs::schedule::SingleThreadedExecutor;
use bevy::math::{DVec2, DVec3};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::tasks::{ComputeTaskPool, TaskPoolBuilder};
use cpu_time::ThreadTime;
use veduta::city::{FacadeSheet, GridPos, Opening, Rgb, VolumeShell, metres};
use veduta::ecs::{CellContent, CellMesh};
use veduta::prelude::*;
use veduta_bake::{BakeSettings, bake};
use veduta_growth::mesh::{MeshData, mouldings, roof_details};

use super::{line, median, workplace};
use crate::Failure;
use crate::camera::camera;
use crate::profile::Profile;
use crate::studio::{Size, Studio, darkroom, film, finish};

/// So small that drawing hardly counts; what the processor does before it is the same at every size.
const SIZE: Size = Size { width: 96, height: 54 };
/// Drawn, but not measured: shaders are made, meshes sent.
const WARM_UP: usize = 12;
/// Frames measured at a time, and how often each city has its turn.
const FRAMES: usize = 30;
const TURNS: usize = 3;
/// The camera turns so far from frame to frame, degrees.
const STEP_DEG: f64 = 4.0;

/// Measures and prints.
///
/// # Errors
/// If the city cannot be baked or there is nothing to draw with.
pub(super) fn entities(scene: &Path) -> Result<(), Failure> {
    // All that the engine does is done on this thread, whose time is measured, and none on the one that a pool must have. Drawing in
    // software has threads of its own.
    let idle = || loop {
        std::thread::park();
    };
    ComputeTaskPool::get_or_init(|| TaskPoolBuilder::new().num_threads(1).on_thread_spawn(idle).build());
    let dir = workplace("entities")?;
    let city = dir.join("sample.city");
    bake(scene, &city, &BakeSettings::default(), &mut |_| ())?;
    for (name, eye) in [("street", Eye::default()), ("aerial", Eye { eye_m: 120.0, pitch_deg: -20.0, ..Eye::default() })] {
        compare(name, &city, eye)?;
    }
    std::fs::remove_dir_all(&dir)?;
    Ok(())
}

/// Both cities, from one stand.
fn compare(name: &str, city: &Path, eye: Eye) -> Result<(), Failure> {
    let mut studio = Studio::open_with(&city.display().to_string(), SIZE, Profile::Low, on_one_thread)?;
    let start = studio.world().get_resource::<City>().map_or(DVec2::ZERO, |city| Eye::at(city.start).plan_pos);
    let eye = Eye { plan_pos: start, ..eye };
    settle(&mut studio, eye, city)?;
    let ground_m = studio.eye().ground_m;
    let shown: BTreeSet<GridPos> = standing(studio.world()).iter().map(|content| content.shell.origin).collect();
    let parts = whole(city, eye, &shown)?;
    let eye_m = ground_m + eye.eye_m;
    let mut naive = Naive::new(&parts, eye_m, eye.pitch_deg);
    let mut empty = Naive::new(&Parts { all: Vec::new(), houses: 0 }, eye_m, eye.pitch_deg);
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    for turn in 0..=TURNS {
        let frames = if turn == 0 { WARM_UP } else { FRAMES };
        for frame in 0..frames {
            let heading_deg = frame as f64 * STEP_DEG;
            studio.set_eye(Eye { heading_deg, ..studio.eye() });
            let ours = timed(|| studio.draw());
            naive.turn(heading_deg, eye.pitch_deg);
            empty.turn(heading_deg, eye.pitch_deg);
            let took = [ours, timed(|| naive.app.update()), timed(|| empty.app.update())];
            if turn > 0 {
                times.iter_mut().zip(took).for_each(|(times, took)| times.push(took));
            }
        }
    }
    let world = studio.world();
    let cells = standing(world).len();
    let meshes = world.query_filtered::<(), With<CellMesh>>().iter(world).count();
    eprintln!("{name}: {} houses in {cells} cells, {} parts", parts.houses, parts.all.len());
    let (entities, peers) = ((meshes + cells) as f64, parts.all.len() as f64);
    line(&format!("{name}_houses"), parts.houses as f64, "1");
    line(&format!("{name}_entities"), entities, "1");
    line(&format!("{name}_entities_one_a_part"), peers, "1");
    line(&format!("{name}_entities_ratio"), entities / peers, "1");
    let [ours, peer, engine] = times.each_mut().map(|times| median(times));
    line(&format!("{name}_frame_cpu_us"), ours, "us");
    line(&format!("{name}_frame_cpu_one_a_part_us"), peer, "us");
    line(&format!("{name}_frame_cpu_empty_us"), engine, "us");
    line(&format!("{name}_frame_cpu_ratio"), ours / peer, "1");
    // What the engine takes without any city, taken from both.
    line(&format!("{name}_city_cpu_ratio"), (ours - engine) / (peer - engine), "1");
    Ok(())
}

/// Waits until all stands that is to be seen from an eye.
fn settle(studio: &mut Studio, eye: Eye, city: &Path) -> Result<(), Failure> {
    studio.set_eye(eye);
    let missing = studio.settle();
    if missing.is_empty() { Ok(()) } else { Err(format!("{}: not all of the city came: {missing}", city.display()).into()) }
}

fn standing(world: &mut World) -> Vec<&CellContent> {
    world.query::<&CellContent>().iter(world).collect()
}

/// The parts of all that stands in these cells, with openings and mouldings however far off it is.
fn whole(city: &Path, eye: Eye, cells: &BTreeSet<GridPos>) -> Result<Parts, Failure> {
    let mut studio = Studio::open_with(&city.display().to_string(), SIZE, Profile::Low, |app| {
        on_one_thread(app);
        app.world_mut().resource_mut::<StreamingSettings>().level_2_m = f64::INFINITY;
    })?;
    settle(&mut studio, eye, city)?;
    let mut parts = Parts { all: Vec::new(), houses: 0 };
    for content in standing(studio.world()).into_iter().filter(|content| cells.contains(&content.shell.origin)) {
        parts.add_cell(content, eye.plan_pos)?;
    }
    Ok(parts)
}

/// Has systems run one after the other, where they are called.
fn on_one_thread(app: &mut App) {
    let set = |world: &mut World| {
        for (_, schedule) in world.resource_mut::<Schedules>().iter_mut() {
            schedule.set_executor(SingleThreadedExecutor::new());
        }
    };
    set(app.world_mut());
    if let Some(render) = app.get_sub_app_mut(RenderApp) {
        set(render.world_mut());
    }
}

/// Microseconds of this thread's time.
fn timed(work: impl FnOnce()) -> f64 {
    let began = ThreadTime::now();
    work();
    began.elapsed().as_secs_f64() * 1e6
}

/// Plan metres from the start and a height in the engine's axes.
fn engine(plan: DVec2, height_m: f64) -> Vec3 {
    DVec3::new(plan.x, height_m, -plan.y).as_vec3()
}

/// What a part is drawn with: a shape that all of its kind share, and a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Look {
    Wall(Rgb),
    Roof(Rgb),
    Opening(Opening),
    Ground,
    Object,
    Piece(Rgb),
}

/// The parts of all houses that stand, each where it is.
struct Parts {
    all: Vec<(Look, Transform)>,
    houses: usize,
}

impl Parts {
    fn add_cell(&mut self, content: &CellContent, start: DVec2) -> Result<(), Failure> {
        let shell = &content.shell;
        let at = |pos: GridPos| (shell.origin + pos).to_metres() - start;
        let told = content.sheet.as_deref();
        let mut wall = 0;
        for house in &shell.houses {
            self.houses += usize::from(house.volumes.iter().any(|volume| volume.has_roof));
            for volume in &house.volumes {
                let first = wall;
                wall += volume.walls.len();
                if !house.is_monument {
                    self.add(volume, told.map(|sheet| (sheet, first)), at);
                }
            }
        }
        let origin = engine(at(GridPos::default()), 0.0);
        self.add_pieces(&roof_details(shell), origin);
        if let Some(sheet) = told {
            self.add_pieces(&mouldings(shell, sheet)?, origin);
        }
        for object in &shell.objects {
            let [x, y, z] = engine(at(object.pos), metres(object.z)).to_array();
            let height = metres(object.height) as f32;
            let place = Transform::from_xyz(x, y + height / 2.0, z).with_scale(Vec3::new(height / 4.0, height, height / 4.0));
            self.all.push((Look::Object, place));
        }
        for patch in &shell.ground {
            let Some((low, high)) = patch.outline.bounds() else { continue };
            let (low, high) = (at(low), at(high));
            let [x, _, z] = engine((low + high) / 2.0, 0.0).to_array();
            let size = (high - low).as_vec2();
            self.all.push((Look::Ground, Transform::from_xyz(x, 0.0, z).with_scale(Vec3::new(size.x, 1.0, size.y))));
        }
        Ok(())
    }

    /// A block for each piece of a mesh that hangs together.
    fn add_pieces(&mut self, mesh: &MeshData, origin: Vec3) {
        for ([low, high], colour) in pieces(mesh) {
            let place = Transform::from_translation(origin + (low + high) / 2.0).with_scale(high - low);
            self.all.push((Look::Piece(colour), place));
        }
    }

    /// A volume's walls, openings and roof.
    fn add(&mut self, volume: &VolumeShell, told: Option<(&FacadeSheet, usize)>, at: impl Fn(GridPos) -> DVec2) {
        let (bottom, eaves) = (metres(volume.bottom), metres(volume.eaves));
        let rings = core::iter::once(&volume.footprint.outer).chain(&volume.footprint.holes);
        let edges: Vec<(GridPos, GridPos)> =
            rings.flat_map(|ring| ring.iter().enumerate().map(move |(i, &a)| (a, ring[(i + 1) % ring.len()]))).collect();
        for (i, &wall) in volume.walls.iter().enumerate() {
            let Some(&(a, b)) = edges.get(usize::from(wall)) else { continue };
            let (a, b) = (at(a), at(b));
            let (length, along) = ((b - a).length(), (b - a).normalize_or_zero());
            // A square's front looks along +z; the wall's along its outer side.
            let turn = Quat::from_rotation_y(along.y.atan2(along.x) as f32);
            let mut place = |look: Look, share: f64, (low, high): (f64, f64), width: f64, off_m: f64| {
                let plan = a + along * (length * share) + DVec2::new(along.y, -along.x) * off_m;
                let middle = engine(plan, (low + high) / 2.0);
                let scale = Vec3::new(width as f32, (high - low) as f32, 1.0);
                self.all.push((look, Transform { translation: middle, rotation: turn, scale }));
            };
            place(Look::Wall(volume.colour), 0.5, (bottom, eaves), length, 0.0);
            let Some(plan) = told.and_then(|(sheet, first)| sheet.walls.get(first + i)) else { continue };
            let total: f64 = plan.storeys.iter().map(|storey| metres(storey.height.max(0))).sum();
            let mut low = bottom;
            for (storey, of) in plan.storeys.iter().enumerate() {
                let high = low + metres(of.height.max(0)) / total.max(1e-6) * (eaves - bottom);
                for bay in 0..plan.bays {
                    let opening = plan.opening(storey, bay);
                    if opening != Opening::Blank {
                        let bays = f64::from(plan.bays);
                        place(Look::Opening(opening), (f64::from(bay) + 0.5) / bays, (low, high), length / bays, 0.02);
                    }
                }
                low = high;
            }
        }
        if let (true, Some((low, high))) = (volume.has_roof, volume.footprint.bounds()) {
            let (low, high, height) = (at(low), at(high), metres(volume.roof.height));
            let middle = engine((low + high) / 2.0, eaves + height / 2.0);
            let size = (high - low).as_vec2();
            let scale = Vec3::new(size.x, height as f32, size.y);
            self.all.push((Look::Roof(volume.roof.colour), Transform { translation: middle, scale, ..Transform::IDENTITY }));
        }
    }
}

/// Bounds and colour of each part of a mesh whose triangles share corners, to the centimetre.
fn pieces(mesh: &MeshData) -> Vec<([Vec3; 2], Rgb)> {
    let mut known = BTreeMap::new();
    let corners: Vec<usize> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = known.len();
            *known.entry(p.map(|x| (x * 100.0).round() as i32)).or_insert(next)
        })
        .collect();
    // Each corner points to one of the same piece; the last of them to itself.
    let mut next: Vec<usize> = (0..known.len()).collect();
    let last = |next: &[usize], from: usize| {
        core::iter::successors(Some(from), |&i| (next[i] != i).then(|| next[i])).last().unwrap_or(from)
    };
    for triangle in mesh.indices.chunks_exact(3) {
        let [a, b, c] = [0, 1, 2].map(|i| last(&next, corners[triangle[i] as usize]));
        let to = a.min(b).min(c);
        [a, b, c].into_iter().for_each(|end| next[end] = to);
    }
    let mut bounds: BTreeMap<usize, ([Vec3; 2], Rgb)> = BTreeMap::new();
    for ((&corner, &p), &[red, green, blue, _]) in corners.iter().zip(&mesh.positions).zip(&mesh.colours) {
        let p = Vec3::from(p);
        let ([low, high], _) = bounds.entry(last(&next, corner)).or_insert(([p, p], Rgb::from_linear([red, green, blue])));
        (*low, *high) = (low.min(p), high.max(p));
    }
    bounds.into_values().collect()
}

/// The city of one entity a part.
struct Naive {
    app: App,
    camera: Entity,
}

impl Naive {
    fn new(parts: &Parts, eye_m: f64, pitch_deg: f64) -> Self {
        let mut app = darkroom();
        Profile::Low.apply(&mut app);
        let target = film(&mut app, SIZE);
        let world = app.world_mut();
        let place = Transform::from_xyz(0.0, eye_m as f32, 0.0);
        let camera = world.spawn((camera(), RenderTarget::Image(target.into()), place)).id();
        world.spawn((DirectionalLight::default(), Transform::from_rotation(Quat::from_rotation_x(-FRAC_PI_2 / 2.0))));
        let mut meshes = world.resource_mut::<Assets<Mesh>>();
        let (square, block) = (meshes.add(Rectangle::new(1.0, 1.0)), meshes.add(Cuboid::new(1.0, 1.0, 1.0)));
        let ground = meshes.add(Plane3d::default().mesh().size(1.0, 1.0));
        let mut materials = world.resource_mut::<Assets<StandardMaterial>>();
        let mut known: BTreeMap<Look, Handle<StandardMaterial>> = BTreeMap::new();
        for (look, _) in &parts.all {
            known.entry(*look).or_insert_with(|| {
                let Rgb(r, g, b) = match *look {
                    Look::Wall(colour) | Look::Roof(colour) | Look::Piece(colour) => colour,
                    Look::Opening(_) => Rgb(40, 44, 52),
                    Look::Ground | Look::Object => Rgb(120, 120, 120),
                };
                materials.add(StandardMaterial::from(Color::srgb_u8(r, g, b)))
            });
        }
        let spawned = parts.all.iter().map(|&(look, place)| {
            let mesh = match look {
                Look::Wall(_) | Look::Opening(_) => &square,
                Look::Roof(_) | Look::Object | Look::Piece(_) => &block,
                Look::Ground => &ground,
            };
            (Mesh3d(mesh.clone()), MeshMaterial3d(known[&look].clone()), place)
        });
        let spawned: Vec<_> = spawned.collect();
        world.spawn_batch(spawned);
        finish(&mut app);
        on_one_thread(&mut app);
        let mut naive = Self { app, camera };
        naive.turn(0.0, pitch_deg);
        naive
    }

    fn turn(&mut self, heading_deg: f64, pitch_deg: f64) {
        if let Some(mut place) = self.app.world_mut().get_mut::<Transform>(self.camera) {
            let turn = Quat::from_rotation_y(-(heading_deg.to_radians() as f32));
            place.rotation = turn * Quat::from_rotation_x(pitch_deg.to_radians() as f32);
        }
    }
}
