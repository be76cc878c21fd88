//! The binary `airball`.

use std::process::ExitCode;

fn main() -> ExitCode {
    airball::program::run()
}
