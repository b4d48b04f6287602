//! The ground floor's other life: shop fronts and arcades.

use glam::Vec3;
use veduta_city::draw::Draw;
use veduta_city::{Opening, Tile};

use crate::bay::{BAY, MIDDLE};
use crate::canvas::{Canvas, Rect, Texel, disc, srgb};
use crate::hole::{Head, Hole, shade_recess};
use crate::letter;
use crate::moulding::{console, cornice, keystone, panel};
use crate::noise::{falloff, floor, hash, mix, smoothstep, word};
use crate::stone::{Sandstone, stone_ring};
use crate::timber::{Timber, boards};

/// Gold of letters.
const GOLD: u32 = 0x00C2_A158;

/// What a shop sells, and how it looks for that.
struct Trade {
    name: &'static str,
    /// Paint of its front.
    front: u32,
    /// Colours of its wares.
    wares: [u32; 6],
    shelves: u32,
    /// Wares side by side on a shelf.
    abreast: u32,
    /// Least and greatest height in shelves and half width in places.
    tall: (f32, f32),
    broad: (f32, f32),
}

const TRADES: [Trade; Tile::TRADES as usize] = [
    // Books.
    Trade {
        name: "NOV\u{c1}K",
        front: 0x002F_4A41,
        wares: [0x008A_5A44, 0x00B9_A27A, 0x0058_6B5E, 0x0070_4A52, 0x00C0_B59E, 0x004B_5A6B],
        shelves: 3,
        abreast: 15,
        tall: (0.45, 0.75),
        broad: (0.36, 0.48),
    },
    // Bread and cakes.
    Trade {
        name: "ROSSI",
        front: 0x006A_2E2A,
        wares: [0x00B5_7B3C, 0x00C9_9650, 0x008C_5428, 0x00D8_B878, 0x00A3_6430, 0x00E2_CFA4],
        shelves: 3,
        abreast: 7,
        tall: (0.22, 0.42),
        broad: (0.34, 0.46),
    },
    // Cloth and dresses.
    Trade {
        name: "KLEIN",
        front: 0x0026_3348,
        wares: [0x008E_2F3A, 0x0031_4A6B, 0x00C8_B48C, 0x003E_5A44, 0x006B_4468, 0x00D8_D2C4],
        shelves: 1,
        abreast: 6,
        tall: (0.5, 0.74),
        broad: (0.24, 0.38),
    },
    // Wine.
    Trade {
        name: "LEONI",
        front: 0x0038_2A22,
        wares: [0x002C_4630, 0x0036_2A22, 0x004A_5A34, 0x005C_2430, 0x0030_3C2C, 0x00A8_8A4A],
        shelves: 3,
        abreast: 13,
        tall: (0.6, 0.78),
        broad: (0.2, 0.28),
    },
    // China and glass.
    Trade {
        name: "WEISS",
        front: 0x0055_6159,
        wares: [0x00E2_E4E0, 0x00C4_D2DC, 0x00E8_E0D0, 0x008C_A6BC, 0x00D4_DCD8, 0x00B0_C8C4],
        shelves: 4,
        abreast: 9,
        tall: (0.3, 0.7),
        broad: (0.22, 0.42),
    },
    // Fruit and flowers.
    Trade {
        name: "MARTIN",
        front: 0x0074_5A34,
        wares: [0x00C4_4438, 0x00D8_9A34, 0x0062_8A3C, 0x00D8_C44C, 0x00B0_5C84, 0x004C_7434],
        shelves: 4,
        abreast: 12,
        tall: (0.4, 0.62),
        broad: (0.38, 0.48),
    },
];

