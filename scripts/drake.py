#!/usr/bin/env python3
"""Makes assets/cse169/drake: a small winged drake in the files of CSE 169, by which they are shown and tested.

    python3 scripts/drake.py [FOLDER]

Nothing but the standard library, and the same bytes every time (the picture's of one zlib): numbers are rounded, and nothing is drawn by
chance. The files have what the course's formats offer: boxes, limits and a pose, several weights to a vertex, a texture, morph targets,
clips with every kind of tangent, and a list. About a metre high, y up, the face towards +z.

Trunk, head, legs and tail are one skin, sculpted from round shapes; wings, horns, spikes, eyes and nostrils are pieces of their own that
reach into it. The skin is modelled where nothing is turned.
"""

import math
import sys
from pathlib import Path

import png
from sculpt import (
    Body, add, ball, bulb, circle, cross, is_closed, limb, loft, mesh, minus, mirrored, mix, normals, number, numbers, other_side, rounded,
    smoothstep, times, unit,
)

FOLDER = Path(__file__).resolve().parent.parent / "assets" / "cse169" / "drake"

FREE = (-180, 180)
FIXED = (0, 0)


class Joint:
    """Where it stands when nothing is turned; the box that stands for it, from there; limits and pose in degrees about x, y and z."""

    def __init__(self, name, parent, place, box, limits, pose=(0, 0, 0)):
        self.name, self.parent, self.place, self.box, self.limits, self.pose = name, parent, place, box, limits, pose

    def on_the_right(self):
        """The twin of a joint on the left, in a mirror at x = 0: what turns about y and z turns the other way."""
        low, high = self.box
        box = ([-high[0], *low[1:]], [-low[0], *high[1:]])
        limits = [self.limits[0], *((-most, -least) for least, most in self.limits[1:])]
        pose = [self.pose[0], -self.pose[1], -self.pose[2]]
        return Joint(other_side(self.name), other_side(self.parent), mirrored(self.place), box, limits, pose)


# What ends in _l has a twin on the right.
LEFT_AND_MIDDLE = [
    Joint("hips", None, [0.0, 0.4, -0.14], ([-0.14, -0.12, -0.16], [0.14, 0.14, 0.14]), (FREE, FREE, FREE)),
    Joint("chest", "hips", [0.0, 0.42, 0.06], ([-0.13, -0.14, -0.1], [0.13, 0.14, 0.14]), ((-25, 25), (-25, 25), (-20, 20))),
    Joint("neck", "chest", [0.0, 0.54, 0.2], ([-0.07, -0.03, -0.07], [0.07, 0.18, 0.09]), ((-40, 30), (-40, 40), (-25, 25)), (-4, 6, 0)),
    Joint("head", "neck", [0.0, 0.7, 0.28], ([-0.17, 0.0, -0.12], [0.17, 0.3, 0.34]), ((-35, 30), (-60, 60), (-30, 30)), (4, 12, 7)),
    Joint("wing_l", "chest", [0.1, 0.55, 0.06], ([0.0, -0.02, -0.26], [0.3, 0.03, 0.05]), ((-40, 40), (-60, 40), (-60, 75)), (0, 22, 30)),
    Joint("tip_l", "wing_l", [0.4, 0.57, 0.06], ([0.0, -0.02, -0.3], [0.42, 0.02, 0.04]), (FIXED, (-20, 110), (-50, 50)), (0, 14, -22)),
    Joint("arm_l", "chest", [0.13, 0.36, 0.14], ([-0.07, -0.19, -0.07], [0.07, 0.05, 0.07]), ((-70, 60), (-20, 20), (-15, 40)), (-4, 0, 2)),
    Joint("paw_l", "arm_l", [0.14, 0.18, 0.13], ([-0.06, -0.18, -0.07], [0.06, 0.04, 0.13]), ((-30, 90), FIXED, FIXED)),
    Joint("thigh_l", "hips", [0.14, 0.36, -0.18], ([-0.08, -0.19, -0.1], [0.08, 0.08, 0.1]), ((-70, 60), (-20, 20), (-15, 40)), (6, 0, 0)),
    Joint("foot_l", "thigh_l", [0.16, 0.18, -0.2], ([-0.06, -0.18, -0.07], [0.06, 0.04, 0.13]), ((-30, 90), FIXED, FIXED)),
    Joint("tail_1", "hips", [0.0, 0.38, -0.32], ([-0.1, -0.1, -0.2], [0.1, 0.1, 0.04]), ((-40, 40), (-40, 40), FIXED), (4, 10, 0)),
    Joint("tail_2", "tail_1", [0.0, 0.33, -0.52], ([-0.08, -0.08, -0.2], [0.08, 0.08, 0.02]), ((-40, 40), (-45, 45), FIXED), (6, 16, 0)),
    Joint("tail_3", "tail_2", [0.0, 0.3, -0.72], ([-0.06, -0.05, -0.18], [0.06, 0.07, 0.02]), ((-45, 45), (-45, 45), FIXED), (10, 20, 0)),
    Joint("tail_4", "tail_3", [0.0, 0.33, -0.9], ([-0.05, -0.04, -0.26], [0.05, 0.2, 0.02]), ((-45, 45), (-45, 45), FIXED), (10, 20, 0)),
]

