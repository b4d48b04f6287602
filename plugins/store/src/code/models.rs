//! What is known of each column of numbers.

use super::mix::VIEWS;
use super::range::Bits;

/// Slots for how many binary digits a number has, up to this one fewer; then a longer tree.
const SHORT: usize = 16;
/// By the number before in the column, and by the one before in the row.
const BEFORE: usize = 8;
const BESIDE: usize = 4;
const LONG: usize = BEFORE * BESIDE * SHORT;
const TOP: usize = LONG + 64;
/// Digits below the highest that are learned together.
const TOGETHER: u32 = 3;
const LOWER: usize = TOP + 32 * 8;
const SIGN: usize = LOWER + 32;
const FLAG: usize = SIGN + 32;
const AGAIN: usize = FLAG + 4 * BESIDE;
const OFF: usize = AGAIN + RUNS;
/// By exactly how many digits the number before in the column had, and the one before in the row.
const FINE_BEFORE: usize = OFF + REST as usize;
const FINE_BESIDE: usize = FINE_BEFORE + SHORT * SHORT;
const SLOTS: usize = FINE_BESIDE + 2 * SHORT * SHORT;
/// A number of steps of the grid lies so close about a whole centimetre.
const REST: i64 = 16;
/// How many hits in a row are told apart.
const RUNS: usize = 12;
/// Slots of a letter: by the one before it.
const LETTERS: usize = 32 * 256;

/// Numbers of one kind.
#[derive(Debug, Clone)]
pub(crate) struct Column<S> {
    pub(super) children: Vec<u32>,
    /// How large the last number was, and the one before it; the last two flags.
    pub(super) before: u8,
    pub(super) earlier: u8,
    pub(super) digits: u8,
    pub(super) flags: u8,
    pub(super) slots: Vec<S>,
    pub(super) letters: Vec<S>,
}

impl<S> Column<S> {
    /// How many slots one has, and how many for letters.
    pub(super) const SLOTS: usize = SLOTS;
    pub(super) const LETTERS: usize = LETTERS;

    /// A column of which something is known; no slots: nothing of these.
    pub(super) fn known(children: Vec<u32>, slots: Vec<S>, letters: Vec<S>) -> Self {
        Self { children, slots, letters, ..Self::default() }
    }
}

impl<S> Default for Column<S> {
    fn default() -> Self {
        Self { children: Vec::new(), before: 0, earlier: 0, digits: 0, flags: 0, slots: Vec::new(), letters: Vec::new() }
    }
}

/// Which column is meant.
pub(crate) type Node = u32;

/// All columns of a structure: a tree after its fields.
#[derive(Debug, Clone)]
pub(crate) struct Models<S: 'static> {
    pub(super) columns: Vec<Column<S>>,
    /// What is known of the first of them before they are used.
    prior: &'static [Column<S>],
    pub(super) beside: u8,
    /// Exactly how many digits the number before in the row has and one more; 0: there is none.
    pub(super) beside_digits: u8,
    /// Numbers told so far of what was made by hand.
    pub(super) told: Option<Told>,
}

/// What has been told, and where the same was told before.
#[derive(Debug, Clone, Default)]
pub(super) struct Told {
    values: Vec<(Node, u64)>,
    /// By what came before: where it went on last; 0: nowhere. Of one size whatever is told, so that bytes from anywhere cannot fill
    /// the memory: of two things that share a place, the later one is known.
    after: Vec<u32>,
    run: usize,
}

impl Told {
    const PLACES_BITS: u32 = 16;

    /// The places of what comes in a column after the last two numbers, and after the last one.
    fn places(&self, node: Node) -> Option<[usize; 2]> {
        let [.., (_, a), (_, b)] = *self.values else { return None };
        let mix = |hash: u64, n: u64| {
            let product = (hash ^ n).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            product ^ product >> 29
        };
        let last = mix(mix(1, node.into()), b);
        Some([mix(last, a), last].map(|hash| (hash >> (u64::BITS - Self::PLACES_BITS)) as usize))
    }

    /// What follows if things go on as they did after the same numbers.
    fn expected(&self, node: Node) -> Option<u64> {
        let [.., a, b] = self.values.as_slice() else { return None };
        let places = self.places(node)?;
        let found = |(place, before): (usize, &[(Node, u64)])| {
            let at = *self.after.get(place)? as usize;
            let (told, same) = (*self.values.get(at)?, self.values.get(at.checked_sub(before.len())?..at)?);
            let is_same = told.0 == node && same.iter().zip(before).all(|(x, y)| x.1 == y.1);
            (at > 0 && is_same).then_some(told.1)
        };
        places.into_iter().zip([&[*a, *b][..], &[*b][..]]).find_map(found)
    }

