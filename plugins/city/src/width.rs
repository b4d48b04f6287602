//! How wide a link is from place to place.

use serde::{Deserialize, Serialize};

use crate::{Link, WIDEST_M};

/// A link's width at one place of its line.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct WidthAt {
    /// Where: the share of the line's length that lies before it, 0 to 1.
    pub share: f64,
    /// Full width there, metres.
    pub width_m: f64,
}

/// What is wrong with an entry of a link's width profile.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum ProfileError {
    /// A share that is none.
    #[error("its share is {0:?}; it must lie from 0 to 1")]
    Share(f64),
    /// A share that does not lie beyond that of the entry before.
    #[error("its share of {share:?} is not beyond the {before:?} of the entry before it; shares ascend")]
    Order {
        /// The share.
        share: f64,
        /// That of the entry before.
        before: f64,
    },
    /// A width that no link has.
    #[error("its width is {0:?} m; it must be more than 0 and at most {WIDEST_M} m")]
    Width(f64),
}

impl WidthAt {
    /// The width that a profile has at a share of the line's length; nothing of an empty one.
    #[must_use]
    pub fn between(profile: &[Self], share: f64) -> Option<f64> {
        let next = profile.partition_point(|entry| entry.share <= share);
        match (next.checked_sub(1).and_then(|before| profile.get(before)), profile.get(next)) {
            (Some(a), Some(b)) => {
                let t = (share - a.share) / (b.share - a.share);
                Some(a.width_m + (b.width_m - a.width_m) * t.clamp(0.0, 1.0))
            }
            (Some(only), None) | (None, Some(only)) => Some(only.width_m),
            (None, None) => None,
        }
    }

    /// What of a profile lies between two shares of the line, for a line of that part alone.
    #[must_use]
    pub fn part(profile: &[Self], from: f64, to: f64) -> Vec<Self> {
        let (Some(first), Some(last)) = (Self::between(profile, from), Self::between(profile, to)) else { return Vec::new() };
        let inner = profile.iter().filter(|entry| from < entry.share && entry.share < to);
        let inner = inner.map(|entry| Self { share: (entry.share - from) / (to - from), ..*entry });
        let (first, last) = (Self { share: 0.0, width_m: first }, Self { share: 1.0, width_m: last });
        core::iter::once(first).chain(inner).chain(core::iter::once(last)).collect()
    }

    /// The mean of a profile over the line's length; nothing of an empty one.
    #[must_use]
    pub fn mean(profile: &[Self]) -> Option<f64> {
        let shares = core::iter::once(0.0).chain(profile.iter().map(|entry| entry.share)).chain(core::iter::once(1.0));
        let ends: Option<Vec<(f64, f64)>> = shares.map(|share| Some((share, Self::between(profile, share)?))).collect();
        Some(ends?.windows(2).map(|w| (w[1].0 - w[0].0) * (w[0].1 + w[1].1) / 2.0).sum())
    }
}

impl Link {
    /// Width in metres at a share of the line's length, 0 to 1: between the entries of its profile as on a straight line, before
    /// the first and after the last as there. [`Link::width`] where it has no profile.
    ///
    /// ```
    /// let street: veduta_city::Link = veduta_city::file::parse("(from: 1, to: 2, kind: Street(Lane), width_m: 9,
    ///     // 6 m at its beginning, from its middle on 10 m.
    ///     profile: [(share: 0, width_m: 6), (share: 0.5, width_m: 10)])", "street")?;
    /// assert_eq!([0.0, 0.25, 0.5, 1.0].map(|share| street.width_at(share)), [6.0, 8.0, 10.0, 10.0]);
    /// # Ok::<(), veduta_city::file::SyntaxError>(())
    /// ```
    #[must_use]
    pub fn width_at(&self, share: f64) -> f64 {
        WidthAt::between(&self.profile, share).unwrap_or_else(|| self.width())
    }

    /// What is wrong with the profile: the number of the entry, from 1, and why. The first that is wrong counts.
    #[must_use]
    pub fn profile_error(&self) -> Option<(usize, ProfileError)> {
        let mut before = f64::NEG_INFINITY;
        self.profile.iter().enumerate().find_map(|(i, &WidthAt { share, width_m })| {
            let error = if !(0.0..=1.0).contains(&share) {
                Some(ProfileError::Share(share))
            } else if share <= before {
                Some(ProfileError::Order { share, before })
            } else {
                (!(width_m > 0.0 && width_m <= WIDEST_M)).then_some(ProfileError::Width(width_m))
            };
            before = share;
            error.map(|error| (i + 1, error))
        })
    }

    /// Keeps of the profile what lies between two shares of the line, for a link of that part alone, and makes its mean the
    /// width.
    pub(crate) fn part_profile(&mut self, from: f64, to: f64) {
        if self.profile.is_empty() || to <= from {
            return;
        }
        self.profile = WidthAt::part(&self.profile, from, to);
        self.part_steps();
        self.width_of_profile();
    }

