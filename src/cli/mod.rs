//! The command line: one file for each subcommand. Never lives here: anything that a client of the daemon could not ask for.

mod builtin;
mod call;
mod doctor;
mod inspect;
mod local;
mod render;
mod serve;
mod values;

pub use builtin::figure;

use clap::{Args, Parser, Subcommand};
use std::io::Write;

/// Keeps character rigs loaded, poses and skins them, and answers with pictures and vertices.
///
/// Without a subcommand it serves: `rigd monster.skel monster.skin` listens with that rig loaded. Without files it takes test.skel and
/// test.skin of the current folder where they exist, else its own built-in figure.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true)]
pub struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    serve: serve::ServeArgs,
}

#[derive(Subcommand)]
enum Command {
    /// Listen for requests until told to stop
    Serve(serve::ServeArgs),
    /// Draw a picture or a sequence of them, without a daemon
    Render(Box<render::RenderArgs>),
    /// Tell what is in the files of a rig, and what is odd about them
    Inspect(inspect::InspectArgs),
    /// Ask a running daemon something
    Call(call::CallArgs),
    /// Find out what this machine can draw with, and what is missing
    Doctor(RendererArgs),
    /// Print the description of the protocol, an OpenRPC document
    Openrpc,
}

/// What draws.
#[derive(Args, Clone, Default)]
struct RendererArgs {
    /// What draws: auto (a GPU, else the CPU), cpu, vulkan, gl, metal, dx12, or a part of an adapter's name
    #[arg(long, value_name = "WHICH", default_value = "auto")]
    adapter: String,
    /// Refuse whatever draws on the CPU
    #[arg(long)]
    require_gpu: bool,
    /// Threads for drawing on the CPU and for encoding [default: one for each core]
    #[arg(long, value_name = "COUNT", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

/// Runs what the arguments of the process ask for.
///
/// # Errors
/// As the subcommand has them, to be shown to the user.
pub fn run() -> anyhow::Result<()> {
    let cli = Cli::parse();
    match cli.command.unwrap_or(Command::Serve(cli.serve)) {
        Command::Serve(args) => serve::run(&args),
        Command::Render(args) => render::run(&args),
        Command::Inspect(args) => inspect::run(&args),
        Command::Call(args) => call::run(&args),
        Command::Doctor(args) => doctor::run(&args),
        Command::Openrpc => print(&format!("{:#}", crate::protocol::openrpc())),
    }
}

/// Text as a terminal may have it: names come from files, and may hold what a terminal would obey.
pub fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        if c.is_control() && c != '\n' {
            shown.extend(c.escape_default());
        } else {
            shown.push(c);
        }
    }
    shown
}

/// Writes a line to standard output. A reader that has seen enough and closed its end is no failure.
fn print(text: &str) -> anyhow::Result<()> {
    match writeln!(std::io::stdout(), "{text}") {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(error.into()),
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn files_without_a_subcommand_are_served() {
        let cli = Cli::try_parse_from(["rigd", "monster.skel", "monster.skin"]).unwrap();
        assert!(cli.command.is_none());
        assert_eq!(cli.serve.files.len(), 2);
    }
}
