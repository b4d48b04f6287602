//! What the targets of the store share.

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

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

/// Does something that may allocate no more at once than four times an input and 1 MiB.
pub fn bounded<T>(input: usize, what: impl FnOnce() -> T) -> T {
    MOST.store(4 * input + (1 << 20), Ordering::Relaxed);
    let result = what();
    MOST.store(usize::MAX, Ordering::Relaxed);
    result
}

/// Deflate that does not shrink.
pub fn deflate(content: &[u8]) -> Vec<u8> {
    let mut out = Vec::with_capacity(content.len() + 16);
    let mut blocks = content.chunks(0xFFFF).peekable();
    if content.is_empty() {
        out.extend([1, 0, 0, 0xFF, 0xFF]);
    }
    while let Some(block) = blocks.next() {
        let length = block.len() as u16;
        out.push(u8::from(blocks.peek().is_none()));
        out.extend(length.to_le_bytes());
        out.extend((!length).to_le_bytes());
        out.extend(block);
    }
    out
}

/// A blob of a kind as stored.
pub fn blob(kind: u8, content: &[u8]) -> Vec<u8> {
    let mut stored = vec![kind];
    let mut size = content.len();
    while size >= 0x80 {
        stored.push(size as u8 | 0x80);
        size >>= 7;
    }
    stored.push(size as u8);
    stored.extend(deflate(content));
    stored
}

/// An index's file.
pub fn index(content: &[u8]) -> Vec<u8> {
    let mut sealed = (content.len() as u32).to_le_bytes().to_vec();
    sealed.extend(deflate(content));
    let mut stored = b"VEDUTA\0\x01".to_vec();
    stored.extend(veduta_store::FORMAT_VERSION.to_le_bytes());
    stored.extend(blake3::hash(&sealed).as_bytes());
    stored.extend(sealed);
    stored
}
