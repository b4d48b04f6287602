use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use bevy::ecs::system::SystemParam;
use bevy::platform::time::Instant;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, futures::check_ready};
use veduta_city::{CellShell, FacadeSheet, Level, PictureFile, Season};
use veduta_ecs::{
    CellContent, CellMemory, CellMesh, CellMeshKind, CellPictures, CellReady, CellStands, CityOpened, Eye, MaterialsProvided,
    StandingCells, Viewer,
};
use veduta_growth::mesh::{self, MeshData, MonumentDetail};

use crate::convert::{bytes_of, mesh_from};
use crate::pictures;
use crate::season::CitySeason;

/// Where meshes are made.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Building {
    /// On the task pool.
    #[default]
    Pool,
    /// At once, in the system that starts them: for tests and films, which must repeat exactly.
    Inline,
}

/// What a frame may spend. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct BuildSettings {
    /// Most vertices handed to the engine a frame, and a quarter as many of districts; a single mesh may exceed it alone.
    pub vertices_a_frame: usize,
    /// Most meshes in the making at a time.
    pub in_the_making: usize,
    /// Cells that are told in an overview that reaches so near to a viewer are shown from afar as long as they do not stand, metres; none
    /// if 0.
    pub districts_m: f64,
    /// Walls of cells that are nearer to a viewer get their relief (level 4), metres; none if 0. Not less than where the material shows it.
    pub relief_m: f64,
}

impl Default for BuildSettings {
    fn default() -> Self {
        Self { vertices_a_frame: 60_000, in_the_making: 16, districts_m: 700.0, relief_m: 30.0 }
    }
}

impl BuildSettings {
    /// What may be spent in this frame: while every viewer is in the dark nobody sees a hitch, and all that has come is built.
    pub(crate) fn in_frame(&self, viewers: &Query<&Eye, With<Viewer>>) -> Self {
        if viewers.is_empty() || viewers.iter().any(|eye| eye.fade < 1.0) {
            return *self;
        }
        Self { vertices_a_frame: usize::MAX, in_the_making: self.in_the_making.max(256), ..*self }
    }
}

/// Meshes of a cell's level, made.
struct Made {
    order: Order,
    meshes: Vec<(CellMeshKind, Mesh, usize)>,
    /// Bytes of all of it.
    bytes: u64,
    /// Seconds that it took.
    seconds: f64,
    /// Pictures of its painted walls, as fine as the level.
    pictures: Option<Image>,
    season: Season,
    error: Option<String>,
}

/// What was made of cells' content since the city was opened: for whoever weighs that against meshes that would come ready.
#[derive(Resource, Debug, Clone, Copy, PartialEq, Default)]
pub struct BuildStats {
    /// Bytes of meshes and pictures.
    pub bytes: u64,
    /// Seconds that their making took, on whatever thread.
    pub seconds: f64,
    /// Levels of cells that wait to be made, or are in the making.
    pub in_the_making: usize,
}

/// Bytes of a picture that cost as much as a vertex to hand over.
const BYTES_A_VERTEX: usize = 48;

/// What is to be made.
#[derive(Clone)]
struct Order {
    ready: CellReady,
    shell: Arc<CellShell>,
    sheet: Option<Arc<FacadeSheet>>,
    pictures: Option<Arc<[PictureFile]>>,
    /// Whether the level stands already and the season has turned.
    is_turned: bool,
}

impl Order {
    fn new(ready: CellReady, content: &CellContent) -> Self {
        let CellContent { shell, sheet, pictures } = content.clone();
        Self { ready, shell, sheet, pictures, is_turned: false }
    }
}

/// The season that a cell's trees were made for.
#[derive(Component, Debug, Clone, Copy)]
pub(crate) struct MadeFor(Season);

/// Orders anew the trees that were made for another season.
pub(crate) fn turn_season(
    season: Res<CitySeason>,
    trees: Query<(&CellMesh, &MadeFor, &ChildOf)>,
    contents: Query<&CellContent>,
    mut queue: ResMut<Queue>,
) {
    let old = trees.iter().filter(|(_, made, _)| made.0 != season.0);
    let mut old: Vec<(u32, Level, Entity)> =
        old.filter_map(|(mesh, _, cell)| Some((mesh.cell, mesh.kind.level()?, cell.parent()))).collect();
    old.sort_unstable();
    for (cell, level, entity) in old {
        let ready = CellReady { entity, cell, level };
        if let (false, Ok(content)) = (queue.turning.contains(&(entity, level)), contents.get(entity)) {
            queue.turning.push((entity, level));
            queue.waiting.push_back(Order { is_turned: true, ..Order::new(ready, content) });
        }
    }
}

