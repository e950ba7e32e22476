//! What kind of file the output is. Never lives here: how it is written.

use crate::cli::files::Destination;
use anyhow::bail;

/// What the ending of the output's name asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Gif,
    Apng,
}

impl Format {
    pub(super) fn of(output: &Destination) -> anyhow::Result<Self> {
        let Destination::File(path) = output else {
            return Ok(Self::Png);
        };
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("png") => Ok(Self::Png),
            Some("gif") => Ok(Self::Gif),
            Some("apng") => Ok(Self::Apng),
            _ => bail!(
                "--output: expected a name that ends in .png, .gif or .apng, or - for a PNG to standard output, but found `{}`",
                path.display()
            ),
        }
    }
}
