#!/bin/sh
# check.sh [ADAPTER]: what rigd makes of this machine's GPU, or of the adapter of this name as `bin/rigd doctor` lists it: whether it draws
# and skins as rigd's own renderer does, and how fast. Needs a Vulkan driver, and a glibc no older than where this was built.
set -u
cd "$(dirname "$0")" || exit 1
# The programs are packed for the journey.
find bin -name '*.gz' -exec gunzip {} +

adapter=${1:-vulkan}
export RIGD_REPOSITORY="$PWD" RIGD_TEST_ADAPTER="$adapter" RIGD_REQUIRE_ADAPTER=1 RIGD_MEASURE_SECONDS=3 NODEVICE_SELECT=1
mkdir -p out
failed=""

echo "== adapter"
bin/rigd doctor --adapter "$adapter" || failed="$failed doctor"

echo "== pictures"
look() {
    name=$1
    shift
    bin/rigd render "$@" -o "out/$name.png" --size 512x512 --adapter "$adapter" || failed="$failed $name"
}
look drake assets/cse169/drake/drake.rig
look bear assets/mit6837/bear/*
look reed assets/gltf/reed.glb

echo "== parity with rigd's own renderer, and vertices against the oracle"
for test in bin/tests/*; do
    log=out/${test##*/}.log
    "$test" >"$log" 2>&1 || failed="$failed $test"
    echo "-- $test"
    grep -E '^test .*(ok|FAILED)$|^[0-9]+ of [0-9]+ channels' "$log"
done

echo "== rates"
bin/throughput --nocapture >out/throughput.log 2>&1 || failed="$failed throughput"
grep 'frames/s' out/throughput.log

if [ -n "$failed" ]; then
    echo "== FAILED:$failed; out/ has the logs and the pictures that differ"
    exit 1
fi
echo "== all is as it should be"
