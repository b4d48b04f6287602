use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use bevy_egui::egui::Color32;
use veduta_city::{GridPolygon, Massing, Overview, SurfaceKind};
use veduta_ecs::{Around, City, Eye, OverviewWants, Overviews, Viewer};

use crate::{MapView, MinimapSettings};

/// Edge of a tile, metres.
const TILE_M: f32 = 128.0;

/// Triangles of the map in plan metres, cut into tiles, in the order in which they are painted; by part of the overview.
#[derive(Resource, Default)]
pub struct MapTiles(BTreeMap<u32, PartTiles>);

/// Triangles that begin in one tile.
#[derive(Default)]
pub(crate) struct Tile {
    pub points: Vec<[f32; 2]>,
    pub colours: Vec<Color32>,
    pub indices: Vec<u32>,
    /// Farthest that anything reaches beyond the tile's square.
    overhang_m: f32,
}

/// Paper, and what is printed on it.
pub(crate) const PAPER: Color32 = Color32::from_rgb(0xE9, 0xE2, 0xD3);
const HOUSE: Color32 = Color32::from_rgb(0xC9, 0xB0, 0x94);
const LANDMARK: Color32 = Color32::from_rgb(0xA8, 0x70, 0x55);
/// What stands higher is a landmark, grid steps.
const LANDMARK_TOP: i32 = 30 * 1024;

const fn ink(surface: SurfaceKind) -> Option<Color32> {
    match surface {
        SurfaceKind::Asphalt | SurfaceKind::Cobbles | SurfaceKind::Mosaic | SurfaceKind::Flagstones => {
            Some(Color32::from_rgb(0xFB, 0xF8, 0xF1))
        }
        SurfaceKind::Gravel => Some(Color32::from_rgb(0xF1, 0xEA, 0xDA)),
        SurfaceKind::Grass => Some(Color32::from_rgb(0xC4, 0xD3, 0xA6)),
        SurfaceKind::Water => Some(Color32::from_rgb(0x9F, 0xC0, 0xCE)),
        SurfaceKind::Ballast => Some(Color32::from_rgb(0xC9, 0xC4, 0xBC)),
        SurfaceKind::Yard | SurfaceKind::Opening => None,
    }
}

/// Outlines that are cut in a frame.
const OUTLINES_A_FRAME: usize = 256;

/// Tiles of one part of the overview.
struct PartTiles {
    source: Arc<Overview>,
    /// So many of its outlines are cut.
    done: usize,
    layers: [BTreeMap<(i32, i32), Tile>; 2],
}

/// Cuts parts of the overview that have arrived into tiles, some outlines a frame, and drops those that are gone.
pub(crate) fn cut_tiles(city: Option<Res<City>>, mut tiles: ResMut<MapTiles>) {
    let overviews = city.as_ref().map(|city| &city.overviews);
    let is_there = |part: u32, tiles: &PartTiles| {
        overviews.and_then(|all| all.get(part)).is_some_and(|overview| Arc::ptr_eq(overview, &tiles.source))
    };
    // Nothing is touched where nothing has changed.
    if tiles.0.iter().any(|(&part, tiles)| !is_there(part, tiles)) {
        tiles.0.retain(|&part, tiles| is_there(part, tiles));
    }
    let parts = || overviews.into_iter().flat_map(Overviews::iter);
    if parts().all(|(part, _)| tiles.0.get(&part).is_some_and(PartTiles::is_done)) {
        return;
    }
    let mut left = OUTLINES_A_FRAME;
    for (part, overview) in parts() {
        let tiles = tiles.0.entry(part).or_insert_with(|| PartTiles::new(Arc::clone(overview)));
        while left > 0 && !tiles.is_done() {
            tiles.cut_next();
            left -= 1;
        }
    }
}

/// Asks for the part of the overview that the map shows.
pub(crate) fn ask_for_overview(
    settings: Res<MinimapSettings>,
    view: Res<MapView>,
    viewers: Query<&Eye, With<Viewer>>,
    mut wants: ResMut<OverviewWants>,
) {
    let shown = viewers.iter().next().and_then(|eye| match view.open {
        true => Some((view.middle.unwrap_or(eye.plan_pos), view.radius_m * WIDE)),
        false => settings.visible.then_some((eye.plan_pos, settings.radius_m * SQUARE)),
    });
    OverviewWants::ask(&mut wants, "minimap", shown.map(|(middle, radius_m)| Around::coarsely(middle, radius_m.into())));
}

/// From the middle to a corner, as a multiple of the way to the nearer edge: of the map in the corner, and of a window.
const SQUARE: f32 = core::f32::consts::SQRT_2;
const WIDE: f32 = 2.2;

impl PartTiles {
    fn new(source: Arc<Overview>) -> Self {
        Self { source, done: 0, layers: Default::default() }
    }

    fn is_done(&self) -> bool {
        self.done >= self.source.ground.len() + self.source.spans.len() + self.source.houses.len()
    }

