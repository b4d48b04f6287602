//! Standing objects, recognisable at a glance and cheap: 50 to 400 triangles each.

mod card;
mod tree;

use glam::{DVec2, DVec3};
use veduta_city::draw::Draw;
use veduta_city::tree::{GREENS, nominal_m as tree_m};
use veduta_city::{CellShell, ObjectKind, ObjectShell, Rgb, Season, SurfaceKind, Tile, metres};

use super::data::{MeshData, Paint};
use super::outline::{centre_of, draw_at, engine};
use super::shape::{Ball, Sculptor};

pub use card::tree_cards;

const IRON: Rgb = Rgb(0x33, 0x38, 0x36);
const LANTERN: Rgb = Rgb(0xFF, 0xEB, 0xBE);
const SANDSTONE: Rgb = Rgb(0xB7, 0x9F, 0x79);
const GRANITE: Rgb = Rgb(0x9A, 0x98, 0x94);
const BRONZE: Rgb = Rgb(0x55, 0x6B, 0x5C);
const BARK: Rgb = Rgb(0x5F, 0x51, 0x44);
const TIMBER: Rgb = Rgb(0x8A, 0x69, 0x47);
const GLASS: Rgb = Rgb(0xB4, 0xC4, 0xC8);
const TRAM_RED: Rgb = Rgb(0xA8, 0x2F, 0x2A);
const PAPER: Rgb = Rgb(0xD8, 0xCF, 0xBC);
/// Red, amber, green.
const LIGHTS: [Rgb; 3] = [Rgb(0xD8, 0x3A, 0x2E), Rgb(0x6E, 0x5A, 0x2C), Rgb(0x24, 0x52, 0x3A)];
const SIGNAL_YELLOW: Rgb = Rgb(0xD9, 0xA9, 0x2E);
const GALVANISED: Rgb = Rgb(0x8E, 0x94, 0x96);
const FLOWERS: [Rgb; 4] = [Rgb(0xC4, 0x44, 0x4E), Rgb(0xD9, 0xA8, 0xB4), Rgb(0xE0, 0xC4, 0x5A), Rgb(0x8C, 0x6C, 0xA8)];
const WARES: [Rgb; 6] = [
    Rgb(0xB4, 0x4A, 0x3C),
    Rgb(0xC8, 0x9A, 0x48),
    Rgb(0x6E, 0x84, 0x4A),
    Rgb(0xD2, 0xBE, 0x92),
    Rgb(0x8A, 0x5A, 0x38),
    Rgb(0x7A, 0x56, 0x74),
];
const CANOPIES: [Rgb; 4] = [Rgb(0xE4, 0xDC, 0xC8), Rgb(0xE4, 0xDC, 0xC8), Rgb(0xA8, 0x3C, 0x34), Rgb(0x5A, 0x6E, 0x50)];
const AWNINGS: [Rgb; 3] = [Rgb(0x8C, 0x3E, 0x2C), Rgb(0x4E, 0x6A, 0x4C), Rgb(0xC9, 0xB0, 0x6E)];

/// Height of a lamp's light above its foot at nominal size; metres.
const LIGHT_M: f64 = 3.7;

/// All standing objects of a cell but trees and those that are seen as monuments. Centres are the objects' positions.
#[must_use]
pub fn objects(shell: &CellShell) -> MeshData {
    let mut mesh = MeshData::default();
    let ball = Ball::new();
    for (object, draw) in drawn(shell).filter(|(object, _)| !object.kind.is_tree()) {
        Maker::new(object, draw, &ball, &mut mesh).make(object.kind);
    }
    mesh
}

/// All trees of a cell as they are in a season, for who is near. Centres are their positions.
#[must_use]
pub fn trees(shell: &CellShell, season: Season) -> MeshData {
    let mut mesh = MeshData::default();
    let ball = Ball::new();
    for (object, draw) in drawn(shell).filter(|(object, _)| object.kind.is_tree()) {
        Maker::new(object, draw, &ball, &mut mesh).tree(object.kind, season);
    }
    mesh
}

/// The objects that are not seen as monuments, and what is random about each.
fn drawn(shell: &CellShell) -> impl Iterator<Item = (&ObjectShell, Draw)> {
    let objects = shell.objects.iter().filter(|object| object.monument.is_none());
    objects.map(|object| (object, draw_at(shell, object.pos, "object")))
}

