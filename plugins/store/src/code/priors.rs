use std::sync::LazyLock;

use serde::{Deserialize, Serialize};

use super::models::{Column, Models};
use super::range::Chance;

/// What is known of a structure before any of it is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Prior {
    /// Nothing.
    None,
    /// A packet of level 1.
    Shell,
    /// A packet of level 2.
    Sheet,
    /// An overview.
    Overview,
    /// A region of the index.
    Region,
    /// The houses of a region.
    Houses,
}

impl Prior {
    pub(crate) fn models(self) -> Models<Chance> {
        match self {
            Self::None => Models::default(),
            Self::Shell => Models::after(&PRIORS.shell),
            Self::Sheet => Models::after(&PRIORS.sheet),
            Self::Overview => Models::after(&PRIORS.overview),
            Self::Region => Models::after(&PRIORS.region),
            Self::Houses => Models::after(&PRIORS.houses),
        }
    }
}

/// Made by `train`; part of the format.
static PRIORS: LazyLock<Priors> = LazyLock::new(|| Priors::read(include_bytes!("priors.bin")));

#[derive(Default)]
struct Priors {
    shell: Vec<Column<Chance>>,
    sheet: Vec<Column<Chance>>,
    overview: Vec<Column<Chance>>,
    region: Vec<Column<Chance>>,
    houses: Vec<Column<Chance>>,
}

impl Priors {
    /// No bytes: nothing is known yet.
    fn read(bytes: &[u8]) -> Self {
        if bytes.is_empty() {
            return Self::default();
        }
        match super::unpress::<[WirePrior; 5]>("the priors", bytes, Prior::None, 1 << 20) {
            Ok(priors) => {
                let [shell, sheet, overview, region, houses] = priors.map(WirePrior::columns);
                Self { shell, sheet, overview, region, houses }
            }
            // They are part of the program.
            Err(error) => unreachable!("{error}"),
        }
    }
}

/// Chances of all columns, coarsely.
#[derive(Serialize, Deserialize)]
pub(super) struct WirePrior(pub(super) Vec<WireColumn>);

#[derive(Serialize, Deserialize)]
pub(super) struct WireColumn {
    pub(super) children: Vec<u32>,
    pub(super) slots: Vec<WireSlot>,
    pub(super) letters: Vec<WireSlot>,
}

/// How many slots before it nothing is known of; its chance, signed by what is likelier; how much evidence it stands for.
#[derive(Serialize, Deserialize)]
pub(super) struct WireSlot(pub(super) u16, i8, u8);

/// Chances of the likelier bit, evenly apart by the logarithm of what one bets on it; in 1/2^16.
const STEPS: [u16; 32] = [
    34405, 37647, 40793, 43790, 46593, 49169, 51500, 53581, 55413, 57009, 58386, 59564, 60565, 61409, 62118, 62711, 63205, 63615,
    63955, 64236, 64468, 64659, 64816, 64945, 65052, 65139, 65210, 65269, 65317, 65357, 65389, 65416,
];
/// How much evidence a prior may stand for.
const SEEN: [u8; 6] = [0, 2, 5, 12, 30, 90];

impl WireSlot {
    /// Those that come near a chance of a zero, in 1/2^16.
    #[cfg(test)]
    pub(super) fn near(zero: u16) -> impl Iterator<Item = Self> {
        let step = |zero: u16| STEPS.partition_point(|&step| step < zero).min(STEPS.len() - 1) as i8;
        let nearest = if zero >= 1 << 15 { step(zero) } else { !step(u16::MAX - zero) };
        let steps = (nearest - 1..=nearest + 1).filter(|step| (-32..32).contains(step));
        steps.flat_map(|step| (0..SEEN.len() as u8).map(move |seen| Self(0, step, seen)))
    }

    pub(super) fn chance(&self) -> Chance {
        // -1 is the first below even, 0 the first above.
        let (step, is_zero) = if self.1 < 0 { (!self.1, false) } else { (self.1, true) };
        let chance = STEPS[usize::from(step.unsigned_abs()).min(STEPS.len() - 1)];
        let seen = SEEN[usize::from(self.2).min(SEEN.len() - 1)];
        Chance::new(if is_zero { chance } else { u16::MAX - chance }, seen)
    }
}

impl WireColumn {
    fn chances(of: &[WireSlot], size: usize) -> Vec<Chance> {
        if of.is_empty() {
            return Vec::new();
        }
        let mut slots = vec![Chance::EVEN; size];
        let mut at = 0;
        for slot in of {
            at += usize::from(slot.0);
            if let Some(place) = slots.get_mut(at) {
                *place = slot.chance();
            }
            at += 1;
        }
        slots
    }
}

impl WirePrior {
    pub(super) fn columns(self) -> Vec<Column<Chance>> {
        let column = |column: WireColumn| {
            let slots = WireColumn::chances(&column.slots, Column::<Chance>::SLOTS);
            let letters = WireColumn::chances(&column.letters, Column::<Chance>::LETTERS);
            Column::known(column.children, slots, letters)
        };
        self.0.into_iter().map(column).collect()
    }
}
