//! The `veduta-bake` program.

mod program;

use std::process::ExitCode;

/// Baking makes and drops millions of small lists, at which the platforms' own allocators are slower.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    program::run()
}
