//! `.skel`, `.skin`, `.morph` and `.anim` of UCSD's CSE 169, read as the course defines them. Panics at what it does not know: the files it is
//! used with are right. Never lives here: evaluation.

use super::clip::{Channel, Clip, Extrapolation, Key, Tangent};
use super::matrix::{Vector, from_columns, length, scaled};
use super::words::Words;
use super::{Joint, Morph, Rig};

pub fn skeleton(text: &str) -> Vec<Joint> {
    let mut words = Words::of(text);
    let mut joints: Vec<Joint> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    while let Some(word) = words.next() {
        if matches!(word.as_str(), "balljoint" | "joint") {
            let name = words.word();
            words.expect("{");
            joints.push(Joint {
                name,
                parent: open.last().copied(),
                ..Joint::default()
            });
            open.push(joints.len() - 1);
            continue;
        }
        let &current = open.last().expect("words stand inside a joint");
        let joint = &mut joints[current];
        match word.as_str() {
            "}" => {
                open.pop();
            }
            "offset" => joint.offset = words.numbers(),
            "pose" => joint.angles = words.numbers(),
            "boxmin" | "boxmax" => {
                let _box: Vector = words.numbers();
            }
            "rotxlimit" => joint.limits[0] = words.numbers(),
            "rotylimit" => joint.limits[1] = words.numbers(),
            "rotzlimit" => joint.limits[2] = words.numbers(),
            other => panic!("unknown word `{other}`"),
        }
    }
    joints
}

pub fn skin(text: &str, rig: &mut Rig) {
    let mut words = Words::of(text);
    while let Some(section) = words.next() {
        if section == "material" {
            while words.word() != "}" {}
            continue;
        }
        let count: usize = words.number();
        words.expect("{");
        match section.as_str() {
            "positions" => rig.positions = (0..count).map(|_| words.numbers()).collect(),
            "normals" => rig.normals = (0..count).map(|_| unit(words.numbers())).collect(),
            "texcoords" => {
                let _unused: Vec<[f64; 2]> = (0..count).map(|_| words.numbers()).collect();
            }
            "triangles" => {
                let mut triangle = || [0; 3].map(|_| words.number());
                rig.triangles = (0..count).map(|_| triangle()).collect();
            }
            "skinweights" => {
                for _ in 0..count {
                    let influences: usize = words.number();
                    let of_vertex = (0..influences).map(|_| (words.number(), words.number()));
                    rig.weights.push(of_vertex.collect());
                }
            }
            "bindings" => {
                for _ in 0..count {
                    words.expect("matrix");
                    words.expect("{");
                    let columns: [Vector; 4] = [0; 4].map(|_| words.numbers());
                    words.expect("}");
                    rig.bindings.push(from_columns(columns));
                }
            }
            other => panic!("unknown section `{other}`"),
        }
        words.expect("}");
    }
}

pub fn morph(name: &str, text: &str) -> Morph {
    let mut words = Words::of(text);
    let mut block = |name: &str| -> Vec<(usize, Vector)> {
        words.expect(name);
        let count: usize = words.number();
        words.expect("{");
        let entries = (0..count).map(|_| (words.number(), words.numbers()));
        let entries = entries.collect();
        words.expect("}");
        entries
    };
    let positions = block("positions");
    let normals = block("normals");
    Morph {
        name: name.to_owned(),
        positions,
        normals: normals
            .into_iter()
            .map(|(vertex, normal)| (vertex, unit(normal).expect("a direction")))
            .collect(),
    }
}

pub fn animation(name: &str, text: &str) -> Clip {
    let mut words = Words::of(text);
    for word in ["animation", "{", "range"] {
        words.expect(word);
    }
    let _range: [f64; 2] = words.numbers();
    words.expect("numchannels");
    let count: usize = words.number();
    let channels = (0..count).map(|_| channel(&mut words)).collect();
    words.expect("}");
    Clip {
        name: name.to_owned(),
        channels,
    }
}

fn channel(words: &mut Words) -> Channel {
    words.expect("channel");
    if !words.stands_before("{") {
        let _index: usize = words.number();
    }
    words.expect("{");
    words.expect("extrapolate");
    let [before, after] = [0; 2].map(|_| extrapolation(&words.word()));
    words.expect("keys");
    let count: usize = words.number();
    words.expect("{");
    let key = |_| Key {
        time: words.number(),
        value: words.number(),
        arriving: tangent(&words.word()),
        leaving: tangent(&words.word()),
    };
    let keys = (0..count).map(key).collect();
    words.expect("}");
    words.expect("}");
    Channel {
        before,
        after,
        keys,
    }
}

fn extrapolation(word: &str) -> Extrapolation {
    match word {
        "constant" => Extrapolation::Constant,
        "linear" => Extrapolation::Linear,
        "cycle" => Extrapolation::Cycle,
        "cycle_offset" => Extrapolation::CycleOffset,
        "bounce" => Extrapolation::Bounce,
        other => panic!("unknown extrapolation `{other}`"),
    }
}

fn tangent(word: &str) -> Tangent {
    match word {
        "flat" => Tangent::Flat,
        "linear" => Tangent::Linear,
        "smooth" => Tangent::Smooth,
        slope => Tangent::Fixed(slope.parse().expect("a slope")),
    }
}

/// `None` where there is no direction.
fn unit(normal: Vector) -> Option<Vector> {
    (length(normal) > 0.0).then(|| scaled(normal))
}
