//! Plain numbers as users type them and as they are shown. Never lives here: what a number is of.

/// A number that is one.
pub(super) fn number(text: &str) -> Result<f64, String> {
    finite(text, "a number", text)
}

/// A number above 0.
pub(super) fn positive(text: &str) -> Result<f64, String> {
    let expected = || format!("expected a number above 0, but found `{text}`");
    Some(finite(text, "a number above 0", text)?)
        .filter(|number| *number > 0.0)
        .ok_or_else(expected)
}

pub(super) fn finite(number: &str, expected: &str, text: &str) -> Result<f64, String> {
    let parsed = number
        .trim()
        .parse::<f64>()
        .ok()
        .filter(|number| number.is_finite());
    parsed.ok_or_else(|| format!("expected {expected}, but found `{text}`"))
}

/// A length or a weight with as many decimals as are of use to a reader.
pub(super) fn decimal(number: f64) -> String {
    rounded(number, 4)
}

/// Without zeros at its end.
pub(super) fn rounded(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0" } else { text }.to_owned()
}
