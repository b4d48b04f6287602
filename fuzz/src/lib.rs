//! What the targets of the store share.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use veduta_city::{GridPolygon, GridPos, Massing};
use veduta_store::{HousePart, RegionHouses};

/// The system's allocator, which ends the program when more is asked for at once than is allowed.
pub struct Bounded;

static MOST: AtomicUsize = AtomicUsize::new(usize::MAX);

fn check(size: usize) {
    let most = MOST.load(Ordering::Relaxed);
    if size > most {
        MOST.store(usize::MAX, Ordering::Relaxed);
        panic!("{size} bytes are allocated at once, {most} are allowed");
    }
}

// SAFETY: all is left to the system's allocator.
unsafe impl GlobalAlloc for Bounded {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        check(layout.size());
        // SAFETY: as asked.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: as asked.
        unsafe { System.dealloc(at, layout) }
    }

    unsafe fn realloc(&self, at: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        check(size);
        // SAFETY: as asked.
        unsafe { System.realloc(at, layout, size) }
    }
}

/// Does something with content that may allocate no more at once than four times its size and 1 MiB.
pub fn bounded<T>(content: &[u8], what: impl FnOnce() -> T) -> T {
    MOST.store(4 * content.len() + (1 << 20), Ordering::Relaxed);
    let result = what();
    MOST.store(usize::MAX, Ordering::Relaxed);
    result
}

/// A blob of a kind as stored.
pub fn blob(kind: u8, content: &[u8]) -> Vec<u8> {
    [&[kind], content].concat()
}

/// An index's file.
pub fn index(content: &[u8]) -> Vec<u8> {
    let mut stored = b"VEDUTA\0\x01".to_vec();
    stored.extend(veduta_store::FORMAT_VERSION.to_le_bytes());
    stored.extend(blake3::hash(content).as_bytes());
    stored.extend(content);
    stored
}

/// Houses of a region of three cells.
pub fn houses() -> RegionHouses {
    let part = |x: i32| {
        let corners = [(x, 0), (x + 10_240, 0), (x + 10_240, 10_240), (x, 10_240)].map(|(x, y)| GridPos(x, y));
        HousePart { style: 0, massing: Massing::block(GridPolygon::simple(corners.to_vec()), 9_000) }
    };
    let mut houses = RegionHouses::default();
    houses.push([part(0)]);
    houses.push([part(10_240), part(20_480)]);
    houses.push([part(-99_999)]);
    houses
}
