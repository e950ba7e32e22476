//! `rigd doctor`: what this machine can draw with, whether it does, and what may be missing.

use super::terminal::{Warnings, print};
use super::{RendererArgs, local};
use crate::adapter::{AdapterInfo, AdapterKind};
use crate::engine::{Timings, adapters};
use crate::formats::Source;
use crate::protocol::frame::FrameParams;
use crate::protocol::{ErrorObject, Fault};
use crate::scene::Size;
use crate::service::Service;
use std::sync::Arc;
use std::time::Instant;

pub(super) fn run(args: &RendererArgs) -> anyhow::Result<()> {
    let found = adapters(args.threads());
    let started = Instant::now();
    let engine = args.open()?;
    let adapter = engine.adapter().clone();
    for other in &found {
        let is_chosen = (&other.name, other.backend) == (&adapter.name, adapter.backend);
        print(&format!("{} {other}", if is_chosen { "*" } else { " " }))?;
    }
    let is_gpu = |info: &AdapterInfo| info.kind < AdapterKind::Software;
    if cfg!(target_os = "linux") && !found.iter().any(is_gpu) {
        let os_release = std::fs::read_to_string("/etc/os-release").unwrap_or_default();
        print(&format!("\n{}", advice(&os_release)))?;
    }
    let loaded = local::load(&engine, &[], &mut Warnings::default())?;
    let service = Service::new(engine, Source::inline_only());
    let (size, _) = draw(&service, &loaded.name)?;
    let first = started.elapsed();
    let (_, again) = draw(&service, &loaded.name)?;
    print(&format!(
        "\nDrew {}x{} with {adapter}.\nFirst picture after {:.0} ms, the next one in {:.1} ms.",
        size.width,
        size.height,
        first.as_secs_f64() * 1e3,
        again.render.as_secs_f64() * 1e3
    ))
}

/// Draws a rig by the defaults of a frame request.
fn draw(service: &Arc<Service>, rig: &str) -> Result<(Size, Timings), ErrorObject> {
    let drawn = || {
        let engine = service.engine();
        let found = engine.rig(rig)?;
        let subject = service.subject(&FrameParams::of(rig), &found)?;
        let drawing = local::draw(engine, &found, subject, |frame, timings| {
            Ok((frame.size, timings))
        })?;
        drawing.wait()
    };
    drawn().map_err(|fault: Fault| fault.into())
}

/// How to get at a GPU that was not found, on this distribution.
fn advice(os_release: &str) -> String {
    let is = |family: &str| {
        let ids = os_release
            .lines()
            .filter(|line| line.starts_with("ID=") || line.starts_with("ID_LIKE="));
        ids.flat_map(|line| line.split(['=', ' ', '"']))
            .any(|word| word == family)
    };
    let package = if is("debian") || is("ubuntu") {
        "apt-get install mesa-vulkan-drivers"
    } else if is("fedora") || is("rhel") {
        "dnf install mesa-vulkan-drivers"
    } else if is("arch") {
        "pacman -S vulkan-radeon or vulkan-intel"
    } else if is("alpine") {
        "apk add mesa-vulkan-ati or mesa-vulkan-intel"
    } else if is("suse") || is("opensuse") {
        "zypper install libvulkan_radeon or libvulkan_intel"
    } else {
        "Mesa's Vulkan drivers"
    };
    format!(
        "No GPU was found. Where the machine has one, its Vulkan driver is missing or may not open the device (/dev/dri, /dev/nvidia0): \
         NVIDIA's driver brings its own, those for AMD and Intel come with\n    {package}"
    )
}

#[cfg(test)]
mod tests {
    use super::advice;

    #[test]
    fn advice_names_the_package_of_the_distribution() {
        for (os_release, package) in [
            ("ID=debian\n", "apt-get install mesa-vulkan-drivers"),
            (
                "ID=linuxmint\nID_LIKE=\"ubuntu debian\"\n",
                "apt-get install mesa-vulkan-drivers",
            ),
            (
                "ID=rocky\nID_LIKE=\"rhel centos fedora\"\n",
                "dnf install mesa-vulkan-drivers",
            ),
            ("ID=alpine\n", "mesa-vulkan-intel"),
            ("", "Mesa's Vulkan drivers"),
        ] {
            assert!(advice(os_release).contains(package), "{os_release}");
        }
    }
}
