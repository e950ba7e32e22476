#!/usr/bin/env python3
"""Makes assets/gltf/reed.glb: a reed that sways and hops, by which glTF files are shown and tested.

    python3 scripts/reed.py [OUT.glb]

Nothing but the standard library, and the same bytes every time (of one zlib): numbers are rounded, and nothing is drawn by chance. The file
is to have much of what glTF offers in little room: a skin that is bent at rest, two morph targets (one of them sparse) with weights of its
own, rigid meshes that ride on a joint, a mesh of two primitives, LINEAR, STEP and CUBICSPLINE, textures, a normal map with tangents, colors
of vertices, a cut-out with two sides, and light of its own. Metres, y up, the face towards +z.
"""

import json
import math
import struct
import sys
from pathlib import Path

import png

OUT = Path(__file__).resolve().parent.parent / "assets" / "gltf" / "reed.glb"

# The outline, turned about the y axis: radius and height, from the pole below to the pole above.
OUTLINE = [
    (0.0, 0.0), (0.17, 0.0), (0.21, 0.035), (0.17, 0.085), (0.085, 0.14), (0.062, 0.25), (0.058, 0.45), (0.055, 0.65), (0.052, 0.85),
    (0.055, 1.0), (0.11, 1.05), (0.175, 1.12), (0.2, 1.2), (0.185, 1.29), (0.13, 1.37), (0.06, 1.41), (0.0, 1.42),
]
LAST = len(OUTLINE) - 1
# Where along the outline there are rings of vertices: closer where it bends.
RINGS = [0, 1, 2, 3, 4, 5, 6, 6.5, 7, 7.5, 8, 8.5, 9, 9.5, 10, 10.5, 11, 11.5, 12, 12.5, 13, 13.5, 14, 14.5, 15, 16]
SEGMENTS = 16

# Heights of the joints in the bind pose, where the stem is straight.
JOINTS = [0.0, 0.3, 0.55, 0.8, 1.04]
# Half of the height over which one joint hands over to the next.
BLEND = 0.1
# By how much each joint leans at rest, in radians about z.
LEAN = [0.0, 0.1, 0.06, -0.08, -0.13]
SMILE_AT_REST = 0.25

FLOAT, U8, U16 = 5126, 5121, 5123
SIZE_OF = {FLOAT: 4, U8: 1, U16: 2}
LETTER = {FLOAT: "f", U8: "B", U16: "H"}
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}
VERTICES, INDICES = 34962, 34963


class Document:
    """The JSON of a file and its binary chunk, as they grow."""

    def __init__(self):
        self.binary = bytearray()
        self.views = []
        self.accessors = []
        self.images = []

    def view(self, content, target=None):
        self.binary += bytes(-len(self.binary) % 4)
        view = {"buffer": 0, "byteOffset": len(self.binary), "byteLength": len(content)}
        if target is not None:
            view["target"] = target
        self.binary += content
        self.views.append(view)
        return len(self.views) - 1

    def accessor(self, rows, kind, component=FLOAT, target=None, normalized=False, bounded=False):
        rows = rounded(rows, component)
        accessor = {
            "bufferView": self.view(packed(rows, component), target),
            "componentType": component,
            "count": len(rows),
            "type": kind,
        }
        assert all(len(row) == WIDTH[kind] for row in rows)
        if normalized:
            accessor["normalized"] = True
        if bounded:
            accessor.update(bounds(rows))
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def sparse(self, rows, bounded=False):
        """Three numbers to a row, most of them zeros."""
        rows = rounded(rows, FLOAT)
        indices = [index for index, row in enumerate(rows) if any(row)]
        accessor = {
            "componentType": FLOAT,
            "count": len(rows),
            "type": "VEC3",
            "sparse": {
                "count": len(indices),
                "indices": {"bufferView": self.view(packed([[index] for index in indices], U16)), "componentType": U16},
                "values": {"bufferView": self.view(packed([rows[index] for index in indices], FLOAT))},
            },
        }
        if bounded:
            accessor.update(bounds(rows))
        self.accessors.append(accessor)
        return len(self.accessors) - 1

    def image(self, name, content):
        self.images.append({"name": name, "mimeType": "image/png", "bufferView": self.view(content)})
        return len(self.images) - 1


def rounded(rows, component):
    if component != FLOAT:
        return rows
    # Six digits: what the last bit of a sine is differs between machines. Adding zero makes -0 a 0; the bounds are those of float32.
    return [[struct.unpack("<f", struct.pack("<f", round(number, 6) + 0.0))[0] for number in row] for row in rows]