    fn remember(&mut self, node: Node, value: u64) {
        if let Some(places) = self.places(node) {
            self.after.resize(1 << Self::PLACES_BITS, 0);
            places.into_iter().for_each(|place| self.after[place] = self.values.len() as u32);
        }
        self.values.push((node, value));
    }
}

impl<S> Models<S> {
    /// Columns of which something is known.
    pub(super) fn after(prior: &'static [Column<S>]) -> Self {
        let columns = core::iter::repeat_with(Column::default).take(prior.len().max(1)).collect();
        Self { columns, prior, beside: 0, beside_digits: 0, told: None }
    }
}

impl<S> Default for Models<S> {
    fn default() -> Self {
        Self::after(&[])
    }
}

fn class(digits: u32) -> u8 {
    match digits {
        0..=3 => digits as u8,
        4..=5 => 4,
        6..=9 => 5,
        10..=13 => 6,
        _ => 7,
    }
}

/// The whole centimetres that lie nearest to so many steps of the grid.
const fn whole_centimetres(steps: i64) -> i64 {
    (steps.wrapping_mul(100).wrapping_add(512)).div_euclid(1024)
}

/// The steps of the grid that lie nearest to so many centimetres.
const fn steps_of(centimetres: i64) -> i64 {
    (centimetres.wrapping_mul(1024).wrapping_add(50)).div_euclid(100)
}

fn tree<B: Bits>(bits: &mut B, slots: &mut [B::Slot], digits: u32, value: u32) -> u32 {
    let mut node = 1;
    for i in (0..digits).rev() {
        node = node << 1 | usize::from(bits.bit(&mut slots[node], value >> i & 1 == 1));
    }
    node as u32 - (1 << digits)
}

fn mixed_tree<B: Bits>(bits: &mut B, slots: &mut [B::Slot], contexts: [usize; VIEWS], digits: u32, value: u32) -> u32 {
    let mut node = 1;
    for i in (0..digits).rev() {
        let views = slots.get_disjoint_mut(contexts.map(|context| context + node)).unwrap_or_else(|_| unreachable!("views differ"));
        node = node << 1 | usize::from(bits.mixed(views, value >> i & 1 == 1));
    }
    node as u32 - (1 << digits)
}

impl<S: Clone + Default> Models<S> {
    /// The column of a part of what a column is for.
    pub(crate) fn child(&mut self, node: Node, n: usize) -> Node {
        let known = self.prior.get(node as usize).map(|column| &column.children);
        let children = core::iter::once(&self.columns[node as usize].children).chain(known);
        if let Some(&child) = children.flat_map(|children| children.get(n)).find(|&&child| child != 0) {
            return child;
        }
        let child = self.columns.len() as Node;
        self.columns.push(Column::default());
        let children = &mut self.columns[node as usize].children;
        children.resize(children.len().max(n + 1), 0);
        children[n] = child;
        child
    }

    /// What follows stands in a row of its own.
    pub(crate) const fn new_row(&mut self) {
        self.beside = 0;
        self.beside_digits = 0;
    }

    fn slots(&mut self, node: Node) -> &mut Column<S> {
        let column = &mut self.columns[node as usize];
        if column.slots.is_empty() {
            let known = self.prior.get(node as usize).map_or(&[][..], |column| &column.slots);
            column.slots = if known.is_empty() { vec![S::default(); SLOTS] } else { known.to_vec() };
        }
        column
    }

