//! The surface cut into charts, each seen flat along an axis of its bone, and packed into one picture.
//! No colour: since the picture is baked from places on the surface, a cut may run anywhere and is not seen.

use super::body::Body;
use super::pack::{SIZE, pack};
use super::skeleton::{CHEST, FOOT, HAND, HEAD, THIGH, UPPER_ARM};
use super::surface::Surface;
use super::vectors::{V, add, cross, dot, len, mul, sub, unit};
use std::collections::BTreeMap;

pub struct Unwrap {
    /// For each vertex of the file the vertex of the surface that it is or repeats.
    pub sources: Vec<usize>,
    pub texcoords: Vec<[f64; 2]>,
    /// The triangles of the file, in the order of the surface's.
    pub faces: Vec<[usize; 3]>,
    /// Triangles of the file that own their texels; the right-hand twins of most share them.
    pub owners: Vec<usize>,
}

/// What is cut apart from its neighbours, and may be held at a scale of its own.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Part {
    Head,
    Trunk,
    Shorts,
    Arm,
    Hand,
    Leg,
    Shoe,
}

impl Part {
    fn at(body: &Body, p: V) -> Part {
        let all = [
            (Part::Head, body.head(p)),
            (Part::Trunk, body.shirt(p).min(body.neck(p))),
            (Part::Shorts, body.seat(p).min(body.shorts(p))),
            (Part::Arm, body.arm(p)),
            (Part::Hand, body.hand(p)),
            (Part::Leg, body.bare_leg(p).min(body.sock(p))),
            (Part::Shoe, body.shoe(p)),
        ];
        let nearest = all.into_iter().reduce(|a, b| if b.1 < a.1 { b } else { a });
        nearest.map_or(Part::Head, |n| n.0)
    }

    /// The bone whose axes it is seen along.
    fn bone(self) -> usize {
        match self {
            Part::Head => HEAD,
            Part::Trunk => CHEST,
            Part::Arm => UPPER_ARM,
            Part::Hand => HAND,
            Part::Shorts | Part::Leg => THIGH,
            Part::Shoe => FOOT,
        }
    }

    /// Texels to a length, relative to the shirt's, of a chart seen along `axis`.
    fn density(self, axis: usize) -> f64 {
        match (self, axis) {
            (Part::Head, FRONT) => 3.2,
            (Part::Head, _) => 1.3,
            (Part::Trunk, _) => 1.0,
            (Part::Shoe, UNDERSIDE) => 0.5,
            (Part::Shoe, _) => 1.2,
            (Part::Shorts, _) => 0.8,
            (Part::Hand, _) => 0.9,
            (Part::Arm, _) => 0.75,
            (Part::Leg, _) => 0.6,
        }
    }

    /// The ways it may be seen.  A hand is of one colour and seen from the back alone: its palm has the same texels.
    fn directions(self) -> &'static [usize] {
        match self {
            Part::Head => &[OUTSIDE, TOP, UNDERSIDE, FRONT, BACK],
            Part::Trunk => &[TOP, FRONT, BACK],
            Part::Hand => &[TOP],
            Part::Arm | Part::Leg => &[FRONT, BACK],
            Part::Shorts => &[OUTSIDE, FRONT, BACK],
            Part::Shoe => &[OUTSIDE, INSIDE, TOP, UNDERSIDE],
        }
    }

    /// Whether both sides share one chart; the shirt's front is not alike on both.
    fn mirrored(self) -> bool {
        self != Part::Trunk
    }
}

// Directions that a chart is seen from: +x -x +y -y +z -z of its bone.
const OUTSIDE: usize = 0;
const INSIDE: usize = 1;
const TOP: usize = 2;
const UNDERSIDE: usize = 3;
const FRONT: usize = 4;
const BACK: usize = 5;

#[derive(Clone, Copy, PartialEq, Eq)]
struct Label {
    part: Part,
    direction: usize,
}

