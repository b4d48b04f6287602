use serde::{Deserialize, Serialize};

use super::{Malformed, columns::Pull};
use crate::RegionKey;

/// Keys of regions, ascending: how deep each lies, and how many squares of its size lie between it and the one before.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Keys {
    depths: Vec<u8>,
    gaps: Vec<i32>,
}

/// Told as the depth of what is no region: it cannot be read back.
const NOWHERE: u32 = RegionKey::DEEPEST + 1;

impl Keys {
    /// As seen from a sound one; those of no region are `None`.
    pub(crate) fn of(own: RegionKey, keys: impl IntoIterator<Item = Option<RegionKey>>) -> Self {
        let (mut told, mut last) = (Self::default(), Last::new(own));
        for key in keys {
            let key = key.filter(|key| key.is_sound());
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
        let mut keys = Vec::with_capacity(self.depths.len());
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

/// Where the last key ends, in smallest squares.
#[derive(Clone, Copy)]
struct Last(u32);

impl Last {
    /// Before the first key, which is looked for about a region.
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
    use super::*;

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
        assert_eq!(Keys::of(key(3, 5), [Some(RegionKey(0))]).pull(key(3, 5)), Err(nowhere));
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
