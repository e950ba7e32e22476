#!/bin/sh
# demo.sh RIGD OUT: starts the daemon RIGD, poses the built-in figure over TCP, and leaves pictures and vertices in the folder OUT.
set -eu

rigd=$1
out=$2
mkdir -p "$out"

# Port 0: whatever runs on the usual one is left alone. The first line that the daemon prints ends in its address.
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

call frame.render '{"rig": "figure", "size": [512, 512]}' -o "$out/rest.png"

call pose.set '{"rig": "figure", "pose": {"dofs": {
    "upper_arm_r.rx": -1.40, "upper_arm_r.ry": 0.17, "upper_arm_r.rz": 0.31,
    "forearm_r.rx": -0.35, "forearm_r.ry": 1.66, "hand_r.rz": -0.17, "fingers_r.rz": 0.09,
    "upper_arm_l.rz": -1.08, "forearm_l.ry": -1.05,
    "head.ry": -0.03, "head.rz": 0.14, "neck.ry": 0, "spine.rz": 0.07}}}'
call frame.render '{"rig": "figure", "size": [840, 560], "compression": "default",
    "camera": {"kind": "orbit", "azimuth": 0.314, "inclination": 0.07, "distance": 2.75}}' -o "$out/wave.png"
call frame.render '{"rig": "figure", "size": [512, 512], "show": {"skeleton": "wireframe", "skin_opacity": 0.45},
    "camera": {"kind": "orbit", "azimuth": 3.5}}' -o "$out/bones.png"
call frame.render '{"rig": "figure", "size": [512, 512],
    "camera": {"kind": "look_at", "eye": [0.35, 1.66, 0.85], "target": [0.02, 1.58, 0.05], "fov_y": 0.6}}' -o "$out/face.png"

# The skinned vertices of the same pose: float32, little-endian, three to a vertex.
call mesh.vertices '{"rig": "figure", "attributes": ["positions"], "transport": "attach"}' -o "$out/vertices.f32"

kill -TERM "$daemon"
wait "$daemon"
trap - EXIT
for file in rest.png wave.png bones.png face.png vertices.f32; do
    echo "$out/$file  $(wc -c <"$out/$file") bytes"
done