/// Where the light of a lamp is, in the mesh's axes; `None` for other objects.
#[must_use]
pub fn lantern(object: &ObjectShell) -> Option<[f32; 3]> {
    let light = engine(object.pos.to_metres(), metres(object.z) + LIGHT_M * scale_of(object));
    (object.kind == ObjectKind::Lamp && object.monument.is_none()).then(|| light.as_vec3().to_array())
}

/// Height that a kind is modelled in; metres.
const fn nominal_m(kind: ObjectKind) -> f64 {
    match kind {
        ObjectKind::Lamp => 4.2,
        ObjectKind::Bench => 0.85,
        ObjectKind::Fountain => 3.2,
        ObjectKind::Statue => 4.2,
        ObjectKind::TramStop => 2.7,
        ObjectKind::Bollard | ObjectKind::Bin => 0.9,
        ObjectKind::Kiosk => 3.0,
        ObjectKind::Well => 2.6,
        ObjectKind::Column | ObjectKind::Signals => 3.4,
        ObjectKind::Sign => 2.6,
        ObjectKind::Hedge => 0.95,
        ObjectKind::Planter => 1.1,
        ObjectKind::Parasol => 2.7,
        ObjectKind::Shrub => 1.2,
        _ => tree_m(kind),
    }
}

/// Size of an object against its model, 0.3 to 12.
pub(super) fn scale_of(object: &ObjectShell) -> f64 {
    let told = metres(object.height) / nominal_m(object.kind);
    if object.height > 0 { told.clamp(0.3, 12.0) } else { 1.0 }
}

/// Radius of the ground on which an object stands, metres.
pub(crate) fn radius_m(object: &ObjectShell) -> f64 {
    object.kind.radius_m() * scale_of(object)
}

struct Maker<'a> {
    sculptor: Sculptor<'a>,
    ball: &'a Ball,
    centre: [f32; 2],
    draw: Draw,
}

impl<'a> Maker<'a> {
    fn new(object: &ObjectShell, draw: Draw, ball: &'a Ball, mesh: &'a mut MeshData) -> Self {
        let plan = object.pos.to_metres();
        let heading = f64::from(object.heading).to_radians();
        let sculptor = Sculptor {
            mesh,
            foot: engine(plan, metres(object.z)),
            front: DVec2::new(libm::sin(heading), libm::cos(heading)),
            scale: scale_of(object),
        };
        Self { sculptor, ball, centre: centre_of(plan), draw }
    }

    fn make(&mut self, kind: ObjectKind) {
        match kind {
            ObjectKind::Lamp => self.lamp(),
            ObjectKind::Bench => self.bench(),
            ObjectKind::Fountain => self.fountain(),
            ObjectKind::Statue => self.statue(),
            ObjectKind::TramStop => self.tram_stop(),
            ObjectKind::Bollard => self.bollard(),
            ObjectKind::Kiosk => self.kiosk(),
            ObjectKind::Well => self.well(),
            ObjectKind::Column => self.column(),
            ObjectKind::Bin => self.bin(),
            ObjectKind::Signals => self.signals(),
            ObjectKind::Sign => self.sign(),
            ObjectKind::Hedge => self.hedge(),
            ObjectKind::Planter => self.planter(),
            ObjectKind::Parasol => self.parasol(),
            ObjectKind::Shrub => self.shrub(),
            _ => {}
        }
    }

    fn paint(&self, colour: Rgb, tile: Tile) -> Paint {
        Paint::new(self.centre, colour, tile)
    }

    fn turned(&mut self, sides: usize, rings: &[(f64, f64)], paint: Paint) {
        self.sculptor.turned((0.0, 0.0), sides, rings, paint);
    }

    /// Cast-iron post with a six-sided lantern, and the bar that the lamplighter leant his ladder on.
    fn lamp(&mut self) {
        let iron = self.paint(IRON, Tile::Metal);
        self.turned(8, &[(0.2, 0.0), (0.2, 0.12), (0.13, 0.2), (0.12, 0.62), (0.07, 0.72), (0.045, 3.2), (0.1, 3.28)], iron);
        self.sculptor.block((0.0, 0.0), (0.34, 0.02), (3.02, 3.06), iron);
        self.turned(6, &[(0.05, 3.28), (0.13, 3.4)], iron);
        self.turned(6, &[(0.13, 3.4), (0.23, 3.92)], self.paint(LANTERN, Tile::Lantern));
        self.turned(6, &[(0.28, 3.92), (0.1, 4.08), (0.06, 4.1), (0.0, 4.2)], iron);
    }