/// Work in the making, in the order of arrival: results are taken in that order, so that every run spawns alike.
#[derive(Resource, Default)]
pub(crate) struct Queue {
    waiting: VecDeque<Order>,
    making: VecDeque<Work>,
    /// Whose trees are being made anew for another season.
    turning: Vec<(Entity, Level)>,
}

impl Queue {
    fn under_way(&self) -> usize {
        self.waiting.len() + self.making.len()
    }

    /// Orders a level of a cell that stands, unless it is under way.
    pub(crate) fn order_once(&mut self, ready: CellReady, content: &CellContent) {
        let is_same = |order: &Order| order.ready == ready && !order.is_turned;
        let is_making = |work: &Work| match work {
            Work::Task(order, _) => is_same(order),
            Work::Done(made) => is_same(&made.order),
        };
        if !self.waiting.iter().any(is_same) && !self.making.iter().any(is_making) {
            self.waiting.push_back(Order::new(ready, content));
        }
    }
}

enum Work {
    Task(Order, Task<Made>),
    Done(Box<Made>),
}

/// Starts making what has arrived.
pub(crate) fn start(
    (mut ready, mut opened): (MessageReader<CellReady>, MessageReader<CityOpened>),
    contents: Query<&CellContent>,
    building: Res<Building>,
    settings: Res<BuildSettings>,
    season: Res<CitySeason>,
    provided: Option<Res<MaterialsProvided>>,
    viewers: Query<&Eye, With<Viewer>>,
    mut queue: ResMut<Queue>,
    mut stats: ResMut<BuildStats>,
) {
    if opened.read().count() > 0 {
        *stats = BuildStats::default();
    }
    let (settings, season) = (settings.in_frame(&viewers), season.0);
    let provided = provided.as_deref().copied();
    for &ready in ready.read() {
        let Ok(content) = contents.get(ready.entity) else { continue };
        queue.waiting.push_back(Order::new(ready, content));
    }
    while queue.making.len() < settings.in_the_making.max(1) {
        let Some(order) = queue.waiting.pop_front() else { break };
        if !contents.contains(order.ready.entity) {
            queue.turning.retain(|&(entity, _)| entity != order.ready.entity);
            continue;
        }
        let work = match *building {
            Building::Inline => Work::Done(Box::new(make(order, season, provided))),
            Building::Pool => {
                let own = order.clone();
                Work::Task(order, AsyncComputeTaskPool::get().spawn(async move { make(own, season, provided) }))
            }
        };
        queue.making.push_back(work);
    }
    stats.in_the_making = queue.under_way();
}

