//! What the rest of Veduta relies on, through the public API.

use std::hash::{DefaultHasher, Hash, Hasher};

use block_compression::CompressionVariant;
use block_compression::decode::decompress_blocks_as_rgba8;
use veduta_city::{ObjectKind, Opening, Rgb, Tile};
use veduta_texture::{MODULATION_UNIT, NEUTRAL_BYTE, Workshop, paint_tile, paint_tiles, paintable_size, unpacked};

const SIZE: usize = 128;

fn hash(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    bytes.hash(&mut hasher);
    hasher.finish()
}

fn linear([r, g, b, _]: [u8; 4]) -> [f32; 3] {
    Rgb(r, g, b).to_linear()
}

/// Mean difference of the bytes of two lines of pixels.
fn difference(a: &[[u8; 4]], b: &[[u8; 4]]) -> f32 {
    let sum: u32 = a.iter().zip(b).flat_map(|(p, q)| p.iter().zip(q)).map(|(&p, &q)| u32::from(p.abs_diff(q))).sum();
    sum as f32 / (a.len() * 4) as f32
}

fn row(pixels: &[[u8; 4]], y: usize) -> Vec<[u8; 4]> {
    pixels[y * SIZE..(y + 1) * SIZE].to_vec()
}

fn column(pixels: &[[u8; 4]], x: usize) -> Vec<[u8; 4]> {
    pixels.iter().skip(x).step_by(SIZE).copied().collect()
}

/// Whether an opening stands on the lower edge of its bay.
fn stands_on_the_ground(tile: Tile) -> bool {
    use Opening::{Arcade, Door, Gate, Portal, Shop};
    matches!(tile.opening(), Some(Arcade | Door | Gate | Portal | Shop))
}

#[test]
fn the_same_seed_paints_the_same_bytes_and_another_seed_others() {
    let (first, again, other) = (paint_tiles(64, 7), paint_tiles(64, 7), paint_tiles(64, 8));
    assert_eq!(hash(&first.colour), hash(&again.colour));
    assert_eq!(hash(&first.normal), hash(&again.normal));
    assert_ne!(hash(&first.colour), hash(&other.colour));
}

#[test]
fn mip_chains_fill_the_array_to_the_byte() {
    for size in [32, 64, 128] {
        let tiles = paint_tiles(size, 1);
        assert_eq!((tiles.size, tiles.layers as usize, tiles.mips), (size, Tile::COUNT, size.ilog2() + 1));
        let texels: u32 = (0..tiles.mips).map(|m| (size >> m) * (size >> m)).sum();
        assert_eq!(tiles.colour.len(), (texels * 4 * tiles.layers) as usize);
        assert_eq!(tiles.normal.len(), tiles.colour.len());
        assert_eq!(tiles.colour_of(tiles.layers - 1, tiles.mips - 1).map(<[u8]>::len), Some(4));
        assert_eq!((tiles.colour_of(tiles.layers, 0), tiles.normal_of(0, tiles.mips)), (None, None));
    }
}

#[test]
fn one_tile_is_the_layer_of_the_array() {
    let tiles = paint_tiles(64, 5);
    let cards = [Tile::LeafyTree(ObjectKind::Palm), Tile::BareTree(ObjectKind::Birch)];
    for tile in [Tile::Plaster, Tile::Bay(Opening::Portal), Tile::Leaves].into_iter().chain(cards) {
        let (colour, normal) = paint_tile(tile, 64, 5);
        assert_eq!(tiles.colour_of(tile.index() as u32, 0), Some(colour.concat().as_slice()), "{tile:?}");
        assert_eq!(tiles.normal_of(tile.index() as u32, 0), Some(normal.concat().as_slice()), "{tile:?}");
    }
}

#[test]
fn odd_sizes_are_rounded_to_what_can_be_painted() {
    for (asked, painted) in [(0, 32), (33, 32), (100, 128), (95, 64), (256, 256), (1024, 1024), (u32::MAX, 1024)] {
        assert_eq!(paintable_size(asked), painted, "{asked}");
    }
    assert_eq!(paint_tiles(40, 1).size, 32);
}

