/// Sorted words, and in which names each stands.
#[derive(Debug, Clone, Default)]
pub(super) struct Dictionary {
    words: Vec<Box<[char]>>,
    /// Where word `i` stands: `stands[first[i]..first[i + 1]]`.
    first: Vec<u32>,
    stands: Vec<Stand>,
}

/// A word in a name.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stand {
    /// Index of the name.
    pub name: u32,
    /// The first of the name's words that it takes.
    pub word: u8,
    /// How many it takes.
    pub words: u8,
}

/// A word that is like what was typed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Like {
    /// Its index.
    pub word: u32,
    /// Letters put in, left out, changed or swapped, as far as it was typed.
    pub slips: u8,
    /// Letters that were not typed.
    pub rest: u16,
}

impl Dictionary {
    /// A dictionary of words and where they stand.
    pub fn new(mut entries: Vec<(Box<[char]>, Stand)>) -> Self {
        entries.sort_unstable();
        entries.dedup();
        let mut dictionary = Self { stands: Vec::with_capacity(entries.len()), ..Self::default() };
        for (word, stand) in entries {
            if dictionary.words.last() != Some(&word) {
                dictionary.words.push(word);
                dictionary.first.push(dictionary.stands.len() as u32);
            }
            dictionary.stands.push(stand);
        }
        dictionary.first.push(dictionary.stands.len() as u32);
        dictionary
    }

    /// Where a word stands.
    pub fn stands(&self, word: u32) -> &[Stand] {
        let bounds = self.first.get(word as usize).zip(self.first.get(word as usize + 1));
        bounds.and_then(|(&from, &to)| self.stands.get(from as usize..to as usize)).unwrap_or(&[])
    }

    /// A word's letters.
    pub fn letters(&self, word: u32) -> usize {
        self.words.get(word as usize).map_or(0, |letters| letters.len())
    }

    /// Every word that begins with what was typed, or is it, but for at most so many slips; each once, at its best.
    ///
    /// The words are gone through in order and share the rows of the distance table for the letters that they share; a beginning
    /// that is too far off takes all words with it.
    pub fn like(&self, typed: &[char], most_slips: u8, mut tell: impl FnMut(Like)) {
        let wide = typed.len() + 1;
        // Row `d`: slips between the first `d` letters of a word and every beginning of what was typed.
        let mut rows: Vec<u8> = (0..wide).map(|n| n.min(255) as u8).collect();
        // By depth: fewest slips with which all that was typed is a beginning of the word so far, and at which depth.
        let mut begun: Vec<(u8, u16)> = vec![(rows[wide - 1], 0)];
        let mut n = 0;
        let mut shared = 0;
        while let Some(word) = self.words.get(n) {
            begun.truncate(shared + 1);
            rows.truncate((shared + 1) * wide);
            let mut cut = None;
            for depth in shared..word.len() {
                let least = push_row(&mut rows, typed, word, depth);
                let (slips, at) = begun[depth];
                let whole = rows[(depth + 1) * wide + wide - 1];
                begun.push(if whole < slips { (whole, depth as u16 + 1) } else { (slips, at) });
                if least > most_slips {
                    cut = Some(depth + 1);
                    break;
                }
            }
            // All words with this beginning go the same way.
            let end = cut.map_or(n + 1, |depth| self.end_of(n, depth));
            let (slips, at) = begun[begun.len() - 1];
            if slips <= most_slips {
                for index in n..end {
                    let rest = self.words[index].len().saturating_sub(at as usize);
                    tell(Like { word: index as u32, slips, rest: rest.min(usize::from(u16::MAX)) as u16 });
                }
            }
            shared = match self.words.get(end) {
                Some(next) => word.iter().zip(next.iter()).take_while(|(a, b)| a == b).count().min(begun.len() - 1),
                None => 0,
            };
            n = end;
        }
    }

