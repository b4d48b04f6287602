//! Bridges: decks, and the vaults or girders that carry them.

use glam::{DVec2, DVec3};
use veduta_city::{CellShell, Rgb, SpanForm, SurfaceKind, Tile, WaySpan, metres};

use super::data::{MeshData, Paint, newell};
use super::drape::Drape;
use super::ground::remainder;
use super::marking::{Floor, lay};
use super::outline::{centre_of, engine};

/// Pavements stand so far above the carriageway; metres.
pub(crate) const KERB_M: f64 = 0.12;
/// Breadth and height of a parapet of stone, and how far its coping reaches beyond and above it; metres.
const PARAPET_M: (f64, f64) = (0.38, 1.0);
const COPING_M: (f64, f64) = (0.07, 0.14);
/// Height of railings, how far their posts stand apart, and breadth of posts and bars; metres.
const RAILING_M: f64 = 1.05;
const POST_STEP_M: f64 = 1.6;
const POST_M: f64 = 0.09;
const BAR_M: f64 = 0.05;
/// From the carriageway to the crown of an arch, metres.
pub(crate) const CROWN_M: f64 = 0.7;
/// Pieces of an arch, height of its voussoirs and how far they stand out of the wall; metres.
const PIECES: u32 = 14;
const VOUSSOIR_M: (f64, f64) = (0.55, 0.05);
/// Length of a stone pier along the bridge as a share of the span, at least and at most; metres.
const PIER: f64 = 0.17;
const PIER_M: (f64, f64) = (1.4, 3.4);
/// Where a bridge of stone ends on land it is solid for so far; metres.
const IMPOST_M: f64 = 0.4;
/// Depth of a girder as a share of the span, at least and at most; metres. Its slab, and how far that reaches over it.
const GIRDER: f64 = 1.0 / 18.0;
const GIRDER_M: (f64, f64) = (0.55, 1.5);
const SLAB_M: (f64, f64) = (0.3, 0.9);
/// Width of the upstand at the edge of a slab, metres.
const UPSTAND_M: f64 = 0.25;
/// Length of a girder's piers along the bridge, and their share of its breadth; metres.
const SHAFT_M: f64 = 0.9;
const SHAFT: f64 = 0.7;

/// Shorter spans are nothing, metres.
const SHORTEST_M: f64 = 0.25;

const SANDSTONE: Rgb = Rgb(0xC2, 0xB0, 0x90);
const VOUSSOIRS: Rgb = Rgb(0xD2, 0xC3, 0xA5);
const CONCRETE: Rgb = Rgb(0xA9, 0xA6, 0x9F);
const STEEL: Rgb = Rgb(0x55, 0x66, 0x60);

/// The spans of ways that a cell draws, on bridges and below the ground: carriageways with what is on them, parapets, railings and walls, and
/// what carries or covers them.
#[must_use]
pub fn spans(shell: &CellShell) -> MeshData {
    let mut mesh = MeshData::default();
    let drape = Drape::of(shell);
    let offset = DVec2::new(remainder(shell.origin.0), remainder(shell.origin.1));
    for span in shell.spans.iter().take(shell.drawn_spans as usize) {
        let Some(deck) = Deck::new(span) else { continue };
        let first = mesh.positions.len();
        deck.way(offset, &mut mesh);
        deck.markings(&mut mesh);
        match span.form {
            SpanForm::Arches => {
                deck.parapets(&mut mesh);
                deck.arch(&mut mesh);
            }
            SpanForm::Girder => {
                deck.railings(&mut mesh);
                deck.girder(&mut mesh);
            }
            SpanForm::Ramp => deck.ramp(&drape, &mut mesh),
            SpanForm::Bore { crown, ends } => deck.bore((crown, ends), first, &drape, &mut mesh),
        }
    }
    mesh
}

/// A span with where its stations are along it.
pub(super) struct Deck<'a> {
    pub span: &'a WaySpan,
    /// Of each station along the middle, metres.
    pub(super) lengths: Vec<f64>,
    /// Half the width of the way, the narrowest.
    pub(super) half_m: f64,
}