    fn bench(&mut self) {
        let (wood, iron) = (self.paint(TIMBER, Tile::Wood), self.paint(IRON, Tile::Metal));
        for z in [-0.14, 0.02, 0.18] {
            self.sculptor.block((0.0, z), (0.85, 0.065), (0.42, 0.46), wood);
        }
        for y in [0.56, 0.72] {
            self.sculptor.block((0.0, -0.25), (0.85, 0.02), (y, y + 0.11), wood);
        }
        for x in [-0.7, 0.7] {
            self.sculptor.block((x, 0.18), (0.03, 0.03), (0.0, 0.42), iron);
            self.sculptor.block((x, -0.28), (0.03, 0.03), (0.0, 0.85), iron);
            self.sculptor.block((x, 0.0), (0.03, 0.24), (0.36, 0.42), iron);
        }
    }

    /// Eight-sided basin, shaft, bowl.
    fn fountain(&mut self) {
        let stone = self.paint(SANDSTONE, Tile::Stone);
        let water = self.paint(Rgb(255, 255, 255), Tile::Ground(SurfaceKind::Water));
        self.turned(8, &[(2.1, 0.0), (2.1, 0.16), (0.0, 0.16)], stone);
        self.turned(8, &[(1.8, 0.16), (1.75, 0.7), (1.9, 0.76), (1.9, 0.88), (1.6, 0.88), (1.6, 0.6)], stone);
        self.turned(8, &[(1.6, 0.66), (0.0, 0.66)], water);
        self.turned(8, &[(0.45, 0.16), (0.45, 0.9), (0.22, 1.05), (0.18, 1.6), (0.3, 1.72)], stone);
        self.turned(12, &[(0.25, 1.7), (0.8, 1.95), (0.9, 2.1), (0.82, 2.1), (0.0, 2.02)], stone);
        self.turned(8, &[(0.14, 2.0), (0.11, 2.55), (0.22, 2.65), (0.1, 2.8), (0.16, 2.95), (0.0, 3.2)], stone);
    }

    /// Stepped plinth and a robed figure, one arm raised.
    fn statue(&mut self) {
        let (stone, bronze) = (self.paint(GRANITE, Tile::Stone), self.paint(BRONZE, Tile::Metal));
        for (half, low, high) in [(0.95, 0.0, 0.22), (0.78, 0.22, 0.44), (0.52, 0.44, 0.62), (0.42, 0.62, 1.95), (0.54, 1.95, 2.14)]
        {
            self.sculptor.block((0.0, 0.0), (half, half), (low, high), stone);
        }
        let robe = [(0.34, 2.14), (0.3, 2.4), (0.2, 3.05), (0.24, 3.3), (0.27, 3.55), (0.1, 3.72)];
        self.turned(10, &robe, bronze);
        let head = self.draw.part(0);
        self.sculptor.blob(self.ball, DVec3::new(0.0, 3.86, 0.02), DVec3::new(0.12, 0.16, 0.13), 0.06, head, bronze);
        let side = if self.draw.chance("left arm", 0.5) { -1.0 } else { 1.0 };
        self.sculptor.turned((side * 0.27, 0.08), 5, &[(0.07, 3.1), (0.08, 3.5), (0.05, 4.05), (0.0, 4.2)], bronze);
        self.sculptor.turned((side * -0.25, 0.06), 5, &[(0.05, 2.75), (0.08, 3.1), (0.07, 3.5), (0.0, 3.58)], bronze);
    }

