use serde::{Deserialize, Serialize};

use crate::tree::TreeCard;
use crate::{ObjectKind, Opening, Rgb, RoofShape, SurfaceKind};

/// A small texture of the workshop: one layer of the texture array that walls, roofs and ground are drawn with. Meshes name
/// it by [`Tile::index`], the workshop paints it, the material samples it.
///
/// A tile's colour is multiplied by the vertex colour where its alpha is 1 (plaster, roof covering), and stands as it is
/// where its alpha is 0 (glass, timber).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Tile {
    /// Bare plaster wall.
    Plaster,
    /// One bay of one storey with its opening; never `Opening::Blank`, which is [`Tile::Plaster`].
    Bay(Opening),
    /// Roof of clay tiles.
    RoofTile,
    /// Roof of slate.
    Slate,
    /// Sheet-metal or copper roof.
    Metal,
    /// Ground.
    Ground(SurfaceKind),
    /// Dressed stone: plinths, monuments, fountains.
    Stone,
    /// Timber.
    Wood,
    /// Foliage.
    Leaves,
    /// Stone without joints: columns, mouldings, statues, tracery.
    Carved,
    /// Leaded glass: church windows.
    Glass,
    /// Opal panes of a lamp, which glow at night.
    Lantern,
    /// A tree in leaf as it is seen from afar, on a card: see [`TreeCard`](crate::tree::TreeCard). The kind is one of
    /// [`ObjectKind::TREES`].
    LeafyTree(ObjectKind),
    /// A tree without leaves on a card, of a kind that sheds them.
    BareTree(ObjectKind),
    /// A bay like `Bay(Opening::Shop)`, 1 to [`Tile::SHOPS`] − 1: see [`Tile::of_shop`].
    Shop(u8),
}

/// Openings in the order of their layers.
const OPENINGS: [Opening; 16] = [
    Opening::Window,
    Opening::FramedWindow,
    Opening::CorniceWindow,
    Opening::PedimentWindow,
    Opening::ArchedWindow,
    Opening::LancetWindow,
    Opening::AtticWindow,
    Opening::WideWindow,
    Opening::Slit,
    Opening::Portal,
    Opening::Door,
    Opening::Shop,
    Opening::Arcade,
    Opening::Gate,
    Opening::Clock,
    Opening::Belfry,
];

/// Surfaces in the order of their layers.
const SURFACES: [SurfaceKind; 9] = [
    SurfaceKind::Asphalt,
    SurfaceKind::Cobbles,
    SurfaceKind::Mosaic,
    SurfaceKind::Flagstones,
    SurfaceKind::Gravel,
    SurfaceKind::Grass,
    SurfaceKind::Yard,
    SurfaceKind::Water,
    SurfaceKind::Ballast,
];

/// Trees that shed their leaves, in the order of their layers.
const BARE: [ObjectKind; 5] = [ObjectKind::Tree, ObjectKind::Poplar, ObjectKind::Birch, ObjectKind::Willow, ObjectKind::FruitTree];

impl Tile {
    /// Number of layers.
    pub const COUNT: usize =
        1 + OPENINGS.len() + 3 + SURFACES.len() + 6 + ObjectKind::TREES.len() + BARE.len() + Self::SHOPS as usize - 1;

    /// Number of trades that shops are painted for: each with its wares, its name and the colour of its front.
    pub const TRADES: u8 = 6;

    /// Number of bays of shops: of every trade one with its name over it and one without.
    pub const SHOPS: u8 = 2 * Self::TRADES;

    /// A shop's bay, of a trade from 0 to [`Tile::TRADES`] − 1; beyond, those again.
    #[must_use]
    pub const fn of_shop(trade: u8, is_named: bool) -> Self {
        match trade % Self::TRADES * 2 + is_named as u8 {
            0 => Self::Bay(Opening::Shop),
            other => Self::Shop(other),
        }
    }

