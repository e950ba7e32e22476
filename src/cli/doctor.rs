//! `rigd doctor`: what this machine can draw with, whether it does, and what to install where it cannot.

use super::{RendererArgs, local};
use crate::engine::adapters;
use crate::formats::Source;
use crate::protocol::frame as wire;
use crate::service::Service;
use std::time::Instant;

pub(super) fn run(args: &RendererArgs) -> anyhow::Result<()> {
    let found = adapters(args.threads);
    if found.is_empty() {
        println!("No graphics adapter was found.");
    }
    for (index, adapter) in found.iter().enumerate() {
        let mark = if index == 0 { "*" } else { " " };
        println!("{mark} {adapter}");
    }
    let has_vulkan = found.iter().any(|adapter| adapter.backend == "vulkan");
    if cfg!(target_os = "linux") && !has_vulkan {
        println!(
            "\n{}",
            advice(&std::fs::read_to_string("/etc/os-release").unwrap_or_default())
        );
    }
    let started = Instant::now();
    let engine = args.open()?;
    let adapter = engine.adapter().to_string();
    let loaded = local::load(&engine, &[])?;
    let service = Service::new(engine, Source::inline_only());
    let params = wire::FrameParams::of(loaded.name.as_str());
    let (frame, _) = local::ask::<_, wire::Frame>(&service, "frame.render", &params)?;
    let first = started.elapsed();
    let (again, _) = local::ask::<_, wire::Frame>(&service, "frame.render", &params)?;
    println!("\nDrew {}x{} with {adapter}.", frame.width, frame.height);
    println!(
        "First picture after {:.0} ms, the next one in {:.1} ms.",
        first.as_secs_f64() * 1e3,
        again.timings_ms.render
    );
    Ok(())
}

/// How to get a software Vulkan driver on this distribution.
fn advice(os_release: &str) -> String {
    let is = |family: &str| {
        let ids = os_release
            .lines()
            .filter(|line| line.starts_with("ID=") || line.starts_with("ID_LIKE="));
        ids.flat_map(|line| line.split(['=', ' ', '"']))
            .any(|word| word == family)
    };
    let command = if is("debian") || is("ubuntu") {
        "apt-get install mesa-vulkan-drivers"
    } else if is("fedora") || is("rhel") {
        "dnf install mesa-vulkan-drivers"
    } else if is("arch") {
        "pacman -S vulkan-swrast"
    } else if is("alpine") {
        "apk add mesa-vulkan-swrast"
    } else if is("suse") || is("opensuse") {
        "zypper install libvulkan_lvp"
    } else {
        return "There is no Vulkan driver. Install your GPU's, or Mesa's software one (lavapipe)."
            .to_owned();
    };
    format!("There is no Vulkan driver. Install your GPU's, or Mesa's software one:\n    {command}")
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
            ("ID=alpine\n", "apk add mesa-vulkan-swrast"),
            ("", "lavapipe"),
        ] {
            assert!(advice(os_release).contains(package), "{os_release}");
        }
    }
}
