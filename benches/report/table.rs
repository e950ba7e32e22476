//! The page: tables in Markdown. Never lives here: what stands in them.

use crate::rounds::Spread;
use std::fmt::Write;

/// What a ratio is held against.
#[derive(Clone, Copy)]
pub enum Wanted {
    AtLeast(f64),
    AtMost(f64),
    /// It is reported, and nothing more.
    Nothing,
}

/// What came out, or why nothing did.
pub enum Outcome {
    /// Both sides in words, and what the first comes to beside the second.
    Measured {
        ratio: Spread,
        daemon: String,
        floor: String,
    },
    NotMeasured(&'static str),
}

/// One line of the table of what is wanted.
pub struct Row {
    pub what: String,
    pub wanted: Wanted,
    pub outcome: Outcome,
}

impl Wanted {
    fn words(self) -> String {
        match self {
            Self::AtLeast(bound) => format!("≥ {bound:.2}"),
            Self::AtMost(bound) => format!("≤ {bound:.2}"),
            Self::Nothing => String::new(),
        }
    }

    fn verdict(self, ratio: f64) -> &'static str {
        match self {
            Self::AtLeast(bound) if ratio >= bound => "yes",
            Self::AtMost(bound) if ratio <= bound => "yes",
            Self::Nothing => "",
            _ => "**no**",
        }
    }
}

impl Row {
    pub const HEAD: &str = "| | wanted | came out | over rounds | so it is | daemon | compared with |\n|---|---|---|---|---|---|---|\n";

    pub fn line(&self) -> String {
        let (what, wanted) = (&self.what, self.wanted.words());
        match &self.outcome {
            Outcome::Measured {
                ratio: Spread { low, median, high },
                daemon,
                floor,
            } => {
                let verdict = self.wanted.verdict(*median);
                format!(
                    "| {what} | {wanted} | {median:.3} | {low:.3}–{high:.3} | {verdict} | {daemon} | {floor} |\n"
                )
            }
            Outcome::NotMeasured(why) => {
                format!("| {what} | {wanted} | not measured: {why} | | | | |\n")
            }
        }
    }
}

/// Numbers by size: a column for each line of a plot.
pub fn by_size(size: &str, columns: &[&str], rows: &[(f64, Vec<f64>)]) -> String {
    let rules = "---|".repeat(columns.len());
    let mut table = format!("| {size} | {} |\n|---|{rules}\n", columns.join(" | "));
    for (size, values) in rows {
        let values: Vec<String> = values.iter().map(|&value| digits(value)).collect();
        let _ = writeln!(table, "| {} | {} |", grouped(*size), values.join(" | "));
    }
    table
}

/// Three digits that count, where there are decimals.
pub fn digits(value: f64) -> String {
    match value {
        100.0.. => grouped(value),
        10.0.. => format!("{value:.1}"),
        1.0.. => format!("{value:.2}"),
        _ => format!("{value:.3}"),
    }
}

/// With a comma after each thousand.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let groups: Vec<&str> = digits
        .as_bytes()
        .rchunks(3)
        .rev()
        .filter_map(|group| std::str::from_utf8(group).ok())
        .collect();
    groups.join(",")
}