/// Shop front of painted timber: stall riser, display window, fascia board under a cornice. The trade is one of [`Tile::TRADES`].
pub(crate) fn shop(canvas: &mut Canvas, draw: Draw, (trade, is_named): (u8, bool)) {
    let trade = &TRADES[usize::from(trade) % TRADES.len()];
    let front = Rect::standing(MIDDLE, 0.0, 2.5, 3.06);
    let timber = Timber::new(trade.front, draw, BAY);
    let paint = Texel::solid(srgb(trade.front), 0.52);
    canvas.cast(front, |x, y| front.distance(x, y), 0.09, 0.45);
    boards(canvas, front, |x, y| front.distance(x, y), &timber, 0.06);
    let window = Hole::of(Opening::Shop).rect;
    display(canvas, window, trade, draw);
    mullions(canvas, window, paint);
    for i in 0..3 {
        let field = Rect::standing(MIDDLE + (i as f32 - 1.0) * 0.7, 0.16, 0.58, 0.36);
        panel(canvas, field, 0.03, paint.times(0.95).at(0.06), 0.02);
    }
    canvas.slab(Rect::standing(MIDDLE, 0.58, 2.22, 0.08), paint.times(1.2).at(0.06), 0.06);
    canvas.shade(front, |_, y| 1.0 - 0.35 * falloff(y, 0.12));
    for side in [-1.0, 1.0] {
        let pilaster = Rect::standing(MIDDLE + side * 1.14, 0.0, 0.2, 2.46);
        canvas.slab(pilaster, paint.times(1.1).at(0.06), 0.03);
        panel(canvas, Rect::standing(MIDDLE + side * 1.14, 0.62, 0.1, 1.7), 0.02, paint.times(1.05).at(0.09), 0.012);
        canvas.slab(Rect::standing(MIDDLE + side * 1.14, 0.0, 0.24, 0.5), paint.times(0.9).at(0.06), 0.04);
    }
    fascia(canvas, paint, is_named.then_some(trade.name));
    for side in [-1.0, 1.0] {
        console(canvas, Rect::standing(MIDDLE + side * 1.14, 2.4, 0.19, 0.56), paint.times(1.25).at(0.08));
    }
    cornice(canvas, Rect::standing(MIDDLE, 2.94, 2.42, 0.14), 0.16, paint.times(1.2));
}

/// The fascia: a gilt line around a name, or around an ornament where there is none.
fn fascia(canvas: &mut Canvas, paint: Texel, name: Option<&str>) {
    let board = Rect::standing(MIDDLE, 2.46, 2.5, 0.48);
    canvas.slab(board, paint.times(0.9).at(0.06), 0.03);
    let gold = Texel::solid(srgb(GOLD) * 0.9, 0.42).at(0.095);
    let line = Rect::standing(MIDDLE, 2.53, 1.94, 0.34);
    canvas.paint(line, |x, y| line.distance(x, y).abs() - 0.008, |_, _| gold);
    let cy = (line.y0 + line.y1) / 2.0;
    if let Some(name) = name {
        return letter::write(canvas, name, (MIDDLE, cy - 0.105), 0.2, gold);
    }
    let lozenge = |half_x: f32, half_y: f32, x: f32, y: f32| {
        (((x - MIDDLE).abs() / half_x + (y - cy).abs() / half_y) - 1.0) * half_x.min(half_y)
    };
    let area = Rect::standing(MIDDLE, line.y0, 1.0, line.height());
    canvas.paint(area, |x, y| lozenge(0.42, 0.032, x, y).min(lozenge(0.085, 0.1, x, y)), |_, _| gold);
    canvas.paint(area, |x, y| lozenge(0.05, 0.06, x, y), |_, _| paint.times(1.1).at(0.095));
    for side in [-1.0, 1.0] {
        let at = MIDDLE + side * 0.19;
        canvas.paint(area, |x, y| disc(at, cy, 0.036, x, y).abs() - 0.009, |_, _| gold);
    }
}

/// What stands in the window: shelves with wares in lamplight, the street mirrored faintly over them.
fn display(canvas: &mut Canvas, window: Rect, trade: &Trade, draw: Draw) {
    let (dark, lamp, sky) = (srgb(0x002C_2A28), srgb(0x00A8_8A5C), srgb(0x0066_7480));
    let wares = trade.wares.map(srgb);
    let key = draw.bits("wares");
    let (shelves, abreast) = (trade.shelves as f32, trade.abreast as f32);
    canvas.paint_rect(window, |x, y| {
        let (u, v) = ((x - window.x0) / window.width(), (y - window.y0) / window.height());
        let glow = smoothstep(1.1, 0.3, v) * (0.25 + 0.75 * falloff((u - 0.5).abs(), 0.75));
        let mut colour: Vec3 = dark.lerp(lamp, 0.4 * glow);
        let up = v * (shelves + 0.2);
        let shelf = floor(up).min(trade.shelves as i32 - 1);
        let on_shelf = up - shelf as f32;
        let along = u * abreast + shelf as f32 * 0.37;
        let slot = floor(along);
        let bits = hash(key, slot, shelf);
        let (tall, broad) = (mix(trade.tall.0, trade.tall.1, word(bits, 0)), mix(trade.broad.0, trade.broad.1, word(bits, 1)));
        let off = (along - slot as f32 - 0.5).abs();
        if word(bits, 3) > 0.12 {
            let round = smoothstep(broad + 0.04, broad - 0.04, off) * smoothstep(tall + 0.04, tall - 0.04, on_shelf);
            let body = wares[(word(bits, 2) * wares.len() as f32) as usize] * (0.35 + 0.55 * glow) * (1.1 - 1.1 * off);
            colour = colour.lerp(body, round);
        }
        colour *= 1.0 - 0.5 * falloff(on_shelf, 0.06);
        let mirror = smoothstep(0.45 + 0.5 * (u - 0.5), 1.25, v) * 0.4;
        let edge = 0.4 * falloff(-window.distance(x, y), 0.05);
        Texel::solid(colour.lerp(sky, mirror) * (1.0 - edge), 0.13).at(-0.02)
    });
    shade_recess(canvas, &Hole::new(window, Head::Flat), 0.14, 0.5);
}

