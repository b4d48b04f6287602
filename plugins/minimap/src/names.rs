use std::sync::Arc;

use bevy::math::DVec2;
use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use bevy_egui::egui::epaint::TextShape;
use bevy_egui::egui::{Color32, FontId, Mesh, Painter, Pos2, Shape, Stroke, Vec2 as EguiVec2};
use veduta_cartography::{
    Area, Colours, Course, Frame, Inks, LEADING, Layers, Layout, Letters, Name, NameKind, Named, Ribbon, SIGN, Setting, Symbol,
    lay_out,
};
use veduta_city::Overview;
use veduta_ecs::{City, PlaceNames};

use crate::tiles::colour;
use crate::view::Projection;

/// What there is to be named on the map, and where it found room: made beside the frame.
#[derive(Resource, Default)]
pub struct MapNames {
    /// What it was made of.
    sources: Vec<Arc<Overview>>,
    written: PlaceNames,
    named: Arc<Named>,
    /// Counts up with each making.
    version: u32,
    making: Option<Task<Named>>,
    /// Of the map in the corner, and of the large one.
    laid: [Laid; 2],
}

/// A layout, and for which view it was made.
#[derive(Default)]
struct Laid {
    shown: Option<Arc<Shown>>,
    making: Option<(View, Task<Shown>)>,
}

/// What of a view decides a layout.
#[derive(Debug, Clone, Copy, PartialEq)]
struct View {
    version: u32,
    /// Steps of scale and turn.
    scale: i32,
    turn: i32,
    /// Steps of the middle.
    at: (i32, i32),
    em: f32,
    size: EguiVec2,
    layers: Layers,
    colours: Colours,
}

/// A layout that is drawn.
struct Shown {
    view: View,
    frame: Frame,
    named: Named,
    layout: Layout,
    pictures: Vec<PictureMesh>,
}

/// A landmark as triangles, in points from the middle of its ground.
struct PictureMesh {
    at: DVec2,
    points: Vec<EguiVec2>,
    colours: Vec<Color32>,
    indices: Vec<u32>,
}

/// Layouts are made anew when the scale has changed by this, or the turn by so many degrees, or the middle by such a share of what is shown.
const SCALE_STEP: f32 = 1.19;
const TURN_STEP_DEG: f64 = 15.0;
const MIDDLE_STEP: f32 = 0.25;
/// Names of long streets are repeated about this often, ems.
const REPEAT_EM: f64 = 34.0;

/// Gathers what is to be named from the parts of the overview that are here.
pub(crate) fn gather(city: Option<Res<City>>, written: Res<PlaceNames>, mut names: ResMut<MapNames>) {
    let names = names.bypass_change_detection();
    if let Some(named) = names.making.as_mut().and_then(|task| block_on(poll_once(task))) {
        (names.named, names.making) = (Arc::new(named), None);
        names.version += 1;
    }
    let parts = || city.iter().flat_map(|city| city.overviews.iter()).map(|(_, part)| part);
    let is_same = names.sources.len() == parts().count() && names.sources.iter().zip(parts()).all(|(a, b)| Arc::ptr_eq(a, b));
    if names.making.is_some() || is_same && names.written == *written {
        return;
    }
    names.sources = parts().map(Arc::clone).collect();
    names.written.clone_from(&written);
    let (sources, written) = (names.sources.clone(), names.written.clone());
    let make = async move { Named::of(sources.iter().map(AsRef::as_ref), &|name| written.of(name).to_owned()) };
    names.making = Some(AsyncComputeTaskPool::get().spawn(make));
}

impl MapNames {
    /// Whether nothing is on its way.
    #[must_use]
    pub fn is_settled(&self) -> bool {
        self.making.is_none() && self.laid.iter().all(|laid| laid.making.is_none())
    }

    /// Draws what has found room; asks for another layout where the view has changed.
    pub(crate) fn draw(&mut self, large: bool, painter: &Painter, map: &Projection, em: f32, layers: Layers, colours: Colours) {
        let view = View::of(self.version, map, em, layers, colours);
        let laid = &mut self.laid[usize::from(large)];
        laid.take();
        let is_made = laid.shown.as_ref().is_some_and(|shown| shown.view == view);
        if laid.making.is_none() && !is_made {
            let (named, before) = (Arc::clone(&self.named), laid.shown.clone());
            laid.making = Some((view, AsyncComputeTaskPool::get().spawn(async move { make(view, &named, before.as_deref()) })));
            // Where tasks run at once it is there already.
            laid.take();
        }
        if let Some(shown) = &laid.shown {
            shown.draw(painter, map, em, colours.inks());
        }
    }
}

