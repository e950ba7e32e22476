"""A body out of round shapes that run into one another: its distance field, its mesh and its weights. Used by drake.py and bear.py.

Each shape belongs to a joint and gives the distance from a point to its surface. The body's own distance is the soft minimum of all of
them, `-blend * log(sum(exp(-distance / blend)))`; the share of a joint's shapes in that sum is its weight.
"""

import math


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def minus(a, b):
    return [x - y for x, y in zip(a, b)]


def times(a, factor):
    return [x * factor for x in a]


def mix(a, b, t):
    return [x + (y - x) * t for x, y in zip(a, b)]


def middle(points):
    return [sum(column) / len(points) for column in zip(*points)]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    return times(a, 1.0 / math.sqrt(dot(a, a)))


def mirrored(p):
    return [-p[0], *p[1:]]


def other_side(name):
    """The joint on the right for one on the left; one of the middle is its own."""
    return name[:-2] + "_r" if name.endswith("_l") else name


def smoothstep(low, high, x):
    t = min(max((x - low) / (high - low), 0.0), 1.0)
    return t * t * (3.0 - 2.0 * t)


def ball(center, radii):
    """An ellipsoid. Its distance is exact at the surface and close near it."""

    def distance(p):
        q = minus(p, center)
        scaled = math.sqrt(sum((x / r) ** 2 for x, r in zip(q, radii)))
        slope = math.sqrt(sum((x / (r * r)) ** 2 for x, r in zip(q, radii)))
        return scaled * (scaled - 1.0) / slope if slope > 0.0 else -min(radii)

    return distance


def limb(a, b, radius_a, radius_b):
    """A rod with round ends, from `a` to `b`."""
    axis = minus(b, a)
    squared = dot(axis, axis)

    def distance(p):
        t = min(max(dot(minus(p, a), axis) / squared, 0.0), 1.0)
        return math.dist(p, mix(a, b, t)) - (radius_a + (radius_b - radius_a) * t)

    return distance


class Body:
    """`shapes` are pairs of a joint's name and a distance; what belongs to a joint on the left is there on the right too."""

    def __init__(self, shapes, blend):
        left = [(joint, distance) for joint, distance in shapes if joint.endswith("_l")]
        self.shapes = shapes + [(other_side(joint), lambda p, it=distance: it(mirrored(p))) for joint, distance in left]
        self.blend = blend

    def distance(self, p):
        return -self.blend * math.log(sum(math.exp(-distance(p) / self.blend) for _, distance in self.shapes))

    def weights(self, p, softness=1.5):
        """The joints that hold `p` and by how much; softer than the surface, so that joints bend over some length."""
        shares = {}
        for joint, distance in self.shapes:
            shares[joint] = shares.get(joint, 0.0) + math.exp(-distance(p) / (self.blend * softness))
        return shares

    def slope(self, p, step=1e-4):
        around = [[step if axis == k else 0.0 for k in range(3)] for axis in range(3)]
        return [(self.distance(add(p, d)) - self.distance(minus(p, d))) / (2.0 * step) for d in around]

    def onto_surface(self, p):
        for _ in range(2):
            slope = self.slope(p)
            p = minus(p, times(slope, self.distance(p) / dot(slope, slope)))
        return p


def mesh(body, low, high, step):
    """Surface nets: a vertex for each cell of a grid that the surface passes through, a quad for each edge of the grid that it cuts.

    The grid is even about x = 0, so that what is symmetric stays so. Returns positions and counter-clockwise triangles.
    """
    counts = [math.ceil((b - a) / step) + 1 for a, b in zip(low, high)]
    counts[0] += counts[0] % 2
    start = [-0.5 * step * (counts[0] - 1), low[1], low[2]]

    def at(cell):
        return [s + step * i for s, i in zip(start, cell)]

    cells = [(i, j, k) for i in range(counts[0]) for j in range(counts[1]) for k in range(counts[2])]
    distances = {cell: body.distance(at(cell)) for cell in cells}
    # Of each cell where the surface cuts its edges, and the four cells around each edge that it cuts.
    cuts, edges = {}, []
    for cell in cells:
        for axis in range(3):
            next_cell = tuple(i + (k == axis) for k, i in enumerate(cell))
            a, b = distances[cell], distances.get(next_cell, 1.0)
            if (a < 0.0) == (b < 0.0):
                continue
            u, v = (axis + 1) % 3, (axis + 2) % 3
            # Counter-clockwise seen from the edge's end.
            corners = ((1, 1), (0, 1), (0, 0), (1, 0))
            ring = [tuple(i - (k == u) * back_u - (k == v) * back_v for k, i in enumerate(cell)) for back_u, back_v in corners]
            edges.append(ring if a < 0.0 else ring[::-1])
            for touched in ring:
                cuts.setdefault(touched, []).append(mix(at(cell), at(next_cell), a / (a - b)))
    index_of = {cell: index for index, cell in enumerate(cuts)}
    quads = [[index_of[cell] for cell in ring] for ring in edges]
    positions = relaxed(body, [middle(points) for points in cuts.values()], quads)
    return positions, [corner for quad in quads for corner in halves(quad, positions)]