SHAPES = [
    ("hips", ball([0.0, 0.4, -0.18], [0.17, 0.16, 0.19])),
    ("chest", ball([0.0, 0.42, 0.08], [0.165, 0.175, 0.19])),
    ("neck", limb([0.0, 0.5, 0.17], [0.0, 0.68, 0.27], 0.12, 0.1)),
    ("head", ball([0.0, 0.83, 0.31], [0.205, 0.175, 0.2])),
    ("head", ball([0.0, 0.765, 0.49], [0.14, 0.095, 0.14])),
    ("head", ball([0.0, 0.735, 0.36], [0.165, 0.09, 0.14])),
    ("arm_l", limb([0.12, 0.37, 0.14], [0.14, 0.18, 0.13], 0.085, 0.066)),
    ("paw_l", limb([0.14, 0.18, 0.13], [0.14, 0.07, 0.14], 0.064, 0.062)),
    ("paw_l", ball([0.145, 0.05, 0.175], [0.072, 0.05, 0.095])),
    ("thigh_l", limb([0.12, 0.36, -0.18], [0.16, 0.18, -0.2], 0.115, 0.068)),
    ("foot_l", limb([0.16, 0.18, -0.2], [0.16, 0.07, -0.2], 0.066, 0.064)),
    ("foot_l", ball([0.165, 0.05, -0.165], [0.074, 0.05, 0.098])),
    ("tail_1", limb([0.0, 0.38, -0.32], [0.0, 0.33, -0.52], 0.12, 0.09)),
    ("tail_2", limb([0.0, 0.33, -0.52], [0.0, 0.3, -0.72], 0.088, 0.066)),
    ("tail_3", limb([0.0, 0.3, -0.72], [0.0, 0.33, -0.9], 0.064, 0.05)),
    ("tail_4", limb([0.0, 0.33, -0.9], [0.0, 0.41, -1.03], 0.048, 0.042)),
]

EYE = [0.125, 0.865, 0.435]
EYE_AXIS = [0.6, 0.12, 1.0]
EYE_RADIUS = 0.078

# The picture: above, the drake from its side; below, a strip for the pieces. In shares of its width and height, from the lower left.
PICTURE = 256
STRIP = 0.25
WING, EYES, HORN, FIN = (0.0, 0.5), (0.5, 0.75), (0.75, 0.875), (0.875, 1.0)
MARGIN = 2 / PICTURE


def from_the_side(p):
    return [(p[2] + 1.2) / 2.0, STRIP + (1.0 - STRIP) * (p[1] + 0.05) / 1.2]


def in_strip(span, across, up):
    """A place of a piece's own part of the strip, both from 0 to 1."""
    left, right = span[0] + MARGIN, span[1] - MARGIN
    return [left + (right - left) * across, MARGIN + (STRIP - 2 * MARGIN) * up]