/// Makes the meshes of one level of one cell; of a level that stands, for another season, its trees. Where there are no cards trees are
/// bodies at level 1. Pure, but for the time it took.
fn make(order: Order, season: Season, provided: Option<MaterialsProvided>) -> Made {
    let began = Instant::now();
    // Without the tiles a card is but a board.
    let has_cards = provided.is_some();
    let in_blocks = provided.is_some_and(|provided| provided.reads_blocks);
    let (shell, level) = (&order.shell, order.ready.level);
    let mut pictures = None;
    let mut parts: Vec<(CellMeshKind, MeshData)> = Vec::new();
    let mut error = None;
    if !order.is_turned {
        match level {
            Level::One => {
                let mut base = mesh::ground(shell);
                base.append(&mesh::markings(shell));
                base.append(&mesh::spans(shell));
                base.append(&mesh::roof_bodies(shell));
                parts.push((CellMeshKind::Base, base));
                // Not with level 2: a cell without façades has none.
                let mut fittings = mesh::roof_details(shell);
                fittings.append(&mesh::objects(shell));
                parts.push((CellMeshKind::Fittings, fittings));
                parts.push((CellMeshKind::Walls(level), mesh::level1(shell)));
            }
            Level::Two | Level::Four => match order.sheet.as_ref().map(|sheet| walls(shell, sheet, level)) {
                Some(Ok(walls)) => parts.extend(walls),
                Some(Err(e)) => error = Some(e.to_string()),
                None => error = Some("its façade sheet is not here".to_owned()),
            },
            // Level 3 of generated walls is composed by the material on level 2's mesh; that of painted ones lies on it.
            Level::Three => {}
        }
        match (level, &order.sheet, &order.pictures) {
            (Level::Two, Some(sheet), _) if has_cards => pictures = pictures::coarse(sheet, in_blocks),
            (Level::Three, Some(sheet), Some(files)) if has_cards => {
                let (made, errors) = pictures::fine(sheet, files, in_blocks);
                pictures = made;
                error = (!errors.is_empty()).then(|| errors.join("; "));
            }
            _ => {}
        }
        // Apart from the walls, so that what has most of a city's vertices is drawn only where it is seen.
        if level != Level::Three {
            parts.push((CellMeshKind::Walls(level), mesh::monuments(shell, MonumentDetail::of(level))));
        }
    }
    match level {
        Level::One if has_cards => parts.push((CellMeshKind::Trees(level), mesh::tree_cards(shell, season))),
        Level::One => parts.push((CellMeshKind::Trees(level), mesh::trees(shell, season))),
        Level::Two if has_cards => parts.push((CellMeshKind::Trees(level), mesh::trees(shell, season))),
        _ => {}
    }
    let meshes = parts.into_iter().filter(|(_, data)| !data.is_empty()).map(|(kind, data)| {
        let vertices = data.positions.len();
        (kind, mesh_from(data), vertices)
    });
    let meshes: Vec<_> = meshes.collect();
    let texels = pictures.as_ref().and_then(|image| image.data.as_ref()).map_or(0, |texels| texels.len() as u64);
    let bytes = texels + meshes.iter().map(|(_, mesh, _)| bytes_of(mesh)).sum::<u64>();
    Made { meshes, bytes, seconds: began.elapsed().as_secs_f64(), order, pictures, season, error }
}

/// Walls of level 2 or 4: those of tiles, and those that somebody painted.
fn walls(shell: &CellShell, sheet: &FacadeSheet, level: Level) -> Result<[(CellMeshKind, MeshData); 2], mesh::MeshError> {
    let in_relief = level == Level::Four;
    let tiled = if in_relief { mesh::level4(shell, sheet)? } else { mesh::level2(shell, sheet)? };
    Ok([(CellMeshKind::Walls(level), tiled), (CellMeshKind::Painted(level), mesh::painted(shell, sheet, in_relief)?)])
}

/// The material of meshes where no plugin provides any.
#[derive(SystemParam)]
pub(crate) struct Plain<'w, 's> {
    materials: Option<ResMut<'w, Assets<StandardMaterial>>>,
    handle: Local<'s, Option<Handle<StandardMaterial>>>,
}

impl Plain<'_, '_> {
    /// `None` where nothing is drawn.
    pub(crate) fn handle(&mut self) -> Option<Handle<StandardMaterial>> {
        let materials = self.materials.as_mut()?;
        Some(self.handle.get_or_insert_with(|| materials.add(StandardMaterial::default())).clone())
    }
}

