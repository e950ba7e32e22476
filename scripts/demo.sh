#!/bin/sh
# demo.sh RIGD SHEET OUT: starts the daemon RIGD, asks it for pictures, vertices and answers about the built-in figure over TCP, lets the
# client SHEET lay some out in one picture, draws rigs of assets/, and leaves everything in the folder OUT.
set -eu

rigd=$1
sheet=$2
out=$3
mkdir -p "$out"

# Port 0: whatever runs on the usual one is left alone. The first line that the daemon prints ends in its address.
: >"$out/rigd.log"
"$rigd" serve --listen 127.0.0.1:0 >"$out/rigd.log" 2>&1 &
daemon=$!
trap 'kill "$daemon" 2>/dev/null || true' EXIT INT TERM
address=""
tries=0
while [ -z "$address" ]; do
    address=$(sed -n 's/^rigd .* listening on //p' "$out/rigd.log")
    tries=$((tries + 1))
    if [ "$tries" -gt 300 ] || ! kill -0 "$daemon" 2>/dev/null; then
        cat "$out/rigd.log" >&2
        exit 1
    fi
    sleep 0.05
done
sed -n 's/^rig .* drawing with /drawing with /p' "$out/rigd.log"

call() {
    "$rigd" call --connect "$address" "$@" >/dev/null 2>&1 || { "$rigd" call --connect "$address" "$@"; exit 1; }
}

"$sheet" "$address" "$out/sheet.png"

# A stored pose, built up in steps: a moment of a clip, a turn about the world's axis, an expression.
call pose.set '{"rig": "figure", "pose": {"clip": {"name": "walk", "time": 0.2}, "dofs": {"pelvis.tz": 0, "morph.smile": 0.8}}}'
call pose.rotate '{"rig": "figure", "joint": "head", "axis": [0, 1, 0], "angle": 0.5, "space": "world"}'
call frame.render '{"rig": "figure", "size": [512, 512], "camera": {"kind": "orbit", "azimuth": -0.5, "inclination": 0.1}}' -o "$out/stride.png"
call frame.render '{"rig": "figure", "size": [512, 512], "show": {"skeleton": "sticks", "skin_opacity": 0.35},
    "camera": {"kind": "orbit", "azimuth": -0.5, "inclination": 0.1}}' -o "$out/bones.png"
# The skinned vertices of the same pose: float32, little-endian, three to a vertex.
call mesh.vertices '{"rig": "figure", "attributes": ["positions"], "transport": "attach"}' -o "$out/vertices.f32"
# What the middle of the picture shows.
"$rigd" call --connect "$address" scene.pick '{"rig": "figure", "size": [512, 512], "pixel": [256, 200],
    "camera": {"kind": "orbit", "azimuth": -0.5, "inclination": 0.1}}' >"$out/pick.json"

kill -TERM "$daemon"
wait "$daemon"
trap - EXIT

# Without a daemon: the whole clip as an animation, and rigs from files, as the README shows them.
"$rigd" render -o "$out/walk.gif" --clip walk --fps 25 --size 240x320 --set pelvis.tz=0 --camera=-50deg,8deg >/dev/null
"$rigd" render assets/cse169/drake/drake.rig -o "$out/drake.png" --size 320x240 --camera 45deg,10deg,2.5 --morph smile=1 --set wing_l.rz=50deg \
    >/dev/null
"$rigd" render assets/mit6837/bear/* -o "$out/bear.png" --size 320x240 --camera 25deg,8deg,2.2 --skeleton sticks --skin-opacity 0.6 \
    --set arm_l.rz=50deg >/dev/null

for file in sheet.png stride.png bones.png vertices.f32 pick.json walk.gif drake.png bear.png; do
    echo "$out/$file  $(wc -c <"$out/$file") bytes"
done