class Skin:
    """The pieces so far: positions, texture coordinates, weights, and triangles."""

    def __init__(self):
        self.positions, self.texcoords, self.weights, self.triangles = [], [], [], []

    def put(self, piece, texcoords, weights):
        """A piece, which is positions and triangles; returns its range of vertices."""
        positions, triangles = piece
        assert is_closed(triangles) and len(positions) == len(texcoords) == len(weights)
        first = len(self.positions)
        self.positions += positions
        self.texcoords += texcoords
        self.weights += weights
        self.triangles += [[first + corner for corner in triangle] for triangle in triangles]
        return range(first, len(self.positions))

    def put_pair(self, piece, texcoords, weights):
        """A piece on the left and its twin."""
        positions, triangles = piece
        left = self.put(piece, texcoords, weights)
        twin = ([mirrored(p) for p in positions], [triangle[::-1] for triangle in triangles])
        right = self.put(twin, texcoords, [[(other_side(joint), weight) for joint, weight in row] for row in weights])
        return [*left, *right]


def build():
    """The skin, and the vertices of its trunk and of its eyes."""
    body, skin = Body(SHAPES, 0.028), Skin()
    trunk = mesh(body, [-0.4, -0.05, -1.12], [0.4, 1.08, 0.7], 0.054)
    trunk = skin.put(trunk, [from_the_side(p) for p in trunk[0]], [rounded(body.weights(p)) for p in trunk[0]])
    eye = bulb(EYE, EYE_AXIS, [EYE_RADIUS, EYE_RADIUS], 12, 7)
    eyes = skin.put_pair(eye, [on_eye(p) for p in eye[0]], held(eye, "head"))
    nostril = bulb([0.045, 0.795, 0.612], [0.3, 0.5, 1.0], [0.018, 0.012])
    skin.put_pair(nostril, [in_strip(HORN, 0.5, 0.0)] * len(nostril[0]), held(nostril, "head"))
    put_wings(skin)
    put_fins(skin, body)
    return skin, trunk, eyes


def held(piece, joint):
    return [[(joint, 1.0)]] * len(piece[0])


def on_eye(p):
    """The angle from where the eye looks is the distance from the middle of its picture."""
    axis = unit(EYE_AXIS)
    right = unit(cross([0.0, 1.0, 0.0], axis))
    q = unit(minus(p, EYE))
    x, y, z = (sum(a * b for a, b in zip(q, direction)) for direction in (right, cross(axis, right), axis))
    around = math.hypot(x, y)
    out = math.acos(min(max(z, -1.0), 1.0)) / math.pi / around if around > 1e-9 else 0.0
    return in_strip(EYES, 0.5 + 0.5 * out * x, 0.5 + 0.5 * out * y)


# Where fingers end on the trailing edge of a wing: how far out, and z.
FINGERS = [(0.0, -0.14), (0.4, -0.3), (0.72, -0.34), (1.0, -0.18)]
WRIST = 0.45


def put_wings(skin):
    """From the shoulder outward, each ring around one section of the wing from its leading to its trailing edge."""
    above, below = [1.0, 0.8, 0.5, 0.12], [0.0, 0.12, 0.5, 0.8]
    section = [(t, 1.0) for t in above] + [(t, -1.0) for t in below]
    out = [k / 12 for k in range(12)] + [0.985]
    rings = [[on_wing(s, t, side) for t, side in section] for s in out]
    texcoords = [in_strip(WING, s, t) for s in out for t, _ in section] + [in_strip(WING, s, 0.5) for s in (0.0, 1.0)]
    weights = [wing_weights(s) for s in out for _ in section] + [wing_weights(0.0), wing_weights(1.0)]
    skin.put_pair(loft(rings), texcoords, weights)