#[test]
fn plaster_and_bays_borders_keep_the_walls_colour_on_the_whole() {
    let mean = |pixels: &[[u8; 4]]| {
        let sum: f32 = pixels.iter().flat_map(|&p| linear(p)).sum();
        sum / (pixels.len() * 3) as f32 / MODULATION_UNIT
    };
    let (plaster, _) = paint_tile(Tile::Plaster, SIZE as u32, 7);
    assert!(plaster.iter().all(|p| p[3] == 255), "plaster is the wall's colour throughout");
    assert!((mean(&plaster) - 1.0).abs() < 0.05, "plaster's mean modulation is {}", mean(&plaster));
    let (bay, _) = paint_tile(Tile::Bay(Opening::Window), SIZE as u32, 7);
    let border = [row(&bay, 0), row(&bay, SIZE - 1), column(&bay, 0), column(&bay, SIZE - 1)].concat();
    assert!((mean(&border) - mean(&plaster)).abs() < 0.04, "a bay's border is {} of the wall", mean(&border));
    assert!((linear([NEUTRAL_BYTE; 4])[0] - MODULATION_UNIT).abs() < 0.003);
}

#[test]
fn bays_meet_in_the_same_plaster() {
    let wall = paint_tile(Tile::Bay(Opening::Window), SIZE as u32, 7);
    for tile in Tile::all().filter(|t| t.opening().is_some()) {
        let bay = paint_tile(tile, SIZE as u32, 7);
        for (what, mine, theirs) in [("colour", &bay.0, &wall.0), ("normal", &bay.1, &wall.1)] {
            for x in [0, SIZE - 1] {
                assert!(column(mine, x) == column(theirs, x), "{what} of {tile:?} differs in column {x}");
            }
            if !stands_on_the_ground(tile) || what == "colour" {
                assert!(row(mine, 0) == row(theirs, 0), "{what} of {tile:?} differs at the top");
            }
            if !stands_on_the_ground(tile) {
                assert!(row(mine, SIZE - 1) == row(theirs, SIZE - 1), "{what} of {tile:?} differs at the foot");
            }
        }
    }
}

#[test]
fn surfaces_repeat_without_a_seam() {
    for tile in Tile::all().filter(|t| t.opening().is_none() && !t.is_card()) {
        let (colour, normal) = paint_tile(tile, SIZE as u32, 7);
        for (what, pixels) in [("colour", &colour), ("normal", &normal)] {
            let columns: Vec<f32> = (1..SIZE).map(|x| difference(&column(pixels, x - 1), &column(pixels, x))).collect();
            let rows: Vec<f32> = (1..SIZE).map(|y| difference(&row(pixels, y - 1), &row(pixels, y))).collect();
            let across = difference(&column(pixels, SIZE - 1), &column(pixels, 0));
            let down = difference(&row(pixels, SIZE - 1), &row(pixels, 0));
            for (way, inside, seam) in [("across", columns, across), ("down", rows, down)] {
                let most = inside.iter().copied().fold(0.0, f32::max);
                assert!(seam <= most * 1.1 + 0.5, "{what} of {tile:?} {way}: {seam} at the seam, at most {most} inside");
            }
        }
    }
}

#[test]
fn nothing_is_pure_black_or_white_and_surfaces_face_outwards() {
    for tile in Tile::all() {
        let (colour, normal) = paint_tile(tile, 64, 7);
        assert!(colour.iter().all(|p| p[..3].iter().all(|c| (8..=247).contains(c))), "{tile:?}");
        for n in normal {
            let ([x, y, z], rough) = unpacked(tile, n);
            assert!(x.hypot(y) < 1.01, "{tile:?}: {n:?}");
            if !tile.is_card() {
                assert!(z > 0.4, "{tile:?}: {n:?}");
                assert!(rough > 0.04, "{tile:?} is a mirror");
            }
        }
    }
}

