//! What the process ends with. Never lives here: what it says before.

use super::terminal;
use std::process::ExitCode;

/// For the help; docs/operations.md says the same at length.
pub(super) const CODES: &str = "\
Exit codes: 0 done; 1 it could not be done, and standard error says why; 2 the command line cannot be read; 3 done, but with warnings \
under --strict; 128 and a signal's number where that signal ended it.";

/// The command line cannot be read.
pub(super) const MISREAD: u8 = 2;
/// Done, but with warnings.
const WARNED: u8 = 3;

/// What came of a subcommand that did what it was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Outcome {
    Done,
    /// With warnings, where that is to be told by the exit code.
    Warned,
}

impl Outcome {
    /// Under `--strict` warnings count.
    pub(super) fn of(warnings: &terminal::Warnings, is_strict: bool) -> Self {
        if is_strict && !warnings.is_empty() {
            Self::Warned
        } else {
            Self::Done
        }
    }
}

/// A signal ended the work before it was done.
#[derive(Debug, Clone, Copy, thiserror::Error)]
#[error("stopped")]
pub(super) struct Stopped {
    pub signal: i32,
}

impl Stopped {
    /// As shells count it.
    pub(super) fn code(self) -> i32 {
        128 + self.signal
    }
}

/// Tells what went wrong, where something did.
pub(super) fn code(result: anyhow::Result<Outcome>) -> ExitCode {
    let error = match result {
        Ok(Outcome::Done) => return ExitCode::SUCCESS,
        Ok(Outcome::Warned) => return WARNED.into(),
        Err(error) => error,
    };
    terminal::note(&format!("rigd: {error:#}"));
    let stopped = error.downcast_ref::<Stopped>();
    let code = stopped.and_then(|stopped| u8::try_from(stopped.code()).ok());
    code.map_or(ExitCode::FAILURE, ExitCode::from)
}

/// That of a command line that cannot be read, or that asks for help.
pub(super) fn misread(error: &clap::Error) -> ExitCode {
    if error.use_stderr() {
        // Where standard error cannot be written there is nobody left to tell.
        let _ = error.print();
        return MISREAD.into();
    }
    let printed = terminal::settle(error.print().and_then(|()| terminal::flush()));
    code(printed.map(|()| Outcome::Done))
}
