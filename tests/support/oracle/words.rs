//! Words and numbers of the text formats, wherever the lines end. Never lives here: what they mean.

pub struct Words(std::vec::IntoIter<String>);

impl Words {
    /// Braces are words of their own, also where they touch others.
    pub fn of(text: &str) -> Self {
        let spaced = text.replace('{', " { ").replace('}', " } ");
        let words: Vec<String> = spaced.split_whitespace().map(str::to_owned).collect();
        Self(words.into_iter())
    }

    pub fn next(&mut self) -> Option<String> {
        self.0.next()
    }

    pub fn word(&mut self) -> String {
        self.next().expect("another word")
    }

    pub fn expect(&mut self, wanted: &str) {
        assert_eq!(self.word(), wanted);
    }

    /// Whether the next word is this one, which is then left where it is.
    pub fn stands_before(&self, word: &str) -> bool {
        self.0.as_slice().first().is_some_and(|next| next == word)
    }

    pub fn number<T: std::str::FromStr>(&mut self) -> T {
        let word = self.word();
        word.parse()
            .unwrap_or_else(|_| panic!("a number, not `{word}`"))
    }

    pub fn numbers<const N: usize>(&mut self) -> [f64; N] {
        [0; N].map(|_| self.number())
    }
}
