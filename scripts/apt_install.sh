#!/bin/sh
# apt_install.sh PACKAGE...: installs them, where that takes no password. Elsewhere it says what is missing and fails.
set -eu
[ $# -gt 0 ] || exit 0

give_up() {
    echo "please install: $packages (or what your system calls these), then try again ($1)" >&2
    exit 1
}

packages="$*"
[ "$(uname -s)" = Linux ] && command -v apt-get >/dev/null 2>&1 || give_up "it cannot be installed here by itself"
if [ "$(id -u)" = 0 ]; then
    run=""
elif sudo -n true 2>/dev/null; then
    run="sudo -n"
else
    give_up "sudo apt-get install $packages would bring it"
fi
echo "installing $packages"
export DEBIAN_FRONTEND=noninteractive
$run apt-get update -qq || give_up "apt-get update failed"
$run apt-get install -y -qq --no-install-recommends "$@" >/dev/null || give_up "apt-get install failed"