    /// Turns the profile about, for a line that runs the other way.
    pub(crate) fn reverse_profile(&mut self) {
        self.profile.reverse();
        for entry in &mut self.profile {
            entry.share = 1.0 - entry.share;
        }
        self.part_steps();
    }

    /// Adds the widths of a link that goes on from the end of this one, where either has a profile. Lengths of both in metres;
    /// `is_turned` if the other runs the other way.
    pub(crate) fn join_profile(&mut self, length_m: f64, other: &Self, other_length_m: f64, is_turned: bool) {
        let whole = length_m + other_length_m;
        if self.profile.is_empty() && other.profile.is_empty() || whole <= 0.0 {
            return;
        }
        let mut other = other.clone();
        if is_turned {
            other.reverse_profile();
        }
        let entries = |link: &Self, from: f64, length: f64| -> Vec<WidthAt> {
            let inner = link.profile.iter().map(|entry| entry.share).filter(|share| 0.0 < *share && *share < 1.0);
            let shares = core::iter::once(0.0).chain(inner).chain(core::iter::once(1.0));
            shares.map(|share| WidthAt { share: (from + share * length) / whole, width_m: link.width_at(share) }).collect()
        };
        let mut all = entries(self, 0.0, length_m);
        all.extend(entries(&other, length_m, other_length_m));
        self.profile = all;
        self.part_steps();
        self.width_of_profile();
    }

    /// Parts entries of one share, where the width makes a step; of those that say the same one is enough.
    fn part_steps(&mut self) {
        /// A step is as steep as this share of the line.
        const STEP: f64 = 1e-4;
        let mut kept: Vec<WidthAt> = Vec::with_capacity(self.profile.len());
        for &entry in &self.profile {
            match kept.last() {
                Some(last) if entry.share <= last.share => {
                    let after = WidthAt { share: last.share + STEP, ..entry };
                    if entry.width_m != last.width_m && after.share < 1.0 {
                        kept.push(after);
                    }
                }
                _ => kept.push(entry),
            }
        }
        self.profile = kept;
    }

