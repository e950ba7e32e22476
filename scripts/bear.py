#!/usr/bin/env python3
"""Makes assets/mit6837/bear: a bear with its arms held out, in the files of MIT 6.837: bear.skel, bear.obj and bear.attach.

    python3 scripts/bear.py [FOLDER]

Nothing but the standard library, and the same bytes every time. As in the course's own models the root moves no vertex by itself, so a
joint sits on it; nothing is turned at rest; and weights are a row of numbers for each vertex, one for each joint but the root. Names behind
the rows of the .skel are rigd's. About a metre high, y up, the face towards +z.
"""

import sys
from pathlib import Path

from sculpt import Body, ball, bulb, is_closed, limb, mesh, minus, mirrored, number, numbers, other_side, rounded

FOLDER = Path(__file__).resolve().parent.parent / "assets" / "mit6837" / "bear"

# Name, parent, and where it stands. What ends in _l has a twin on the right.
JOINTS = [
    ("root", None, [0.0, 0.36, 0.0]),
    ("pelvis", "root", [0.0, 0.36, 0.0]),
    ("spine", "pelvis", [0.0, 0.44, -0.01]),
    ("chest", "spine", [0.0, 0.54, -0.01]),
    ("neck", "chest", [0.0, 0.65, 0.0]),
    ("head", "neck", [0.0, 0.71, 0.01]),
    ("arm_l", "chest", [0.13, 0.6, 0.0]),
    ("forearm_l", "arm_l", [0.27, 0.6, 0.0]),
    ("paw_l", "forearm_l", [0.38, 0.6, 0.0]),
    ("thigh_l", "pelvis", [0.11, 0.29, 0.0]),
    ("shin_l", "thigh_l", [0.125, 0.17, 0.01]),
    ("foot_l", "shin_l", [0.13, 0.075, 0.0]),
]

SHAPES = [
    ("pelvis", ball([0.0, 0.36, 0.0], [0.16, 0.11, 0.13])),
    ("spine", ball([0.0, 0.44, 0.025], [0.17, 0.13, 0.155])),
    ("chest", ball([0.0, 0.55, 0.0], [0.13, 0.12, 0.11])),
    ("neck", limb([0.0, 0.64, 0.0], [0.0, 0.7, 0.01], 0.075, 0.075)),
    ("head", ball([0.0, 0.85, 0.01], [0.2, 0.17, 0.165])),
    ("head", ball([0.0, 0.795, 0.15], [0.095, 0.07, 0.075])),
    ("head", ball([0.16, 0.99, -0.01], [0.075, 0.078, 0.045])),
    ("head", ball([-0.16, 0.99, -0.01], [0.075, 0.078, 0.045])),
    ("arm_l", limb([0.1, 0.6, 0.0], [0.27, 0.6, 0.0], 0.06, 0.058)),
    ("forearm_l", limb([0.27, 0.6, 0.0], [0.37, 0.6, 0.0], 0.058, 0.056)),
    ("paw_l", ball([0.43, 0.6, 0.005], [0.072, 0.062, 0.065])),
    ("thigh_l", limb([0.1, 0.3, 0.0], [0.125, 0.17, 0.01], 0.08, 0.073)),
    ("shin_l", limb([0.125, 0.17, 0.01], [0.13, 0.08, 0.0], 0.072, 0.07)),
    ("foot_l", ball([0.135, 0.055, 0.05], [0.08, 0.055, 0.115])),
]

# Small balls that lie on the skin: joint, middle, where they point, and how wide and high they are.
BUTTONS = [
    ("head", [0.0, 0.835, 0.222], [0.0, 0.4, 1.0], [0.036, 0.024]),
    ("head", [0.08, 0.88, 0.152], [0.4, 0.1, 1.0], [0.03, 0.02]),
    ("head", [-0.08, 0.88, 0.152], [-0.4, 0.1, 1.0], [0.03, 0.02]),
    ("pelvis", [0.0, 0.34, -0.14], [0.0, 0.3, -1.0], [0.055, 0.055]),
]


def joints():
    """Those of the table, then the twins on the right."""
    right = [(other_side(name), other_side(parent), mirrored(place)) for name, parent, place in JOINTS if name.endswith("_l")]
    return JOINTS + right


def skel():
    """A row for each joint: from its parent, in the world for the root; its parent's number; its name."""
    rows = []
    places = {name: place for name, _, place in joints()}
    indices = {name: index for index, name in enumerate(places)}
    for name, parent, place in joints():
        offset = minus(place, places[parent]) if parent else place
        rows.append(f"{numbers(offset)} {indices[parent] if parent else -1} {name}\n")
    return "".join(rows)


def skin():
    """Positions, triangles, and for each vertex its joints and their weights."""
    body = Body(SHAPES, 0.025)
    positions, triangles = mesh(body, [-0.55, -0.05, -0.22], [0.55, 1.12, 0.3], 0.036)
    shares = [rounded(body.weights(p)) for p in positions]
    for joint, *place in BUTTONS:
        button, corners = bulb(*place)
        triangles += [[corner + len(positions) for corner in triangle] for triangle in corners]
        positions += button
        shares += [[(joint, 1.0)]] * len(button)
    assert is_closed(triangles)
    return positions, triangles, shares


def obj(positions, triangles):
    rows = [f"v {numbers(p)}\n" for p in positions]
    rows += [f"f {' '.join(str(corner + 1) for corner in triangle)}\n" for triangle in triangles]
    return "".join(rows)


def attach(shares):
    columns = [name for name, _, _ in joints()[1:]]
    rows = [dict(row) for row in shares]
    return "".join(" ".join(number(row.get(name, 0.0)) for name in columns) + "\n" for row in rows)


def main():
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    positions, triangles, shares = skin()
    for name, text in [("bear.skel", skel()), ("bear.obj", obj(positions, triangles)), ("bear.attach", attach(shares))]:
        (folder / name).write_text(text, newline="\n")


main()
