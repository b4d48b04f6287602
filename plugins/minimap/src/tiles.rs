use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::prelude::*;
use bevy_egui::egui::Color32;
use veduta_cartography::{Inks, Tone, tones};
use veduta_city::{GridPolygon, Massing, Overview, Rgb, SurfaceKind};
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
    pub fills: Vec<Fill>,
    pub indices: Vec<u32>,
    /// Farthest that anything reaches beyond the tile's square.
    overhang_m: f32,
}

/// What an outline is painted as: its ink is looked up when it is drawn, so that other inks need no other tiles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fill {
    Street,
    Gravel,
    Grass,
    Water,
    Ballast,
    House,
    Notable,
    Monument,
}

impl Fill {
    const fn of_ground(surface: SurfaceKind) -> Option<Self> {
        match surface {
            SurfaceKind::Asphalt | SurfaceKind::Cobbles | SurfaceKind::Mosaic | SurfaceKind::Flagstones => Some(Self::Street),
            SurfaceKind::Gravel => Some(Self::Gravel),
            SurfaceKind::Grass => Some(Self::Grass),
            SurfaceKind::Water => Some(Self::Water),
            SurfaceKind::Ballast => Some(Self::Ballast),
            SurfaceKind::Yard | SurfaceKind::Opening => None,
        }
    }

    const fn of_house(tone: Tone) -> Self {
        match tone {
            Tone::House => Self::House,
            Tone::Notable => Self::Notable,
            Tone::Monument => Self::Monument,
        }
    }

    /// The inks of all fills, in their order.
    pub fn palette(inks: &Inks) -> [Color32; 8] {
        let &Inks { street, gravel, grass, water, ballast, house, notable, monument, .. } = inks;
        [street, gravel, grass, water, ballast, house, notable, monument].map(colour)
    }
}

/// An ink on the screen.
pub(crate) const fn colour(Rgb(r, g, b): Rgb) -> Color32 {
    Color32::from_rgb(r, g, b)
}

/// Outlines that are cut in a frame.
const OUTLINES_A_FRAME: usize = 256;

/// Tiles of one part of the overview.
struct PartTiles {
    source: Arc<Overview>,
    /// How dark each of its houses is.
    tones: Vec<Tone>,
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
        Self { tones: tones(&source), source, done: 0, layers: Default::default() }
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
            return Fill::of_ground(patch.surface).into_iter().for_each(|fill| self.add(0, &patch.outline, fill));
        }
        let n = n - source.ground.len();
        if let Some(span) = source.spans.get(n) {
            let fill = Fill::of_ground(span.surface).filter(|_| !span.is_bore());
            return fill.into_iter().for_each(|fill| self.add(0, &span.outline(), fill));
        }
        let n = n - source.spans.len();
        if let Some(Massing { outline, .. }) = source.houses.get(n) {
            let tone = self.tones.get(n).copied().unwrap_or_default();
            self.add(1, outline, Fill::of_house(tone));
        }
    }

    fn add(&mut self, layer: usize, outline: &GridPolygon, fill: Fill) {
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
        tile.fills.extend(core::iter::repeat_n(fill, points.len()));
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