    /// The ground first, then spans, then houses.
    fn cut_next(&mut self) {
        let source = Arc::clone(&self.source);
        let n = self.done;
        self.done += 1;
        if let Some(patch) = source.ground.get(n) {
            return ink(patch.surface).into_iter().for_each(|ink| self.add(0, &patch.outline, ink));
        }
        let n = n - source.ground.len();
        if let Some(span) = source.spans.get(n) {
            return ink(span.surface).filter(|_| !span.is_bore()).into_iter().for_each(|ink| self.add(0, &span.outline(), ink));
        }
        if let Some(Massing { outline, height, .. }) = source.houses.get(n - source.spans.len()) {
            self.add(1, outline, if *height > LANDMARK_TOP { LANDMARK } else { HOUSE });
        }
    }

    fn add(&mut self, layer: usize, outline: &GridPolygon, ink: Color32) {
        let mut points: Vec<[f32; 2]> = Vec::new();
        let mut holes = Vec::new();
        for ring in outline.rings() {
            if !points.is_empty() {
                holes.push(points.len() as u32);
            }
            points.extend(ring.iter().map(|p| p.to_metres().as_vec2().to_array()));
        }
        let Some(&first) = points.first() else { return };
        let mut triangles: Vec<u32> = Vec::new();
        earcut::Earcut::new().earcut(points.iter().copied(), &holes, &mut triangles);
        let key = ((first[0] / TILE_M).floor() as i32, (first[1] / TILE_M).floor() as i32);
        let low = [key.0 as f32 * TILE_M, key.1 as f32 * TILE_M];
        let reach = points.iter().flat_map(|p| [0, 1].map(|i| (low[i] - p[i]).max(p[i] - low[i] - TILE_M))).fold(0.0, f32::max);
        let tile = self.layers[layer].entry(key).or_default();
        let base = tile.points.len() as u32;
        tile.colours.extend(core::iter::repeat_n(ink, points.len()));
        tile.points.extend(points);
        tile.indices.extend(triangles.into_iter().map(|i| base + i));
        tile.overhang_m = tile.overhang_m.max(reach);
    }
}

impl MapTiles {
    /// Tiles that may touch a circle (plan metres), painted in this order.
    pub(crate) fn near(&self, middle: Vec2, radius_m: f32) -> impl Iterator<Item = &Tile> {
        (0..2).flat_map(|n| self.0.values().map(move |part| &part.layers[n])).flat_map(move |layer| {
            layer.iter().filter_map(move |(&(x, y), tile)| {
                let low = Vec2::new(x as f32, y as f32) * TILE_M - tile.overhang_m;
                let high = low + TILE_M + 2.0 * tile.overhang_m;
                (middle.distance(middle.clamp(low, high)) <= radius_m).then_some(tile)
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::GridPos;

    #[test]
    fn a_house_is_found_from_where_it_reaches_and_not_from_afar() {
        let side = 200 * 1024;
        let long = GridPolygon::simple(vec![GridPos(0, 0), GridPos(side, 0), GridPos(side, 9000), GridPos(0, 9000)]);
        let overview = Overview { houses: vec![Massing::block(long, 0)], ..Overview::default() };
        let mut app = App::new();
        app.init_resource::<MapTiles>().add_systems(Update, cut_tiles);
        app.insert_resource(City { overviews: Overviews::whole(overview), ..City::default() });
        app.update();
        let tiles = app.world().resource::<MapTiles>();
        assert_eq!(tiles.near(Vec2::new(205.0, 5.0), 10.0).count(), 1, "its far end is 5 m away");
        assert_eq!(tiles.near(Vec2::new(900.0, 5.0), 10.0).count(), 0);
        let tile = tiles.near(Vec2::ZERO, 1.0).next().expect("the house begins here");
        assert_eq!(tile.indices.len(), 6);
    }

    #[test]
    fn parts_are_cut_as_they_come_and_dropped_as_they_go() {
        let house = |i: i32| GridPolygon::simple(vec![GridPos(i, 0), GridPos(i + 9000, 0), GridPos(i, 9000)]);
        let part =
            Arc::new(Overview { houses: (0..600).map(|i| Massing::block(house(i * 256), 0)).collect(), ..Overview::default() });
        let mut app = App::new();
        app.init_resource::<MapTiles>().add_systems(Update, cut_tiles);
        let mut overviews = Overviews::awaited([(GridPos(0, 0), GridPos(0, 0)); 2]);
        overviews.put(1, Some(part));
        app.insert_resource(City { overviews, ..City::default() });
        let corners = |app: &App| {
            let tiles = app.world().resource::<MapTiles>();
            tiles.near(Vec2::ZERO, f32::INFINITY).map(|tile| tile.indices.len()).sum::<usize>()
        };
        let mut seen = Vec::new();
        for _ in 0..4 {
            app.update();
            seen.push(corners(&app));
        }
        assert_eq!(seen, [768, 1536, 1800, 1800], "some a frame");
        app.world_mut().resource_mut::<City>().overviews.put(1, None);
        app.update();
        assert_eq!(corners(&app), 0);
    }
}
