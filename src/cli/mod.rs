//! The command line: one file for each subcommand. Never lives here: anything that a client of the daemon could not ask for.

mod angle;
mod builtin;
mod call;
mod doctor;
mod environment;
mod exit;
mod files;
mod inspect;
mod local;
mod numbers;
mod render;
mod serve;
mod terminal;
mod values;

pub use builtin::figure;

use crate::protocol::nearest;
use clap::error::ErrorKind;
use clap::{Args, CommandFactory, Parser, Subcommand};
use exit::Outcome;
use std::path::Path;
use std::process::ExitCode;

/// Keeps character rigs loaded, poses and skins them, and answers with pictures and vertices.
///
/// Without a subcommand it serves: `rigd monster.skel monster.skin` listens with that rig loaded. Without files it takes test.skel and
/// test.skin of the current folder where they exist, else its own built-in figure.
#[derive(Parser)]
#[command(version, args_conflicts_with_subcommands = true, after_help = exit::CODES)]
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

/// Runs what the arguments of the process ask for, and gives what it is to end with.
pub fn run() -> ExitCode {
    let first = std::env::args_os().nth(1).unwrap_or_default();
    if let Some(first) = first.to_str()
        && let Some(meant) = mistyped(first)
    {
        terminal::note(&format!(
            "error: there is neither a subcommand nor a file `{first}`; did you mean `rigd {meant}`?"
        ));
        return exit::MISREAD.into();
    }
    match Cli::try_parse() {
        Ok(cli) => exit::code(cli.command.unwrap_or(Command::Serve(cli.serve)).run()),
        Err(error) if error.kind() == ErrorKind::InvalidUtf8 => {
            name_what_is_no_text();
            exit::MISREAD.into()
        }
        Err(error) => exit::misread(&error),
    }
}

/// Tells which arguments are not UTF-8, which the error of the parser does not.
fn name_what_is_no_text() {
    for argument in std::env::args_os().filter(|argument| argument.to_str().is_none()) {
        let shown = argument.display();
        terminal::note(&format!(
            "error: expected UTF-8, but found the argument `{shown}`"
        ));
    }
}

/// The subcommand that was meant by the first argument, which would else be taken for a file to serve.
fn mistyped(first: &str) -> Option<String> {
    let program = Cli::command();
    let known: Vec<&str> = program
        .get_subcommands()
        .map(clap::Command::get_name)
        .collect();
    let is_else = first.contains(['-', '.', '/', '\\']) || known.contains(&first);
    if is_else || Path::new(first).exists() {
        return None;
    }
    nearest(first, known.into_iter()).map(str::to_owned)
}

impl Command {
    fn run(self) -> anyhow::Result<Outcome> {
        if self.may_ask_for_gpus() {
            environment::set_for_graphics();
        }
        match self {
            Self::Serve(args) => serve::run(&args)?,
            Self::Render(args) => return render::run(&args),
            Self::Inspect(args) => return inspect::run(&args),
            Self::Call(args) => call::run(&args)?,
            Self::Doctor(args) => doctor::run(&args)?,
            Self::Openrpc => terminal::print(&format!("{:#}", crate::protocol::openrpc()))?,
        }
        Ok(Outcome::Done)
    }

    /// Whether the machine's graphics libraries may be asked what there is.
    fn may_ask_for_gpus(&self) -> bool {
        match self {
            Self::Serve(args) => args.renderer.may_ask_for_gpus(),
            Self::Render(args) => args.renderer.may_ask_for_gpus(),
            // It lists all there are, whichever is chosen.
            Self::Doctor(_) => true,
            Self::Inspect(_) | Self::Call(_) | Self::Openrpc => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arguments_are_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn a_mistyped_subcommand_is_no_file() {
        for (first, meant) in [
            ("rendr", Some("render")),
            ("Inspect", Some("inspect")),
            ("doctor", None),
            ("help", None),
            ("--help", None),
            ("server.glb", None),
            ("src", None),
            ("", None),
        ] {
            assert_eq!(mistyped(first).as_deref(), meant, "{first}");
        }
    }

    #[test]
    fn files_without_a_subcommand_are_served() {
        let cli = Cli::try_parse_from(["rigd", "monster.skel", "monster.skin"]).unwrap();
        assert!(cli.command.is_none());
        assert_eq!(cli.serve.files.len(), 2);
    }
}