def packed(rows, component):
    flat = [number for row in rows for number in row]
    return struct.pack(f"<{len(flat)}{LETTER[component]}", *flat)


def bounds(rows):
    columns = list(zip(*rows))
    return {"min": [min(column) for column in columns], "max": [max(column) for column in columns]}


def smoothstep(low, high, x):
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def outline(t):
    """Radius and height at `t`, by Catmull and Rom."""
    first = min(int(t), LAST - 1)
    f = t - first
    before, a, b, after = (OUTLINE[min(max(first + step, 0), LAST)] for step in (-1, 0, 1, 2))
    return [
        0.5 * (2 * q + (r - p) * f + (2 * p - 5 * q + 4 * r - s) * f * f + (3 * q - p - 3 * r + s) * f ** 3)
        for p, q, r, s in zip(before, a, b, after)
    ]


def surface(angle, t, puff=0.0, smile=0.0):
    """A point of the body; `angle` is 0 in front."""
    radius, height = outline(t)
    inside = smoothstep(0.98, 1.15, height) * puff
    radius *= 1.0 + 0.35 * inside
    height += 0.12 * inside * (height - 1.1)
    mouth = smile * math.exp(-(((height - 1.12) / 0.06) ** 2) - (angle / 0.75) ** 2)
    radius += 0.02 * mouth
    height += mouth * (0.1 * (angle / 0.6) ** 2 - 0.025)
    return [radius * math.sin(angle), height, radius * math.cos(angle)]


def surface_normal(angle, t, **morphs):
    if t in (0, LAST):
        return [0.0, -1.0 if t == 0 else 1.0, 0.0]
    step = 1e-4
    around = minus(surface(angle + step, t, **morphs), surface(angle - step, t, **morphs))
    upward = minus(surface(angle, t + step, **morphs), surface(angle, t - step, **morphs))
    return unit(cross(around, upward))


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(v):
    length = math.sqrt(sum(x * x for x in v))
    return [x / length for x in v]


def grid_triangles(rows, columns, skip_first, skip_last, start=0):
    """Counter-clockwise where columns go right and rows go up. A first or last row that is a pole makes one triangle to a column."""
    corners = []
    for row in range(rows - 1):
        for column in range(columns - 1):
            a = start + row * columns + column
            b, c, d = a + 1, a + 1 + columns, a + columns
            if not (row == 0 and skip_first):
                corners += [a, b, c] if row == rows - 2 and skip_last else [a, b, c, a, c, d]
            else:
                corners += [a, c, d]
    return corners


def body(document):
    columns = SEGMENTS + 1
    # Both ends of the seam are computed from the same angle, so that the surface is closed to the last bit.
    angles = [-math.pi + 2.0 * math.pi * (column % SEGMENTS) / SEGMENTS for column in range(columns)]
    places = [(angle, t) for t in RINGS for angle in angles]

    def displaced(of, **morphs):
        return [minus(of(angle, t, **morphs), of(angle, t)) for angle, t in places]

    texcoords = [[column / SEGMENTS, 1.0 - t / LAST] for t in RINGS for column in range(columns)]
    influences = [influences_at(outline(t)[1]) for _, t in places]
    triangles = grid_triangles(len(RINGS), columns, True, True)
    return {
        "name": "body",
        "primitives": [
            {
                "attributes": {
                    "POSITION": document.accessor([surface(*place) for place in places], "VEC3", target=VERTICES, bounded=True),
                    "NORMAL": document.accessor([surface_normal(*place) for place in places], "VEC3", target=VERTICES),
                    "TEXCOORD_0": document.accessor(texcoords, "VEC2", target=VERTICES),
                    "JOINTS_0": document.accessor([joints for joints, _ in influences], "VEC4", U8, VERTICES),
                    "WEIGHTS_0": document.accessor([weights for _, weights in influences], "VEC4", U8, VERTICES, normalized=True),
                },
                "indices": document.accessor([[corner] for corner in triangles], "SCALAR", U16, INDICES),
                "material": 0,
                "targets": [
                    {
                        "POSITION": document.accessor(displaced(surface, puff=1.0), "VEC3", target=VERTICES, bounded=True),
                        "NORMAL": document.accessor(displaced(surface_normal, puff=1.0), "VEC3", target=VERTICES),
                    },
                    {
                        "POSITION": document.sparse(displaced(surface, smile=1.0), bounded=True),
                        "NORMAL": document.sparse(displaced(surface_normal, smile=1.0)),
                    },
                ],
            }
        ],
        "weights": [0.0, SMILE_AT_REST],
        "extras": {"targetNames": ["puff", "smile"]},
    }