pub fn unwrap(body: &Body, surface: &Surface) -> Unwrap {
    let mut labels = label(body, surface);
    absorb(surface, &mut labels);
    let charts = charts(surface, &labels);
    let flat: Vec<Chart> = charts
        .iter()
        .map(|faces| Chart::new(body, surface, faces, labels[faces[0]]))
        .collect();
    let sizes: Vec<_> = flat.iter().map(|c| c.size).collect();
    let (scale, corners) = pack(&sizes);
    let mut out = Unwrap {
        sources: (0..surface.points.len()).collect(),
        texcoords: vec![[f64::NAN; 2]; surface.points.len()],
        faces: surface.faces.clone(),
        owners: Vec::new(),
    };
    let mut taken: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    for (c, faces) in charts.iter().enumerate() {
        out.owners.extend(faces);
        let twins = faces.iter().map(|f| f + surface.left_faces);
        let twins = twins.filter(|_| labels[faces[0]].part.mirrored());
        for f in faces.iter().copied().chain(twins) {
            for i in 0..3 {
                let v = surface.faces[f][i];
                let seen = &flat[c].seen[&seen_as(surface, labels[faces[0]], v)];
                let at = [0, 1]
                    .map(|k| (corners[c][k] + (seen[k] - flat[c].low[k]) * scale) / SIZE as f64);
                let index = *taken.entry((v, c)).or_insert_with(|| {
                    if out.texcoords[v][0].is_nan() {
                        out.texcoords[v] = at;
                        return v;
                    }
                    out.sources.push(v);
                    out.texcoords.push(at);
                    out.sources.len() - 1
                });
                out.faces[f][i] = index;
            }
        }
    }
    out
}

/// The vertex that stands for `v` in a chart.
fn seen_as(surface: &Surface, label: Label, v: usize) -> usize {
    if label.part.mirrored() {
        surface.origin[v]
    } else {
        v
    }
}

/// Decides for every face what it belongs to and which way it is seen: the way it faces, unless its neighbours differ.
fn label(body: &Body, surface: &Surface) -> Vec<Label> {
    let left = &surface.faces[..surface.left_faces];
    let corner = |f: usize, i: usize| surface.points[left[f][i]];
    let middle = |f: usize| {
        mul(
            add(add(corner(f, 0), corner(f, 1)), corner(f, 2)),
            1.0 / 3.0,
        )
    };
    let facing = |f: usize, part: Part| -> [f64; 6] {
        let normal = unit(cross(
            sub(corner(f, 1), corner(f, 0)),
            sub(corner(f, 2), corner(f, 0)),
        ));
        let [x, y, z] = body.frames[part.bone()].axes.map(|a| dot(a, normal));
        [x, -x, y, -y, z, -z]
    };
    let edges = edges(left);
    let beside = |f: usize, i: usize| {
        let (a, b) = (left[f][i], left[f][(i + 1) % 3]);
        edges.get(&(b, a)).copied()
    };
    let mut parts: Vec<Part> = (0..left.len()).map(|f| Part::at(body, middle(f))).collect();
    // Ragged borders cost vertices: a face with two neighbours of one other part joins them.
    for _ in 0..4 {
        let old = parts.clone();
        for (f, part) in parts.iter_mut().enumerate() {
            let around: Vec<_> = (0..3)
                .filter_map(|i| beside(f, i))
                .map(|g| old[g])
                .collect();
            let other = around
                .iter()
                .find(|&o| o != part && around.iter().filter(|a| *a == o).count() >= 2);
            *part = other.copied().unwrap_or(*part);
        }
    }
    let mut labels: Vec<Label> = (0..left.len())
        .map(|f| {
            let part = parts[f];
            let facing = facing(f, part);
            let ways = part.directions().iter().copied();
            let best = ways.reduce(|a, b| if facing[b] > facing[a] { b } else { a });
            Label {
                part,
                direction: best.unwrap_or(0),
            }
        })
        .collect();
    for _ in 0..30 {
        for f in 0..left.len() {
            let facing = facing(f, labels[f].part);
            let round: f64 = (0..3)
                .map(|i| len(sub(corner(f, i), corner(f, (i + 1) % 3))))
                .sum();
            let cost = |direction: usize| {
                let steep = if facing[direction] < STEEPEST {
                    3.0
                } else {
                    0.0
                };
                let cut: f64 = (0..3)
                    .filter(|&i| {
                        beside(f, i).is_some_and(|g| {
                            labels[g]
                                != Label {
                                    direction,
                                    ..labels[f]
                                }
                        })
                    })
                    .map(|i| len(sub(corner(f, i), corner(f, (i + 1) % 3))) / round)
                    .sum();
                steep - facing[direction] + UNITY * cut
            };
            let ways = labels[f].part.directions().iter().copied();
            let best = ways.reduce(|a, b| if cost(b) < cost(a) { b } else { a });
            labels[f].direction = best.unwrap_or(0);
        }
    }
    // The right half is the left one's mirror image.
    labels.extend_from_within(..);
    labels
}

