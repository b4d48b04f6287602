//! Names: of streets, squares, parks, bridges and rivers. Every list is the project's own.

use std::collections::BTreeSet;

use veduta_city::draw::Draw;
use veduta_city::{Id, StreetClass};

const WORDS: [&str; 132] = [
    "Abbey",
    "Acorn",
    "Alder",
    "Almond",
    "Anchor",
    "Angel",
    "Apple",
    "Arbour",
    "Archer",
    "Ash",
    "Aspen",
    "Baker",
    "Barley",
    "Basket",
    "Beech",
    "Bell",
    "Birch",
    "Bishop",
    "Blossom",
    "Bower",
    "Brazier",
    "Bridle",
    "Brook",
    "Cannon",
    "Candle",
    "Carter",
    "Castle",
    "Cedar",
    "Chalk",
    "Chapel",
    "Cherry",
    "Chestnut",
    "Clay",
    "Cloister",
    "Clover",
    "Cooper",
    "Copper",
    "Coronet",
    "Crane",
    "Crown",
    "Dove",
    "Dyer",
    "Eagle",
    "Elder",
    "Elm",
    "Falcon",
    "Farrier",
    "Feather",
    "Fern",
    "Ferry",
    "Fiddler",
    "Fisher",
    "Fletcher",
    "Flint",
    "Forge",
    "Fountain",
    "Fox",
    "Friar",
    "Garland",
    "Glazier",
    "Glover",
    "Goose",
    "Granary",
    "Hammer",
    "Hart",
    "Harvest",
    "Hatter",
    "Hawthorn",
    "Hazel",
    "Heron",
    "Holly",
    "Honey",
    "Hop",
    "Horn",
    "Ivy",
    "Juniper",
    "Kestrel",
    "Kiln",
    "Lantern",
    "Lark",
    "Laurel",
    "Lily",
    "Linden",
    "Lion",
    "Loom",
    "Magpie",
    "Malt",
    "Maple",
    "Mason",
    "Meadow",
    "Mercer",
    "Mill",
    "Miller",
    "Minstrel",
    "Mint",
    "Mulberry",
    "Nightingale",
    "Oak",
    "Orchard",
    "Otter",
    "Pearl",
    "Pewter",
    "Pilgrim",
    "Plough",
    "Poplar",
    "Potter",
    "Quarry",
    "Raven",
    "Reed",
    "Rope",
    "Rose",
    "Rowan",
    "Saddler",
    "Saffron",
    "Salt",
    "Shepherd",
    "Silver",
    "Smith",
    "Sparrow",
    "Spindle",
    "Star",
    "Swan",
    "Tanner",
    "Thatcher",
    "Thistle",
    "Thorn",
    "Tinker",
    "Vine",
    "Weaver",
    "Wheel",
    "Willow",
    "Wool",
];
const BROAD: [&str; 4] = ["Avenue", "Boulevard", "Road", "Parade"];
const COMMON: [&str; 3] = ["Street", "Road", "Street"];
const NARROW: [&str; 6] = ["Lane", "Row", "Alley", "Lane", "Passage", "Walk"];
const BEFORE: [&str; 7] = ["Upper", "Lower", "Little", "Great", "Old", "New", "Long"];
const SAINTS: [&str; 12] =
    ["Agnes", "Barbara", "Clement", "Giles", "Helena", "James", "Lawrence", "Martin", "Nicholas", "Peter", "Stephen", "Thomas"];
const RIVERS: [&str; 10] = ["Alwen", "Brend", "Corrin", "Esk", "Linnet", "Marle", "Orne", "Rill", "Tamber", "Wend"];
const MARKETS: [&str; 7] =
    ["Corn Market", "Horse Market", "Fish Market", "Wool Market", "Salt Market", "Fruit Market", "Hay Market"];

/// Gives names, each once.
#[derive(Debug)]
pub(super) struct Names {
    seed: u64,
    taken: BTreeSet<String>,
}

impl Names {
    pub fn new(seed: u64) -> Self {
        Self { seed, taken: BTreeSet::new() }
    }

    /// Takes a name given by the words, so that nothing else gets it.
    pub fn take(&mut self, name: &str) -> String {
        self.taken.insert(name.to_owned());
        name.to_owned()
    }

