use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use bevy::light::NotShadowCaster;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use veduta_city::{GridPos, Level, Overview};
use veduta_ecs::{
    Around, CellMesh, CellMeshKind, City, DistrictMemory, Eye, MaterialsProvided, Overviews, StandingCells, Viewer, WorldOrigin,
};
use veduta_growth::mesh;

use crate::build::{BuildSettings, Building, Plain};
use crate::convert::{bytes_of, mesh_from};

/// What the cells of the overview's parts look like from afar: a mesh for each, shown as long as the cell itself does not stand.
#[derive(Resource, Default)]
pub(crate) struct Districts {
    parts: BTreeMap<u32, Part>,
    /// Parts that are to go, a slice a frame.
    going: Vec<Part>,
    /// Where parts were last looked for.
    about: Vec<Around>,
}

struct Part {
    source: Arc<Overview>,
    work: Work,
    /// Those that are spawned; their cells ascend.
    spawned: Vec<Spawned>,
    /// Bytes of their meshes.
    bytes: u64,
}

struct Spawned {
    cell: u32,
    entity: Entity,
    is_hidden: bool,
}

enum Work {
    Task(Task<VecDeque<Made>>),
    Made(VecDeque<Made>),
}

struct Made {
    cell: u32,
    origin: GridPos,
    mesh: Mesh,
    vertices: usize,
    bytes: u64,
}

/// Makes a mesh of each cell that an overview tells of. Pure.
fn make(overview: &Overview) -> VecDeque<Made> {
    let made = mesh::districts(overview).filter_map(|(cell, shell)| {
        let data = mesh::afar(&shell);
        let vertices = data.positions.len();
        (vertices > 0).then(|| {
            let mesh = mesh_from(data);
            Made { cell, origin: shell.origin, bytes: bytes_of(&mesh), mesh, vertices }
        })
    });
    made.collect()
}

/// Begins with the parts that have come, and lets go of those that are gone, or far away and out of sight.
pub(crate) fn start(
    city: Option<Res<City>>,
    settings: Res<BuildSettings>,
    building: Res<Building>,
    viewers: Query<&Eye, With<Viewer>>,
    mut districts: ResMut<Districts>,
) {
    let reach_m = settings.districts_m;
    let about: Vec<Around> = match reach_m > 0.0 {
        true => viewers.iter().map(|eye| Around::coarsely(eye.plan_pos, reach_m)).collect(),
        false => Vec::new(),
    };
    let is_city_new = city.as_ref().is_some_and(|city| city.is_changed());
    if about == districts.about && !is_city_new && (city.is_some() || districts.parts.is_empty()) {
        return;
    }
    let overviews = city.as_ref().map(|city| &city.overviews);
    let parts_near = |all: &Overviews| {
        let near = about.iter().flat_map(|&circle| all.within(circle).collect::<Vec<_>>());
        let far = all.vistas().iter().copied().filter(|_| reach_m > 0.0);
        near.chain(far).collect::<Vec<u32>>()
    };
    let wanted: BTreeMap<u32, &Arc<Overview>> =
        overviews.into_iter().flat_map(|all| parts_near(all).into_iter().filter_map(|part| Some((part, all.get(part)?)))).collect();
    let stays = |part: &u32, of: &mut Part| wanted.get(part).is_some_and(|overview| Arc::ptr_eq(overview, &of.source));
    let going: Vec<Part> = districts.parts.extract_if(.., |part, of| !stays(part, of)).map(|(_, part)| part).collect();
    districts.going.extend(going);
    for (part, overview) in wanted {
        districts.parts.entry(part).or_insert_with(|| {
            let source = Arc::clone(overview);
            let work = match *building {
                Building::Inline => Work::Made(make(&source)),
                Building::Pool => {
                    let overview = Arc::clone(&source);
                    Work::Task(AsyncComputeTaskPool::get().spawn(async move { make(&overview) }))
                }
            };
            Part { source, work, spawned: Vec::new(), bytes: 0 }
        });
    }
    districts.about = about;
}

