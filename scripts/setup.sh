#!/bin/sh
# Installs, through apt where that is possible, what the tests need beyond cargo and lack: the tools that the README's examples are run
# with, and Mesa's software drivers for Vulkan and GL, which the wgpu renderer is tested with. Without the tools the tests cannot run;
# without the drivers those of the wgpu renderer are left out, and that is said loudly.
set -eu

missing_tools=""
missing_drivers=""

tool() {
    command -v "$1" >/dev/null 2>&1 || missing_tools="$missing_tools $2"
}

tool nc netcat-openbsd
tool jq jq
tool python3 python3
sh scripts/driver.sh lavapipe >/dev/null || missing_drivers="mesa-vulkan-drivers"
sh scripts/driver.sh gl >/dev/null || missing_drivers="$missing_drivers libegl1 libgl1-mesa-dri"

missing="$missing_tools $missing_drivers"
[ "$missing" != " " ] || exit 0

# $1: what could not be installed, and why.
give_up() {
    if [ -n "$missing_drivers" ]; then
        echo "setup: WARNING: there are not all software drivers ($1): the wgpu renderer will NOT be fully tested" >&2
    fi
    if [ -n "$missing_tools" ]; then
        echo "setup: please install:$missing_tools (or what your system calls these), then try again ($1)" >&2
        exit 1
    fi
    exit 0
}

[ "$(uname -s)" = Linux ] && command -v apt-get >/dev/null 2>&1 || give_up "it cannot be installed here by itself"
if [ "$(id -u)" = 0 ]; then
    run=""
elif sudo -n true 2>/dev/null; then
    run="sudo -n"
else
    give_up "sudo apt-get install $missing would bring it"
fi
echo "setup: installing $missing"
export DEBIAN_FRONTEND=noninteractive
$run apt-get update -qq || give_up "apt-get update failed"
# Each by itself: the tests can do without the drivers.
for package in $missing; do
    $run apt-get install -y -qq --no-install-recommends "$package" >/dev/null || give_up "installing $package failed"
done