def on_wing(s, t, side):
    """A point of the left wing, `s` of the way out and `t` of the way from the leading edge back, above or below."""
    lead = [0.07 + 0.76 * s, 0.55 + 0.05 * math.sin(math.pi * s), 0.09 - 0.27 * max(s - WRIST, 0.0) ** 2 / (1.0 - WRIST) ** 2]
    for (inner, z_inner), (outer, z_outer) in zip(FINGERS, FINGERS[1:]):
        if s <= outer:
            f = (s - inner) / (outer - inner)
            # The edge of the web hangs between the fingers.
            trail = z_inner + (z_outer - z_inner) * f + 0.07 * math.sin(math.pi * f)
            break
    thick = (0.02 * (1.0 - t) + 0.005) * (1.0 - 0.6 * s) * (0.0 if t in (0.0, 1.0) else 1.0)
    sag = 0.14 * (lead[2] - trail) * math.sin(math.pi * t)
    return [lead[0], lead[1] - sag + side * thick, lead[2] + (trail - lead[2]) * t]


def wing_weights(s):
    shoulder, tip = smoothstep(-0.05, 0.15, s), smoothstep(WRIST - 0.13, WRIST + 0.13, s)
    return rounded({"chest": 1.0 - shoulder, "wing_l": shoulder * (1.0 - tip), "tip_l": shoulder * tip})


def put_fins(skin, body):
    """Horns, ears, spikes along the back, and the end of the tail."""
    horn = spire([[0.09, 0.95, 0.26], [0.115, 1.05, 0.21], [0.13, 1.11, 0.14]], [0.042, 0.03, 0.008], 7)
    skin.put_pair(horn, along(horn, HORN, 7), held(horn, "head"))
    ear = spire([[0.17, 0.88, 0.25], [0.25, 0.93, 0.19], [0.32, 0.95, 0.12], [0.36, 0.96, 0.07]], [0.03, 0.06, 0.04, 0.006], 8, 0.3)
    skin.put_pair(ear, along(ear, FIN, 8), held(ear, "head"))
    for z, height in [(0.13, 0.07), (0.02, 0.085), (-0.1, 0.085), (-0.22, 0.08), (-0.34, 0.07), (-0.46, 0.06), (-0.58, 0.05), (-0.7, 0.042)]:
        foot = body.onto_surface(body.onto_surface([0.0, 0.6 if z > -0.3 else 0.45, z]))
        upward = unit(add(body.slope(foot), [0.0, 0.0, -0.35]))
        places = [add(foot, times(upward, height * share)) for share in (-0.3, 0.35, 1.0)]
        spike = spire(places, [0.5 * height, 0.4 * height, 0.08 * height], 6)
        skin.put(spike, along(spike, FIN, 6), [rounded(body.weights(foot))] * len(spike[0]))
    end = spire(
        [[0.0, 0.395, -1.01], [0.0, 0.44, -1.06], [0.0, 0.49, -1.1], [0.0, 0.54, -1.13], [0.0, 0.58, -1.15]],
        [0.03, 0.095, 0.08, 0.04, 0.008], 8, 0.3,
    )
    skin.put(end, along(end, FIN, 8), held(end, "tail_4"))


def spire(places, radii, count, flat=1.0):
    """Rings of these radii around these places, each across the way from the one before to the one behind."""
    ways = [minus(places[min(k + 1, len(places) - 1)], places[max(k - 1, 0)]) for k in range(len(places))]
    return loft([circle(place, way, radius, count, flat) for place, way, radius in zip(places, ways, radii)])


def along(piece, span, count):
    """Texture coordinates of a spire: how far along it is."""
    rows = len(piece[0]) // count
    rings = [in_strip(span, 0.5, row / (rows - 1)) for row in range(rows) for _ in range(count)]
    return rings + [in_strip(span, 0.5, end) for end in (0.0, 1.0)]


