#!/bin/sh
# Installs, through apt where that is possible, what the tests need beyond cargo and lack: the tools that the README's examples are run
# with, and Mesa's software Vulkan driver, which the wgpu renderer is tested with. Without the tools the tests cannot run; without the
# driver those of the wgpu renderer are left out, and that is said loudly.
set -eu

missing_tools=""
missing_driver=""

tool() {
    command -v "$1" >/dev/null 2>&1 || missing_tools="$missing_tools $2"
}

tool nc netcat-openbsd
tool jq jq
tool python3 python3
sh scripts/has_driver.sh || missing_driver="mesa-vulkan-drivers"

missing="$missing_tools $missing_driver"
[ "$missing" != " " ] || exit 0

# $1: what could not be installed, and why.
give_up() {
    if [ -n "$missing_driver" ]; then
        echo "setup: WARNING: there is no software Vulkan driver ($1): the wgpu renderer will NOT be tested" >&2
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
# Each by itself: the tests can do without the driver.
for package in $missing; do
    $run apt-get install -y -qq --no-install-recommends "$package" >/dev/null || give_up "installing $package failed"
done