    /// Sign on a pole beside a shelter with a bench.
    fn tram_stop(&mut self) {
        let (iron, red) = (self.paint(IRON, Tile::Metal), self.paint(TRAM_RED, Tile::Metal));
        let (glass, wood) = (self.paint(GLASS, Tile::Plaster), self.paint(TIMBER, Tile::Wood));
        self.sculptor.turned((2.0, 0.5), 6, &[(0.05, 0.0), (0.04, 2.7)], iron);
        self.sculptor.block((2.0, 0.53), (0.26, 0.02), (2.1, 2.65), red);
        self.sculptor.block((2.0, 0.53), (0.22, 0.03), (1.2, 1.9), self.paint(PAPER, Tile::Plaster));
        self.sculptor.block((0.0, 0.0), (1.6, 0.75), (2.35, 2.47), iron);
        self.sculptor.block((0.0, -0.6), (1.45, 0.02), (0.25, 2.2), glass);
        for x in [-1.45, 1.45] {
            self.sculptor.block((x, -0.6), (0.04, 0.04), (0.0, 2.35), iron);
            self.sculptor.block((x, 0.55), (0.04, 0.04), (0.0, 2.35), iron);
            self.sculptor.block((x, -0.2), (0.015, 0.35), (0.25, 2.1), glass);
        }
        self.sculptor.block((0.0, -0.35), (1.1, 0.18), (0.42, 0.47), wood);
    }

    fn bollard(&mut self) {
        let iron = self.paint(IRON, Tile::Metal);
        let rings = [(0.15, 0.0), (0.15, 0.08), (0.1, 0.14), (0.09, 0.66), (0.13, 0.7), (0.08, 0.74), (0.1, 0.82), (0.0, 0.9)];
        self.turned(8, &rings, iron);
    }

    /// Market stall: counter, posts, back wall, hipped awning.
    fn kiosk(&mut self) {
        let wood = self.paint(TIMBER, Tile::Wood);
        let cloth = self.draw.pick("awning", &AWNINGS).copied().unwrap_or(AWNINGS[0]);
        let cloth = self.paint(cloth, Tile::Plaster);
        self.sculptor.block((0.0, 0.7), (1.2, 0.28), (0.0, 0.95), wood);
        self.sculptor.block((0.0, 0.72), (1.3, 0.36), (0.95, 1.02), wood);
        self.sculptor.block((0.0, -0.95), (1.25, 0.05), (0.0, 2.2), wood);
        for x in [-1.2, 1.2] {
            self.sculptor.block((x, 0.95), (0.05, 0.05), (0.0, 2.2), wood);
            self.sculptor.block((x, 0.0), (0.04, 0.95), (0.0, 1.0), wood);
        }
        // Wares in boxes on the counter, and on a shelf behind it.
        for (i, x) in (0..6).map(|i| (i, 0.4 * f64::from(i) - 1.0)) {
            let ware = self.draw.part(i as u64);
            let [front, back] = ["front", "back"].map(|row| ware.pick(row, &WARES).copied().unwrap_or(TIMBER));
            let (front, back) = (self.paint(front, Tile::Plaster), self.paint(back, Tile::Plaster));
            self.sculptor.block((x, 0.72), (0.16, 0.24), (1.02, ware.between("heap", 1.08, 1.2)), front);
            self.sculptor.block((x, -0.72), (0.13, 0.12), (1.3, ware.between("stack", 1.42, 1.7)), back);
        }
        self.sculptor.block((0.0, -0.74), (1.2, 0.16), (1.26, 1.3), wood);
        // Left and right as seen from the front.
        let corner = |x: f64, z: f64| DVec3::new(-1.5 * x, 2.15, 1.3 * z);
        let ridge = |x: f64| DVec3::new(-0.6 * x, 3.0, 0.0);
        let (fl, fr, bl, br) = (corner(-1.0, 1.0), corner(1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0));
        let slopes: [&[DVec3]; 4] =
            [&[fl, fr, ridge(1.0), ridge(-1.0)], &[br, bl, ridge(-1.0), ridge(1.0)], &[fr, br, ridge(1.0)], &[bl, fl, ridge(-1.0)]];
        for slope in slopes {
            self.sculptor.face(slope, cloth);
        }
        self.sculptor.face(&[fl, bl, br, fr], cloth);
        // Valance.
        let drop = |p: DVec3| p - DVec3::Y * 0.2;
        for (a, b) in [(fl, fr), (fr, br), (br, bl), (bl, fl)] {
            self.sculptor.face(&[drop(a), drop(b), b, a], cloth);
        }
    }