GREEN, DEEP, CREAM, CORAL, PEACH, PINK, DARK, WHITE = (
    (104, 184, 140), (62, 138, 112), (248, 226, 176), (238, 126, 84), (250, 182, 128), (240, 140, 130), (44, 36, 52), (252, 250, 242),
)
# Where the middle of the body is, seen from the side, from the end of the tail: z and y.
SPINE = [(-1.2, 0.5), (-0.9, 0.33), (-0.72, 0.3), (-0.52, 0.33), (-0.18, 0.42), (0.1, 0.44), (0.2, 0.55), (0.27, 0.7), (0.4, 0.8), (0.9, 0.8)]
LEGS = [distance for joint, distance in SHAPES if joint in ("arm_l", "paw_l", "thigh_l", "foot_l")]
# Spots: z, y and radius.
SPOTS = [
    (-0.26, 0.49, 0.032), (-0.16, 0.45, 0.022), (-0.12, 0.53, 0.026), (-0.02, 0.5, 0.02), (-0.44, 0.39, 0.024), (-0.55, 0.36, 0.018),
    (-0.36, 0.45, 0.018), (-0.66, 0.33, 0.016), (0.13, 0.92, 0.022), (0.2, 0.87, 0.016), (0.19, 0.96, 0.016), (0.06, 0.56, 0.015),
]


def mouth(z):
    """The height of the line of the mouth, its corner up."""
    return 0.728 + 1.5 * (z - 0.52) ** 2 * (1.6 if z < 0.52 else 0.6)


def side_color(z, y):
    if y < 0.4 and min(distance([0.14, y, z]) for distance in LEGS) < 0.025:
        is_toe = y < 0.05 and (z > 0.22 or -0.12 < z < 0.0)
        return CREAM if is_toe else mix(DEEP, GREEN, smoothstep(0.02, 0.3, y))
    if 0.385 < z and abs(y - mouth(z)) < 0.009:
        return DARK
    if math.hypot(z - 0.375, y - 0.785) < 0.036:
        return PINK
    if any(math.hypot(z - at, y - up) < radius for at, up, radius in SPOTS):
        return DEEP
    if 0.36 < z and 0.5 < y:
        return CREAM if y < mouth(z) else GREEN
    along_it, above = from_spine(z, y)
    if above < -0.055:
        return CREAM if along_it % 0.06 > 0.008 else mix(CREAM, CORAL, 0.35)
    return GREEN


def from_spine(z, y):
    """How far along the middle of the body, and how far above it or, below zero, in front of and below it."""
    nearest, start = (0.0, math.inf), 0.0
    for (az, ay), (bz, by) in zip(SPINE, SPINE[1:]):
        length = math.hypot(bz - az, by - ay)
        t = min(max(((z - az) * (bz - az) + (y - ay) * (by - ay)) / length ** 2, 0.0), 1.0)
        far = math.hypot(z - az - t * (bz - az), y - ay - t * (by - ay))
        if far < abs(nearest[1]):
            nearest = start + t * length, math.copysign(far, (bz - az) * (y - ay) - (by - ay) * (z - az))
        start += length
    return nearest


def wing_color(s, t):
    if t < 0.1:
        return GREEN
    for out, _ in FINGERS[1:3]:
        if abs(s - (WRIST + (out - WRIST) * t)) < 0.022 * (1.2 - 0.6 * t):
            return GREEN
    return mix(CORAL, PEACH, t)


def eye_color(x, y):
    """From -1 to 1 across the whole ball; what looks out is within a half."""
    x, y = 2.0 * x - 1.0, 2.0 * y - 1.0
    out = math.hypot(x, y)
    if math.hypot(x, y - 0.13) < 0.065 or math.hypot(x + 0.07, y + 0.1) < 0.03:
        return WHITE
    if out < 0.27:
        return DARK
    return (206, 142, 42) if out < 0.34 else WHITE if out < 0.56 else DEEP


def color(u, v):
    """The picture at a place of texture coordinates, as sRGB from 0 to 255."""
    if v >= STRIP:
        return side_color(u * 2.0 - 1.2, (v - STRIP) / (1.0 - STRIP) * 1.2 - 0.05)
    v /= STRIP
    if u < WING[1]:
        return wing_color(u / WING[1], v)
    if u < EYES[1]:
        return eye_color((u - EYES[0]) / (EYES[1] - EYES[0]), v)
    return mix(DARK, CREAM, smoothstep(0.05, 0.3, v)) if u < HORN[1] else mix(CORAL, PEACH, v)