    /// Trade of a shop's bay, and whether its name stands over it.
    #[must_use]
    pub const fn shop(self) -> Option<(u8, bool)> {
        match self {
            Self::Bay(Opening::Shop) => Some((0, false)),
            Self::Shop(bay) => Some((bay / 2, bay % 2 == 1)),
            _ => None,
        }
    }

    /// The opening that it shows in a bay of one storey.
    #[must_use]
    pub const fn opening(self) -> Option<Opening> {
        match self {
            Self::Bay(opening) => Some(opening),
            Self::Shop(_) => Some(Opening::Shop),
            _ => None,
        }
    }

    /// The card of a kind of tree, in leaf or bare.
    #[must_use]
    pub const fn of_tree(kind: ObjectKind, is_bare: bool) -> Self {
        if is_bare { Self::BareTree(kind) } else { Self::LeafyTree(kind) }
    }

    /// Whether it is a picture that does not fill its tile: what its normal picture's alpha leaves out is not drawn.
    #[must_use]
    pub const fn is_card(self) -> bool {
        matches!(self, Self::LeafyTree(_) | Self::BareTree(_))
    }

    /// The tile of an opening.
    #[must_use]
    pub const fn of_opening(opening: Opening) -> Self {
        match opening {
            Opening::Blank => Self::Plaster,
            other => Self::Bay(other),
        }
    }

    /// The covering of a roof: slate where the colour is bluish or grey and dark, metal on domes or where it is greenish,
    /// clay tiles otherwise.
    #[must_use]
    pub const fn of_roof(shape: RoofShape, colour: Rgb) -> Self {
        let Rgb(r, g, b) = colour;
        if matches!(shape, RoofShape::Dome | RoofShape::Onion | RoofShape::Flat) || g > r && g >= b {
            Self::Metal
        } else if b >= r || (r < 0x70 && r as i16 - (b as i16) < 24) {
            Self::Slate
        } else {
            Self::RoofTile
        }
    }

    /// The stuff an object is made of, for the larger part.
    #[must_use]
    pub const fn of_object(kind: ObjectKind) -> Self {
        match kind {
            ObjectKind::Tree
            | ObjectKind::Conifer
            | ObjectKind::Poplar
            | ObjectKind::Birch
            | ObjectKind::Willow
            | ObjectKind::FruitTree
            | ObjectKind::Palm
            | ObjectKind::Hedge
            | ObjectKind::Shrub => Self::Leaves,
            ObjectKind::Bench | ObjectKind::Kiosk | ObjectKind::Planter => Self::Wood,
            ObjectKind::Fountain | ObjectKind::Statue | ObjectKind::Well | ObjectKind::Bollard => Self::Stone,
            ObjectKind::Lamp
            | ObjectKind::TramStop
            | ObjectKind::Column
            | ObjectKind::Bin
            | ObjectKind::Signals
            | ObjectKind::Sign => Self::Metal,
            ObjectKind::Parasol => Self::Plaster,
        }
    }

    /// Layer in the texture array, 0 to [`Tile::COUNT`] − 1.
    #[must_use]
    pub fn index(self) -> usize {
        let position = |found: Option<usize>| found.unwrap_or(0);
        let (walls, roofs) = (1, 1 + OPENINGS.len());
        let grounds = roofs + 3;
        let stuffs = grounds + SURFACES.len();
        match self {
            Self::Plaster | Self::Bay(Opening::Blank) => 0,
            Self::Bay(opening) => walls + position(OPENINGS.iter().position(|&o| o == opening)),
            Self::RoofTile => roofs,
            Self::Slate => roofs + 1,
            Self::Metal => roofs + 2,
            Self::Ground(surface) => grounds + position(SURFACES.iter().position(|&s| s == surface)),
            Self::Stone => stuffs,
            Self::Wood => stuffs + 1,
            Self::Leaves => stuffs + 2,
            Self::Carved => stuffs + 3,
            Self::Glass => stuffs + 4,
            Self::Lantern => stuffs + 5,
            Self::LeafyTree(kind) => stuffs + 6 + position(ObjectKind::TREES.iter().position(|&k| k == kind)),
            Self::BareTree(kind) => stuffs + 6 + ObjectKind::TREES.len() + position(BARE.iter().position(|&k| k == kind)),
            Self::Shop(bay) => Self::COUNT - usize::from(Self::SHOPS - bay.clamp(1, Self::SHOPS - 1)),
        }
    }

