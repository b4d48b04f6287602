//! The `veduta-bake` program.

mod allocator;
mod program;

use std::process::ExitCode;

fn main() -> ExitCode {
    program::run()
}
