//! Façade level-of-detail switching and its material.
//!
//! Walls come as one mesh per cell and level. Which level shows is decided per façade *in the shader*: from the distance to
//! the façade's centre follows a weight for every level, and a fixed 8×8 ordered-dither pattern splits the pixels between
//! neighbouring levels so that level n keeps a pixel exactly where level n + 1 drops it. There is never a hole and never
//! both, without temporal anti-aliasing, and also for cells that arrive late: they fade in over what was there before.
//!
//! Meshes of which no façade has a pixel are hidden as wholes, by their bounds; those that share pixels with no other level are opaque.
//!
//! Levels change places while they look alike, in the first fifth of a band of distances or of a fade: the walls of level 2 come as plain as level 1,
//! those of level 4 as flat as the levels before. In the rest openings come out of the wall and relief rises. Level 3 is composed in the shader on the
//! meshes of levels 2 and 4, each façade by its own seed: mottled and streaked paint, repairs, damp, hairlines, and behind clear panes a room.
//!
//! Painted walls have [`CellPictures`](veduta_ecs::CellPictures) in the place of tiles: put together of small textures at level 2, into which those of level 3 are
//! mixed by distance and as they arrive. Each cell with some has materials of its own.
//!
//! ```text
//!  CellMesh ──► material by level ─┐
//!  LevelFade ──► MeshTag (bits) ────├─► shader: keep pixel where R(n+1) ≤ bayer < R(n)
//!  LevelDistances × LevelReach ─────┤      R(n) = max over m ≥ n, but 3, of fade(m) · near(m)
//!  Daylight, Weather ──► uniform ──┘      glass, water, wet ground, lit windows
//! ```
//!
//! | level | shown from | what it is |
//! |---|---|---|
//! | 1 | the horizon | coloured outline |
//! | 2 | [`LevelDistances::far`]`[0]` | small repeated textures |
//! | 3 | `far[1]` | weathered paint, panes and rooms; pictures of painted walls |
//! | 4 | `far[2]` | relief |
//!
//! With [`AutoLevels`] levels reach only as far as frames keep their time.
//!
//! Fittings (chimneys, dormers, lamps) are shown where level 2 is, whether or not a cell has it. Trees have two: cards at level 1, bodies from level 2 on. A tree's cards look in eight directions, upright and leaning back, and
//! one looks up; the shader shows the one that looks towards the eye, and for shadows the one that looks towards the sun.
//!
//! # Use
//! ```no_run
//! use bevy::prelude::*;
//! use veduta_facade::{FacadePlugin, LevelDistances};
//!
//! App::new()
//!     .add_plugins((DefaultPlugins, FacadePlugin::default()))
//!     .insert_resource(LevelDistances::uniform(60.0))
//!     .run();
//! ```
//! Then spawn meshes with a [`CellMesh`] and, on their parent, a [`LevelFade`](veduta_ecs::LevelFade). A
//! mesh carries in its second UV set the centre of its façade (x, z, in the mesh's own space) and in its colour's alpha the
//! layer of the texture array (`veduta_city::Tile::index`).
//!
//! # Limits
//! Shadows of walls are cast by level 1 alone, which has every level's silhouette, so that they neither pop nor dither; those of trees by
//! their bodies where these have come, however far. [`Shading::Plain`] knows one directional light and the sky: no shadows, lamps or gloss.
//! Monuments of level 4 are made more finely than those of level 2, and look alike only from some metres. Relief neither casts nor catches shadows of its own: it is shaded as if it were flat, and contact
//! shade comes from ambient occlusion where there is any. WebGL2-safe: no storage buffers, two texture arrays, one uniform. Rims of cards are thinned out
//! pixel by pixel and do not gain from MSAA. Where a cell's level 2 never comes, its trees stay cards however near they are. An orthographic
//! camera must have no depth prepass: it is taken for the sun's view there.
//!
//! # Rejected
//! Bevy's `VisibilityRange` (one entity per part; late arrivals do not dither), alpha blending (sorting), per-façade
//! entities (cost every frame, near or far), a dither through the whole band (its stipple is seen as long as it lasts), a
//! composed texture for each façade (at 512 texels it is coarser than the tiles, and costs memory), and two crossed cards that both show (they look like a cross).

mod fade;
mod material;
mod reach;
mod share;
mod tiles;

use bevy::camera::visibility::VisibilitySystems;
use bevy::prelude::*;
use veduta_ecs::{CellMesh, MaterialsProvided, VedutaSystems};

pub use fade::FadeSettings;
pub use material::{CityMaterial, CityMaterials, FacadeExtension, LevelDistances, Shading};
pub use reach::{AutoLevels, LevelReach};
pub use tiles::{Painting, TileFormat, TileQuality};

/// Gives cell meshes their material and switches levels per façade.
#[derive(Debug, Clone, Default)]
pub struct FacadePlugin {
    /// How finely tiles are painted and sampled.
    pub tiles: TileQuality,
    /// Where they are painted.
    pub painting: Painting,
}

impl Plugin for FacadePlugin {
    fn build(&self, app: &mut App) {
        veduta_ecs::ensure(app);
        app.init_resource::<LevelDistances>()
            .init_resource::<LevelReach>()
            .init_resource::<FadeSettings>()
            .init_resource::<Shading>()
            .insert_resource(self.tiles)
            .insert_resource(self.painting)
            .register_type::<LevelDistances>()
            .register_type::<LevelReach>()
            .register_type::<AutoLevels>()
            .register_type::<FadeSettings>()
            .register_type::<Shading>();
        // Without rendering (tests, servers) there is nothing to shade: fading still runs, so that its state can be tested.
        app.add_systems(Update, reach::choose_reach.run_if(resource_exists::<AutoLevels>).before(VedutaSystems::Show));
        app.add_systems(Update, (fade::fade_levels, fade::tag_meshes).chain().in_set(VedutaSystems::Show));
        app.add_systems(
            PostUpdate,
            (share::find_shares, share::heed_shares)
                .chain()
                .after(TransformSystems::Propagate)
                .after(VisibilitySystems::CalculateBounds)
                .before(VisibilitySystems::VisibilityPropagate)
                .before(bevy::mesh::mark_3d_meshes_as_changed_if_their_assets_changed),
        );
        let is_drawn = app.is_plugin_added::<bevy::pbr::PbrPlugin>();
        app.insert_resource(MaterialsProvided { are_made: !is_drawn, reads_blocks: false });
        if is_drawn {
            material::build(app);
        }
    }
}

/// A mesh of a cell that waits for its material.
type NewCellMesh = (With<CellMesh>, Without<MeshMaterial3d<CityMaterial>>);
