//! Finds things by what people type of their names.

mod dictionary;

use glam::DVec2;
use veduta_city::{GuidePlace, Place, PlaceKind};

use crate::letters::fold;
use dictionary::{Dictionary, Stand};

/// Something that can be found by its names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Named {
    /// Its names, the one to show first.
    pub names: Vec<String>,
    /// Where it is, plan metres; `None` for what is nowhere, such as a command.
    pub plan_pos: Option<DVec2>,
    /// How well known it is, 0 to 1: of two that fit alike, the better known comes first.
    pub renown: f64,
}

impl Named {
    /// A place under all the names that a guide knows, the map's first.
    #[must_use]
    pub fn place(place: &Place, told: Option<&GuidePlace>) -> Self {
        let others = told.into_iter().flat_map(GuidePlace::all_names).filter(|name| *name != place.name);
        let names = core::iter::once(place.name.as_str()).chain(others).map(str::to_owned).collect();
        // What is seen from afar is better known than what is not.
        let wide = (place.radius_m / 60.0).clamp(0.0, 1.0);
        let (least, more) = match place.kind {
            PlaceKind::Monument => (0.5, 0.5),
            PlaceKind::Square => (0.5, 0.4),
            PlaceKind::Street => (0.25, 0.0),
            PlaceKind::House | PlaceKind::Shop | PlaceKind::Other => (0.3, 0.2),
            PlaceKind::Viewpoint => (0.0, 0.0),
        };
        Self { names, plan_pos: Some(place.pos), renown: least + more * wide }
    }

    /// A street that is no place of its own.
    #[must_use]
    pub fn street(name: &str, plan_pos: DVec2) -> Self {
        Self { names: vec![name.to_owned()], plan_pos: Some(plan_pos), renown: 0.2 }
    }
}

/// Something found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Its index among what was given.
    pub index: usize,
    /// Which of its names fits best.
    pub name: usize,
    /// How well, 0 to about 1.
    pub score: f64,
}

/// An index of names, for a search box: forgiving of marks, slips of the finger, unfinished words, words in another order, too many or
/// too few, joined or split.
///
/// ```
/// use veduta_route::{Finder, Named};
///
/// let named = |name: &str| Named { names: vec![name.to_owned()], ..Named::default() };
/// let finder = Finder::new(vec![named("Powder Tower"), named("Celetná")]);
/// assert_eq!(finder.find("powdre", None, 5)[0].index, 0);
/// assert_eq!(finder.find("celetna street", None, 5)[0].index, 1);
/// ```
///
/// Typed words are looked up in a sorted dictionary of all names' words, so that the cost grows with the words that
/// are alike, not with all there are; then the names in which most of what was typed stands are compared word by word.
#[derive(Debug, Clone, Default)]
pub struct Finder {
    named: Vec<Named>,
    names: Vec<Name>,
    /// Single words.
    words: Dictionary,
    /// Two neighbours written as one, and whole names.
    joined: Dictionary,
}

#[derive(Debug, Clone, Copy)]
struct Name {
    named: u32,
    /// Which of its names.
    number: u16,
    words: u8,
    /// Without spaces.
    letters: u16,
}

/// So much of a name or of what is typed is looked at.
const MOST_WORDS: usize = 8;
const MOST_LETTERS: usize = 48;
/// So many names are compared word by word.
const COMPARED: usize = 64;
/// What fits worse than this is not found.
const LEAST_SCORE: f64 = 0.3;
/// Shares of the score: how much of the name was typed, how well known it is, how near.
const COVERED: f64 = 0.14;
const RENOWN: f64 = 0.14;
/// What is shown is meant rather than what is not: the score of names after the first falls by so much.
const BY_NAME: f64 = 0.07;
const NEARNESS: f64 = 0.05;
/// At this distance nearness counts for half, metres.
const NEAR_M: f64 = 250.0;

/// A typed word, and how it fits a word of a name.
struct Fits {
    /// Letters of the typed word.
    letters: f64,
    /// By name: the best fit and where; the names that have one.
    at: Vec<(Stand, f64)>,
}