def influences_at(height):
    """Joints and weights, as bytes whose sum is 255. A weight of nothing is that of joint 0."""
    for joint in range(1, len(JOINTS)):
        upper = round(255 * smoothstep(JOINTS[joint] - BLEND, JOINTS[joint] + BLEND, height))
        if upper == 0:
            return [joint - 1, 0, 0, 0], [255, 0, 0, 0]
        if upper < 255:
            return [joint - 1, joint, 0, 0], [255 - upper, upper, 0, 0]
    return [len(JOINTS) - 1, 0, 0, 0], [255, 0, 0, 0]


def ball(center, radius, tilts, segments):
    """Positions and normals of a ball with its poles before and behind; `tilts` are angles from +z, of one ring each."""
    normals = []
    for tilt in tilts:
        for column in range(segments + 1):
            turn = 2.0 * math.pi * (column % segments) / segments
            around = 0.0 if tilt in (0.0, math.pi) else math.sin(tilt)
            normals.append([around * math.cos(turn), around * math.sin(turn), math.cos(tilt)])
    positions = [[c + radius * n for c, n in zip(center, normal)] for normal in normals]
    return positions, normals


def ball_triangles(rings, segments, start=0):
    # Rings go from the pole in front to that behind and columns counter-clockwise, which is the other way round.
    corners = grid_triangles(rings, segments + 1, True, True, start)
    return [corner for i in range(0, len(corners), 3) for corner in (corners[i], corners[i + 2], corners[i + 1])]


def eyes(document):
    degrees = [0, 24, 30, 60, 90, 130, 180]
    tilts = [math.radians(degree) if degree != 180 else math.pi for degree in degrees]
    segments = 10
    positions, normals, colors, corners = [], [], [], []
    for side in (-1.0, 1.0):
        corners += ball_triangles(len(tilts), segments, len(positions))
        ball_positions, ball_normals = ball([0.075 * side, 0.0, 0.0], 0.05, tilts, segments)
        positions += ball_positions
        normals += ball_normals
        for degree in degrees:
            colors += [[13, 10, 26, 255] if degree < 30 else [242, 240, 230, 255]] * (segments + 1)
    return {
        "name": "eyes",
        "primitives": [
            {
                "attributes": {
                    "POSITION": document.accessor(positions, "VEC3", target=VERTICES, bounded=True),
                    "NORMAL": document.accessor(normals, "VEC3", target=VERTICES),
                    "COLOR_0": document.accessor(colors, "VEC4", U8, VERTICES, normalized=True),
                },
                "indices": document.accessor([[corner] for corner in corners], "SCALAR", U16, INDICES),
                "material": 1,
            }
        ],
    }


def crown(document):
    """Two leaves and a bud that glows."""
    rows = 5
    positions, normals, tangents, texcoords, corners = [], [], [], [], []
    for side in (-1.0, 1.0):
        corners += grid_triangles(rows, 2, False, False, len(positions))
        for row in range(rows):
            along = row / (rows - 1)
            # An arc that rises and then hangs; the slope of its height is that of the normal.
            out, up, slope = 0.02 + 0.3 * along, 0.16 * along - 0.22 * along * along, (0.16 - 0.44 * along) / 0.3
            for z in (1.0, -1.0):
                positions.append([side * out, up, -side * z * 0.09])
                normals.append(unit([-slope * side, 1.0, 0.0]))
                tangents.append([0.0, 0.0, side, 1.0])
                texcoords.append([0.5 - 0.5 * z, 1.0 - along])
    tilts = [math.pi * ring / 6 for ring in range(7)]
    bud_positions, bud_normals = ball([0.0, 0.035, 0.0], 0.045, tilts, 10)
    leaves = {
        "attributes": {
            "POSITION": document.accessor(positions, "VEC3", target=VERTICES, bounded=True),
            "NORMAL": document.accessor(normals, "VEC3", target=VERTICES),
            # The validator warns of a normal map without them.
            "TANGENT": document.accessor(tangents, "VEC4", target=VERTICES),
            "TEXCOORD_0": document.accessor(texcoords, "VEC2", target=VERTICES),
        },
        "indices": document.accessor([[corner] for corner in corners], "SCALAR", U16, INDICES),
        "material": 2,
    }
    bud = {
        "attributes": {
            "POSITION": document.accessor(bud_positions, "VEC3", target=VERTICES, bounded=True),
            "NORMAL": document.accessor(bud_normals, "VEC3", target=VERTICES),
        },
        "indices": document.accessor([[corner] for corner in ball_triangles(7, 10)], "SCALAR", U16, INDICES),
        "material": 3,
    }
    return {"name": "crown", "primitives": [leaves, bud]}


