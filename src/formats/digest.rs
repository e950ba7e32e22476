//! One name for the same files, wherever and in whatever order they were sent.
//! Never lives here: what is in them.

use sha2::{Digest, Sha256};
use std::fmt::Write;

/// `sha256:` and 64 hexadecimal digits over the one file that the rig is, whatever it is called.
pub(super) fn of_content(content: &[u8]) -> String {
    written(Sha256::new_with_prefix(content))
}

/// The same over `(base name, content)`, sorted by base name: of each its length as a little-endian
/// u64, then itself.
pub(super) fn of(mut files: Vec<(&str, &[u8])>) -> String {
    // By content too: pictures of one name can come from two folders.
    files.sort_unstable();
    let mut hash = Sha256::new();
    for (name, content) in files {
        for part in [name.as_bytes(), content] {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part);
        }
    }
    written(hash)
}

fn written(hash: Sha256) -> String {
    let mut digest = "sha256:".to_owned();
    for byte in hash.finalize() {
        // Writing into a String cannot fail.
        let _ = write!(digest, "{byte:02x}");
    }
    digest
}

#[cfg(test)]
mod tests {
    use super::{of, of_content};

    #[test]
    fn order_does_not_count_but_where_a_name_ends_does() {
        let (a, b) = (("a", &b"1"[..]), ("b", &b"2"[..]));
        assert_eq!(of(vec![a, b]), of(vec![b, a]));
        assert_ne!(of(vec![("ab", b"c")]), of(vec![("a", b"bc")]));
    }

    #[test]
    fn it_is_the_one_that_anybody_can_compute() {
        // printf '\1\0\0\0\0\0\0\0a\2\0\0\0\0\0\0\0hi' | sha256sum
        let wanted = "sha256:cddc1822a27eb821c85f4b29ab888ceed50f1b0f53bb7dfc17231570bd2eacd8";
        assert_eq!(of(vec![("a", b"hi")]), wanted);
        // printf hi | sha256sum
        let wanted = "sha256:8f434346648f6b96df89dda901c5176b10a6d83961dd3c1ac88b59b2dc327aa4";
        assert_eq!(of_content(b"hi"), wanted);
    }
}