impl Finder {
    /// An index of what has names.
    #[must_use]
    pub fn new(named: Vec<Named>) -> Self {
        let (mut names, mut words, mut joined) = (Vec::new(), Vec::new(), Vec::new());
        for (index, one) in named.iter().enumerate() {
            for (number, text) in one.names.iter().enumerate().take(usize::from(u16::MAX)) {
                let parts = words_of(text);
                if parts.is_empty() {
                    continue;
                }
                let name = names.len() as u32;
                let letters = parts.iter().map(|part| part.len()).sum::<usize>() as u16;
                names.push(Name { named: index as u32, number: number as u16, words: parts.len() as u8, letters });
                let join = |parts: &[Box<[char]>]| parts.concat().into_boxed_slice();
                let stand = |word: usize, words: usize| Stand { name, word: word as u8, words: words as u8 };
                if parts.len() > 2 {
                    joined.push((join(&parts), stand(0, parts.len())));
                }
                for (n, pair) in parts.windows(2).enumerate() {
                    joined.push((join(pair), stand(n, 2)));
                }
                words.extend(parts.into_iter().enumerate().map(|(n, part)| (part, stand(n, 1))));
            }
        }
        Self { named, names, words: Dictionary::new(words), joined: Dictionary::new(joined) }
    }

    /// What was given.
    #[must_use]
    pub fn named(&self) -> &[Named] {
        &self.named
    }