/// A line along a span: how far to the left of its middle, measured from its left (1) or right (−1) end or from the middle (0), and how
/// high above its carriageway or, if absolute, above the city's zero.
#[derive(Clone, Copy)]
struct Rail {
    side: f64,
    left: f64,
    up: f64,
}

const fn rail(side: f64, left: f64, up: f64) -> Rail {
    Rail { side, left, up }
}

impl<'a> Deck<'a> {
    /// `None` if it has no length to speak of.
    pub fn new(span: &'a WaySpan) -> Option<Self> {
        let middles: Vec<DVec2> = span.stations.iter().map(|station| station.at(0.0)).collect();
        let mut lengths = vec![0.0];
        for pair in middles.windows(2) {
            lengths.push(lengths[lengths.len() - 1] + pair[0].distance(pair[1]));
        }
        let half_m = span.stations.iter().map(|station| station.half_m()).fold(f64::INFINITY, f64::min);
        let has_length = lengths.windows(2).all(|pair| pair[1] - pair[0] > 1e-3) && half_m > 1e-3;
        let is_long = lengths.last().is_some_and(|length| *length > SHORTEST_M);
        (span.stations.len() > 1 && has_length && is_long).then_some(Self { span, lengths, half_m })
    }

    pub(super) fn length_m(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Between which stations a distance along the span is, and the share of the way between them.
    fn locate(&self, s: f64) -> (usize, f64) {
        let i = self.lengths.partition_point(|&length| length <= s).clamp(1, self.lengths.len() - 1) - 1;
        (i, ((s - self.lengths[i]) / (self.lengths[i + 1] - self.lengths[i])).clamp(0.0, 1.0))
    }

    /// Height of the carriageway at a distance along the span.
    pub(super) fn y(&self, s: f64) -> f64 {
        let (i, share) = self.locate(s);
        let [a, b] = [i, i + 1].map(|i| metres(self.span.stations[i].z));
        a + (b - a) * share
    }

    pub(super) fn plan(&self, s: f64, side: f64, left: f64) -> DVec2 {
        let (i, share) = self.locate(s);
        let [a, b] = [i, i + 1].map(|i| {
            let station = &self.span.stations[i];
            station.at(side * station.half_m() + left)
        });
        a.lerp(b, share)
    }

    fn on(&self, s: f64, rail: Rail) -> DVec3 {
        engine(self.plan(s, rail.side, rail.left), self.y(s) + rail.up)
    }

    /// At an absolute height.
    pub(super) fn at(&self, s: f64, side: f64, left: f64, y: f64) -> DVec3 {
        engine(self.plan(s, side, left), y)
    }

    pub(super) fn paint(&self, colour: Rgb, tile: Tile) -> Paint {
        Paint::new(centre_of(self.plan(self.length_m() / 2.0, 0.0, 0.0)), colour, tile)
    }

    /// A face between two lines along the span, seen from where the first lies on the right of the way.
    fn face(&self, right: Rail, left: Rail, paint: Paint, mesh: &mut MeshData) {
        for pair in self.lengths.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            mesh.polygon(&[self.on(a, right), self.on(b, right), self.on(b, left), self.on(a, left)], paint);
        }
    }

