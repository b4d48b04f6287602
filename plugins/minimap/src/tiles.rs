use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use bevy_egui::egui::Color32;
use veduta_city::{GridPolygon, Overview, SurfaceKind};
use veduta_ecs::City;

/// Edge of a tile, metres.
const TILE_M: f32 = 128.0;

/// Triangles of the map in plan metres, cut into tiles, in the order in which they are painted.
#[derive(Resource, Default)]
pub struct MapTiles {
    source: Option<Arc<Overview>>,
    layers: [BTreeMap<(i32, i32), Tile>; 2],
}

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
/// Tops so high above the ground make a landmark, grid steps.
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

/// Cuts a newly arrived overview into tiles.
pub(crate) fn cut_tiles(city: Option<Res<City>>, mut tiles: ResMut<MapTiles>) {
    let overview = city.and_then(|city| city.overview.clone());
    let same = match (&tiles.source, &overview) {
        (Some(a), Some(b)) => Arc::ptr_eq(a, b),
        (None, None) => true,
        _ => false,
    };
    if same {
        return;
    }
    *tiles = MapTiles::default();
    let Some(overview) = overview else { return };
    for (surface, outline) in &overview.areas {
        if let Some(ink) = ink(*surface) {
            tiles.add(0, outline, ink);
        }
    }
    for span in overview.spans.iter().filter(|span| !span.is_bore()) {
        if let Some(ink) = ink(span.surface) {
            tiles.add(0, &span.outline(), ink);
        }
    }
    for (_, outline, top) in &overview.houses {
        let ground = outline.outer.first().map_or(0, |&p| overview.terrain.height(p));
        tiles.add(1, outline, if top.saturating_sub(ground) > LANDMARK_TOP { LANDMARK } else { HOUSE });
    }
    tiles.source = Some(overview);
}

impl MapTiles {
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

    /// Tiles that may touch a circle (plan metres), painted in this order.
    pub(crate) fn near(&self, middle: Vec2, radius_m: f32) -> impl Iterator<Item = &Tile> {
        self.layers.iter().flat_map(move |layer| {
            layer.iter().filter_map(move |(&(x, y), tile)| {
                let low = Vec2::new(x as f32, y as f32) * TILE_M - tile.overhang_m;
                let high = low + TILE_M + 2.0 * tile.overhang_m;
                (middle.distance(middle.clamp(low, high)) <= radius_m).then_some(tile)
            })
        })
    }

    /// The overview that the tiles were cut from.
    pub(crate) fn overview(&self) -> Option<&Arc<Overview>> {
        self.source.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use veduta_city::{GridPos, Id};

    #[test]
    fn a_house_is_found_from_where_it_reaches_and_not_from_afar() {
        let side = 200 * 1024;
        let long = GridPolygon::simple(vec![GridPos(0, 0), GridPos(side, 0), GridPos(side, 9000), GridPos(0, 9000)]);
        let overview = Overview { houses: vec![(Id(1), long, 0)], ..Overview::default() };
        let mut app = App::new();
        app.init_resource::<MapTiles>().add_systems(Update, cut_tiles);
        app.insert_resource(City { overview: Some(Arc::new(overview)), ..City::default() });
        app.update();
        let tiles = app.world().resource::<MapTiles>();
        assert_eq!(tiles.near(Vec2::new(205.0, 5.0), 10.0).count(), 1, "its far end is 5 m away");
        assert_eq!(tiles.near(Vec2::new(900.0, 5.0), 10.0).count(), 0);
        let tile = tiles.near(Vec2::ZERO, 1.0).next().expect("the house begins here");
        assert_eq!(tile.indices.len(), 6);
    }
}