    fn draw(&self, n: usize, stage: &str) -> Draw {
        Draw::new(self.seed, Id(n as u64 + 1), stage)
    }

    /// The first of the names tried that is free; the last with a number where none is.
    fn first_free(&mut self, tried: impl Iterator<Item = String>) -> String {
        let mut last = String::new();
        for name in tried {
            if self.taken.insert(name.clone()) {
                return name;
            }
            last = name;
        }
        let numbered = (2..).map(|n: u64| format!("{last} {n}")).find(|name| !self.taken.contains(name));
        self.take(&numbered.unwrap_or_default())
    }

    /// Name of the `n`th street.
    pub fn street(&mut self, n: usize, class: StreetClass) -> String {
        let draw = self.draw(n, "words: street name");
        let kinds: &[&str] = match class {
            StreetClass::Motorway | StreetClass::Main => &BROAD,
            StreetClass::Street => &COMMON,
            _ => &NARROW,
        };
        self.first_free((0..60).map(|i| {
            let draw = draw.part(i);
            let word = draw.pick("word", &WORDS).copied().unwrap_or_default();
            let kind = draw.pick("kind", kinds).copied().unwrap_or_default();
            match draw.below("before", if i < 12 { 14 } else { 7 }) {
                before if i >= 6 && before < BEFORE.len() => format!("{} {word} {kind}", BEFORE[before]),
                _ if i < 6 && draw.chance("saint", 0.04) => {
                    format!("St {} {kind}", draw.pick("saint's", &SAINTS).copied().unwrap_or_default())
                }
                _ => format!("{word} {kind}"),
            }
        }))
    }

    /// Name of the `n`th square; the first is the main one.
    pub fn square(&mut self, n: usize, is_old: bool) -> String {
        let draw = self.draw(n, "words: square name");
        let first = if is_old { "Market Square" } else { "Central Square" };
        let main = (n == 0).then(|| first.to_owned());
        let market = draw.pick("market", &MARKETS).filter(|_| draw.chance("is market", 0.5)).map(|&m| m.to_owned());
        let word = (0..30).map(|i| format!("{} Square", draw.part(i).pick("word", &WORDS).copied().unwrap_or_default()));
        self.first_free(main.into_iter().chain(market).chain(word))
    }

    /// Name of the `n`th park.
    pub fn park(&mut self, n: usize) -> String {
        let draw = self.draw(n, "words: park name");
        self.first_free((0..40).map(|i| {
            let draw = draw.part(i);
            let kind = draw.pick("kind", &["Park", "Gardens", "Green"]).copied().unwrap_or_default();
            format!("{} {kind}", draw.pick("word", &WORDS).copied().unwrap_or_default())
        }))
    }

    /// Name of the `n`th bridge; the first is the oldest.
    pub fn bridge(&mut self, n: usize) -> String {
        let draw = self.draw(n, "words: bridge name");
        let old = (n == 0).then(|| "Stone Bridge".to_owned());
        let word = (0..40).map(|i| format!("{} Bridge", draw.part(i).pick("word", &WORDS).copied().unwrap_or_default()));
        self.first_free(old.into_iter().chain(word))
    }

    /// Name of the river.
    pub fn river(&mut self) -> String {
        let draw = self.draw(0, "words: river name");
        self.first_free(draw.pick("name", &RIVERS).iter().map(|&&n| n.to_owned()))
    }

    /// Name of the church.
    pub fn church(&mut self) -> String {
        let draw = self.draw(0, "words: church name");
        let saint = draw.pick("saint", &SAINTS).copied().unwrap_or_default();
        self.first_free(core::iter::once(format!("St {saint}’s Church")))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thousands_of_streets_have_names_of_their_own() {
        let mut names = Names::new(3);
        let all: Vec<String> = (0..4_000).map(|n| names.street(n, StreetClass::Lane)).collect();
        assert_eq!(all.iter().collect::<BTreeSet<_>>().len(), all.len());
        assert!(all.iter().all(|n| !n.trim().is_empty()));
        let numbered = all.iter().take(600).filter(|n| n.ends_with(|c: char| c.is_ascii_digit())).count();
        assert_eq!(numbered, 0, "a town of 600 lanes needs no numbers");
    }
}
