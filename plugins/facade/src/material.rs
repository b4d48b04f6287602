use bevy::asset::embedded_asset;
use bevy::ecs::entity::EntityHashMap;
use bevy::light::NotShadowCaster;
use bevy::mesh::MeshVertexBufferLayoutRef;
use bevy::pbr::{ExtendedMaterial, MaterialExtension, MaterialExtensionKey, MaterialExtensionPipeline};
use bevy::prelude::*;
use bevy::render::render_resource::{AsBindGroup, RenderPipelineDescriptor, ShaderType, SpecializedMeshPipelineError};
use bevy::shader::{ShaderRef, load_shader_library};
use veduta_city::Level;
use veduta_ecs::{ATTRIBUTE_RELIEF, CellMesh, CellMeshKind, CellPictures, Daylight, MaterialsProvided, VedutaSystems, Weather};

use crate::NewCellMesh;
use crate::reach::LevelReach;
use crate::tiles::{self, Easel, Painting, TileQuality};

/// The material of everything in a cell.
pub type CityMaterial = ExtendedMaterial<StandardMaterial, FacadeExtension>;

/// At which distances façades and trees change level, metres from the eye to the façade's or tree's centre. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq)]
#[reflect(Resource)]
pub struct LevelDistances {
    /// Level n + 2 is all there nearer than `near[n]`.
    pub near: [f32; 3],
    /// Level n + 2 begins to show at `far[n]`; not below `near[n]`, and none farther off than the one before. 0 forbids the level.
    pub far: [f32; 3],
}

impl Default for LevelDistances {
    fn default() -> Self {
        Self { near: [110.0, 40.0, 12.0], far: [150.0, 55.0, 18.0] }
    }
}

impl LevelDistances {
    /// Level 2 within a distance, levels 3 and 4 within a third and a tenth of it.
    #[must_use]
    pub fn uniform(far_m: f32) -> Self {
        let far = [far_m, far_m / 3.0, far_m / 10.0];
        Self { near: far.map(|f| f * 0.75), far }
    }
}

/// What the extension's shader reads besides the textures.
#[derive(ShaderType, Debug, Clone, Copy, Reflect, Default)]
pub struct FacadeUniform {
    /// `x, y, z`: near ends of the bands 1|2, 2|3, 3|4; `w`: this material's level, 0 for what shows at every distance.
    near_level: Vec4,
    /// `x, y, z`: far ends of the bands; `w`: what is drawn, see [`Kind`].
    far_kind: Vec4,
    /// `x, y, z`: luminance of the sky overhead, candela per square metre; `w`: how wet ground is, 0 to 1.
    zenith_wet: Vec4,
    /// `x, y, z`: luminance of the sky at the horizon; `w`: 0 by day, 1 at night.
    horizon_night: Vec4,
    /// `x, y, z`: luminance of what surfaces see that look up, level and down.
    fill: [Vec4; 3],
}

impl FacadeUniform {
    fn lit(light: &Daylight, wet: f32) -> Self {
        Self {
            zenith_wet: light.zenith.extend(wet.clamp(0.0, 1.0)),
            horizon_night: light.horizon.extend(light.night),
            fill: light.fill.map(|colour| colour.extend(0.0)),
            ..Self::default()
        }
    }
}

/// How surfaces are lit. Live.
#[derive(Resource, Reflect, Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
#[reflect(Resource)]
pub enum Shading {
    /// By the engine's model: every light, shadows, gloss.
    #[default]
    Physical,
    /// By the first directional light and the sky alone, without shadows or gloss: a fraction of the work, for processors that draw.
    Plain,
}

/// Which shader a material takes: what is not wanted is left out of it, for a processor that draws does both sides of every choice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct FacadeKey {
    /// Whether level 3 is composed: it is not where it is forbidden.
    is_composed: bool,
    shading: Shading,
    /// Whether pixels are left to other levels.
    is_shared: bool,
    /// Whether cards are drawn, of which pixels are left out.
    is_cut: bool,
    /// Whether walls are drawn that somebody painted.
    is_painted: bool,
}