    /// Carriageway and pavements, with texture coordinates that go on from those of the ground.
    fn way(&self, offset: DVec2, mesh: &mut MeshData) {
        let [left, right] = self.pavements_m();
        let strip = |right: Rail, left: Rail, surface: SurfaceKind, mesh: &mut MeshData| {
            let paint = self.paint(Rgb(255, 255, 255), Tile::Ground(surface));
            for pair in self.lengths.windows(2) {
                let corners =
                    [(pair[0], right), (pair[1], right), (pair[1], left), (pair[0], left)].map(|(s, rail)| self.on(s, rail));
                let Some(normal) = newell(&corners) else { continue };
                let base = mesh.positions.len() as u32;
                for p in corners {
                    let uv = DVec2::new(p.x + offset.x, p.z - offset.y) / paint.size_m();
                    mesh.vertex(p, normal.as_vec3().to_array(), uv, paint);
                }
                mesh.indices.extend([base, base + 1, base + 2, base, base + 2, base + 3]);
            }
        };
        strip(rail(-1.0, right, 0.0), rail(1.0, -left, 0.0), self.span.surface, mesh);
        let stone = self.paint(Rgb(0xB9, 0xB4, 0xA8), Tile::Stone);
        if right > 0.0 {
            strip(rail(-1.0, 0.0, KERB_M), rail(-1.0, right, KERB_M), SurfaceKind::Mosaic, mesh);
            self.face(rail(-1.0, right, KERB_M), rail(-1.0, right, 0.0), stone, mesh);
        }
        if left > 0.0 {
            strip(rail(1.0, -left, KERB_M), rail(1.0, 0.0, KERB_M), SurfaceKind::Mosaic, mesh);
            self.face(rail(1.0, -left, 0.0), rail(1.0, -left, KERB_M), stone, mesh);
        }
    }

    /// Widths of the pavements on its left and right.
    pub fn pavements_m(&self) -> [f64; 2] {
        let (left, right) = self.span.pavements;
        [left, right].map(|width| metres(width.max(0)).min(self.half_m * 0.8))
    }

    /// Its sides that have parapets or railings: 1 for its left, −1 for its right.
    fn guarded(&self) -> impl Iterator<Item = f64> + use<> {
        let (left, right) = self.span.parapets;
        [(1.0, left), (-1.0, right)].into_iter().filter_map(|(side, is_there)| is_there.then_some(side))
    }

    /// A beam along the span: from one distance to another beyond its edge, and from one height to another above the carriageway.
    fn beam(&self, side: f64, (near, far): (f64, f64), (low, high): (f64, f64), paint: Paint, mesh: &mut MeshData) {
        let place = |out: f64, up: f64| rail(side, side * out, up);
        // Seen from the left side everything is turned round.
        let mut face = |a: Rail, b: Rail| if side < 0.0 { self.face(a, b, paint, mesh) } else { self.face(b, a, paint, mesh) };
        face(place(far, high), place(near, high));
        face(place(far, low), place(far, high));
        face(place(near, high), place(near, low));
        face(place(near, low), place(far, low));
        for (s, is_end) in [(0.0, false), (self.length_m(), true)] {
            let mut cap = [place(near, low), place(far, low), place(far, high), place(near, high)].map(|rail| self.on(s, rail));
            if is_end == (side < 0.0) {
                cap.reverse();
            }
            mesh.polygon(&cap, paint);
        }
    }

    fn parapets(&self, mesh: &mut MeshData) {
        let (wall, coping) = (self.paint(SANDSTONE, Tile::Stone), self.paint(VOUSSOIRS, Tile::Stone));
        let (thick, high) = PARAPET_M;
        for side in self.guarded() {
            self.beam(side, (0.0, thick), (0.0, high), wall, mesh);
            self.beam(side, (-COPING_M.0, thick + COPING_M.0), (high, high + COPING_M.1), coping, mesh);
        }
    }

    fn railings(&self, mesh: &mut MeshData) {
        let steel = self.paint(STEEL, Tile::Metal);
        for side in self.guarded() {
            for up in [0.2, 0.45, 0.7] {
                self.beam(side, (0.1, 0.1 + BAR_M), (up, up + BAR_M), steel, mesh);
            }
            self.beam(side, (0.08, 0.08 + POST_M), (RAILING_M - POST_M, RAILING_M), steel, mesh);
            let count = (self.length_m() / POST_STEP_M).ceil().max(1.0) as u32;
            for i in 0..=count {
                let s = (self.length_m() * f64::from(i) / f64::from(count)).clamp(POST_M / 2.0, self.length_m() - POST_M / 2.0);
                self.post(s, side, steel, mesh);
            }
        }
    }

