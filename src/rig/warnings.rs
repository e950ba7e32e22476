//! What a reader found odd but could work with. Bounded, so that a hostile file cannot fill memory with complaints.

/// Sentences for the person who made the file, at most [`Warnings::KEPT`] of them.
#[derive(Debug, Default)]
pub struct Warnings {
    kept: Vec<String>,
    dropped: usize,
}

impl Warnings {
    /// As many as a person will read.
    pub const KEPT: usize = 50;

    /// The sentence is only made where it will be kept.
    pub fn push(&mut self, sentence: impl FnOnce() -> String) {
        if self.kept.len() < Self::KEPT {
            self.kept.push(sentence());
        } else {
            self.dropped += 1;
        }
    }

    /// Adds those of another list behind these.
    pub fn append(&mut self, other: Self) {
        for sentence in other.kept {
            self.push(|| sentence);
        }
        self.dropped += other.dropped;
    }

    /// The sentences, the last of which counts those that were not kept.
    pub fn into_sentences(mut self) -> Vec<String> {
        if self.dropped > 0 {
            self.kept
                .push(format!("and {} more warnings", self.dropped));
        }
        self.kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rest_is_counted_and_not_kept() {
        let mut warnings = Warnings::default();
        for i in 0..Warnings::KEPT + 7 {
            warnings.push(|| format!("odd thing {i}"));
        }
        let sentences = warnings.into_sentences();
        assert_eq!(sentences.len(), Warnings::KEPT + 1);
        assert_eq!(sentences[Warnings::KEPT], "and 7 more warnings");
    }

    #[test]
    fn appending_keeps_no_more_and_counts_all() {
        let many = || {
            let mut warnings = Warnings::default();
            (0..Warnings::KEPT + 7).for_each(|i| warnings.push(|| format!("odd thing {i}")));
            warnings
        };
        let mut warnings = many();
        warnings.append(many());
        let sentences = warnings.into_sentences();
        assert_eq!(sentences.len(), Warnings::KEPT + 1);
        let dropped = Warnings::KEPT + 2 * 7;
        assert_eq!(
            sentences[Warnings::KEPT],
            format!("and {dropped} more warnings")
        );
    }
}