impl From<&FacadeExtension> for FacadeKey {
    fn from(extension: &FacadeExtension) -> Self {
        let FacadeExtension { uniform, shading, is_shared, is_painted, .. } = extension;
        let is_cut = uniform.far_kind.w == f32::from(Kind::Cards as u8);
        Self { is_composed: uniform.far_kind.y > 0.0, shading: *shading, is_shared: *is_shared, is_cut, is_painted: *is_painted }
    }
}

/// Extends the standard material by tiles, level switching, weathering and glass.
#[derive(Asset, AsBindGroup, Reflect, Debug, Clone)]
#[bind_group_data(FacadeKey)]
pub struct FacadeExtension {
    #[uniform(100)]
    uniform: FacadeUniform,
    /// Colours of tiles; of painted walls the finest pictures that are here.
    #[texture(101, dimension = "2d_array")]
    #[sampler(102)]
    colour: Handle<Image>,
    /// Normals of tiles; of painted walls, which have none, the pictures of level 2.
    #[texture(103, dimension = "2d_array")]
    normal_or_coarse: Handle<Image>,
    shading: Shading,
    is_shared: bool,
    is_painted: bool,
}

/// Where the vertex shaders expect the relief.
const RELIEF_LOCATION: u32 = 8;

/// What a material draws, as its shader knows it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Walls and all that is shown at every distance.
    Walls = 0,
    /// Cards of trees, which their tiles do not fill.
    Cards = 1,
    /// Bodies of trees, of which there is nothing finer.
    Bodies = 2,
    /// Fittings, of which there is nothing finer either, and which are there from the first.
    Fittings = 3,
}

impl MaterialExtension for FacadeExtension {
    fn vertex_shader() -> ShaderRef {
        "embedded://veduta_facade/vertex.wgsl".into()
    }

    fn prepass_vertex_shader() -> ShaderRef {
        "embedded://veduta_facade/prepass_vertex.wgsl".into()
    }

    fn specialize(
        _: &MaterialExtensionPipeline,
        descriptor: &mut RenderPipelineDescriptor,
        layout: &MeshVertexBufferLayoutRef,
        key: MaterialExtensionKey<Self>,
    ) -> Result<(), SpecializedMeshPipelineError> {
        if let Some(fragment) = &mut descriptor.fragment {
            let FacadeKey { is_composed, shading, is_shared, is_cut, is_painted } = key.bind_group_data;
            let defs = [
                (is_composed, "COMPOSED"),
                (shading == Shading::Plain, "PLAIN_LIGHT"),
                (is_shared, "SHARED"),
                (is_cut, "CARDS"),
                (is_painted, "PAINTED"),
            ];
            fragment.shader_defs.extend(defs.into_iter().filter(|def| def.0).map(|def| def.1.into()));
        }
        if layout.0.contains(ATTRIBUTE_RELIEF) {
            let relief = layout.0.get_layout(&[ATTRIBUTE_RELIEF.at_shader_location(RELIEF_LOCATION)])?;
            if let Some(buffer) = descriptor.vertex.buffers.first_mut() {
                buffer.attributes.extend(relief.attributes);
            }
            descriptor.vertex.shader_defs.push("VERTEX_RELIEF".into());
        }
        Ok(())
    }

    fn fragment_shader() -> ShaderRef {
        "embedded://veduta_facade/facade.wgsl".into()
    }

    fn prepass_fragment_shader() -> ShaderRef {
        "embedded://veduta_facade/prepass.wgsl".into()
    }
}

/// The materials in use: for what shows at every distance, for each level's walls, for trees' cards and bodies, and for fittings.
#[derive(Resource, Debug, Clone)]
pub struct CityMaterials {
    base: Handle<CityMaterial>,
    levels: [Handle<CityMaterial>; 4],
    cards: Handle<CityMaterial>,
    bodies: Handle<CityMaterial>,
    fittings: Handle<CityMaterial>,
    /// Of walls of levels 1 and 2, bodies and fittings, for where they have all pixels: opaque, so that what lies behind is dropped at
    /// once. Their shader is that of `base`, which is always there.
    alone: [Handle<CityMaterial>; 4],
    /// Of the painted walls of a cell, by its entity: of levels 2 and 4.
    painted: EntityHashMap<[Handle<CityMaterial>; 2]>,
}