def skin_pixel(column, row):
    """A pot, a stem with bands and a head with a face; 64 by 64."""
    t = (1.0 - (row + 0.5) / 64) * LAST
    angle = ((column + 0.5) / 64 - 0.5) * 2.0 * math.pi
    if t < 4:
        return (176, 92, 58) if t > 3.2 or t < 2 else (150, 74, 48)
    if t < 9.5:
        return (74, 138, 66) if int(t * 2) % 2 else (98, 164, 78)
    mouth = 11.0 + 0.35 * (angle / 0.55) ** 2
    if abs(angle) < 0.6 and abs(t - mouth) < 0.2:
        return (110, 34, 40)
    if (abs(angle) - 0.95) ** 2 + ((t - 11.7) / 2.2) ** 2 < 0.06:
        return (240, 150, 120)
    return (240, 200, 96) if t < 15 else (220, 170, 70)


def furrows_pixel(column, _):
    """Four furrows along a leaf, as a normal map of 32 by 4."""
    slope = 0.35 * math.sin(2.0 * math.pi * (column + 0.5) / 8)
    x, _, z = unit([slope, 0.0, 1.0])
    return (round(127.5 + 127.5 * x), 128, round(127.5 + 127.5 * z))


def leaf_pixel(column, row):
    """A leaf between transparent corners, 32 by 32; the tip is above. What is cut out has the leaf's color, for texels that mix."""
    across, along = abs((column + 0.5) / 16 - 1.0), 1.0 - (row + 0.5) / 32
    width = 0.95 * math.sin(math.pi * (0.08 + 0.92 * along)) ** 0.8
    vein = across < 0.08 or abs((along * 6 - across * 1.5) % 1.0 - 0.5) < 0.09
    return (*((120, 176, 70) if vein else (62, 128, 52)), 255 if across < width else 0)