/// The least cosine between a face and the way it is seen.
const STEEPEST: f64 = 0.0;
/// How much a face would rather be seen like its neighbours than straight on.
const UNITY: f64 = 3.2;

/// Charts of fewer faces than this cost more vertices than the texels they save from being seen askew.
const SMALLEST: usize = 14;

/// Gives small charts to the neighbour of the same part that they share most edges with.
fn absorb(surface: &Surface, labels: &mut [Label]) {
    let edges = edges(&surface.faces);
    for chart in charts(surface, labels)
        .iter()
        .filter(|c| c.len() < SMALLEST)
    {
        let mine = labels[chart[0]];
        let mut shared = [0; 6];
        for t in chart.iter().map(|&f| surface.faces[f]) {
            let beside = (0..3).filter_map(|i| edges.get(&(t[(i + 1) % 3], t[i])));
            for other in beside
                .map(|&g| labels[g])
                .filter(|o| o.part == mine.part && *o != mine)
            {
                shared[other.direction] += 1;
            }
        }
        let most = (0..6).max_by_key(|&d| shared[d]).filter(|&d| shared[d] > 0);
        for &f in chart {
            let twin = (f + surface.left_faces) % surface.faces.len();
            labels[f].direction = most.unwrap_or(mine.direction);
            labels[twin].direction = labels[f].direction;
        }
    }
}

/// The face on the left of every edge, by the edge's ends.
fn edges(faces: &[[usize; 3]]) -> BTreeMap<(usize, usize), usize> {
    let sides = |(f, t): (usize, &[usize; 3])| [0, 1, 2].map(|i| ((t[i], t[(i + 1) % 3]), f));
    faces.iter().enumerate().flat_map(sides).collect()
}

/// Connected faces of one label; those on the right only where they do not share the left's.
fn charts(surface: &Surface, labels: &[Label]) -> Vec<Vec<usize>> {
    let mine = |f: usize| f < surface.left_faces || !labels[f].part.mirrored();
    // Seen from the side, the two halves are seen from opposite sides.
    let joins = |f: usize, g: usize| {
        let across = (f < surface.left_faces) != (g < surface.left_faces);
        mine(g) && labels[f] == labels[g] && !(across && labels[f].direction < 2)
    };
    let edges = edges(&surface.faces);
    let mut seen = vec![false; surface.faces.len()];
    let mut charts = Vec::new();
    for start in (0..surface.faces.len()).filter(|&f| mine(f)) {
        if std::mem::replace(&mut seen[start], true) {
            continue;
        }
        let mut chart = vec![start];
        let mut next = 0;
        while next < chart.len() {
            let f = chart[next];
            next += 1;
            let t = surface.faces[f];
            for i in 0..3 {
                if let Some(&g) = edges.get(&(t[(i + 1) % 3], t[i]))
                    && !seen[g]
                    && joins(f, g)
                {
                    seen[g] = true;
                    chart.push(g);
                }
            }
        }
        charts.push(chart);
    }
    charts
}

/// A chart laid flat, in lengths of the shirt's scale.
struct Chart {
    seen: BTreeMap<usize, [f64; 2]>,
    low: [f64; 2],
    size: [f64; 2],
}

impl Chart {
    fn new(body: &Body, surface: &Surface, faces: &[usize], label: Label) -> Chart {
        let axis = label.direction / 2;
        let axes = body.frames[label.part.bone()].axes;
        // Bones lie along x in the arm and along y elsewhere; that way is up.
        let (mut across, mut up) = [(2, 1), (0, 2), (0, 1)].map(|(a, b)| (axes[a], axes[b]))[axis];
        if matches!(label.part, Part::Arm | Part::Hand) && axis > 0 {
            (across, up) = (up, across);
        }
        let density = label.part.density(label.direction);
        let mut seen = BTreeMap::new();
        for &f in faces {
            for v in surface.faces[f] {
                let p = surface.points[v];
                seen.insert(
                    seen_as(surface, label, v),
                    [across, up].map(|a| dot(a, p) * density),
                );
            }
        }
        let bound = |pick: fn(f64, f64) -> f64| {
            [0, 1].map(|k| seen.values().map(|s| s[k]).reduce(pick).unwrap_or(0.0))
        };
        let (low, high) = (bound(f64::min), bound(f64::max));
        Chart {
            low,
            size: [high[0] - low[0], high[1] - low[1]],
            seen,
        }
    }
}