impl CityMaterials {
    fn handles(&self) -> impl Iterator<Item = &Handle<CityMaterial>> {
        let painted = self.painted.values().flatten();
        [&self.base, &self.cards, &self.bodies, &self.fittings].into_iter().chain(&self.levels).chain(&self.alone).chain(painted)
    }

    /// What a mesh of a cell is drawn with, where its level shares pixels with others and where it has them all. `None` as long as its
    /// pictures are not here.
    pub(crate) fn of(&self, kind: CellMeshKind, cell: Entity, is_alone: bool) -> Option<&Handle<CityMaterial>> {
        Some(match (kind, is_alone) {
            (CellMeshKind::Painted(level), _) => &self.painted.get(&cell)?[usize::from(level > Level::Two)],
            (CellMeshKind::Base | CellMeshKind::District, _) => &self.base,
            (CellMeshKind::Walls(Level::One), true) => &self.alone[0],
            (CellMeshKind::Walls(Level::Two), true) => &self.alone[1],
            (CellMeshKind::Trees(Level::Two), true) => &self.alone[2],
            (CellMeshKind::Fittings, true) => &self.alone[3],
            (CellMeshKind::Fittings, false) => &self.fittings,
            (CellMeshKind::Walls(level), _) => &self.levels[level.index()],
            (CellMeshKind::Trees(Level::One), _) => &self.cards,
            (CellMeshKind::Trees(_), _) => &self.bodies,
        })
    }
}

pub(crate) fn build(app: &mut App) {
    load_shader_library!(app, "levels.wgsl");
    load_shader_library!(app, "surface.wgsl");
    load_shader_library!(app, "glass.wgsl");
    embedded_asset!(app, "vertex.wgsl");
    embedded_asset!(app, "prepass_vertex.wgsl");
    embedded_asset!(app, "facade.wgsl");
    embedded_asset!(app, "prepass.wgsl");
    app.add_plugins(MaterialPlugin::<CityMaterial>::default()).add_systems(Startup, tiles::set_up).add_systems(
        Update,
        (make.run_if(resource_exists::<Easel>), paint, set_distances, set_light, dress_meshes).chain().in_set(VedutaSystems::Show),
    );
}

/// Makes the materials when their tiles are painted.
fn make(
    mut commands: Commands,
    mut easel: ResMut<Easel>,
    painting: Res<Painting>,
    quality: Res<TileQuality>,
    (distances, reach): (Res<LevelDistances>, Res<LevelReach>),
    shading: Res<Shading>,
    light: Res<Daylight>,
    weather: Res<Weather>,
    mut images: ResMut<Assets<Image>>,
    mut materials: ResMut<Assets<CityMaterial>>,
    mut provided: ResMut<MaterialsProvided>,
) {
    let Some(painted) = tiles::take(&mut easel, *painting) else { return };
    commands.remove_resource::<Easel>();
    provided.are_made = true;
    let [colour, normal] = painted.images(quality.anisotropy).map(|image| images.add(image));
    let mut material = |level: f32, kind: Kind, is_shared: bool| {
        let LevelDistances { near: [a, b, c], far: [d, e, f] } = distances.within(*reach);
        materials.add(CityMaterial {
            base: StandardMaterial {
                base_color: Color::WHITE,
                reflectance: 0.25,
                // Walls drop pixels by level, and so must their prepass; what has no levels needs no fragment there.
                alpha_mode: if is_shared { AlphaMode::Mask(0.5) } else { AlphaMode::Opaque },
                ..StandardMaterial::default()
            },
            extension: FacadeExtension {
                uniform: FacadeUniform {
                    near_level: Vec4::new(a, b, c, level),
                    far_kind: Vec4::new(d, e, f, f32::from(kind as u8)),
                    ..FacadeUniform::lit(&light, weather.wet)
                },
                colour: colour.clone(),
                normal_or_coarse: normal.clone(),
                shading: *shading,
                is_shared,
                is_painted: false,
            },
        })
    };
    let levels = [1.0, 2.0, 3.0, 4.0].map(|level| material(level, Kind::Walls, true));
    let (cards, bodies) = (material(1.0, Kind::Cards, true), material(2.0, Kind::Bodies, true));
    let (base, fittings) = (material(0.0, Kind::Walls, false), material(2.0, Kind::Fittings, true));
    let alone = [(1.0, Kind::Walls), (2.0, Kind::Walls), (2.0, Kind::Bodies), (2.0, Kind::Fittings)]
        .map(|(level, kind)| material(level, kind, false));
    commands.insert_resource(CityMaterials { base, levels, cards, bodies, fittings, alone, painted: EntityHashMap::default() });
}