def texel(column, row):
    """The mean of four places."""
    places = [((column + x) / PICTURE, 1.0 - (row + y) / PICTURE) for x in (0.25, 0.75) for y in (0.25, 0.75)]
    return [round(sum(channel) / 4) for channel in zip(*(color(u, v) for u, v in places))]


def joints():
    """All of them in depth-first order, as they stand in the .skel."""
    table = LEFT_AND_MIDDLE + [joint.on_the_right() for joint in LEFT_AND_MIDDLE if joint.name.endswith("_l")]

    def below(parent):
        for joint in table:
            if joint.parent == parent:
                yield joint
                yield from below(joint.name)

    return list(below(None))


def skel():
    places = {joint.name: joint.place for joint in joints()}
    rows = []

    def write(joint, pad):
        offset = minus(joint.place, places[joint.parent]) if joint.parent else joint.place
        rows.append(f"{pad}balljoint {joint.name} {{")
        rows.append(f"{pad}  offset {numbers(offset)}")
        rows.extend(f"{pad}  box{end} {numbers(corner)}" for end, corner in zip(("min", "max"), joint.box))
        rows.extend(f"{pad}  rot{axis}limit {numbers(radians(limit))}" for axis, limit in zip("xyz", joint.limits) if limit != FREE)
        rows.append(f"{pad}  pose {numbers(radians(joint.pose))}")
        for child in joints():
            if child.parent == joint.name:
                write(child, pad + "  ")
        rows.append(f"{pad}}}")

    write(joints()[0], "")
    return lines(rows)


def radians(degrees):
    return [math.radians(x) for x in degrees]


def lines(rows):
    return "".join(f"{row}\n" for row in rows)


def section(name, rows):
    return lines([f"{name} {len(rows)} {{", *rows, "}"])


def skin_file(skin):
    indices = {joint.name: index for index, joint in enumerate(joints())}
    weights = [" ".join([str(len(row)), *(f"{indices[joint]} {number(weight)}" for joint, weight in row)]) for row in skin.weights]
    bindings = [f"matrix {{ 1 0 0  0 1 0  0 0 1  {numbers(joint.place)} }}" for joint in joints()]
    return "".join(
        [
            section("positions", [numbers(p) for p in skin.positions]),
            section("normals", [numbers(normal, 3) for normal in normals(skin.positions, skin.triangles)]),
            section("texcoords", [numbers(place, 3) for place in skin.texcoords]),
            section("skinweights", weights),
            "material scales { texture drake.png }\n",
            section("triangles", [" ".join(map(str, triangle)) for triangle in skin.triangles]),
            section("bindings", bindings),
        ]
    )


def morph_file(skin, moved):
    """`moved` has the position of each vertex; those that stay, and normals that do, are not listed."""

    def changed(rest, now, digits):
        both = [(numbers(a, digits), numbers(b, digits)) for a, b in zip(rest, now)]
        return [f"{index} {b}" for index, (a, b) in enumerate(both) if a != b]

    positions = changed(skin.positions, moved, 4)
    turned = changed(normals(skin.positions, skin.triangles), normals(moved, skin.triangles), 3)
    return section("positions", positions) + section("normals", turned)


def smile(skin, trunk):
    """The corners of the mouth go up, the cheeks out."""
    moved = list(skin.positions)
    for k in trunk:
        x, y, z = skin.positions[k]
        much = math.exp(-(((y - 0.77) / 0.06) ** 2) - ((z - 0.41) / 0.075) ** 2) * smoothstep(0.03, 0.1, abs(x))
        if much > 0.02:
            moved[k] = add(moved[k], times([math.copysign(0.035, x), 0.065, -0.015], much))
    return moved


