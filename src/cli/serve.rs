//! `rigd serve`.

use super::exit::Stopped;
use super::terminal::{Warnings, note, print, printable};
use super::values::address;
use super::{RendererArgs, local};
use crate::formats::Source;
use crate::server::{Server, Stopper, Timeouts};
use crate::service::Service;
use anyhow::Context;
use clap::Args;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

#[derive(Args, Clone)]
pub(super) struct ServeArgs {
    /// Files of a rig to load before listening, in any order
    pub(super) files: Vec<String>,
    /// Address to listen on; port 0 lets the system choose
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:7443", value_parser = address)]
    listen: String,
    /// Folder below which requests may name files; without it they bring their files along
    #[arg(long, value_name = "DIR")]
    root: Option<PathBuf>,
    #[command(flatten)]
    pub(super) renderer: RendererArgs,
}

pub(super) fn run(args: &ServeArgs) -> anyhow::Result<()> {
    // Before anything slow, so that a stop asked for meanwhile is heard.
    let signals = Signals::new([SIGTERM, SIGINT]).context("cannot listen for signals")?;
    let stopping = Arc::new(Mutex::new(None));
    std::thread::spawn({
        let stopping = Arc::clone(&stopping);
        move || stop_on(signals, &stopping)
    });
    let source = match &args.root {
        Some(folder) => Source::rooted(folder)
            .with_context(|| format!("cannot open the root folder {}", folder.display()))?,
        None => Source::inline_only(),
    };
    let engine = args.renderer.open()?;
    let loaded = local::load(&engine, &args.files, &mut Warnings::default())?;
    let adapter = engine.adapter().to_string();
    let service = Service::new(engine, source);
    let server = Server::bind(&args.listen, service, Timeouts::default())
        .with_context(|| format!("cannot listen on {}", args.listen))?;
    let address = server.address()?;
    if !address.ip().is_loopback() {
        Warnings::default().tell(&format!(
            "{address} can be reached from other machines, and whoever reaches it may load and draw rigs"
        ));
    }
    *stopping.lock().unwrap_or_else(PoisonError::into_inner) = Some(server.stopper()?);
    let (version, name) = (env!("CARGO_PKG_VERSION"), &loaded.name);
    // On its own line and flushed, so that a script can wait for it and read the port. Once it has what it wanted it may close its end,
    // which is no reason to stop.
    print(&printable(&format!(
        "rigd {version} listening on {address}\nrig `{name}` loaded, drawing with {adapter}"
    )))?;
    server.run()?;
    Ok(())
}

/// The first signal stops the server, one before there is a server or a second one ends the process at once.
fn stop_on(mut signals: Signals, server: &Mutex<Option<Stopper>>) {
    for signal in signals.forever() {
        let stopper = server.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(stopper) = stopper else {
            std::process::exit(Stopped { signal }.code());
        };
        note("rigd: stopping; requests in hand are answered first");
        stopper.stop();
    }
}
