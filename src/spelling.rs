//! The known name that an unknown one may have been meant for. Never lives here: any name.

/// The same in another case, the only one that ends in it after a dot (`ping`, `server.ping`), or the first of those that look most like
/// it. `None` where no known name is near.
pub(crate) fn nearest<'a>(
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Option<&'a str> {
    /// Bytes of a name that is compared: that takes time by the product of the lengths.
    const LONGEST: usize = 64;
    /// Names that are compared, of a rig's hundred thousands: a matter of milliseconds.
    const MOST: usize = 4096;
    /// `fovy` and `fov_y` come to 0.96, `pos` and `pose` to 0.94; `tangents` and `triangles`, which are two things, to 0.825.
    const NEAR: f64 = 0.83;
    let is_same = |candidate: &str| candidate.eq_ignore_ascii_case(name);
    if let Some(same) = known.clone().find(|candidate| is_same(candidate)) {
        return Some(same);
    }
    let ends_in_it = |candidate: &&str| {
        let last = candidate.rsplit_once('.').map(|(_, last)| last);
        last.is_some_and(is_same)
    };
    let mut ending = known.clone().filter(ends_in_it);
    if let (Some(only), None) = (ending.next(), ending.next()) {
        return Some(only);
    }
    if name.len() > LONGEST {
        return None;
    }
    let name = name.to_lowercase();
    known
        .filter(|candidate| candidate.len() <= LONGEST)
        .take(MOST)
        .map(|candidate| {
            (
                strsim::jaro_winkler(&name, &candidate.to_lowercase()),
                candidate,
            )
        })
        .filter(|(similarity, _)| *similarity >= NEAR)
        .reduce(|best, other| if other.0 > best.0 { other } else { best })
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

    #[test]
    fn the_nearest_name_is_found_among_many_and_long_ones() {
        let known = ["Head", "hand.L", "hand.R", "morph.smile"];
        for (name, near) in [
            ("head", Some("Head")),
            ("HAND.l", Some("hand.L")),
            ("Smile", Some("morph.smile")),
            ("l", Some("hand.L")),
            ("hnad.R", Some("hand.R")),
            // As near as `hand.R`, which comes later.
            ("hand.X", Some("hand.L")),
            ("tail", None),
            ("", None),
        ] {
            assert_eq!(nearest(name, known.into_iter()), near, "{name}");
        }
        let long = "x".repeat(100_000);
        let many = vec![long.as_str(); 100_000];
        assert_eq!(nearest("xxxxxxxx", many.iter().copied()), None);
        assert_eq!(
            nearest(&"X".repeat(100_000), many.into_iter()),
            Some(long.as_str())
        );
    }
}