    fn post(&self, s: f64, side: f64, paint: Paint, mesh: &mut MeshData) {
        let corner = |along: f64, out: f64, up: f64| self.on(s + along, rail(side, side * out, up));
        let (near, far, half) = (0.08, 0.08 + POST_M, POST_M / 2.0);
        let ring = [(-half, near), (-half, far), (half, far), (half, near)];
        for i in 0..4 {
            let (a, b) = (ring[i], ring[(i + 1) % 4]);
            let mut face = [corner(a.0, a.1, 0.0), corner(b.0, b.1, 0.0), corner(b.0, b.1, RAILING_M), corner(a.0, a.1, RAILING_M)];
            if side > 0.0 {
                face.reverse();
            }
            mesh.polygon(&face, paint);
        }
    }

    /// Length of its piers along the bridge.
    fn pier_m(&self) -> f64 {
        match self.span.form {
            SpanForm::Arches => (self.length_m() * PIER).clamp(PIER_M.0, PIER_M.1).min(self.length_m() / 2.0),
            _ => SHAFT_M.min(self.length_m() / 2.0),
        }
    }

    /// The vault's underside, the walls above it, and the pier under its end.
    fn arch(&self, mesh: &mut MeshData) {
        let [wall, under, ring] = [(SANDSTONE, 1.0), (SANDSTONE, 0.85), (VOUSSOIRS, 1.0)]
            .map(|(colour, shade)| self.paint(if shade < 1.0 { colour.scaled(shade) } else { colour }, Tile::Stone));
        let vault = Vault::of(self);
        let out = PARAPET_M.0;
        for pair in vault.places(self).windows(2) {
            let [a, b] = [pair[0], pair[1]];
            let low = [vault.y(a), vault.y(b)];
            let edge = |side: f64, s: f64, more: f64, y: f64| self.at(s, side, side * (out + more), y);
            for side in [-1.0, 1.0] {
                let mut quad = |low: [f64; 2], high: [f64; 2], more: f64, paint: Paint| {
                    let mut face = [
                        edge(side, a, more, low[0]),
                        edge(side, b, more, low[1]),
                        edge(side, b, more, high[1]),
                        edge(side, a, more, high[0]),
                    ];
                    if side > 0.0 {
                        face.reverse();
                    }
                    mesh.polygon(&face, paint);
                };
                let top = [self.y(a), self.y(b)];
                quad(low, top, 0.0, wall);
                if vault.is_open(a) && vault.is_open(b) {
                    let crown = [0, 1].map(|i| (low[i] + VOUSSOIR_M.0).min(top[i]));
                    quad(low, crown, VOUSSOIR_M.1, ring);
                }
            }
            let beyond = VOUSSOIR_M.1;
            mesh.polygon(
                &[
                    edge(1.0, a, beyond, low[0]),
                    edge(1.0, b, beyond, low[1]),
                    edge(-1.0, b, beyond, low[1]),
                    edge(-1.0, a, beyond, low[0]),
                ],
                under,
            );
        }
        if let Some(foot) = self.span.piers.1 {
            self.stone_pier(metres(foot), &vault, wall, mesh);
        }
    }

    /// A pier with prows that part the water, under the end of the span.
    fn stone_pier(&self, foot: f64, vault: &Vault, paint: Paint, mesh: &mut MeshData) {
        let (end, half) = (self.length_m(), self.pier_m() / 2.0);
        let way = (self.plan(end, 0.0, 0.0) - self.plan(end - 0.01, 0.0, 0.0)).normalize_or_zero();
        let side = |side: f64| self.plan(end, side, side * PARAPET_M.0);
        let (left, right) = (side(1.0), side(-1.0));
        let prow = |from: DVec2, other: DVec2| from + (from - other).normalize_or_zero() * half * 1.3;
        let ring =
            [right + way * half, left + way * half, prow(left, right), left - way * half, right - way * half, prow(right, left)];
        let (top, cap) = (vault.springing.max(foot + 0.1), half * 0.9);
        for i in 0..6 {
            let (a, b) = (ring[i], ring[(i + 1) % 6]);
            mesh.polygon(&[engine(a, foot), engine(b, foot), engine(b, top), engine(a, top)], paint);
        }
        // The prows' caps lean against the walls.
        for (first, tip, last) in [(1, 2, 3), (4, 5, 0)] {
            let ridge = engine((ring[first] + ring[last]) / 2.0, top + cap);
            mesh.polygon(&[engine(ring[first], top), engine(ring[tip], top), ridge], paint);
            mesh.polygon(&[engine(ring[tip], top), engine(ring[last], top), ridge], paint);
        }
    }

