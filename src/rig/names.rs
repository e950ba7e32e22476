//! Names that files give are free, repeated or missing; names in a [`Rig`](super::Rig) are unique.

use std::collections::{HashMap, HashSet};

/// Makes names unique: an empty one becomes `<noun>_<index>`, the k-th repeat of one gets `#k`.
pub(super) fn unique<'a>(noun: &str, names: impl Iterator<Item = &'a str>) -> Vec<String> {
    let mut taken = HashSet::new();
    let mut repeats: HashMap<String, usize> = HashMap::new();
    names
        .enumerate()
        .map(|(index, name)| {
            let base = if name.is_empty() {
                format!("{noun}_{index}")
            } else {
                name.to_owned()
            };
            let seen = repeats.entry(base.clone()).or_insert(0);
            let mut candidate = base.clone();
            loop {
                *seen += 1;
                if *seen > 1 {
                    candidate = format!("{base}#{seen}");
                }
                // A file may itself spell `knee#2`; then the count goes on past it.
                if taken.insert(candidate.clone()) {
                    return candidate;
                }
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::unique;

    #[test]
    fn repeats_are_counted_and_blanks_are_numbered() {
        for (given, wanted) in [
            (
                vec!["knee", "knee", "hip", "knee"],
                vec!["knee", "knee#2", "hip", "knee#3"],
            ),
            (vec!["", "a", ""], vec!["joint_0", "a", "joint_2"]),
            (
                vec!["knee#2", "knee", "knee"],
                vec!["knee#2", "knee", "knee#3"],
            ),
            (vec!["joint_1", ""], vec!["joint_1", "joint_1#2"]),
        ] {
            assert_eq!(unique("joint", given.into_iter()), wanted);
        }
    }
}
