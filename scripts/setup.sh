#!/bin/sh
# Installs, through apt where that is possible, what the tests need beyond cargo and lack: the tools that the README's examples are run
# with, and Mesa's software drivers for Vulkan and GL, which the wgpu renderer is tested with. Without the tools the tests cannot run;
# without the drivers those of the wgpu renderer are left out, and that is said loudly.
set -eu

tools=""
tool() {
    command -v "$1" >/dev/null 2>&1 || tools="$tools $2"
}
tool nc netcat-openbsd
tool jq jq
tool python3 python3
sh scripts/apt_install.sh $tools

drivers=""
sh scripts/driver.sh lavapipe >/dev/null || drivers="mesa-vulkan-drivers"
sh scripts/driver.sh gl >/dev/null || drivers="$drivers libegl1 libgl1-mesa-dri"
sh scripts/apt_install.sh $drivers || echo "setup: WARNING: not all of the wgpu renderer will be tested" >&2