/// Slender posts and a transom of the display window.
fn mullions(canvas: &mut Canvas, window: Rect, paint: Texel) {
    for at in [0.335, 0.665] {
        canvas.slab(
            Rect::standing(mix(window.x0, window.x1, at), window.y0, 0.045, window.height()),
            paint.times(1.25).at(0.02),
            0.02,
        );
    }
    canvas.slab(Rect::new(window.x0, window.y1 - 0.42, window.x1, window.y1 - 0.37), paint.times(1.25).at(0.02), 0.02);
}

/// Arch of an arcade: stone piers and archivolt around the dark of the vaulted walk, with a door's glow at its back.
pub(crate) fn arcade(canvas: &mut Canvas, draw: Draw) {
    let stone = Sandstone::new(draw, BAY);
    let hole = Hole::of(Opening::Arcade);
    stone_ring(canvas, &hole, 0.3, (0.45, 13.0), 0.04, &stone);
    keystone(canvas, MIDDLE, hole.rect.y1 - 0.02, hole.rect.y1 + 0.34, 0.22, stone.texel(MIDDLE, 3.0, (9, 9)).times(1.08));
    vault(canvas, &hole);
    for side in [-1.0, 1.0] {
        let at = MIDDLE + side * 1.12;
        stone.block(canvas, Rect::standing(at, hole.springing() - 0.09, 0.36, 0.14), 1.1, 0.08);
        stone.block(canvas, Rect::standing(at, 0.0, 0.36, 0.5), 0.88, 0.07);
    }
}

/// The walk behind the arch: groins of the vault, a lit wall at the back with a shop's door, light falling on the floor.
fn vault(canvas: &mut Canvas, hole: &Hole) {
    let (deep, plaster, glow, floor_stone) = (srgb(0x0030_2C29), srgb(0x008A_7C66), srgb(0x00B0_8A56), srgb(0x0078_7266));
    let back = Hole::new(Rect::standing(MIDDLE + 0.06, 0.32, 1.2, 1.95), Head::Round);
    let door = Rect::standing(MIDDLE + 0.22, 0.32, 0.56, 1.25);
    let shape = |x: f32, y: f32| hole.distance(x, y);
    canvas.paint(hole.rect, shape, |x, y| {
        let from_back = back.distance(x, y).max(0.0);
        let inward = falloff(from_back, 0.75);
        // The right side of the passage catches more daylight than the left.
        let side = 0.8 + 0.35 * (x - MIDDLE);
        let mut colour = deep.lerp(plaster, (0.2 + 0.22 * (1.0 - inward)) * side);
        let groin = (from_back * 3.4 - floor(from_back * 3.4) as f32 - 0.5).abs();
        colour *= 1.0 - 0.22 * falloff(groin, 0.14) * f32::from(u8::from(y > back.springing()));
        if back.distance(x, y) < 0.0 {
            colour = deep.lerp(plaster, 0.36) * (0.75 + 0.25 * smoothstep(2.3, 0.6, y));
            let pane = smoothstep(0.02, -0.02, door.distance(x, y));
            let bars = 1.0 - 0.6 * falloff(((x - door.cx()).abs()).min((y - 1.2).abs()), 0.03);
            colour = colour.lerp(glow * (0.5 * bars), pane);
            colour += glow * (0.12 * falloff(door.distance(x, y), 0.45));
        }
        let ground = (0.32 - y).max(0.0) / 0.32;
        if y < 0.32 + 0.1 * from_back.min(0.0) {
            colour = colour.lerp(floor_stone, 0.3 + 0.4 * ground);
        }
        Texel::solid(colour, 0.9).at(-0.13 + 0.05 * from_back.min(0.5))
    });
    shade_recess(canvas, hole, 0.34, 0.6);
}