/// Keeps materials for cells with painted walls.
fn paint(
    in_use: Option<ResMut<CityMaterials>>,
    mut gone: RemovedComponents<CellPictures>,
    cells: Query<(Entity, Ref<CellPictures>)>,
    mut assets: ResMut<Assets<CityMaterial>>,
) {
    let Some(mut in_use) = in_use else { return };
    for cell in gone.read().filter(|&cell| !cells.contains(cell)) {
        in_use.painted.remove(&cell);
    }
    // Also those that came before the materials were made.
    for (cell, pictures) in &cells {
        if in_use.painted.contains_key(&cell) && !pictures.is_changed() {
            continue;
        }
        let finest = pictures.fine.as_ref().unwrap_or(&pictures.coarse);
        let painted = |level: Level| {
            let plain = assets.get(&in_use.levels[level.index()])?.clone();
            let extension = FacadeExtension {
                colour: finest.clone(),
                normal_or_coarse: pictures.coarse.clone(),
                is_painted: true,
                ..plain.extension
            };
            Some(CityMaterial { extension, ..plain })
        };
        let (Some(flat), Some(relief)) = (painted(Level::Two), painted(Level::Four)) else { continue };
        match in_use.painted.get(&cell) {
            Some(handles) => {
                for (handle, material) in handles.iter().zip([flat, relief]) {
                    if let Some(mut known) = assets.get_mut(handle) {
                        *known = material;
                    }
                }
            }
            None => {
                let handles = [assets.add(flat), assets.add(relief)];
                in_use.painted.insert(cell, handles);
            }
        }
    }
}

/// Tells the materials which levels show from where, and how they are lit.
fn set_distances(
    (distances, reach): (Res<LevelDistances>, Res<LevelReach>),
    shading: Res<Shading>,
    in_use: Option<Res<CityMaterials>>,
    mut assets: ResMut<Assets<CityMaterial>>,
) {
    let Some(in_use) = in_use else { return };
    if !distances.is_changed() && !reach.is_changed() && !shading.is_changed() {
        return;
    }
    let distances = distances.within(*reach);
    for handle in in_use.handles() {
        let Some(mut material) = assets.get_mut(handle) else { continue };
        let u = &mut material.extension.uniform;
        u.near_level = Vec3::from_array(distances.near).extend(u.near_level.w);
        u.far_kind = Vec3::from_array(distances.far).extend(u.far_kind.w);
        material.extension.shading = *shading;
    }
}

/// How much light or weather must change for the materials to be told: a change costs each of them a new bind group.
const LEAST_CHANGE: f32 = 0.01;

/// Tells the materials what glass mirrors, how dark and how wet it is.
fn set_light(
    light: Res<Daylight>,
    weather: Res<Weather>,
    in_use: Option<Res<CityMaterials>>,
    mut assets: ResMut<Assets<CityMaterial>>,
    mut told: Local<FacadeUniform>,
) {
    let Some(in_use) = in_use else { return };
    let now = FacadeUniform::lit(&light, weather.wet);
    let scale = now.zenith_wet.truncate().max(now.horizon_night.truncate()).max_element().max(1.0);
    let unit = Vec3::splat(scale).extend(1.0);
    let differs = |a: Vec4, b: Vec4| ((a - b) / unit).abs().max_element() > LEAST_CHANGE;
    let fills = now.fill.iter().zip(&told.fill).any(|(now, told)| differs(*now, *told));
    if !fills && !differs(now.zenith_wet, told.zenith_wet) && !differs(now.horizon_night, told.horizon_night) {
        return;
    }
    *told = now;
    for handle in in_use.handles() {
        if let Some(mut material) = assets.get_mut(handle) {
            let u = &mut material.extension.uniform;
            (u.zenith_wet, u.horizon_night, u.fill) = (now.zenith_wet, now.horizon_night, now.fill);
        }
    }
}