impl Laid {
    fn take(&mut self) {
        if let Some(shown) = self.making.as_mut().and_then(|(_, task)| block_on(poll_once(task))) {
            (self.shown, self.making) = (Some(Arc::new(shown)), None);
        }
    }
}

impl View {
    fn of(version: u32, map: &Projection, em: f32, layers: Layers, colours: Colours) -> Self {
        let scale = (map.scale.max(1e-6).ln() / SCALE_STEP.ln()).round() as i32;
        let turn = (f64::from(map.up).to_degrees() / TURN_STEP_DEG).round() as i32;
        let size = map.rect.size();
        let mut view = Self { version, scale, turn, at: (0, 0), em, size, layers, colours };
        let at = (map.middle() / view.step_m()).round();
        view.at = (at.x as i32, at.y as i32);
        view
    }

    fn units_a_metre(&self) -> f64 {
        f64::from(SCALE_STEP.powi(self.scale))
    }

    /// How far the middle may move, metres.
    fn step_m(&self) -> f64 {
        f64::from(self.size.min_elem() * MIDDLE_STEP) / self.units_a_metre()
    }
}

fn make(view: View, named: &Named, before: Option<&Shown>) -> Shown {
    let middle = DVec2::new(f64::from(view.at.0), f64::from(view.at.1)) * view.step_m();
    let frame = Frame::new(middle, DVec2::ZERO, view.units_a_metre(), f64::from(view.turn) * TURN_STEP_DEG);
    let named = named.shown(&view.layers);
    let letters = Letters::new();
    let advance = |letter: char| letters.as_ref().map_or(0.6, |letters| letters.advance(letter));
    // As far as the view may go until the next layout, turned too.
    let reach = DVec2::new(f64::from(view.size.x), f64::from(view.size.y)) * f64::from(0.55 + MIDDLE_STEP);
    let setting = Setting {
        frame,
        bounds: Area { min: -reach, max: reach },
        em: f64::from(view.em),
        repeat: f64::from(view.em) * REPEAT_EM,
        taken: &[],
        advance: &advance,
        before: before.map(|shown| shown.layout.stood()),
    };
    let layout = lay_out(&named.wanted(), &setting);
    let pictures = layout.pictures.iter().map(|shown| PictureMesh::of(&named, shown, frame, view.colours)).collect();
    Shown { view, frame, named, layout, pictures }
}

impl PictureMesh {
    fn of(named: &Named, shown: &veduta_cartography::Shown, frame: Frame, colours: Colours) -> Self {
        let picture = named.landmarks[shown.landmark].0.picture(frame.up_deg, colours);
        let mut mesh = Self { at: frame.plan(shown.at), points: Vec::new(), colours: Vec::new(), indices: Vec::new() };
        for facet in &picture.facets {
            let points: Vec<[f32; 2]> = facet.points.iter().map(|&p| (p * shown.scale).as_vec2().to_array()).collect();
            let mut triangles: Vec<u32> = Vec::new();
            earcut::Earcut::new().earcut(points.iter().copied(), &[], &mut triangles);
            let base = mesh.points.len() as u32;
            mesh.points.extend(points.iter().map(|&[x, y]| EguiVec2::new(x, y)));
            mesh.colours.extend(core::iter::repeat_n(colour(facet.fill), points.len()));
            mesh.indices.extend(triangles.into_iter().map(|i| base + i));
            if let Some(edge) = facet.edge {
                mesh.edges(&points, colour(edge).gamma_multiply(0.55));
            }
        }
        mesh
    }

    /// Edges as thin quads.
    fn edges(&mut self, points: &[[f32; 2]], ink: Color32) {
        const HALF: f32 = 0.35;
        for (&[ax, ay], &[bx, by]) in points.iter().zip(points.iter().cycle().skip(1)) {
            let (a, b) = (EguiVec2::new(ax, ay), EguiVec2::new(bx, by));
            let aside = (b - a).normalized().rot90() * HALF;
            let base = self.points.len() as u32;
            self.points.extend([a - aside, a + aside, b + aside, b - aside]);
            self.colours.extend([ink; 4]);
            self.indices.extend([0, 1, 2, 0, 2, 3].map(|i| base + i));
        }
    }