    /// A square canopy with a valance on a pole; under it a round table and four chairs.
    fn parasol(&mut self) {
        let (wood, iron) = (self.paint(TIMBER, Tile::Wood), self.paint(IRON, Tile::Metal));
        let cloth = self.draw.pick("canopy", &CANOPIES).copied().unwrap_or(CANOPIES[0]);
        let cloth = self.paint(cloth, Tile::Plaster);
        self.sculptor.block((0.0, 0.0), (0.025, 0.025), (0.0, 2.65), wood);
        self.turned(10, &[(0.34, 0.71), (0.34, 0.745), (0.0, 0.745)], wood);
        self.turned(6, &[(0.22, 0.0), (0.2, 0.03), (0.0, 0.03)], iron);
        for (x, z) in [(0.72, 0.0), (-0.72, 0.0), (0.0, 0.72), (0.0, -0.72)] {
            let back = |at: f64| if at == 0.0 { 0.2 } else { 0.02 };
            self.sculptor.block((x, z), (0.2, 0.2), (0.43, 0.46), wood);
            self.sculptor.block((1.25 * x, 1.25 * z), (back(x), back(z)), (0.46, 0.86), wood);
            for (dx, dz) in [(-0.17, -0.17), (0.17, -0.17), (0.17, 0.17), (-0.17, 0.17)] {
                self.sculptor.block((x + dx, z + dz), (0.014, 0.014), (0.0, 0.43), iron);
            }
        }
        // Left and right as seen from the front.
        let corner = |x: f64, z: f64| DVec3::new(-1.45 * x, 2.12, 1.45 * z);
        let corners = [corner(-1.0, 1.0), corner(1.0, 1.0), corner(1.0, -1.0), corner(-1.0, -1.0)];
        let top = DVec3::new(0.0, 2.7, 0.0);
        let drop = DVec3::Y * 0.18;
        for (a, b) in (0..4).map(|i| (corners[i], corners[(i + 1) % 4])) {
            self.sculptor.face(&[a, b, top], cloth);
            self.sculptor.face(&[b, a, top - DVec3::Y * 0.02], cloth);
            self.sculptor.face(&[a - drop, b - drop, b, a], cloth);
            self.sculptor.face(&[b - drop, a - drop, a, b], cloth);
        }
    }

    /// Round curb, two posts, a little roof over the winch.
    fn well(&mut self) {
        let (stone, wood) = (self.paint(SANDSTONE, Tile::Stone), self.paint(TIMBER, Tile::Wood));
        let water = self.paint(Rgb(255, 255, 255), Tile::Ground(SurfaceKind::Water));
        self.turned(12, &[(0.8, 0.0), (0.78, 0.75), (0.85, 0.8), (0.85, 0.9), (0.6, 0.9), (0.6, 0.4)], stone);
        self.turned(12, &[(0.6, 0.5), (0.0, 0.5)], water);
        for x in [-0.72, 0.72] {
            self.sculptor.block((x, 0.0), (0.06, 0.06), (0.88, 2.05), wood);
        }
        self.sculptor.block((0.0, 0.0), (0.7, 0.07), (1.5, 1.64), wood);
        let tiles = self.paint(Rgb(0x8C, 0x4A, 0x38), Tile::RoofTile);
        self.turned(4, &[(1.25, 2.05), (0.0, 2.6)], tiles);
        self.turned(4, &[(0.0, 2.05), (1.25, 2.05)], wood);
    }

    /// Advertising column: drum with posters, cornice, cap.
    fn column(&mut self) {
        let iron = self.paint(IRON, Tile::Metal);
        self.turned(14, &[(0.66, 0.0), (0.66, 0.28), (0.58, 0.34)], iron);
        self.turned(14, &[(0.58, 0.34), (0.58, 2.6)], self.paint(PAPER, Tile::Plaster));
        self.turned(14, &[(0.58, 2.55), (0.74, 2.66), (0.74, 2.76), (0.5, 3.0), (0.16, 3.15), (0.1, 3.3), (0.0, 3.4)], iron);
    }

    fn bin(&mut self) {
        let iron = self.paint(IRON, Tile::Metal);
        self.turned(10, &[(0.2, 0.0), (0.24, 0.06), (0.25, 0.72)], iron);
        self.turned(10, &[(0.27, 0.72), (0.27, 0.77), (0.16, 0.86), (0.0, 0.9)], iron);
    }