    /// What fits what was typed, best first, `most` at most; of two that fit alike, the one better known, then the one nearer to `near`.
    #[must_use]
    pub fn find(&self, typed: &str, near: Option<DVec2>, most: usize) -> Vec<Hit> {
        let mut words = words_of(typed);
        if words.len() > 1 {
            words.retain(|word| **word != ARTICLE);
        }
        if words.is_empty() {
            return Vec::new();
        }
        let mut fits: Vec<Fits> = words.iter().map(|word| self.fits(word)).collect();
        let letters: f64 = fits.iter().map(|fit| fit.letters).sum();
        // What was typed apart may be one word, and the other way round.
        if words.len() > 1 {
            let whole = self.fits_joined(&words.concat());
            fits.push(Fits { letters: 0.0, at: whole });
        }
        let mut hits: Vec<Hit> = Vec::new();
        for name in self.likeliest(&fits) {
            let (score, name) = (self.score(name, &fits, letters, near), self.names[name as usize]);
            if score >= LEAST_SCORE {
                hits.push(Hit { index: name.named as usize, name: name.number.into(), score });
            }
        }
        hits.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.index.cmp(&b.index)).then(a.name.cmp(&b.name)));
        let mut told = Vec::new();
        hits.retain(|hit| {
            let is_new = !told.contains(&hit.index);
            told.push(hit.index);
            is_new
        });
        hits.truncate(most);
        hits
    }

    /// How a typed word fits words of names.
    fn fits(&self, typed: &[char]) -> Fits {
        let mut at = Vec::new();
        self.words.like(typed, slips_of(typed.len()), |like| {
            let fit = fit(typed.len(), like.slips, like.rest.into());
            at.extend(self.words.stands(like.word).iter().map(|&stand| (stand, fit)));
        });
        if typed.len() >= JOINED_LETTERS {
            at.extend(self.fits_joined(typed));
        }
        Fits { letters: typed.len() as f64, at }
    }

    /// How a typed word fits words of names that are written as one.
    fn fits_joined(&self, typed: &[char]) -> Vec<(Stand, f64)> {
        let mut at = Vec::new();
        self.joined.like(typed, slips_of(typed.len()).min(typed.len() as u8 / 6), |like| {
            // Single words say it as well as long as the second has not begun.
            if typed.len() * 5 >= self.joined.letters(like.word) * 3 {
                let fit = 0.97 * fit(typed.len(), like.slips, like.rest.into());
                at.extend(self.joined.stands(like.word).iter().map(|&stand| (stand, fit)));
            }
        });
        at
    }

    /// The names in which most of what was typed stands.
    fn likeliest(&self, fits: &[Fits]) -> Vec<u32> {
        let mut sums = vec![0_f32; self.names.len()];
        let mut best = vec![0_f32; self.names.len()];
        let mut touched: Vec<u32> = Vec::new();
        for fits in fits {
            let letters = if fits.letters > 0.0 { fits.letters } else { f64::MAX };
            let mut here: Vec<u32> = Vec::new();
            for &(stand, fit) in &fits.at {
                let slot = &mut best[stand.name as usize];
                if *slot == 0.0 {
                    here.push(stand.name);
                }
                *slot = slot.max(fit as f32);
            }
            for name in here {
                let (sum, best) = (&mut sums[name as usize], &mut best[name as usize]);
                if *sum == 0.0 {
                    touched.push(name);
                }
                // A whole name written as one word counts as all of it.
                *sum += *best * if letters == f64::MAX { 100.0 } else { letters as f32 };
                *best = 0.0;
            }
        }
        // Of names alike the shorter, then the better known.
        let order = |name: u32| {
            let Name { named, letters, .. } = self.names[name as usize];
            let renown = self.named[named as usize].renown as f32;
            sums[name as usize] * (1.0 + 0.2 * renown) - 0.01 * f32::from(letters)
        };
        if touched.len() > COMPARED {
            touched.select_nth_unstable_by(COMPARED, |&a, &b| order(b).total_cmp(&order(a)).then(a.cmp(&b)));
            touched.truncate(COMPARED);
        }
        touched
    }

    /// How well a name fits all that was typed.
    fn score(&self, name: u32, fits: &[Fits], letters: f64, near: Option<DVec2>) -> f64 {
        let Name { named, number, words, letters: long } = self.names[name as usize];
        let long = f64::from(long).max(1.0);
        let mut taken = [false; MOST_WORDS];
        let (mut fit_all, mut covered, mut in_order) = (0.0, 0.0, true);
        let mut last = 0;
        for fits in fits.iter().filter(|fits| fits.letters > 0.0) {
            let free = |stand: &Stand| !(stand.word..stand.word + stand.words).any(|n| taken[usize::from(n)]);
            let here = fits.at.iter().filter(|(stand, _)| stand.name == name && free(stand));
            let Some(&(stand, fit)) = here.max_by(|a, b| a.1.total_cmp(&b.1).then(b.0.cmp(&a.0))) else { continue };
            (stand.word..stand.word + stand.words).for_each(|n| taken[usize::from(n)] = true);
            fit_all += fit * fits.letters;
            covered += fits.letters;
            in_order &= stand.word >= last;
            last = stand.word;
        }
        let mut score = fit_all / letters;
        let mut covers = (covered / long).min(1.0);
        let whole = fits.iter().filter(|fits| fits.letters == 0.0).flat_map(|fits| &fits.at);
        for (stand, fit) in whole.filter(|(stand, _)| stand.name == name) {
            let share = f64::from(stand.words) / f64::from(words);
            if *fit > score {
                (score, covers) = (*fit, share.min(letters / long));
            }
        }
        let one = &self.named[named as usize];
        let nearness = near.zip(one.plan_pos).map_or(0.0, |(a, b)| NEAR_M / (NEAR_M + a.distance(b)));
        let begins = if taken[0] { 0.03 } else { 0.0 };
        let order = if in_order { 0.01 } else { 0.0 };
        let by_name = if number > 0 { BY_NAME } else { 0.0 };
        score * (1.0 - COVERED + COVERED * covers) + begins + order - by_name
            + RENOWN * one.renown.clamp(0.0, 1.0)
            + NEARNESS * nearness
    }
}

/// What nobody means by itself.
const ARTICLE: [char; 3] = ['t', 'h', 'e'];

/// Typed words from so many letters on may be two of a name's.
const JOINED_LETTERS: usize = 5;

/// How many slips are forgiven in a typed word.
const fn slips_of(letters: usize) -> u8 {
    match letters {
        0..=2 => 0,
        3..=6 => 1,
        _ => 2,
    }
}