#[test]
fn openings_show_glass_or_timber_and_ground_its_own_colour() {
    for tile in Tile::all() {
        let (colour, _) = paint_tile(tile, 64, 7);
        let own = colour.iter().filter(|p| p[3] < 64).count() as f32 / colour.len() as f32;
        match tile {
            Tile::Bay(Opening::Slit) => assert!(own > 0.005, "{tile:?}: {own}"),
            Tile::Bay(_) | Tile::Shop(_) => assert!((0.04..0.8).contains(&own), "{tile:?}: {own}"),
            Tile::Ground(_) => assert_eq!(own, 1.0, "{tile:?}"),
            _ if tile.is_card() => {}
            _ => assert!(own < 0.1, "{tile:?}: {own}"),
        }
    }
}

#[test]
fn coverings_are_on_the_whole_as_bright_as_their_vertex_colour() {
    let wall = 0.2;
    let tiles = paint_tiles(64, 7);
    for tile in [Tile::RoofTile, Tile::Slate, Tile::Metal, Tile::Stone, Tile::Wood, Tile::Leaves, Tile::Carved, Tile::Glass] {
        let Some(&[r, g, b, a]) = tiles.colour_of(tile.index() as u32, tiles.mips - 1) else {
            panic!("{tile:?} has no last mip");
        };
        let share = f32::from(a) / 255.0;
        let seen = linear([r, g, b, a]).map(|c| c * (1.0 - share) + c / MODULATION_UNIT * wall * share);
        let by = seen.iter().sum::<f32>() / 3.0 / wall;
        assert!((0.65..1.15).contains(&by), "{tile:?} shows {by} times its colour");
    }
}

/// Where the normal picture of a card says that it is drawn, by row and column.
fn drawn(normal: &[[u8; 4]], side: usize) -> Vec<(usize, usize)> {
    let drawn = normal.iter().enumerate().filter(|(_, n)| n[3] >= 128);
    drawn.map(|(i, _)| (i / side, i % side)).collect()
}

#[test]
fn cards_show_a_tree_from_three_sides_and_nothing_between() {
    for (seed, tile) in
        [1, 7, 8].into_iter().flat_map(|seed| Tile::all().filter(|tile| tile.is_card()).map(move |tile| (seed, tile)))
    {
        let (_, normal) = paint_tile(tile, SIZE as u32, seed);
        let half = SIZE / 2;
        for (what, columns, rows, least) in [
            ("front", 0..half, 0..SIZE, (SIZE / 5, SIZE * 4 / 5)),
            ("above", half..SIZE, 0..half, (SIZE / 5, SIZE / 5)),
            ("half above", half..SIZE, half..SIZE, (SIZE / 5, SIZE / 4)),
        ] {
            let part: Vec<_> = drawn(&normal, SIZE).into_iter().filter(|(y, x)| rows.contains(y) && columns.contains(x)).collect();
            let ends = |of: fn(&(usize, usize)) -> usize| {
                let all = part.iter().map(of);
                (all.clone().min().expect("something"), all.max().expect("something"))
            };
            let ((top, foot), (left, right)) = (ends(|p| p.0), ends(|p| p.1));
            assert!(right - left > least.0 && foot - top > least.1, "{what} of {tile:?}: {left}..{right}, {top}..{foot}");
            let is_free = left > columns.start && right + 1 < columns.end && top > rows.start && foot + 1 < rows.end;
            assert!(is_free, "{what} of {tile:?} reaches the edge: {left}..{right}, {top}..{foot}");
            assert!(what != "front" || foot + 2 == SIZE, "{tile:?} stands on its foot, in row {foot}");
        }
    }
}

#[test]
fn a_card_keeps_its_cover_and_its_trunk_as_it_grows_smaller() {
    let tiles = paint_tiles(SIZE as u32, 7);
    for tile in Tile::all().filter(|tile| tile.is_card()) {
        let cover = |mip: u32| -> Vec<f32> {
            let normal = tiles.normal_of(tile.index() as u32, mip).expect("a mip");
            normal.chunks_exact(4).map(|n| f32::from(n[3]) / 255.0).collect()
        };
        let mean = |mip: u32| cover(mip).iter().sum::<f32>() / cover(mip).len() as f32;
        for mip in 1..tiles.mips {
            assert!((0.95..1.35).contains(&(mean(mip) / mean(0))), "{tile:?} at mip {mip}: {} of {}", mean(mip), mean(0));
        }
        for mip in 1..4 {
            // Below the crown.
            let (side, cover) = (SIZE >> mip, cover(mip));
            let row = side - side / 8;
            assert!(cover[row * side..row * side + side / 2].iter().any(|&c| c > 0.9), "the trunk of {tile:?} at mip {mip}");
        }
    }
}

