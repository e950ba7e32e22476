//! The known name that an unknown one may have been meant for. Never lives here: any name.

/// `None` where no known name is near.
pub fn nearest<'a>(name: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    // A name far longer than any known one is near none of them; comparing takes time by the product of the lengths.
    if name.len() > 64 {
        return None;
    }
    let name = name.to_lowercase();
    // `fovy` and `fov_y` come to 0.96, `pos` and `pose` to 0.94; `tangents` and `triangles`, which are two things, to 0.825.
    const NEAR: f64 = 0.83;
    known
        .map(|candidate| {
            (
                strsim::jaro_winkler(&name, &candidate.to_lowercase()),
                candidate,
            )
        })
        .filter(|(similarity, _)| *similarity >= NEAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slip_is_near_and_another_word_is_not() {
        const KNOWN: [&str; 4] = ["pose", "rotxlimit", "triangles", "fov_y"];
        for (name, wanted) in [
            ("pos", Some("pose")),
            ("POSE", Some("pose")),
            ("rotlimit", Some("rotxlimit")),
            ("fovy", Some("fov_y")),
            ("tangents", None),
            ("mesh", None),
            ("", None),
            (&"pose".repeat(100), None),
        ] {
            assert_eq!(nearest(name, KNOWN.into_iter()), wanted, "{name}");
        }
    }
}