    /// Post, a head of three lights under hoods, and a box for those who walk.
    fn signals(&mut self) {
        let iron = self.paint(IRON, Tile::Metal);
        self.turned(8, &[(0.16, 0.0), (0.16, 0.1), (0.07, 0.16), (0.06, 3.4), (0.0, 3.4)], iron);
        self.sculptor.block((0.0, 0.14), (0.16, 0.09), (2.4, 3.36), iron);
        for (y, light) in [(2.56, LIGHTS[2]), (2.88, LIGHTS[1]), (3.2, LIGHTS[0])] {
            let light = self.paint(light, Tile::Plaster);
            self.sculptor.block((0.0, 0.235), (0.1, 0.012), (y - 0.1, y + 0.1), light);
            self.sculptor.block((0.0, 0.3), (0.12, 0.08), (y + 0.11, y + 0.125), iron);
        }
        self.sculptor.block((0.14, 0.0), (0.08, 0.06), (2.0, 2.5), iron);
        self.sculptor.block((0.14, 0.0), (0.1, 0.07), (1.0, 1.16), self.paint(SIGNAL_YELLOW, Tile::Metal));
    }

    /// Eight-sided plate on a post.
    fn sign(&mut self) {
        let (iron, white) = (self.paint(GALVANISED, Tile::Metal), self.paint(PAPER, Tile::Plaster));
        self.turned(8, &[(0.035, 0.0), (0.035, 2.58), (0.0, 2.6)], iron);
        let red = self.paint(TRAM_RED, Tile::Metal);
        let corner = |i: u32, radius: f64, z: f64| {
            let angle = (f64::from(i) + 0.5) * core::f64::consts::FRAC_PI_4;
            DVec3::new(radius * libm::cos(angle), 2.22 + radius * libm::sin(angle), z)
        };
        for (radius, back, front, paint) in [(0.36, 0.04, 0.055, white), (0.32, 0.055, 0.06, red)] {
            let plate = |z: f64| (0..8).map(move |i| corner(i, radius, z));
            // Left and right as seen from the front.
            let (face, rear): (Vec<DVec3>, Vec<DVec3>) = (plate(front).rev().collect(), plate(back).collect());
            self.sculptor.face(&face, paint);
            self.sculptor.face(&rear, iron);
            for i in 0..8 {
                let side =
                    [corner(i + 1, radius, back), corner(i, radius, back), corner(i, radius, front), corner(i + 1, radius, front)];
                self.sculptor.face(&side, iron);
            }
        }
        // The bar of the word on it.
        self.sculptor.block((0.0, 0.061), (0.22, 0.002), (2.17, 2.27), white);
    }

    /// Clipped: straight sides, a level top.
    fn hedge(&mut self) {
        let hue = GREENS[3];
        for (k, x) in [-0.75, -0.25, 0.25, 0.75].into_iter().enumerate() {
            let part = self.draw.part(k as u64);
            let leaves = self.paint(hue.scaled(part.between("shade", 0.9, 1.08)), Tile::Leaves);
            let (depth, top) = (0.33 + part.between("depth", -0.02, 0.02), 0.95 - part.between("top", 0.0, 0.03));
            self.sculptor.block((x, 0.0), (0.26, depth), (0.0, top), leaves);
        }
        let leaves = self.paint(hue.scaled(0.85), Tile::Leaves);
        self.sculptor.block((0.0, 0.0), (1.0, 0.27), (0.0, 0.9), leaves);
    }

    /// Square tub, flowers in two colours.
    fn planter(&mut self) {
        let (wood, iron) = (self.paint(TIMBER, Tile::Wood), self.paint(IRON, Tile::Metal));
        self.sculptor.block((0.0, 0.0), (0.42, 0.42), (0.0, 0.6), wood);
        for y in [0.14, 0.5] {
            self.sculptor.block((0.0, 0.0), (0.435, 0.435), (y, y + 0.03), iron);
        }
        let leaves = self.paint(GREENS[0], Tile::Leaves);
        self.sculptor.blob(self.ball, DVec3::new(0.0, 0.68, 0.0), DVec3::new(0.4, 0.26, 0.4), 0.2, self.draw.part(0), leaves);
        let first = self.draw.below("flowers", FLOWERS.len());
        for k in 0..2 {
            let part = self.draw.part(1 + k as u64);
            let flowers = self.paint(FLOWERS[(first + k) % FLOWERS.len()], Tile::Leaves);
            let middle = DVec3::new(part.between("x", -0.2, 0.2), 0.86, part.between("z", -0.2, 0.2));
            self.sculptor.blob(self.ball, middle, DVec3::new(0.24, 0.2, 0.24), 0.3, part, flowers);
        }
    }