    fn girder(&self, mesh: &mut MeshData) {
        let is_railway = self.span.surface == SurfaceKind::Ballast;
        let (colour, tile) = if is_railway { (STEEL, Tile::Metal) } else { (CONCRETE, Tile::Plaster) };
        let (paint, under) = (self.paint(colour, tile), self.paint(colour.scaled(0.8), tile));
        let depth = (self.length_m() * GIRDER).clamp(GIRDER_M.0, GIRDER_M.1);
        let slab = SLAB_M.0.min(depth);
        let inset = SLAB_M.1.min(self.half_m * 0.4);
        let (left, right) = self.span.parapets;
        for (side, is_guarded) in [(1.0, left), (-1.0, right)] {
            let place = |out: f64, up: f64| rail(side, side * out, up);
            let mut face = |a: Rail, b: Rail, paint: Paint| {
                if side < 0.0 { self.face(a, b, paint, mesh) } else { self.face(b, a, paint, mesh) }
            };
            // The edge of the slab, with an upstand unless another bridge lies beside it, its underside, and the girder's side.
            let edge = if is_guarded { UPSTAND_M } else { 0.0 };
            if is_guarded {
                face(place(edge, -slab), place(edge, KERB_M), paint);
                face(place(edge, KERB_M), place(0.0, KERB_M), paint);
                face(place(0.0, KERB_M), place(0.0, 0.0), paint);
            } else {
                face(place(0.0, -slab), place(0.0, 0.0), paint);
            }
            face(place(-inset, -slab), place(edge, -slab), under);
            face(place(-inset, -depth), place(-inset, -slab), paint);
        }
        self.face(rail(1.0, -inset, -depth), rail(-1.0, inset, -depth), under, mesh);
        // Its ends, which show where a shallower girder, or none, goes on.
        for (s, near) in [(0.0, 1.0), (self.length_m(), -1.0)] {
            let corner = |side: f64, out: f64, up: f64| self.on(s, rail(side, side * out, up));
            let (far, inner) = (-near, -inset);
            mesh.polygon(
                &[corner(near, inner, -depth), corner(far, inner, -depth), corner(far, inner, -slab), corner(near, inner, -slab)],
                paint,
            );
            for side in self.guarded() {
                let (left, right) = if side == near { (UPSTAND_M, 0.0) } else { (0.0, UPSTAND_M) };
                let foot = [corner(side, left, -slab), corner(side, right, -slab)];
                mesh.polygon(&[foot[0], foot[1], corner(side, right, KERB_M), corner(side, left, KERB_M)], paint);
            }
        }
        if let Some(foot) = self.span.piers.1 {
            let (end, half) = (self.length_m(), SHAFT_M / 2.0);
            let way = (self.plan(end, 0.0, 0.0) - self.plan(end - 0.01, 0.0, 0.0)).normalize_or_zero();
            let middle = self.plan(end, 0.0, 0.0);
            let [left, right] = [1.0, -1.0].map(|side| middle + (self.plan(end, side, 0.0) - middle) * SHAFT);
            let ring = [right - way * half, right + way * half, left + way * half, left - way * half];
            let (foot, top) = (metres(foot), self.y(end) - depth + 0.02);
            for i in 0..4 {
                let (a, b) = (ring[i], ring[(i + 1) % 4]);
                mesh.polygon(&[engine(a, foot), engine(b, foot), engine(b, top), engine(a, top)], paint);
            }
        }
    }