def relaxed(body, positions, quads, rounds=3):
    """Moves vertices along the surface to the middle of their neighbours."""
    neighbours = [set() for _ in positions]
    for quad in quads:
        for a, b in zip(quad, quad[1:] + quad[:1]):
            neighbours[a].add(b)
            neighbours[b].add(a)
    for _ in range(rounds):
        # In a written order, so that sums are the same every time.
        targets = [middle([positions[k] for k in sorted(near)]) for near in neighbours]
        positions = [body.onto_surface(mix(p, target, 0.5)) for p, target in zip(positions, targets)]
    return positions


def halves(quad, positions):
    """Two triangles, cut along the shorter diagonal; of two that are equal but for rounding, the first."""
    a, b, c, d = quad
    if math.dist(positions[a], positions[c]) < math.dist(positions[b], positions[d]) + 1e-6:
        return [(a, b, c), (a, c, d)]
    return [(a, b, d), (b, c, d)]


def loft(rings):
    """A skin over rings of as many points each, closed by the middle of the first and of the last.

    Points run counter-clockwise seen from the last ring. Returns positions, the rings' one after another and then the two middles, and
    triangles.
    """
    count = len(rings[0])
    positions = [p for ring in rings for p in ring]
    first, last = len(positions), len(positions) + 1
    positions += [middle(rings[0]), middle(rings[-1])]
    triangles = []
    for row in range(len(rings) - 1):
        for k in range(count):
            a, b = row * count + k, row * count + (k + 1) % count
            triangles += halves([a, b, b + count, a + count], positions)
    top = (len(rings) - 1) * count
    for k in range(count):
        triangles += [(first, (k + 1) % count, k), (last, top + k, top + (k + 1) % count)]
    return positions, triangles


def circle(center, axis, radius, count, flat=1.0):
    """Points of a circle, counter-clockwise seen from where `axis` leads; of an ellipse where it is `flat`."""
    axis = unit(axis)
    side = unit(cross(axis, [0.0, 0.0, 1.0] if abs(axis[2]) < 0.9 else [0.0, 1.0, 0.0]))
    other = times(cross(axis, side), flat)
    turns = [2.0 * math.pi * k / count for k in range(count)]
    return [add(center, add(times(side, radius * math.cos(turn)), times(other, radius * math.sin(turn)))) for turn in turns]


def bulb(center, axis, radii, count=8, rows=5):
    """A ball that is `radii[0]` wide and reaches `radii[1]` along `axis`."""
    reach = times(unit(axis), radii[1])
    tilts = [math.pi * (row + 0.5) / rows for row in range(rows)]
    rings = [circle(minus(center, times(reach, math.cos(tilt))), axis, radii[0] * math.sin(tilt), count) for tilt in tilts]
    positions, triangles = loft(rings)
    return positions[:-2] + [minus(center, reach), add(center, reach)], triangles


def normals(positions, triangles):
    """The mean of the triangles around each vertex, by area."""
    sums = [[0.0, 0.0, 0.0] for _ in positions]
    for triangle in triangles:
        a, b, c = (positions[k] for k in triangle)
        normal = cross(minus(b, a), minus(c, a))
        for k in triangle:
            sums[k] = add(sums[k], normal)
    return [unit(total) for total in sums]


def is_closed(triangles):
    """Whether each edge is run along once in either direction."""
    edges = [(t[k], t[(k + 1) % 3]) for t in triangles for k in range(3)]
    return len(set(edges)) == len(edges) and set(edges) == {(b, a) for a, b in edges}


def rounded(shares):
    """Weights of four digits that sum to 1, as pairs of a joint and a weight, the heaviest first."""
    total = sum(shares.values())
    kept = sorted(((joint, share / total) for joint, share in shares.items() if share > 0.01 * total), key=lambda it: -it[1])
    total = sum(share for _, share in kept)
    rest = [(joint, round(share / total, 4)) for joint, share in kept[1:]]
    return [(kept[0][0], round(1.0 - sum(share for _, share in rest), 4)), *rest]


def number(x, digits=4):
    """As short as may be, and never -0."""
    text = f"{x:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def numbers(row, digits=4):
    return " ".join(number(x, digits) for x in row)