    fn shrub(&mut self) {
        self.turned(5, &[(0.06, 0.0), (0.03, 0.4)], self.paint(BARK, Tile::Wood));
        let hue = self.draw.pick("leaves", &GREENS).copied().unwrap_or(GREENS[0]);
        for (k, (x, z, size)) in [(0.0, 0.0, 0.76), (0.5, 0.25, 0.5), (-0.4, 0.35, 0.46)].into_iter().enumerate() {
            let part = self.draw.part(k as u64);
            let size = size * part.between("size", 0.96, 1.04);
            let leaves = self.paint(hue.scaled(part.between("shade", 0.84, 1.08)), Tile::Leaves);
            self.sculptor.blob(self.ball, DVec3::new(x, size * 0.86, z), DVec3::new(size, size * 0.8, size), 0.2, part, leaves);
        }
    }
}

#[cfg(test)]
mod tests {
    use veduta_city::GridPos;

    use super::*;

    fn one(kind: ObjectKind, heading: u16, season: Season) -> MeshData {
        let height = GridPos::steps(nominal_m(kind));
        let object = ObjectShell { kind, pos: GridPos(2048, 1024), z: 1024, heading, height, monument: None };
        let shell = CellShell { origin: GridPos(2, 0), objects: vec![object], ..Default::default() };
        let mut mesh = objects(&shell);
        mesh.append(&trees(&shell, season));
        mesh
    }

    fn in_all_seasons() -> impl Iterator<Item = (ObjectKind, Season)> {
        ObjectKind::ALL.into_iter().flat_map(|kind| Season::ALL.map(|season| (kind, season)))
    }

    #[test]
    fn every_kind_has_its_height_and_stays_cheap() {
        for (kind, season) in in_all_seasons() {
            let mesh = one(kind, 30, season);
            mesh.validate().unwrap();
            assert!((50..=400).contains(&mesh.triangle_count()), "{kind:?} in {season:?}: {}", mesh.triangle_count());
            let top = mesh.positions.iter().map(|p| p[1]).fold(0.0, f32::max);
            let bottom = mesh.positions.iter().map(|p| p[1]).fold(9.0, f32::min);
            assert!((f64::from(top) - 1.0 - nominal_m(kind)).abs() < 0.1 * nominal_m(kind), "{kind:?}: {top}");
            assert!((bottom - 1.0).abs() < 1e-5, "{kind:?} stands on its foot: {bottom}");
            assert!(mesh.centres.iter().all(|c| *c == [2.0, -1.0]));
        }
    }

    #[test]
    fn normals_agree_with_the_way_triangles_turn() {
        for (kind, season) in in_all_seasons() {
            let mesh = one(kind, 200, season);
            for t in mesh.indices.chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| glam::Vec3::from_array(mesh.positions[i as usize]));
                let turn = (b - a).cross(c - a);
                let normal: glam::Vec3 = t.iter().map(|&i| glam::Vec3::from_array(mesh.normals[i as usize])).sum();
                assert!(turn.dot(normal) >= -1e-7, "{kind:?} at {a}: {turn} {normal}");
            }
            let volume: f32 = mesh
                .indices
                .chunks_exact(3)
                .map(|t| {
                    let [a, b, c] =
                        [t[0], t[1], t[2]].map(|i| glam::Vec3::from_array(mesh.positions[i as usize]) - glam::vec3(2.0, 1.0, -1.0));
                    a.cross(b).dot(c) / 6.0
                })
                .sum();
            assert!(volume > 0.0, "{kind:?} is inside out: {volume}");
        }
    }

    #[test]
    fn a_bench_looks_where_it_is_told_to() {
        // Its back is behind: looking east, the back rest lies in the west.
        let mesh = one(ObjectKind::Bench, 90, Season::Summer);
        let high = mesh.positions.iter().filter(|p| p[1] > 1.6).map(|p| p[0]).fold(0.0, f32::max);
        assert!(high < 2.0, "{high}");
    }

    #[test]
    fn only_lamps_shine() {
        let lamp = ObjectShell { kind: ObjectKind::Lamp, pos: GridPos(0, 1024), z: 0, heading: 0, height: 4301, monument: None };
        let [x, y, z] = lantern(&lamp).unwrap();
        assert!((x, z) == (0.0, -1.0) && (3.6..3.8).contains(&y));
        assert_eq!(lantern(&ObjectShell { kind: ObjectKind::Bin, ..lamp }), None);
    }
}