    /// Makes the mean of the profile the width, to a centimetre, where a width is given.
    fn width_of_profile(&mut self) {
        if let Some(mean) = WidthAt::mean(&self.profile).filter(|_| self.width_m > 0.0) {
            self.width_m = (mean * 100.0).round() / 100.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::testing::{lane, node};
    use crate::{CityGraph, GraphError, GraphOverrides, Id, file};

    fn street(profile: &[(f64, f64)]) -> Link {
        let profile = profile.iter().map(|&(share, width_m)| WidthAt { share, width_m }).collect();
        Link { id: Id(7), width_m: 9.0, profile, ..lane(1, 2) }
    }

    fn profiles() -> impl Strategy<Value = Vec<(f64, f64)>> {
        prop::collection::vec((0.0..1.0f64, 0.5..40.0f64), 0..6).prop_map(|mut all| {
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            all.dedup_by(|a, b| a.0 - b.0 < 0.01);
            all
        })
    }

    proptest! {
        #[test]
        fn widths_lie_between_those_of_the_entries_around(profile in profiles(), share in -0.5..1.5f64) {
            let link = street(&profile);
            prop_assert_eq!(link.profile_error(), None);
            let width = link.width_at(share);
            let before = profile.iter().rev().find(|entry| entry.0 <= share);
            let after = profile.iter().find(|entry| entry.0 > share);
            let around: Vec<f64> = before.into_iter().chain(after).map(|entry| entry.1).collect();
            let (low, high) = around.iter().fold((f64::MAX, f64::MIN), |(low, high), w| (low.min(*w), high.max(*w)));
            if around.is_empty() {
                prop_assert_eq!(width, 9.0);
            } else {
                prop_assert!((low - 1e-9..=high + 1e-9).contains(&width), "{} at {}", width, share);
            }
            for &(share, width_m) in &profile {
                prop_assert!((link.width_at(share) - width_m).abs() < 1e-9);
            }
        }

        #[test]
        fn parts_joined_again_are_as_wide_as_the_whole(profile in profiles(), cut in 0.05..0.95f64, is_turned: bool, share in 0.0..1.0f64) {
            let whole = street(&profile);
            let (mut first, mut second) = (whole.clone(), whole.clone());
            first.part_profile(0.0, cut);
            second.part_profile(cut, 1.0);
            prop_assert_eq!((first.profile_error(), second.profile_error()), (None, None));
            let of_part = if share < cut { first.width_at(share / cut) } else { second.width_at((share - cut) / (1.0 - cut)) };
            prop_assert!((of_part - whole.width_at(share)).abs() < 1e-6, "{} for {}", of_part, whole.width_at(share));
            if is_turned {
                second.reverse_profile();
            }
            first.join_profile(100.0 * cut, &second, 100.0 * (1.0 - cut), is_turned);
            prop_assert_eq!(first.profile_error(), None);
            prop_assert!((first.width_at(share) - whole.width_at(share)).abs() < 1e-6);
            let (joined, whole) = (WidthAt::mean(&first.profile), WidthAt::mean(&whole.profile));
            prop_assert!((joined.unwrap_or(9.0) - whole.unwrap_or(9.0)).abs() < 1e-6, "{:?} for {:?}", joined, whole);
        }
    }

    #[test]
    fn a_joint_of_two_widths_is_a_step() {
        let mut link = street(&[(0.0, 6.0), (1.0, 8.0)]);
        link.join_profile(30.0, &Link { width_m: 12.0, ..lane(2, 3) }, 10.0, false);
        assert_eq!(link.profile_error(), None);
        assert!(
            [(0.0, 6.0), (0.75, 8.0), (0.76, 12.0), (1.0, 12.0)].iter().all(|&(share, w)| (link.width_at(share) - w).abs() < 0.01)
        );
        assert_eq!(link.width_m, 8.25, "the mean of 7 m over 30 m and 12 m over 10 m");
    }

    #[test]
    fn a_profile_comes_back_from_its_file_and_is_not_written_where_there_is_none() {
        let mut graph = CityGraph { nodes: vec![node(1, 0.0, 0.0), node(2, 90.0, 0.0)], ..Default::default() };
        graph.links = vec![street(&[(0.0, 6.5), (0.25, 9.0), (1.0, 12.25)])];
        let text = file::to_text(&graph).expect("plain values");
        assert_eq!(file::parse::<CityGraph>(&text, "t").unwrap_or_else(|e| panic!("{e}")), graph);
        graph.links[0].profile.clear();
        assert!(!file::to_text(&graph).expect("plain values").contains("profile"));
    }

    #[test]
    fn a_profile_that_is_none_is_told_with_its_link_and_entry() {
        for (profile, told) in [
            (vec![(0.0, 6.0), (1.2, 6.0)], "entry 2 of the `profile` of link 7: its share is 1.2; it must lie from 0 to 1"),
            (vec![(f64::NAN, 6.0)], "entry 1 of the `profile` of link 7: its share is NaN; it must lie from 0 to 1"),
            (
                vec![(0.0, 6.0), (0.5, 7.0), (0.5, 8.0)],
                "entry 3 of the `profile` of link 7: its share of 0.5 is not beyond the 0.5 of the entry before it; shares ascend",
            ),
            (vec![(0.0, 0.0)], "entry 1 of the `profile` of link 7: its width is 0.0 m; it must be more than 0 and at most 400 m"),
            (
                vec![(0.5, f64::INFINITY)],
                "entry 1 of the `profile` of link 7: its width is inf m; it must be more than 0 and at most 400 m",
            ),
        ] {
            let graph = CityGraph {
                nodes: vec![node(1, 0.0, 0.0), node(2, 90.0, 0.0)],
                links: vec![street(&profile)],
                ..Default::default()
            };
            let errors = graph.validate();
            assert!(matches!(errors[..], [GraphError::Profile { link: Id(7), .. }]), "{errors:?}");
            assert_eq!(errors[0].to_string(), told);
        }
    }

    #[test]
    fn edits_keep_the_profile_or_put_one_width_in_its_place() {
        let edited = |edits: &str| {
            let mut graph = CityGraph { nodes: vec![node(1, 0.0, 0.0), node(2, 100.0, 0.0)], ..Default::default() };
            graph.links = vec![street(&[(0.0, 6.0), (1.0, 12.0)])];
            let overrides: GraphOverrides = file::parse(&format!("(edits: [{edits}])"), "t").unwrap_or_else(|e| panic!("{e}"));
            assert_eq!(overrides.apply(&mut graph), []);
            assert_eq!(graph.validate(), []);
            graph.links
        };
        let is_near = |found: f64, want: f64| (found - want).abs() < 0.01;
        let links = edited("Width(target: (at: (50, 0)), width_m: 7)");
        assert!(links[0].profile.is_empty() && links[0].width_at(0.9) == 7.0);
        let links = edited("Link(target: (at: (50, 0)), width_m: 8, name: \"A\")");
        assert!(links[0].profile.is_empty() && links[0].width() == 8.0);
        assert_eq!(edited("Name(target: (at: (50, 0)), name: \"B\")")[0].profile.len(), 2);
        let links = edited("SplitLink((at: (40, 0)))");
        assert!(
            is_near(links[0].width_at(1.0), 8.4) && is_near(links[1].width_at(0.0), 8.4) && is_near(links[1].width_at(1.0), 12.0)
        );
        assert_eq!((links[0].width(), links[1].width()), (7.2, 10.2), "each part has its own mean");
        // The longer part, which keeps its id, runs the other way after.
        let links = edited("SplitLink((at: (40, 0))), RemoveNode((at: (40, 0)))");
        assert!(links.len() == 1 && links[0].from == Id(2), "{links:?}");
        assert!(
            is_near(links[0].width_at(0.0), 12.0) && is_near(links[0].width_at(0.6), 8.4) && is_near(links[0].width_at(1.0), 6.0)
        );
        let links = edited("AddSquare((outline: [(40, -20), (60, -20), (60, 20), (40, 20)]))");
        assert!(is_near(links[0].width_at(1.0), 8.4) && is_near(links[1].width_at(0.0), 9.6), "{links:?}");
    }
}
