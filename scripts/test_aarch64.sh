#!/bin/sh
# test_aarch64.sh CARGO: the accepted pictures and vertices once more, by a program for AArch64 under emulation. The standard library for it
# comes from rustup; where rustup has none, Debian's compiler and library are taken. The linker and the emulator are Debian's.
set -eu

cargo=$1
target=aarch64-unknown-linux-gnu
packages=""
[ -f /usr/aarch64-linux-gnu/lib/crt1.o ] || packages="gcc-aarch64-linux-gnu libc6-dev-arm64-cross"
command -v qemu-aarch64-static >/dev/null 2>&1 || packages="$packages qemu-user-static"
sh scripts/apt_install.sh $packages

# Debian's packages of one release fit each other. Those of AArch64 cannot be installed beside those of this machine, only unpacked.
take_debians() {
    export PATH="/usr/bin:$PATH"
    sh scripts/apt_install.sh rustc-web cargo-web libstd-rust-web-dev
    cargo=/usr/bin/cargo
    folder=$PWD/target/aarch64-std
    rm -rf "$folder"
    mkdir -p "$folder/lists/partial" "$folder/sysroot"
    (
        cd "$folder"
        apt() { apt-get -qq -o APT::Sandbox::User=root -o APT::Architectures=amd64,arm64 -o Dir::State::Lists="$folder/lists" -o Dir::Cache="$folder" "$@"; }
        apt update
        apt download libstd-rust-web-dev:arm64
        dpkg-deb -x libstd-rust-web-dev_*_arm64.deb sysroot
    )
    mkdir -p "$folder/sysroot/lib/rustlib"
    ln -s "$folder/sysroot/usr/lib/rustlib/$target" /usr/lib/rustlib/x86_64-unknown-linux-gnu "$folder/sysroot/lib/rustlib/"
    export RUSTFLAGS="--sysroot $folder/sysroot"
    export CARGO_TARGET_DIR="$folder/build"
}

rustup target add "$target" 2>/dev/null || take_debians
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc
export CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUNNER="qemu-aarch64-static -L /usr/aarch64-linux-gnu"
exec "$cargo" test --locked --target "$target" --test golden