/// Spawns what is made, within the frame's budget.
pub(crate) fn finish(
    mut commands: Commands,
    settings: Res<BuildSettings>,
    viewers: Query<&Eye, With<Viewer>>,
    provided: Option<Res<MaterialsProvided>>,
    mut queue: ResMut<Queue>,
    mut assets: ResMut<Assets<Mesh>>,
    mut images: Option<ResMut<Assets<Image>>>,
    mut plain: Plain,
    mut cells: Query<(&CellContent, &mut CellMemory)>,
    mut pictures: Query<&mut CellPictures>,
    trees: Query<(Entity, &CellMesh, &ChildOf), With<MadeFor>>,
    mut standing: ResMut<StandingCells>,
    mut stands: MessageWriter<CellStands>,
    mut stats: ResMut<BuildStats>,
) {
    let settings = settings.in_frame(&viewers);
    let mut vertices = 0;
    // Of cells whose level 3 may be next: what commands insert is not here yet.
    let mut coarse: Vec<(Entity, Handle<Image>)> = Vec::new();
    while vertices < settings.vertices_a_frame {
        let made = match queue.making.pop_front() {
            None => break,
            Some(Work::Done(made)) => *made,
            Some(Work::Task(order, mut task)) => match check_ready(&mut task) {
                Some(made) => made,
                None => {
                    queue.making.push_front(Work::Task(order, task));
                    break;
                }
            },
        };
        let CellReady { entity, cell, level } = made.order.ready;
        (stats.bytes, stats.seconds) = (stats.bytes + made.bytes, stats.seconds + made.seconds);
        if made.order.is_turned {
            queue.turning.retain(|&turned| turned != (entity, level));
        }
        let Ok((content, mut memory)) = cells.get_mut(entity) else { continue }; // released meanwhile
        let same_sheet = || match (&content.sheet, &made.order.sheet) {
            (Some(now), Some(then)) => Arc::ptr_eq(now, then),
            _ => false,
        };
        if level != Level::One && !same_sheet() {
            continue; // the level was dropped meanwhile; it may be on its way again
        }
        let same_pictures = || match (&content.pictures, &made.order.pictures) {
            (Some(now), Some(then)) => Arc::ptr_eq(now, then),
            _ => false,
        };
        if level == Level::Three && !same_pictures() {
            continue;
        }
        if let Some(error) = made.error {
            error!("cell {cell}, {level}: {error}; the level before it stays");
            // Of several pictures those that can be shown are.
            if level != Level::Three || made.pictures.is_none() {
                continue;
            }
        }
        // Where nothing is drawn there are no images.
        if let (Some(image), Some(images)) = (made.pictures, &mut images) {
            vertices += image.data.as_ref().map_or(0, Vec::len) / BYTES_A_VERTEX;
            let image = images.add(image);
            if level == Level::Three {
                match (pictures.get_mut(entity), coarse.iter().find(|(of, _)| *of == entity)) {
                    (Ok(mut known), _) => known.fine = Some(image),
                    (Err(_), Some((_, coarse))) => {
                        commands.entity(entity).insert(CellPictures { coarse: coarse.clone(), fine: Some(image) });
                    }
                    (Err(_), None) => {}
                }
            } else {
                coarse.push((entity, image.clone()));
                commands.entity(entity).insert(CellPictures { coarse: image, fine: None });
            }
        }
        if made.order.is_turned {
            let old = trees.iter().filter(|(_, mesh, cell)| cell.parent() == entity && mesh.kind == CellMeshKind::Trees(level));
            old.for_each(|(old, ..)| commands.entity(old).despawn());
        }
        for (kind, mesh, count) in made.meshes {
            vertices += count;
            let mut child = commands.spawn((CellMesh { cell, kind }, Mesh3d(assets.add(mesh)), ChildOf(entity)));
            if matches!(kind, CellMeshKind::Trees(_)) {
                child.insert(MadeFor(made.season));
            }
            if provided.is_none()
                && let Some(handle) = plain.handle()
            {
                child.insert(MeshMaterial3d(handle));
            }
        }
        // Trees of another season are as many.
        if made.order.is_turned {
            continue;
        }
        memory.0[level.index()] = made.bytes;
        standing.add(cell, level, &made.order.shell);
        stands.write(CellStands { entity, cell, level });
    }
    stats.in_the_making = queue.under_way();
}

/// Where no plugin switches levels, of a cell's walls the finest that are here are shown.
pub(crate) fn show_finest(
    arrived: Query<(), Added<CellMesh>>,
    mut gone: RemovedComponents<CellMesh>,
    mut meshes: Query<(&CellMesh, &mut Visibility)>,
) {
    if arrived.is_empty() && gone.read().count() == 0 {
        return;
    }
    let level = |mesh: &CellMesh| match mesh.kind {
        CellMeshKind::Walls(level) | CellMeshKind::Painted(level) => Some(level),
        _ => None,
    };
    let mut finest: BTreeMap<u32, Level> = BTreeMap::new();
    for (mesh, _) in &meshes {
        if let Some(level) = level(mesh) {
            finest.entry(mesh.cell).and_modify(|finest| *finest = level.max(*finest)).or_insert(level);
        }
    }
    for (mesh, mut shown) in &mut meshes {
        if let Some(level) = level(mesh) {
            let is_finest = finest.get(&mesh.cell) == Some(&level);
            shown.set_if_neq(if is_finest { Visibility::Inherited } else { Visibility::Hidden });
        }
    }
}