    fn markings(&self, mesh: &mut MeshData) {
        let length = self.length_m();
        for marking in &self.span.markings {
            let (from, to) = (metres(marking.left.0), metres(marking.left.1));
            let line: Vec<DVec2> = self.lengths.iter().map(|&s| self.plan(s, 0.0, from + (to - from) * s / length)).collect();
            lay(marking.kind, &line, metres(marking.width.max(0)), (self, 0.0), mesh);
        }
    }
}

impl Floor for Deck<'_> {
    fn above(&self, p: DVec2, lift: f64) -> DVec3 {
        let stations = &self.span.stations;
        let before = |i: usize| {
            let (left, right) = (stations[i].left.to_metres(), stations[i].right.to_metres());
            (left - right).normalize_or_zero().perp_dot(p - right)
        };
        // Its way is to the right of the left: what lies behind a station's line is on its left.
        let i = (1..stations.len() - 1).find(|&i| before(i) > 0.0).unwrap_or(stations.len() - 1);
        let (start, end) = (-before(i - 1), before(i));
        let share = if start + end > 0.0 { (start / (start + end)).clamp(0.0, 1.0) } else { 0.0 };
        let [a, b] = [i - 1, i].map(|i| metres(stations[i].z));
        engine(p, a + (b - a) * share + lift)
    }

    fn way(&self, a: DVec2, b: DVec2) -> Vec<DVec2> {
        vec![a, b]
    }

    fn pieces(&self, polygon: &[DVec2], each: &mut dyn FnMut(&[DVec2])) {
        each(polygon);
    }
}

/// The underside of an arch: part of a circle between its imposts, which it springs from.
struct Vault {
    springing: f64,
    /// Where it begins and ends along the span.
    from: f64,
    to: f64,
    /// Middle and radius of the circle.
    centre: DVec2,
    radius: f64,
}

impl Vault {
    fn of(deck: &Deck<'_>) -> Self {
        let impost = |pier: Option<i32>| if pier.is_some() { deck.pier_m() / 2.0 } else { IMPOST_M.min(deck.length_m() / 4.0) };
        let (from, to) = (impost(deck.span.piers.0), deck.length_m() - impost(deck.span.piers.1));
        let crown = deck.span.stations.iter().map(|station| metres(station.z)).fold(f64::INFINITY, f64::min) - CROWN_M;
        let half = ((to - from) / 2.0).max(0.01);
        let springing = metres(deck.span.springing).min(crown - 0.05).max(crown - half);
        let rise = crown - springing;
        let radius = (half * half + rise * rise) / (2.0 * rise);
        Self { springing, from, to, centre: DVec2::new((from + to) / 2.0, crown - radius), radius }
    }

    fn is_open(&self, s: f64) -> bool {
        (self.from..=self.to).contains(&s)
    }

    /// Height of the underside at a distance along the span.
    fn y(&self, s: f64) -> f64 {
        let x = s - self.centre.x;
        if !self.is_open(s) {
            return self.springing;
        }
        (self.centre.y + libm::sqrt((self.radius * self.radius - x * x).max(0.0))).max(self.springing)
    }

    /// Where along the span it is drawn: evenly about its circle, at the imposts and at the stations.
    fn places(&self, deck: &Deck<'_>) -> Vec<f64> {
        let half = (self.to - self.from) / 2.0;
        let most = libm::asin((half / self.radius).min(1.0));
        let on_circle = (0..=PIECES).map(|i| {
            let angle = most * (2.0 * f64::from(i) / f64::from(PIECES) - 1.0);
            (self.centre.x + self.radius * libm::sin(angle)).clamp(self.from, self.to)
        });
        let mut out: Vec<f64> = on_circle.chain(deck.lengths.iter().copied()).collect();
        out.sort_by(f64::total_cmp);
        out.dedup_by(|b, a| *b - *a < 1e-3);
        out
    }
}