/// How well a typed word fits, 0 to 1: less for each slip, and a little less for letters not typed.
fn fit(letters: usize, slips: u8, rest: usize) -> f64 {
    let typed = letters as f64;
    let slip = f64::from(slips) * (0.12 + 0.6 / typed);
    let unfinished = 0.25 * rest as f64 / (typed + rest as f64);
    (1.0 - slip - unfinished).max(0.05)
}

/// The words of a name, or of what was typed: letters and digits alone.
fn words_of(text: &str) -> Vec<Box<[char]>> {
    let folded = fold(text);
    let mut words: Vec<Box<[char]>> = Vec::new();
    let mut left = MOST_LETTERS;
    for word in folded.split(|c: char| !c.is_alphanumeric() && c != '\'').filter(|w| !w.is_empty()).take(MOST_WORDS) {
        let letters: Vec<char> = word.chars().filter(|c| *c != '\'').take(left).collect();
        left -= letters.len();
        if !letters.is_empty() {
            words.push(letters.into());
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn finder(names: &[&str]) -> Finder {
        Finder::new(names.iter().map(|name| Named { names: vec![(*name).to_owned()], ..Named::default() }).collect())
    }

    fn first<'a>(finder: &'a Finder, typed: &str) -> Option<&'a str> {
        finder.find(typed, None, 1).first().map(|hit| finder.named()[hit.index].names[hit.name].as_str())
    }

    #[test]
    fn what_was_typed_fits_in_many_ways() {
        let finder = finder(&[
            "Powder Tower",
            "Old Town Hall",
            "Old Town Square",
            "Na Příkopě",
            "Church of St James",
            "Týnská",
            "Týn Church",
        ]);
        for (typed, name) in [
            ("tyn", "Týn Church"),
            ("tynska", "Týnská"),
            ("old to ha", "Old Town Hall"),
            ("oldtown square", "Old Town Square"),
            ("powdertower", "Powder Tower"),
            ("naprikope", "Na Příkopě"),
            ("na prikpoe", "Na Příkopě"),
            ("james church", "Church of St James"),
            ("the powder tower", "Powder Tower"),
            ("pow der tower", "Powder Tower"),
            ("hall", "Old Town Hall"),
        ] {
            assert_eq!(first(&finder, typed), Some(name), "{typed}");
        }
        assert_eq!(first(&finder, "xyzzy"), None);
        assert_eq!(first(&finder, " - "), None);
    }

    #[test]
    fn of_those_alike_the_better_known_and_the_nearer_come_first() {
        let at = |x: f64, renown: f64| Named { names: vec!["Mill".to_owned()], plan_pos: Some(DVec2::new(x, 0.0)), renown };
        let finder = Finder::new(vec![at(0.0, 0.0), at(500.0, 0.0), at(900.0, 1.0)]);
        let order = |x: f64| finder.find("mill", Some(DVec2::new(x, 0.0)), 9).iter().map(|hit| hit.index).collect::<Vec<_>>();
        assert_eq!(order(0.0), [2, 0, 1]);
        assert_eq!(order(500.0), [2, 1, 0]);
    }

    #[test]
    fn a_thing_of_many_names_is_found_by_each_and_told_once() {
        let clock =
            Named { names: ["Astronomical Clock", "Orloj", "Orologio astronomico"].map(str::to_owned).into(), ..Named::default() };
        let finder = Finder::new(vec![clock]);
        let hits = finder.find("or", None, 9);
        assert_eq!((hits.len(), hits[0].name), (1, 1), "{hits:?}");
    }

    proptest! {
        #[test]
        fn every_name_is_found_first_by_itself(names in prop::collection::btree_set("[a-zá-ž]{2,9}( [a-z]{1,9}){0,3}", 1..30)) {
            let folded: std::collections::BTreeSet<String> = names.iter().map(|name| fold(name)).collect();
            prop_assume!(folded.len() == names.len());
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            let finder = finder(&names);
            for name in names {
                prop_assert_eq!(first(&finder, name), Some(name));
            }
        }

        #[test]
        fn nothing_typed_makes_it_panic(typed in any::<String>(), name in any::<String>()) {
            let finder = finder(&["Old Town Square", &name]);
            let _ = finder.find(&typed, Some(DVec2::NAN), 3);
        }
    }
}