    fn draw(&self, painter: &Painter, map: &Projection) {
        let at = map.screen(self.at);
        if !map.rect.expand(map.rect.width() * 0.2).contains(at) {
            return;
        }
        let vertices = self.points.iter().zip(&self.colours).map(|(&p, &color)| bevy_egui::egui::epaint::Vertex {
            pos: at + p,
            uv: bevy_egui::egui::epaint::WHITE_UV,
            color,
        });
        painter.add(Shape::mesh(Mesh { vertices: vertices.collect(), indices: self.indices.clone(), ..Mesh::default() }));
    }
}

impl Shown {
    fn draw(&self, painter: &Painter, map: &Projection, em: f32, inks: &Inks) {
        for picture in &self.pictures {
            picture.draw(painter, map);
        }
        let screen = |p: DVec2| map.screen(self.frame.plan(p));
        for sign in &self.layout.signs {
            let at = map.screen(self.named.marks[sign.mark].plan_pos);
            if map.rect.contains(at) {
                draw_sign(painter, at, sign.symbol, em * SIGN as f32, inks);
            }
        }
        // The weightiest last.
        for name in self.layout.names.iter().rev() {
            match &name.course {
                Course::Along(line) => along(painter, map, name, &line.iter().map(|&p| screen(p)).collect::<Vec<_>>(), em, inks),
                Course::Level { anchor, offset, lines } => {
                    let offset = EguiVec2::new(offset.x as f32, offset.y as f32);
                    let middle = screen(*anchor) + offset;
                    let leading = (name.size * LEADING) as f32;
                    let first = middle.y - leading * (lines.len() as f32 - 1.0) / 2.0;
                    for (n, line) in lines.iter().enumerate() {
                        let at = Pos2::new(middle.x, first + leading * n as f32);
                        if map.rect.expand(em * 2.0).contains(at) {
                            write(painter, line, name, at, 0.0, em, inks);
                        }
                    }
                }
            }
        }
    }
}

pub(crate) fn draw_sign(painter: &Painter, at: Pos2, symbol: Symbol, size: f32, inks: &Inks) {
    let outline = symbol.outline().iter().map(|&[x, y]| at + EguiVec2::new(x as f32, y as f32) * size).collect();
    painter.add(Shape::convex_polygon(outline, colour(symbol.ink(inks)), Stroke::new(size * 0.09, colour(inks.halo))));
}

/// Names that turn by less than this in all are written straight, radians.
const STRAIGHT: f32 = 0.10;

/// Writes a name along a line: straight where the line is, else letter by letter.
fn along(painter: &Painter, map: &Projection, name: &Name, line: &[Pos2], em: f32, inks: &Inks) {
    let (Some(&first), Some(&last)) = (line.first(), line.last()) else { return };
    if !line.iter().any(|&p| map.rect.contains(p)) {
        return;
    }
    let chord = last - first;
    let most_off = line.iter().map(|&p| (p - first).dot(chord.normalized().rot90()).abs()).fold(0.0, f32::max);
    if most_off <= STRAIGHT * name.size as f32 * 3.0 {
        return write(painter, &name.text, name, first + chord / 2.0, chord.angle(), em, inks);
    }
    let points = line.iter().map(|p| DVec2::new(f64::from(p.x), f64::from(p.y))).collect();
    let Some(ribbon) = Ribbon::new(points) else { return };
    let font = FontId::proportional(name.size as f32);
    let letters: Vec<(String, f32)> = name
        .text
        .chars()
        .map(|letter| {
            let letter = letter.to_string();
            let width = painter.layout_no_wrap(letter.clone(), font.clone(), Color32::PLACEHOLDER).size().x;
            (letter, width + (name.kind.style().spacing * name.size) as f32)
        })
        .collect();
    let length: f32 = letters.iter().map(|(_, width)| width).sum();
    let mut upto = (ribbon.length() as f32 - length) / 2.0;
    for (letter, width) in letters {
        let (at, leads) = ribbon.at(f64::from(upto + width / 2.0));
        upto += width;
        let angle = leads.y.atan2(leads.x) as f32;
        write(painter, &letter, name, Pos2::new(at.x as f32, at.y as f32), angle, em, inks);
    }
}