/// So many meshes go in a frame at most: whoever leaps leaves thousands behind.
const GOING_A_FRAME: usize = 128;

/// Despawns a slice of what is to go.
pub(crate) fn let_go(mut commands: Commands, mut districts: ResMut<Districts>) {
    let mut left = GOING_A_FRAME;
    while left > 0
        && let Some(part) = districts.going.last_mut()
    {
        let keeps = part.spawned.len().saturating_sub(left);
        left -= part.spawned.len() - keeps;
        part.spawned.drain(keeps..).for_each(|gone| commands.entity(gone.entity).despawn());
        if keeps == 0 {
            districts.going.pop();
        }
    }
}

/// Spawns what is made, within a budget of its own.
pub(crate) fn finish(
    mut commands: Commands,
    settings: Res<BuildSettings>,
    viewers: Query<&Eye, With<Viewer>>,
    origin: Res<WorldOrigin>,
    standing: Res<StandingCells>,
    provided: Option<Res<MaterialsProvided>>,
    mut districts: ResMut<Districts>,
    mut assets: ResMut<Assets<Mesh>>,
    mut plain: Plain,
    mut memory: ResMut<DistrictMemory>,
) {
    let most = (settings.in_frame(&viewers).vertices_a_frame / SHARE).max(1);
    let mut vertices = 0;
    for part in districts.parts.values_mut() {
        if let Work::Task(task) = &mut part.work {
            let Some(made) = check_ready(task) else { continue };
            part.work = Work::Made(made);
        }
        let Work::Made(made) = &mut part.work else { continue };
        while vertices < most
            && let Some(Made { cell, origin: at, mesh, vertices: count, bytes }) = made.pop_front()
        {
            vertices += count;
            part.bytes += bytes;
            let is_hidden = standing.levels(cell).has(Level::One);
            let mut entity = commands.spawn((
                CellMesh { cell, kind: CellMeshKind::District },
                Mesh3d(assets.add(mesh)),
                Transform::from_translation(origin.world_from_grid(at)),
                visibility(is_hidden),
                NotShadowCaster,
            ));
            if provided.is_none()
                && let Some(handle) = plain.handle()
            {
                entity.insert(MeshMaterial3d(handle));
            }
            part.spawned.push(Spawned { cell, entity: entity.id(), is_hidden });
        }
    }
    let made = || districts.parts.values().chain(&districts.going).filter(|part| part.bytes > 0);
    memory.set_if_neq(DistrictMemory { bytes: made().map(|part| part.bytes).sum(), parts: made().count() });
}

/// The budget of the cells themselves is so many times as much.
const SHARE: usize = 4;

/// Shows districts where their cells do not stand.
pub(crate) fn show(
    standing: Res<StandingCells>,
    mut districts: ResMut<Districts>,
    mut meshes: Query<&mut Visibility, With<CellMesh>>,
) {
    if !standing.is_changed() {
        return;
    }
    let Districts { parts, going, .. } = &mut *districts;
    for part in parts.values_mut().chain(going) {
        let (Some(first), Some(last)) = (part.spawned.first(), part.spawned.last()) else { continue };
        let mut stands = standing.within(first.cell, last.cell).filter(|(_, levels)| levels.has(Level::One)).peekable();
        for district in &mut part.spawned {
            while stands.next_if(|&(cell, _)| cell < district.cell).is_some() {}
            let is_hidden = stands.peek().is_some_and(|&(cell, _)| cell == district.cell);
            if core::mem::replace(&mut district.is_hidden, is_hidden) != is_hidden
                && let Ok(mut shown) = meshes.get_mut(district.entity)
            {
                *shown = visibility(is_hidden);
            }
        }
    }
}

const fn visibility(is_hidden: bool) -> Visibility {
    if is_hidden { Visibility::Hidden } else { Visibility::Visible }
}