    /// The first word after `n` that does not begin with the same `depth` letters.
    fn end_of(&self, n: usize, depth: usize) -> usize {
        let begins = |word: &[char]| word.get(..depth) == self.words[n].get(..depth);
        // Most often it is near.
        let mut step = 1;
        while self.words.get(n + step).is_some_and(|word| begins(word)) {
            step *= 2;
        }
        let high = (n + step).min(self.words.len());
        n + self.words[n..high].partition_point(|word| begins(word))
    }
}

/// Adds the row of a word's letter `depth` to the table of optimal string alignment, and tells its least number.
fn push_row(rows: &mut Vec<u8>, typed: &[char], word: &[char], depth: usize) -> u8 {
    let wide = typed.len() + 1;
    let (last, base) = (depth * wide, (depth + 1) * wide);
    rows.push((depth + 1).min(255) as u8);
    let mut least = rows[base];
    for (j, &letter) in typed.iter().enumerate() {
        let changed = rows[last + j].saturating_add(u8::from(letter != word[depth]));
        let mut slips = changed.min(rows[last + j + 1].saturating_add(1)).min(rows[base + j].saturating_add(1));
        if depth > 0 && j > 0 && word[depth] == typed[j - 1] && word[depth - 1] == letter {
            slips = slips.min(rows[last - wide + j - 1].saturating_add(1));
        }
        rows.push(slips);
        least = least.min(slips);
    }
    // A swap reaches back over a row: the row before may still save what this one has lost.
    if depth > 0 { least.min(rows[last..base].iter().copied().min().unwrap_or(255).saturating_add(1)) } else { least }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use proptest::prelude::*;

    use super::*;
    use crate::letters::distance;

    fn dictionary(words: &[String]) -> Dictionary {
        let stand = |n: usize| Stand { name: n as u32, word: 0, words: 1 };
        Dictionary::new(words.iter().enumerate().map(|(n, word)| (word.chars().collect(), stand(n))).collect())
    }

    #[test]
    fn beginnings_and_slips_are_found() {
        let words = ["celetna", "celnice", "tyn", "tynska", "karlova"].map(str::to_owned);
        let dictionary = dictionary(&words);
        let like = |typed: &str, most| {
            let mut found = Vec::new();
            let typed: Vec<char> = typed.chars().collect();
            dictionary.like(&typed, most, |like| {
                let word: String = dictionary.words[like.word as usize].iter().collect();
                found.push((word, like.slips, like.rest));
            });
            found
        };
        let told = |found: &[(&str, u8, u16)]| found.iter().map(|&(w, s, r)| (w.to_owned(), s, r)).collect::<Vec<_>>();
        assert_eq!(like("tyn", 0), told(&[("tyn", 0, 0), ("tynska", 0, 3)]));
        assert_eq!(like("cel", 0), told(&[("celetna", 0, 4), ("celnice", 0, 4)]));
        assert_eq!(like("ceeltna", 1), told(&[("celetna", 1, 0)]), "two letters swapped");
        assert_eq!(like("karlva", 1), told(&[("karlova", 1, 0)]), "a letter left out");
        assert_eq!(like("xyz", 1), told(&[]));
    }

    proptest! {
        #[test]
        fn the_same_is_found_as_by_comparing_with_every_word(
            words in prop::collection::btree_set("[a-c]{1,6}", 0..40), typed in "[a-c]{1,6}", most in 0u8..=2,
        ) {
            let words: Vec<String> = words.into_iter().collect();
            let letters: Vec<char> = typed.chars().collect();
            let mut found = BTreeMap::new();
            let dictionary = dictionary(&words);
            dictionary.like(&letters, most, |like| assert!(found.insert(like.word, like.slips).is_none(), "each once"));
            for (n, word) in words.iter().enumerate() {
                let word: Vec<char> = word.chars().collect();
                let slips = (0..=word.len()).map(|end| distance(&letters, &word[..end])).min().unwrap_or(usize::MAX);
                let told = found.get(&(n as u32)).copied().map(usize::from);
                prop_assert_eq!(told, (slips <= usize::from(most)).then_some(slips), "{:?} in {:?}", &typed, words[n]);
            }
        }
    }
}