def materials(document):
    skin = document.image("skin", png.encode(64, 64, 3, skin_pixel))
    furrows = document.image("furrows", png.encode(32, 4, 3, furrows_pixel))
    leaf = document.image("leaf", png.encode(32, 32, 4, leaf_pixel))
    textures = [{"sampler": 0, "source": image} for image in (skin, furrows, leaf)]
    return textures, [
        {
            "name": "skin",
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0.0, "roughnessFactor": 0.7},
        },
        {"name": "eye", "pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.25}},
        {
            "name": "leaf",
            "pbrMetallicRoughness": {"baseColorTexture": {"index": 2}, "metallicFactor": 0.0, "roughnessFactor": 0.8},
            "normalTexture": {"index": 1, "scale": 0.8},
            "alphaMode": "MASK",
            "alphaCutoff": 0.5,
            "doubleSided": True,
        },
        {
            "name": "bud",
            "pbrMetallicRoughness": {"baseColorFactor": [0.3, 0.08, 0.02, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.5},
            "emissiveFactor": [1.0, 0.45, 0.1],
        },
    ]


def leaning(z, x=0.0):
    """The quaternion of a turn about x and then about z, in radians."""
    sin_x, cos_x, sin_z, cos_z = math.sin(x / 2), math.cos(x / 2), math.sin(z / 2), math.cos(z / 2)
    return [cos_z * sin_x, sin_z * sin_x, sin_z * cos_x, cos_z * cos_x]


def sway(document, stem):
    """Two seconds, round and round: lower joints with many straight keys, upper ones with few splines."""
    duration = 2.0
    channels, samplers = [], []

    def turn(joint, time):
        phase = 2.0 * math.pi * time / duration - 0.5 * joint
        return leaning(LEAN[joint] + 0.06 * (1 + joint) * math.sin(phase), 0.03 * (1 + joint) * math.cos(phase))

    for joint, (steps, interpolation) in {1: (8, "LINEAR"), 2: (8, "LINEAR"), 3: (4, "CUBICSPLINE"), 4: (4, "CUBICSPLINE")}.items():
        times = [duration * step / steps for step in range(steps + 1)]
        rows = []
        for time in times:
            if interpolation == "CUBICSPLINE":
                step = 1e-3
                tangent = [x / (2 * step) for x in minus(turn(joint, time + step), turn(joint, time - step))]
                rows += [tangent, turn(joint, time), tangent]
            else:
                rows.append(turn(joint, time))
        add_channel(document, channels, samplers, stem[joint], "rotation", interpolation, times, rows, "VEC4")
    return {"name": "sway", "channels": channels, "samplers": samplers}


def hop(document, stem, body_node, eyes_node):
    """A hop with knees and cheeks, and a blink on the way."""
    channels, samplers = [], []
    heights = [0.0, 0.0, 0.14, 0.24, 0.28, 0.24, 0.14, 0.0, 0.0]
    times = [0.0, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.2]
    moved = [[0.0, height, 0.0] for height in heights]
    add_channel(document, channels, samplers, stem[0], "translation", "LINEAR", times, moved, "VEC3")
    stretched = [1.0, 0.82, 1.12, 1.0, 0.84, 1.0]
    times = [0.0, 0.25, 0.4, 0.6, 1.0, 1.2]
    # As much wider as it is lower, so that its volume stays.
    scales = [[s ** -0.5, s, s ** -0.5] for s in stretched]
    add_channel(document, channels, samplers, stem[0], "scale", "LINEAR", times, scales, "VEC3")
    blink = [[1.0, 1.0, 1.0], [1.0, 0.12, 1.0], [1.0, 1.0, 1.0]]
    add_channel(document, channels, samplers, eyes_node, "scale", "STEP", [0.0, 0.85, 1.02], blink, "VEC3")
    times = [0.0, 0.25, 0.5, 0.7, 0.95, 1.2]
    weights = [[0.0, SMILE_AT_REST], [1.0, 0.0], [0.1, 1.0], [0.0, 1.0], [0.6, 0.5], [0.0, SMILE_AT_REST]]
    flat = [[weight] for row in weights for weight in row]
    add_channel(document, channels, samplers, body_node, "weights", "LINEAR", times, flat, "SCALAR")
    return {"name": "hop", "channels": channels, "samplers": samplers}


def add_channel(document, channels, samplers, node, path, interpolation, times, rows, kind):
    channels.append({"sampler": len(samplers), "target": {"node": node, "path": path}})
    samplers.append(
        {
            "input": document.accessor([[time] for time in times], "SCALAR", bounded=True),
            "interpolation": interpolation,
            "output": document.accessor(rows, kind),
        }
    )


def nodes():
    """Body, the stem one joint upon the other, and what rides on the last of them."""
    stem = [1 + joint for joint in range(len(JOINTS))]
    found = [{"name": "body", "mesh": 0, "skin": 0}]
    for joint, height in enumerate(JOINTS):
        node = {"name": f"stem_{joint}"}
        if joint > 0:
            node["translation"] = [0.0, round(height - JOINTS[joint - 1], 6), 0.0]
            node["rotation"] = [round(x, 6) for x in leaning(LEAN[joint])]
        if joint + 1 < len(JOINTS):
            node["children"] = [stem[joint + 1]]
        found.append(node)
    head = JOINTS[-1]
    eyes_node, crown_node = len(found), len(found) + 1
    found[stem[-1]]["children"] = [eyes_node, crown_node]
    found.append({"name": "eyes", "mesh": 1, "translation": [0.0, round(1.25 - head, 6), 0.165]})
    found.append({"name": "crown", "mesh": 2, "translation": [0.0, round(1.42 - head, 6), 0.0]})
    return found, stem, eyes_node


def main():
    document = Document()
    found, stem, eyes_node = nodes()
    meshes = [body(document), eyes(document), crown(document)]
    straight = [[1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, -height, 0, 1] for height in JOINTS]
    skin = {"name": "stem", "joints": stem, "skeleton": stem[0], "inverseBindMatrices": document.accessor(straight, "MAT4")}
    clips = [sway(document, stem), hop(document, stem, 0, eyes_node)]
    textures, of_meshes = materials(document)
    document.binary += bytes(-len(document.binary) % 4)
    root = {
        "asset": {"version": "2.0", "generator": "rigd scripts/reed.py"},
        "scene": 0,
        "scenes": [{"name": "reed", "nodes": [0, stem[0]]}],
        "nodes": found,
        "meshes": meshes,
        "skins": [skin],
        "animations": clips,
        "materials": of_meshes,
        "textures": textures,
        "samplers": [{"magFilter": 9729, "minFilter": 9987, "wrapS": 10497, "wrapT": 33071}],
        "images": document.images,
        "accessors": document.accessors,
        "bufferViews": document.views,
        "buffers": [{"byteLength": len(document.binary)}],
    }
    text = json.dumps(root, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    whole = struct.pack("<4sII", b"glTF", 2, 12 + 8 + len(text) + 8 + len(document.binary))
    whole += struct.pack("<I4s", len(text), b"JSON") + text
    whole += struct.pack("<I4s", len(document.binary), b"BIN\0") + document.binary
    out = Path(sys.argv[1]) if len(sys.argv) > 1 else OUT
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(whole)


main()