def blink(skin, eyes):
    """Both eyes are flattened into a line, a little lower."""
    moved = list(skin.positions)
    for k in eyes:
        middle = EYE if skin.positions[k][0] > 0.0 else mirrored(EYE)
        x, y, z = minus(skin.positions[k], middle)
        moved[k] = add(middle, [0.9 * x, 0.13 * y - 0.025, 0.9 * z])
    return moved


def puff(skin, trunk):
    """A deep breath: chest and throat, and the cheeks full of it."""
    moved = list(skin.positions)
    outward = normals(skin.positions, skin.triangles)
    for k in trunk:
        p = skin.positions[k]
        breast = math.exp(-((math.dist(p, [0.0, 0.4, 0.16]) / 0.2) ** 2)) * 0.09
        cheek = math.exp(-((math.dist([abs(p[0]), *p[1:]], [0.15, 0.75, 0.4]) / 0.1) ** 2)) * 0.07
        if breast + cheek > 0.006:
            moved[k] = add(p, times(outward[k], breast + cheek))
    return moved


class Wave:
    """A sine about `mean`: at `lag` of its period it is highest. In degrees, or in metres where a root is moved."""

    def __init__(self, mean, height, lag, times_a_round=1):
        self.mean, self.height, self.lag, self.times = mean, height, lag, times_a_round

    def keys(self, seconds):
        rows = []
        for k in range(4 * self.times + 1):
            phase = 2.0 * math.pi * (k / 4 - self.lag)
            slope = -2.0 * math.pi * self.times / seconds * self.height * math.sin(phase)
            rows.append((seconds * k / (4 * self.times), self.mean + self.height * math.cos(phase), slope, slope))
        return rows


class Strokes:
    """Values at shares of the round, with one word for every tangent."""

    def __init__(self, tangent, *values):
        self.tangent, self.values = tangent, values

    def keys(self, seconds):
        return [(seconds * share, value, self.tangent, self.tangent) for share, value in self.values]


def walk():
    """Diagonal legs go together; a leg is farthest back at its lag, then lifted and swung forward."""
    found = {
        "hips.tz": Strokes("linear", (0, 0.0), (1, 0.5)),
        "hips.ty": Wave(0.0, 0.012, 0.1, 2),
        "hips.ry": Wave(0, 4, 0.25),
        "hips.rz": Wave(0, 2.5, 0.0),
        "chest.ry": Wave(0, -8, 0.25),
        "neck.rx": Wave(-4, 2.5, 0.2, 2),
        "head.ry": Wave(0, 4, 0.25),
        "head.rx": Wave(4, 3, 0.3, 2),
        "wing_l.rz": Wave(40, 4, 0.0, 2), "wing_r.rz": Wave(-40, -4, 0.0, 2),
        "wing_l.ry": Strokes("flat", (0, 38)), "wing_r.ry": Strokes("flat", (0, -38)),
        "tip_l.ry": Wave(70, 5, 0.1, 2), "tip_r.ry": Wave(-70, -5, 0.1, 2),
    }
    for upper, lower, lag in [("arm_l", "paw_l", 0.0), ("arm_r", "paw_r", 0.5), ("thigh_l", "foot_l", 0.55), ("thigh_r", "foot_r", 0.05)]:
        found[f"{upper}.rx"] = Wave(0, 24, lag)
        lifted = [((share + lag) % 1.0, bent) for share, bent in [(0.0, 4), (0.25, 42), (0.5, 4), (0.75, 0)]]
        found[f"{lower}.rx"] = Strokes("flat", *around(sorted(lifted)))
    for k in range(1, 5):
        found[f"tail_{k}.ry"] = Wave(0, 6 + 3 * k, 0.12 * k)
    return found


def around(values):
    """The same at the beginning and at the end of a round, between the last value and the first."""
    (first, a), (last, b) = values[0], values[-1]
    if first == 0.0:
        return [*values, (1.0, a)]
    share = (1.0 - last) / (1.0 - last + first)
    between = b + (a - b) * smoothstep(0.0, 1.0, share)
    return [(0.0, between), *values, (1.0, between)]


