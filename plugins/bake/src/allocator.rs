//! The program's memory.

use core::ffi::c_long;

use libmimalloc_sys::{mi_option_set_default, mi_option_t};

/// Baking makes and drops millions of small lists, at which the platforms' own allocators are slower.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// How long memory that was freed is kept for what asks next, milliseconds: mimalloc's `mi_option_purge_delay`, which its bindings do not
/// name.
const PURGE_DELAY: mi_option_t = 15;

/// Gives memory back to the system as soon as it is free, for work that goes through a large city stage by stage: its peak is then that
/// of the largest stage. `MIMALLOC_PURGE_DELAY` in the environment goes before.
pub(crate) fn keep_no_memory() {
    set_default(PURGE_DELAY, 0);
}

#[allow(unsafe_code, reason = "options of the allocator are set through its C interface")]
fn set_default(option: mi_option_t, value: c_long) {
    // SAFETY: it sets a number in a static table, unless the environment has set it; the main thread does so before there are others.
    unsafe { mi_option_set_default(option, value) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[allow(unsafe_code, reason = "options of the allocator are read through its C interface")]
    fn the_number_is_that_of_the_purge_delay() {
        // SAFETY: they read a static table; no other test sets it.
        let get = |option| unsafe { libmimalloc_sys::mi_option_get(option) };
        let told = std::env::var("MIMALLOC_PURGE_DELAY").ok().and_then(|value| value.parse().ok());
        assert_eq!(get(PURGE_DELAY), told.unwrap_or(1000), "the default of this version of mimalloc");
        keep_no_memory();
        assert_eq!(get(PURGE_DELAY), told.unwrap_or(0));
    }
}
