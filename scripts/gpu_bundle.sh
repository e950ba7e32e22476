#!/bin/sh
# gpu_bundle.sh CARGO FOLDER: what tells how rigd does on a GPU of another machine, without cargo or network there: the program, tests that
# are built already, the files they read, and gpu_check.sh, which runs it all.
set -eu

cargo=$1
bundle=$2
# Parity with rigd's own renderer, and vertices against the oracle.
tests="parity materials extensions skinning"
log=$(mktemp)
trap 'rm -f "$log"' EXIT

set --
for test in $tests throughput; do
    set -- "$@" --test "$test"
done
"$cargo" test --release --locked --no-run --bin rigd "$@" --message-format=json-render-diagnostics >"$log"
# The program that was built for this kind of target.
built() { sed -n "s/.*\"kind\":\[\"$1\"\].*\"name\":\"$2\".*\"test\":$3.*\"executable\":\"\([^\"]*\)\".*/\1/p" "$log" | tail -n 1; }

rm -rf "$bundle"
mkdir -p "$bundle/bin/tests" "$bundle/tests" "$bundle/assets"
cp "$(built bin rigd false)" "$bundle/bin/rigd"
cp "$(built test throughput true)" "$bundle/bin/throughput"
for test in $tests; do
    cp "$(built test "$test" true)" "$bundle/bin/tests/$test"
done
programs=$(find "$bundle/bin" -type f)
strip $programs
gzip $programs
cp -R tests/cases "$bundle/tests/"
cp -R assets/cse169 assets/mit6837 assets/gltf "$bundle/assets/"
cp LICENSE-APACHE LICENSE-MIT "$bundle/"
cp scripts/gpu_check.sh "$bundle/check.sh"

size=$(du -sm "$bundle" | cut -f 1)
echo "$bundle: $size MiB; copy it to an x86-64 Linux machine with a Vulkan driver and run ./check.sh there"
[ "$size" -lt 60 ] || { echo "$bundle is larger than 60 MiB" >&2; exit 1; }
