//! The `rigd` binary: see [`rigd::cli`].

fn main() -> std::process::ExitCode {
    rigd::cli::run()
}