#[test]
fn leaves_on_cards_are_tinted_and_their_trunks_are_not() {
    let (leafy, normal) = paint_tile(Tile::LeafyTree(ObjectKind::Birch), SIZE as u32, 7);
    let at = |row: usize| -> Vec<u8> {
        drawn(&normal, SIZE).into_iter().filter(|&(y, x)| y == row && x < SIZE / 2).map(|(y, x)| leafy[y * SIZE + x][3]).collect()
    };
    assert!(!at(SIZE / 2).is_empty() && at(SIZE / 2).iter().all(|&share| share > 200));
    assert!(!at(SIZE - SIZE / 16).is_empty() && at(SIZE - SIZE / 16).iter().all(|&share| share < 50));
}

/// What a surface looks like, side by side with its plain texels: its colour, and its normal and roughness, as 8-bit RGB.
fn seen(tile: Tile, colour: &[u8], normal: &[u8]) -> [Vec<u8>; 2] {
    let texels = |bytes: &[u8]| -> Vec<[u8; 4]> { bytes.chunks_exact(4).map(|t| [t[0], t[1], t[2], t[3]]).collect() };
    let wall = linear([0xD9, 0xB3, 0x6C, 0]);
    let lit = |texel: [u8; 4]| -> [u8; 3] {
        let (share, own) = (f32::from(texel[3]) / 255.0, linear(texel));
        core::array::from_fn(|i| {
            let light = own[i] * (1.0 - share) + own[i] / MODULATION_UNIT * wall[i] * share;
            (light.clamp(0.0, 1.0).powf(1.0 / 2.2) * 255.0) as u8
        })
    };
    let shade = |texel: [u8; 4]| -> [u8; 3] {
        let ([x, y, z], other) = unpacked(tile, texel);
        let light = (-0.45 * x + 0.55 * y + 0.70 * z).max(0.0);
        [(light * 255.0) as u8, (light * 255.0) as u8, (other * 255.0) as u8]
    };
    [texels(colour).into_iter().flat_map(lit).collect(), texels(normal).into_iter().flat_map(shade).collect()]
}

#[test]
fn blocks_look_like_what_was_painted_at_a_quarter_of_the_bytes() {
    let (size, workshop) = (256, Workshop::new(256, 7));
    let mut worst = [(0.0, Tile::Plaster); 2];
    for tile in Tile::all() {
        let layer = workshop.paint(tile);
        let blocks = layer.in_blocks();
        // A byte a texel; but mips of one texel and of four take a block each.
        assert_eq!(blocks.colour.len(), layer.colour.len() / 4 - (1 + 4) + 2 * 16, "{tile:?}");
        assert_eq!(blocks.normal.len(), blocks.colour.len());
        let [colour, normal] = [&blocks.colour, &blocks.normal].map(|blocks| {
            let mut texels = vec![0; (size * size * 4) as usize];
            decompress_blocks_as_rgba8(CompressionVariant::BC3, size, size, &blocks[..(size * size) as usize], &mut texels);
            texels
        });
        let mip = (size * size * 4) as usize;
        let painted = seen(tile, &layer.colour[..mip], &layer.normal[..mip]);
        for (worst, (painted, shown)) in worst.iter_mut().zip(painted.iter().zip(&seen(tile, &colour, &normal))) {
            let image = |bytes: &[u8]| nv_flip::FlipImageRgb8::with_data(size, size, bytes);
            let map = nv_flip::flip(image(painted), image(shown), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
            let mean = nv_flip::FlipPool::from_image(&map).mean();
            if mean > worst.0 {
                *worst = (mean, tile);
            }
        }
    }
    let [(colour, of), (normal, other)] = worst;
    assert!(colour < 0.075, "the colour of {of:?} differs by {colour}");
    // Relief is lit alone here, without the colours that hide most of what it lacks.
    assert!(normal < 0.12, "the relief of {other:?} differs by {normal}");
}