/// Writes letters about a middle, with their halo.
fn write(painter: &Painter, text: &str, name: &Name, middle: Pos2, angle: f32, em: f32, inks: &Inks) {
    let ink = colour(name.kind.ink(inks));
    let halo = colour(inks.halo);
    let galley = painter.layout_no_wrap(text.to_owned(), FontId::proportional(name.size as f32), ink);
    let half = galley.size() / 2.0;
    let (sin, cos) = angle.sin_cos();
    let corner = middle - EguiVec2::new(half.x * cos - half.y * sin, half.x * sin + half.y * cos);
    let reach = if name.kind == NameKind::Water { 0.0 } else { (em * 0.12).max(1.1) };
    let round = if reach > 0.0 { 8 } else { 0 };
    for n in 0..round {
        let offset = EguiVec2::angled(n as f32 * core::f32::consts::TAU / 8.0) * reach;
        painter.add(TextShape::new(corner + offset, galley.clone(), halo).with_angle(angle).with_override_text_color(halo));
    }
    // Of two strokes the font has the lighter one alone; names that matter are written twice, a hair apart.
    if name.kind.style().weight > 0.045 {
        let aside = EguiVec2::new(cos, sin) * (name.size as f32 * 0.03);
        painter.add(TextShape::new(corner + aside, galley.clone(), ink).with_angle(angle));
    }
    painter.add(TextShape::new(corner, galley, ink).with_angle(angle));
}

#[cfg(test)]
mod tests {
    use bevy_egui::egui::Rect;
    use veduta_city::{GridPos, Id, PlanStreet};

    use super::*;

    fn street(id: u64, name: &str, line: &[(f64, f64)]) -> PlanStreet {
        let line = line.iter().map(|&p| GridPos::from_metres(p.into())).collect();
        PlanStreet { id: Id(id), name: name.into(), line, width: 10 * 1024, walkable: true, ..PlanStreet::default() }
    }

    fn named() -> Named {
        let streets = vec![
            street(1, "Long Street", &[(-300.0, 0.0), (300.0, 20.0)]),
            street(2, "Cross Street", &[(0.0, -300.0), (10.0, 300.0)]),
            street(3, "Bend", &[(40.0, 40.0), (90.0, 60.0), (110.0, 110.0)]),
        ];
        Named::of([&Overview { streets, ..Overview::default() }], &str::to_owned)
    }

    fn view(radius_m: f32, up_deg: f64, middle: DVec2) -> View {
        let rect = Rect::from_min_size(Pos2::ZERO, EguiVec2::splat(400.0));
        View::of(1, &Projection::new(rect, middle, radius_m, up_deg), 14.0, Layers::ALL, Colours::Paper)
    }

    #[test]
    fn small_moves_keep_a_layout_and_large_ones_do_not() {
        let first = view(100.0, 0.0, DVec2::ZERO);
        assert_eq!(first, view(101.0, 3.0, DVec2::splat(2.0)));
        for other in [view(130.0, 0.0, DVec2::ZERO), view(100.0, 20.0, DVec2::ZERO), view(100.0, 0.0, DVec2::new(60.0, 0.0))] {
            assert_ne!(first, other);
        }
    }

    /// Where each name's middle stands in plan.
    fn stands(shown: &Shown) -> Vec<(String, DVec2)> {
        let middle = |name: &Name| match &name.course {
            Course::Along(line) => shown.frame.plan(line[line.len() / 2]),
            Course::Level { anchor, .. } => shown.frame.plan(*anchor),
        };
        shown.layout.names.iter().map(|name| (name.text.clone(), middle(name))).collect()
    }

    #[test]
    fn names_stay_where_they_stood_while_one_zooms_and_turns() {
        let named = named();
        let mut last = make(view(150.0, 0.0, DVec2::ZERO), &named, None);
        assert!(last.layout.names.len() >= 3, "{:?}", stands(&last));
        for n in 1..=24 {
            let next = make(view(150.0 - n as f32 * 2.0, f64::from(n) * 7.0, DVec2::ZERO), &named, Some(&last));
            for (text, at) in stands(&last) {
                // One that stands no more must have no room any more: those of one long street stay.
                let nearest = stands(&next)
                    .into_iter()
                    .filter(|(t, _)| *t == text)
                    .map(|(_, p)| p.distance(at))
                    .fold(f64::INFINITY, f64::min);
                if text == "Bend" {
                    assert!(nearest < 25.0, "step {n}: {text} moved by {nearest:.0} m");
                } else {
                    assert!(nearest < 60.0, "step {n}: {text} moved by {nearest:.0} m");
                }
            }
            last = next;
        }
    }

    #[test]
    fn what_a_layer_hides_is_not_laid_out() {
        let mut view = view(150.0, 0.0, DVec2::ZERO);
        view.layers = Layers { names: false, ..Layers::ALL };
        assert!(make(view, &named(), None).layout.names.is_empty());
    }
}
