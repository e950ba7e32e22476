//! What the graphics libraries find in the environment. Never lives here: what they find on the machine.

use std::path::Path;

/// Where a session of a desktop has its sockets.
const RUNTIME_DIR: &str = "XDG_RUNTIME_DIR";

/// Mesa looks for a display whatever it is asked for, and where it is not told where to look, writes to standard error that
/// `XDG_RUNTIME_DIR` is invalid. So it is told of a folder that is not there. As the environment of a process that runs cannot be changed
/// safely, the process starts its own program once more; where that fails, it goes on as it is.
pub(super) fn set_for_graphics() {
    let is_valid = |folder: &std::ffi::OsString| Path::new(folder).is_absolute();
    if cfg!(target_os = "linux") && !std::env::var_os(RUNTIME_DIR).as_ref().is_some_and(is_valid) {
        restart_with(RUNTIME_DIR, "/nonexistent");
    }
}

#[cfg(unix)]
fn restart_with(name: &str, value: &str) {
    use std::os::unix::process::CommandExt;
    let Ok(program) = std::env::current_exe() else {
        return;
    };
    let mut arguments = std::env::args_os();
    let mut command = std::process::Command::new(program);
    if let Some(own) = arguments.next() {
        command.arg0(own);
    }
    // Comes back only where it failed.
    let _ = command.args(arguments).env(name, value).exec();
}

#[cfg(not(unix))]
fn restart_with(_: &str, _: &str) {}
