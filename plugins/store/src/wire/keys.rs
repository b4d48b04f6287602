use serde::{Deserialize, Serialize};

use super::{Malformed, columns::Pull, expecting};
use crate::RegionKey;

/// Keys of regions: how deep each lies, and how many squares of its size lie between the end of the one before and it. In an index they
/// ascend, and so do those that a region names, so that neighbours cost next to nothing; others come back as well.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Keys {
    depths: Vec<u8>,
    gaps: Vec<i32>,
}

/// Told as the depth of what is no region: it cannot be read back.
const NOWHERE: u32 = RegionKey::DEEPEST + 1;

impl Keys {
    /// As seen from one; those of no region are `None`.
    pub(crate) fn of(own: RegionKey, keys: impl IntoIterator<Item = Option<RegionKey>>) -> Self {
        let (mut told, mut last) = (Self::default(), Last::new(own));
        for key in keys {
            let depth = key.map_or(NOWHERE, RegionKey::depth);
            told.depths.push(depth as u8);
            told.gaps.extend(key.map(|key| key.square() as i32 - last.next(depth)));
            last = key.map_or(last, Last::of);
        }
        told
    }

    pub(crate) fn pull(self, own: RegionKey) -> Result<Vec<RegionKey>, Malformed> {
        let mut gaps = Pull::new("gaps between regions", self.gaps);
        let mut last = Last::new(own);
        let mut keys = expecting(self.depths.len());
        for depth in self.depths.into_iter().map(u32::from) {
            let square = if depth < NOWHERE { last.next(depth).checked_add(gaps.take()?) } else { None };
            let square = square.and_then(|square| u32::try_from(square).ok());
            let key = square.and_then(|square| RegionKey::new(square, depth)).ok_or(Malformed::Reason("a region lies nowhere"))?;
            last = Last::of(key);
            keys.push(key);
        }
        gaps.finish()?;
        Ok(keys)
    }
}

/// Where the next key is expected: where the last one ends, in smallest squares.
#[derive(Clone, Copy)]
struct Last(u32);

impl Last {
    /// Before the first key: where the region begins that names them, for most are those about it. That of the whole grid is 0.
    fn new(own: RegionKey) -> Self {
        Self(own.square() << (RegionKey::DEEPEST - own.depth()))
    }

    fn of(key: RegionKey) -> Self {
        Self((key.square() + 1) << (RegionKey::DEEPEST - key.depth()))
    }

    /// The next square so many steps down.
    fn next(self, depth: u32) -> i32 {
        self.0.div_ceil(1 << (RegionKey::DEEPEST - depth)) as i32
    }
}

#[cfg(test)]
mod tests {
    use proptest::collection::vec;
    use proptest::prelude::*;

    use super::*;
    use crate::code::{Prior, press};

    fn any_key() -> impl Strategy<Value = RegionKey> {
        (0..=RegionKey::DEEPEST).prop_flat_map(|depth| (0..1_u32 << depth).prop_map(move |square| key(square, depth)))
    }

    proptest! {
        #[test]
        fn any_keys_come_back_from_any_region(own in any_key(), mut keys in vec(any_key(), 0..40), is_sorted in any::<bool>()) {
            if is_sorted {
                keys.sort_by_key(|key| key.first_code());
            }
            let told = Keys::of(own, keys.iter().copied().map(Some));
            prop_assert_eq!(told.pull(own), Ok(keys));
        }
    }

    /// What most regions name: those about them, which ascend with few gaps.
    #[test]
    fn regions_about_a_region_take_few_bytes() {
        let bytes = |own: RegionKey, keys: &[RegionKey]| {
            let mut out = Vec::new();
            press(&Keys::of(own, keys.iter().copied().map(Some)), None, Prior::None, &mut out);
            out.len()
        };
        let about: Vec<RegionKey> = [0, 1, 2, 3, 8, 9, 12, 13, 14].map(|n| key(0x35_5550 + n, 24)).into();
        let far: Vec<RegionKey> = (0..9).map(|n| key(0x35_5550 + n * 0x1111, 24)).collect();
        let (about, far) = (bytes(key(0x35_5553, 24), &about), bytes(key(0x35_5553, 24), &far));
        assert_eq!((about, far), (9, 10), "bytes, of which one counts the values");
    }

    fn key(square: u32, depth: u32) -> RegionKey {
        RegionKey::new(square, depth).expect("a key")
    }

    #[test]
    fn neighbours_cost_nothing_and_all_come_back() {
        let keys = [key(5, 4), key(6, 4), key(28, 6), key(29, 6), key(15, 5), key((1 << 30) - 1, 30), key(0, 30), key(0, 0)];
        let told = Keys::of(key(5, 4), keys.map(Some));
        assert_eq!(told.gaps[..5], [0; 5], "side by side");
        assert_eq!(told.pull(key(5, 4)).expect("told"), keys);
        assert!(Keys::of(key(0, 0), []).pull(key(0, 0)).expect("told").is_empty());
    }

    #[test]
    fn what_lies_nowhere_is_no_region() {
        let nowhere = Malformed::Reason("a region lies nowhere");
        assert_eq!(Keys::of(key(3, 5), [None]).pull(key(3, 5)), Err(nowhere));
        assert_eq!(Keys::of(key(3, 5), [Some(key(3, 5)), None, Some(key(4, 5))]).pull(key(3, 5)), Err(nowhere));
        for (depth, gap) in [(31, 0), (4, -6), (4, 11), (0, 0), (30, i32::MAX), (255, 0)] {
            let told = Keys { depths: vec![depth], gaps: vec![gap] };
            assert_eq!(told.pull(key(5, 4)), Err(nowhere), "{depth} {gap}");
        }
        let short = Keys { depths: vec![4, 4], gaps: vec![0] };
        assert!(short.pull(key(5, 4)).is_err());
        let long = Keys { depths: vec![4], gaps: vec![0, 0] };
        assert!(long.pull(key(5, 4)).is_err());
    }
}