/// Gives new cell meshes their material. Level 1 and the base cast shadows; finer walls have the same silhouette. Trees' bodies cast
/// them in place of their cards.
fn dress_meshes(
    mut commands: Commands,
    in_use: Option<Res<CityMaterials>>,
    new: Query<(Entity, &CellMesh, Option<&ChildOf>), NewCellMesh>,
) {
    let Some(in_use) = in_use else { return };
    for (entity, mesh, cell) in &new {
        // Districts are of no cell.
        let Some(material) = in_use.of(mesh.kind, cell.map_or(entity, ChildOf::parent), false) else { continue };
        let mut entity = commands.entity(entity);
        entity.insert(MeshMaterial3d(material.clone()));
        if matches!(mesh.kind, CellMeshKind::Walls(level) | CellMeshKind::Painted(level) if level != Level::One) {
            entity.insert(NotShadowCaster);
        }
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::tree::TreeCard;
    use veduta_city::{Opening, SurfaceKind, Tile};

    #[test]
    fn the_shader_knows_the_layers_that_are_more_than_paint() {
        let source = include_str!("facade.wgsl");
        let layer = |name: &str| -> usize {
            let line = source.lines().find(|line| line.contains(&format!("const {name}:"))).expect("the constant");
            line.rsplit('=').next().and_then(|value| value.trim().trim_end_matches(';').parse().ok()).expect("a number")
        };
        let bays: Vec<usize> = Tile::all().filter(|tile| matches!(tile, Tile::Bay(_))).map(Tile::index).collect();
        assert_eq!(bays, (layer("FIRST_BAY")..=layer("LAST_BAY")).collect::<Vec<_>>());
        assert_eq!(layer("LAST_WINDOW"), Tile::Bay(Opening::WideWindow).index());
        assert_eq!(layer("SETTS"), Tile::Ground(SurfaceKind::Cobbles).index());
        assert_eq!(layer("FLAGSTONES"), Tile::Ground(SurfaceKind::Flagstones).index());
        assert_eq!(layer("SHOP"), Tile::Bay(Opening::Shop).index());
        assert_eq!(layer("WATER"), Tile::Ground(SurfaceKind::Water).index());
        let grounds: Vec<usize> = Tile::all().filter(|tile| matches!(tile, Tile::Ground(_))).map(Tile::index).collect();
        assert_eq!(grounds, (layer("FIRST_GROUND")..=layer("LAST_GROUND")).collect::<Vec<_>>());
        assert_eq!(layer("LEAVES"), Tile::Leaves.index());
        assert_eq!((layer("STONE"), layer("CARVED")), (Tile::Stone.index(), Tile::Carved.index()));
        assert_eq!(layer("LANTERN"), Tile::Lantern.index());
        let trades: Vec<usize> = Tile::all().filter(|tile| matches!(tile, Tile::Shop(_))).map(Tile::index).collect();
        assert_eq!(trades, (layer("FIRST_TRADE")..Tile::COUNT).collect::<Vec<_>>(), "the last layers");
    }

    #[test]
    fn the_shader_knows_in_how_many_directions_cards_look_and_how_they_lean() {
        let source = include_str!("levels.wgsl");
        let number = |name: &str| -> f64 {
            let line = source.lines().find(|line| line.contains(&format!("const {name}:"))).expect("the constant");
            line.rsplit('=').next().and_then(|value| value.trim().trim_end_matches(';').parse().ok()).expect("a number")
        };
        assert!((number("HALF_TURN") - core::f64::consts::PI / f64::from(TreeCard::DIRECTIONS)).abs() < 1e-6);
        // How far their normals look up.
        let lean = TreeCard::LEAN.sin();
        assert!(number("UPRIGHT") < lean && lean < number("LEVEL"), "{lean}");
    }
}