    fn digits<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, value: u64) -> (u64, u32) {
        let (beside, beside_digits) = (self.beside, usize::from(self.beside_digits));
        let column = self.slots(node);
        let beside = usize::from(if beside == 0 { column.earlier } else { beside });
        let slots = &mut column.slots;
        let digits = u64::BITS - value.leading_zeros();
        let contexts = [
            (usize::from(column.before) * BESIDE + beside) * SHORT,
            FINE_BEFORE + usize::from(column.digits) * SHORT,
            FINE_BESIDE + beside_digits * SHORT,
        ];
        let mut digits = mixed_tree(bits, slots, contexts, 4, digits.min(SHORT as u32 - 1));
        let exactly = digits as u8;
        if digits == SHORT as u32 - 1 {
            let more = (u64::BITS - value.leading_zeros()).saturating_sub(digits);
            digits += tree(bits, &mut slots[LONG..LONG + 64], 6, more);
        }
        let digits = digits.min(u64::BITS);
        let mut told = u64::from(digits > 0);
        let mut node = 1;
        let clipped = digits.min(31) as usize;
        for i in (0..digits.saturating_sub(1)).rev() {
            let one = value >> i & 1 == 1;
            let one = if digits - 2 - i < TOGETHER {
                let one = bits.bit(&mut slots[TOP + clipped * 8 + node], one);
                node = node << 1 | usize::from(one);
                one
            } else {
                bits.bit(&mut slots[LOWER + i.min(31) as usize], one)
            };
            told = told << 1 | u64::from(one);
        }
        column.earlier = match column.before {
            0 => 1,
            1..=3 => 2,
            _ => 3,
        };
        column.before = class(digits);
        column.digits = exactly;
        self.beside_digits = exactly + 1;
        self.beside = match digits {
            0 => 1,
            1..=4 => 2,
            _ => 3,
        };
        (told, digits)
    }

    /// Whether what follows was made by hand: then it is looked for what was told before.
    pub(crate) fn handmade(&mut self, on: bool) {
        self.told = on.then(Told::default);
    }

    /// What follows if things go on as they did when the last two numbers were told before.
    fn again<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, value: u64) -> Option<u64> {
        let told = self.told.as_ref()?;
        let expected = told.expected(node)?;
        let run = told.run.min(RUNS - 1);
        let is_it = bits.bit(&mut self.slots(node).slots[AGAIN + run], value == expected);
        if let Some(told) = &mut self.told {
            told.run = if is_it { told.run + 1 } else { 0 };
        }
        is_it.then_some(expected)
    }

    fn remember(&mut self, node: Node, value: u64) {
        if let Some(told) = &mut self.told {
            told.remember(node, value);
        }
    }

    /// A number.
    pub(crate) fn unsigned<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, value: u64) -> u64 {
        let value = match self.again(bits, node, value) {
            Some(value) => value,
            None => self.digits(bits, node, value).0,
        };
        self.remember(node, value);
        value
    }

    /// A number that may be below zero.
    pub(crate) fn signed<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, value: i64) -> i64 {
        let value = match self.again(bits, node, value as u64) {
            Some(value) => value as i64,
            None => self.fresh(bits, node, value),
        };
        self.remember(node, value as u64);
        value
    }

    fn fresh<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, value: i64) -> i64 {
        if self.told.is_none() {
            return self.sized(bits, node, value);
        }
        let whole = self.sized(bits, node, whole_centimetres(value));
        let rest = value.wrapping_sub(steps_of(whole)).wrapping_add(REST / 2) as u32;
        let rest = tree(bits, &mut self.columns[node as usize].slots[OFF..OFF + REST as usize], REST.ilog2(), rest % REST as u32);
        steps_of(whole).wrapping_add(i64::from(rest)).wrapping_sub(REST / 2)
    }

    fn sized<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, value: i64) -> i64 {
        let (size, digits) = self.digits(bits, node, value.unsigned_abs());
        if digits == 0 {
            return 0;
        }
        let slot = &mut self.columns[node as usize].slots[SIGN + digits.min(31) as usize];
        if bits.bit(slot, value < 0) { (size as i64).wrapping_neg() } else { size as i64 }
    }

    /// Yes or no.
    pub(crate) fn flag<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, value: bool) -> bool {
        let beside = usize::from(self.beside);
        let column = self.slots(node);
        let slot = FLAG + usize::from(column.flags) * BESIDE + beside;
        let value = bits.bit(&mut column.slots[slot], value);
        column.flags = (column.flags << 1 | u8::from(value)) & 3;
        self.beside = 1 + u8::from(value);
        self.beside_digits = 1 + u8::from(value);
        value
    }

    /// One of eight symbols, by one of 72 contexts.
    pub(crate) fn symbol<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, context: usize, symbol: u32) -> u32 {
        let slots = &mut self.slots(node).slots;
        tree(bits, &mut slots[context * 8..context * 8 + 8], 3, symbol)
    }

    /// A letter of a text, after another.
    pub(crate) fn letter<B: Bits<Slot = S>>(&mut self, bits: &mut B, node: Node, before: u8, value: u8) -> u8 {
        let column = &mut self.columns[node as usize];
        if column.letters.is_empty() {
            let known = self.prior.get(node as usize).map_or(&[][..], |column| &column.letters);
            column.letters = if known.is_empty() { vec![S::default(); LETTERS] } else { known.to_vec() };
        }
        let context = usize::from(before % 32) * 256;
        tree(bits, &mut column.letters[context..context + 256], 8, u32::from(value)) as u8
    }
}
