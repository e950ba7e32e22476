//! The `rigd` binary: see [`rigd::cli`].

use std::process::ExitCode;

fn main() -> ExitCode {
    match rigd::cli::run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("rigd: {}", rigd::cli::printable(&format!("{error:#}")));
            ExitCode::FAILURE
        }
    }
}