def flap():
    """In the air: a fast stroke down, a slow one up with the tips folded."""
    found = {
        "hips.ty": Strokes("smooth", (0, 0.3), (0.2, 0.27), (0.45, 0.36), (0.75, 0.345), (1, 0.3)),
        "hips.rx": Wave(-24, 3, 0.5),
        "neck.rx": Wave(6, 3, 0.1),
        "head.rx": Wave(14, 3, 0.15),
        "head.ry": Strokes("flat", (0, 0)),
        "tail_1.rx": Wave(-14, 6, 0.2), "tail_2.rx": Wave(-8, 8, 0.3), "tail_3.rx": Wave(4, 10, 0.4), "tail_4.rx": Wave(16, 10, 0.5),
    }
    for side, sign in (("l", 1), ("r", -1)):
        found[f"wing_{side}.rz"] = Strokes("flat", *((share, sign * value) for share, value in [(0, 58), (0.35, -34), (1, 58)]))
        found[f"wing_{side}.ry"] = Strokes("flat", *((share, sign * value) for share, value in [(0, 6), (0.35, -4), (0.7, 16), (1, 6)]))
        found[f"tip_{side}.rz"] = Strokes("flat", *((share, sign * value) for share, value in [(0, -10), (0.2, 26), (0.65, -40), (1, -10)]))
        found[f"tip_{side}.ry"] = Strokes("flat", *((share, sign * value) for share, value in [(0, 4), (0.35, 0), (0.7, 30), (1, 4)]))
        found[f"arm_{side}.rx"] = Wave(26, 5, 0.3)
        found[f"paw_{side}.rx"] = Wave(40, 6, 0.4)
        found[f"thigh_{side}.rx"] = Wave(34, 5, 0.3)
        found[f"foot_{side}.rx"] = Wave(30, 6, 0.4)
    return found


def anim(curves, seconds):
    """A clip that goes round and round. What has no curve keeps the pose of the .skel."""
    names = [f"hips.t{axis}" for axis in "xyz"] + [f"{joint.name}.r{axis}" for joint in joints() for axis in "xyz"]
    rest = {f"{joint.name}.r{axis}": value for joint in joints() for axis, value in zip("xyz", joint.pose)}
    assert set(curves) <= set(names)
    rows = ["animation {", f"  range 0 {number(seconds)}", f"  numchannels {len(names)}"]
    for index, name in enumerate(names):
        scale = 1.0 if ".t" in name else math.pi / 180.0
        keys = curves[name].keys(seconds) if name in curves else [(0.0, rest.get(name, 0.0), "flat", "flat")]
        mode = "cycle" if abs(keys[0][1] - keys[-1][1]) < 1e-9 else "cycle_offset"
        rows += [f"  channel {index} {{", f"    extrapolate {mode} {mode}", f"    keys {len(keys)} {{"]
        for time, value, *tangents in keys:
            words = [word if isinstance(word, str) else number(word * scale) for word in tangents]
            rows.append(f"      {number(time)} {number(value * scale)} {' '.join(words)}")
        rows += ["    }", "  }"]
    return lines([*rows, "}"])


RIG = """\
rig drake {
  skeleton drake.skel
  skin drake.skin
  morphs 3 {
    smile.morph
    blink.morph
    puff.morph
  }
}
"""


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    skin, trunk, eyes = build()
    for name, text in {
        "drake.skel": skel(),
        "drake.skin": skin_file(skin),
        "smile.morph": morph_file(skin, smile(skin, trunk)),
        "blink.morph": morph_file(skin, blink(skin, eyes)),
        "puff.morph": morph_file(skin, puff(skin, trunk)),
        "walk.anim": anim(walk(), 1.0),
        "flap.anim": anim(flap(), 0.8),
        "drake.rig": RIG,
    }.items():
        (folder / name).write_text(text, newline="\n")
    (folder / "drake.png").write_bytes(png.encode(PICTURE, PICTURE, 3, texel))


main()
