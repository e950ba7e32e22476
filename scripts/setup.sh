#!/bin/sh
# Installs, through apt where that is possible, what is missing of:
#   driver  a Vulkan driver: Mesa's software one where there is no other
#   tools   what the README's examples are run with: nc, jq, python3
# Where it may not install anything it says what to do.
set -eu

missing=""

driver() {
    # The loader reads its drivers' manifests from these folders.
    for manifest in /usr/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json "${VK_DRIVER_FILES:-}" "${VK_ICD_FILENAMES:-}"; do
        case "$1:$manifest" in
            any:*) [ -f "$manifest" ] && return ;;
            software:*lvp*) [ -f "$manifest" ] && return ;;
        esac
    done
    missing="$missing mesa-vulkan-drivers"
}

tool() {
    command -v "$1" >/dev/null 2>&1 || missing="$missing $2"
}

case " $* " in
    # Tests compare pictures, and so draw with the one driver that every machine can have.
    *" tools "*)
        driver software
        tool nc netcat-openbsd
        tool jq jq
        tool python3 python3
        ;;
    *) driver any ;;
esac

[ -n "$missing" ] || exit 0

if [ "$(uname -s)" != Linux ] || ! command -v apt-get >/dev/null 2>&1; then
    echo "setup: please install:$missing (or what your system calls these), then try again" >&2
    # Other systems bring drivers of their own.
    [ "$(uname -s)" != Linux ] && exit 0
    exit 1
fi
if [ "$(id -u)" = 0 ]; then
    run=""
elif sudo -n true 2>/dev/null; then
    run="sudo -n"
else
    echo "setup: please run:  sudo apt-get install$missing" >&2
    exit 1
fi
echo "setup: installing$missing"
export DEBIAN_FRONTEND=noninteractive
# shellcheck disable=SC2086 # both are lists of words
$run apt-get update -qq && $run apt-get install -y -qq --no-install-recommends $missing >/dev/null