    /// All tiles in the order of their layers.
    pub fn all() -> impl Iterator<Item = Self> {
        core::iter::once(Self::Plaster)
            .chain(OPENINGS.map(Self::Bay))
            .chain([Self::RoofTile, Self::Slate, Self::Metal])
            .chain(SURFACES.map(Self::Ground))
            .chain([Self::Stone, Self::Wood, Self::Leaves, Self::Carved, Self::Glass, Self::Lantern])
            .chain(ObjectKind::TREES.map(Self::LeafyTree))
            .chain(BARE.map(Self::BareTree))
            .chain((1..Self::SHOPS).map(Self::Shop))
    }

    /// Width and height in metres that one repeat of the tile covers. Bays are stretched to their wall's grid instead, and cards
    /// to their tree; for them it is the size they are painted for.
    #[must_use]
    pub const fn size_m(self) -> (f32, f32) {
        match self {
            Self::Bay(_) | Self::Shop(_) => (2.8, 3.4),
            Self::Plaster => (4.0, 4.0),
            Self::RoofTile | Self::Slate | Self::Metal | Self::Stone | Self::Wood | Self::Leaves | Self::Carved => (2.0, 2.0),
            Self::Glass => (1.2, 1.2),
            Self::Lantern => (0.5, 0.5),
            Self::Ground(SurfaceKind::Cobbles | SurfaceKind::Mosaic) => (1.6, 1.6),
            Self::Ground(SurfaceKind::Water) => (8.0, 8.0),
            Self::Ground(_) => (3.2, 3.2),
            Self::LeafyTree(kind) | Self::BareTree(kind) => {
                let card = TreeCard::of(kind);
                (4.0 * card.half_m as f32, card.height_m as f32)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_tile_has_its_own_layer_in_order() {
        let layers: Vec<usize> = Tile::all().map(Tile::index).collect();
        assert_eq!(layers, (0..Tile::COUNT).collect::<Vec<_>>());
    }

    #[test]
    fn every_trade_has_a_bay_with_its_name_and_one_without() {
        for (trade, is_named) in (0..Tile::TRADES).flat_map(|trade| [(trade, false), (trade, true)]) {
            let tile = Tile::of_shop(trade, is_named);
            assert_eq!((tile.shop(), tile.opening()), (Some((trade, is_named)), Some(Opening::Shop)));
            assert!(Tile::all().any(|other| other == tile), "{tile:?}");
        }
    }

    #[test]
    fn every_kind_of_tree_has_its_cards() {
        let of = |keep: fn(ObjectKind) -> bool| ObjectKind::ALL.into_iter().filter(move |&kind| keep(kind));
        let sorted = |kinds: &[ObjectKind]| std::collections::BTreeSet::from_iter(kinds.iter().copied().map(|kind| kind as u8));
        assert_eq!(sorted(&ObjectKind::TREES), of(ObjectKind::is_tree).map(|kind| kind as u8).collect());
        assert_eq!(sorted(&BARE), of(crate::tree::sheds).map(|kind| kind as u8).collect());
    }

    #[test]
    fn roofs_of_prague_get_their_covering() {
        assert_eq!(Tile::of_roof(RoofShape::Gabled, Rgb(0xA2, 0x4B, 0x33)), Tile::RoofTile);
        assert_eq!(Tile::of_roof(RoofShape::Pyramidal, Rgb(0x4A, 0x4F, 0x55)), Tile::Slate);
        assert_eq!(Tile::of_roof(RoofShape::Dome, Rgb(0x6F, 0x9B, 0x86)), Tile::Metal);
    }
}
