//! `.skel`, `.obj` and `.attach` of MIT's 6.837, line by line as the course defines them, Panics at what it does not know: the files
//! it is used with are right. Never lives here: evaluation, and the normals that an `.obj` leaves out.

use super::{Joint, Rig};

/// Lines of `x y z parent`.
pub fn skeleton(text: &str) -> Vec<Joint> {
    let joint = |(index, line): (usize, &str)| {
        let numbers = numbers(line);
        let [x, y, z, parent] = numbers.try_into().expect("x y z parent");
        Joint {
            name: format!("joint_{index}"),
            parent: (parent >= 0.0).then_some(parent as usize),
            offset: [x, y, z],
            ..Joint::default()
        }
    };
    lines(text).enumerate().map(joint).collect()
}

/// Lines of `v x y z` and of `f a b c`, counted from 1.
pub fn mesh(text: &str, rig: &mut Rig) {
    for line in lines(text) {
        let (kind, rest) = line.split_once(' ').expect("a word and numbers");
        let three: [f64; 3] = numbers(rest).try_into().expect("three numbers");
        match kind {
            "v" => rig.positions.push(three),
            "f" => rig.triangles.push(three.map(|index| index as usize - 1)),
            other => panic!("unknown line `{other}`"),
        }
    }
}

/// A line for each vertex, a weight for each joint but the root. A weight of 0 is no influence.
pub fn attachment(text: &str) -> Vec<Vec<(usize, f64)>> {
    let of_vertex = |line| {
        let weights = numbers(line).into_iter().enumerate();
        weights
            .filter(|(_, weight)| *weight != 0.0)
            .map(|(column, weight)| (column + 1, weight))
            .collect()
    };
    lines(text).map(of_vertex).collect()
}

fn lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().map(str::trim).filter(|line| !line.is_empty())
}

fn numbers(line: &str) -> Vec<f64> {
    let number = |word: &str| word.parse().expect("a number");
    line.split_whitespace().map(number).collect()
}
