//! Reads a CSE 169 `.anim`: curves over time, one for each number that a skeleton is posed by.
//! Never lives here: what the value of a curve is at a time, and playing one.
//!
//! ```text
//! anim    := "animation" "{" ("range" t0 t1 | "numchannels" N | channel)* "}"     range and numchannels once each
//! channel := "channel" [INDEX] "{" ["extrapolate" MODE MODE] "keys" K "{" (time value TANGENT TANGENT){K} "}" "}"
//! MODE    := "constant" | "linear" | "cycle" | "cycle_offset" | "bounce"          before the first key, after the last
//! TANGENT := "flat" | "linear" | "smooth" | slope                                 into the key, out of it
//! ```
//! `numchannels` stands before the channels. A channel's number is its place among them; an INDEX that is another is worth a warning.
//! Without `extrapolate` both modes are `constant`. Times are in seconds and rise from key to key.
//!
//! Channels set the root's displacement along x, y and z, then each joint's angles about x, y and z in the order of joints. Slopes
//! are value per second: `flat` is 0; `linear` is that of the line to the key before (coming in) or behind (going out); `smooth` is
//! that of the line between those two. At the first and the last key, `linear` and `smooth` are the one line there is; at a
//! single key they are 0.

use super::common::{second, warn_of_rest};
use super::keywords::{Keywords, PassedOver};
use super::sections::{Brace, Section};
use crate::formats::contribution::LooseClip;
use crate::formats::error::{FileFault, LoadError};
use crate::formats::text::lexer::{Lexer, Token, parse_number};
use crate::limits::Limits;
use crate::rig::{
    Axis, ChannelDraft, ChannelTarget, ClipDraft, Curve, DofKind, Extrapolation, Interpolation,
    Key, LARGEST_COORDINATE, Warnings,
};

const START: Keywords = Keywords(&["animation"]);
const ITEM: Keywords = Keywords(&["range", "numchannels", "channel"]);
const IN_CHANNEL: Keywords = Keywords(&["extrapolate", "keys"]);

/// The clip has no name yet.
///
/// # Errors
/// [`LoadError::Invalid`] at the word that does not fit, [`LoadError::Limit`] where more keys are announced than a rig may have.
pub(super) fn read(
    lexer: Lexer,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Result<LooseClip, LoadError> {
    let mut reader = Reader {
        lexer,
        limits,
        warnings,
        range: None,
        announced: None,
        surplus: None,
        curves: Vec::new(),
        key_count: 0,
        passed_over: PassedOver::default(),
    };
    let start = reader.read_start()?;
    reader.read_items(start)?;
    warn_of_rest(&reader.lexer, "the `animation`", reader.warnings);
    Ok(reader.into_clip())
}

struct Reader<'a, 'w> {
    lexer: Lexer<'a>,
    limits: &'w Limits,
    warnings: &'w mut Warnings,
    range: Option<[f64; 2]>,
    /// What `numchannels` says, and where.
    announced: Option<(u64, Token<'a>)>,
    /// The first channel that was not announced.
    surplus: Option<Token<'a>>,
    curves: Vec<Curve<f64>>,
    /// Of all channels together.
    key_count: u64,
    passed_over: PassedOver<'a>,
}

impl<'a> Reader<'a, '_> {
    fn read_start(&mut self) -> Result<Token<'a>, FileFault> {
        let word = START.next(&mut self.lexer, self.warnings);
        if word.text != "animation" {
            return Err(self.lexer.fault(word, "`animation`"));
        }
        self.lexer.expect("{", || "after `animation`".to_owned())?;
        Ok(word)
    }

    fn read_items(&mut self, start: Token<'a>) -> Result<(), LoadError> {
        loop {
            let word = ITEM.next(&mut self.lexer, self.warnings);
            match word.text {
                "range" if self.range.is_some() => return Err(second(&self.lexer, word).into()),
                "range" => self.range = Some(self.read_range(word)?),
                "numchannels" if self.announced.is_some() => {
                    return Err(second(&self.lexer, word).into());
                }
                "numchannels" => {
                    let after = || "after `numchannels`".to_owned();
                    self.announced = Some(self.lexer.whole(after)?);
                }
                "channel" => self.read_channel(word)?,
                "}" => return Ok(self.check_end(word)?),
                "" => {
                    self.check_end(word)?;
                    let (line, column) = self.lexer.line_column(start);
                    let expected = format!("`}}` to end the `animation` at {line}:{column}");
                    return Err(self.lexer.fault(word, expected).into());
                }
                _ => {
                    let near = ITEM.skip_unknown(&mut self.lexer, word, self.warnings)?;
                    self.passed_over.note(near, word);
                }
            }
        }
    }

    fn read_range(&mut self, word: Token<'a>) -> Result<[f64; 2], FileFault> {
        let after = || format!("after `{}`", word.text);
        let first = self.lexer.peek();
        let range = [self.lexer.number(after)?, self.lexer.number(after)?];
        if range[0] > range[1] {
            let expected = format!("the earlier time first {}", after());
            let found = format!("{} and {}", range[0], range[1]);
            return Err(self.lexer.fault_found(first, expected, found));
        }
        Ok(range)
    }

    fn read_channel(&mut self, keyword: Token<'a>) -> Result<(), LoadError> {
        let Some((announced, _)) = self.announced else {
            let expected = "`numchannels` before the first `channel`";
            let reported_at = self.passed_over.of("numchannels").unwrap_or(keyword);
            return Err(self.lexer.fault(reported_at, expected).into());
        };
        let number = self.curves.len() as u64;
        if number == announced {
            self.surplus = Some(keyword);
        }
        self.read_index(number)?;
        let mut extrapolation = None;
        let mut keys = None;
        let mut passed_over = PassedOver::default();
        loop {
            let word = IN_CHANNEL.next(&mut self.lexer, self.warnings);
            match word.text {
                "extrapolate" if extrapolation.is_some() => {
                    return Err(second(&self.lexer, word).into());
                }
                "extrapolate" => {
                    extrapolation = Some([self.read_mode()?, self.read_mode()?]);
                }
                "keys" if keys.is_some() => return Err(second(&self.lexer, word).into()),
                "keys" => keys = Some(self.read_keys(word)?),
                "}" if keys.is_some() => break,
                "}" => {
                    let expected = format!("`keys` in channel {number}");
                    let reported_at = passed_over.of("keys").unwrap_or(word);
                    return Err(self.lexer.fault(reported_at, expected).into());
                }
                "" => {
                    let (line, column) = self.lexer.line_column(keyword);
                    let expected = format!("`}}` to end the `channel` at {line}:{column}");
                    return Err(self.lexer.fault(word, expected).into());
                }
                _ => {
                    let near = IN_CHANNEL.skip_unknown(&mut self.lexer, word, self.warnings)?;
                    passed_over.note(near, word);
                }
            }
        }
        let [before, after] = extrapolation.unwrap_or([Extrapolation::Constant; 2]);
        self.curves.push(Curve {
            interpolation: Interpolation::Cubic,
            keys: keys.unwrap_or_default(),
            before,
            after,
        });
        Ok(())
    }

    /// What may stand between `channel` and its brace, and the brace.
    fn read_index(&mut self, number: u64) -> Result<(), FileFault> {
        if self.lexer.take("{") {
            return Ok(());
        }
        let (index, token) = self.lexer.whole(|| "or `{` after `channel`".to_owned())?;
        if index != number {
            let lexer = &self.lexer;
            self.warnings.push(|| {
                let place = lexer.place(token);
                format!("{place}: this is channel {number}, not {index}; the order counts")
            });
        }
        let after = || format!("after `channel {}`", token.text);
        self.lexer.expect("{", after).map(drop)
    }

    fn read_mode(&mut self) -> Result<Extrapolation, FileFault> {
        let token = self.lexer.next();
        Ok(match token.text {
            "constant" => Extrapolation::Constant,
            "linear" => Extrapolation::Linear,
            "cycle" => Extrapolation::Cycle,
            "cycle_offset" => Extrapolation::CycleOffset,
            "bounce" => Extrapolation::Bounce,
            _ => {
                let expected = "`constant`, `linear`, `cycle`, `cycle_offset` or `bounce` \
                                twice after `extrapolate`";
                return Err(self.lexer.fault(token, expected));
            }
        })
    }

    fn read_keys(&mut self, keyword: Token<'a>) -> Result<Vec<Key<f64>>, LoadError> {
        let (so_far, limits) = (self.key_count, self.limits);
        let check_limit = |count: u64| limits.keys(count.saturating_add(so_far));
        let lexer = &mut self.lexer;
        let section = Section::open(lexer, keyword, ("key", "keys"), Brace::Needed, check_limit)?;
        let mut last_time = f64::NEG_INFINITY;
        let drawn = section.read_rows(lexer, 8, |lexer, row| {
            let place = || section.in_row(row);
            let start = lexer.offset();
            let time = lexer.number(place)?;
            if time <= last_time {
                let expected = format!("a time after {last_time} {}", place());
                return Err(lexer.fault(lexer.from(start).next(), expected).into());
            }
            last_time = time;
            Ok(FileKey {
                time,
                value: lexer.number(place)?,
                tangents: [read_tangent(lexer, place)?, read_tangent(lexer, place)?],
            })
        })?;
        self.key_count += drawn.len() as u64;
        let resolve = |index| {
            let key = resolved(&drawn, index);
            let steepest = key.slope_in.abs().max(key.slope_out.abs());
            // Where two keys are next to each other, a line between them can be steeper than anything can be computed with.
            if steepest <= LARGEST_COORDINATE {
                return Ok(key);
            }
            let expected = format!("slopes of at most 1e9 {}", section.in_row(index));
            let token = section.word(lexer, 4 * index);
            Err(lexer.fault_found(token, expected, format!("one of {steepest:.1e}")))
        };
        Ok((0..drawn.len()).map(resolve).collect::<Result<_, _>>()?)
    }

    /// Holds the number of channels against what was announced. `end` is the brace, or the end of the file.
    fn check_end(&self, end: Token<'a>) -> Result<(), FileFault> {
        let Some((announced, _)) = self.announced else {
            let reported_at = self.passed_over.of("numchannels").unwrap_or(end);
            return Err(self.lexer.fault(reported_at, "`numchannels`"));
        };
        let channels = self.curves.len();
        let noun = if announced == 1 {
            "channel"
        } else {
            "channels"
        };
        let wanted = format!("{announced} {noun} as announced");
        if let Some(surplus) = self.surplus {
            let expected = format!("`}}` after {wanted}");
            let fault = self.lexer.fault(surplus, expected);
            let found = format!("{}: {channels} channels in all", fault.found);
            return Err(FileFault { found, ..fault });
        }
        if (channels as u64) < announced {
            let fault = self.lexer.fault(end, wanted);
            let found = format!("{} after {channels}", fault.found);
            return Err(FileFault { found, ..fault });
        }
        match self.range {
            Some(_) => Ok(()),
            None => {
                let reported_at = self.passed_over.of("range").unwrap_or(end);
                Err(self.lexer.fault(reported_at, "`range`"))
            }
        }
    }

    fn into_clip(self) -> LooseClip {
        let place = self.announced.map(|(_, token)| self.lexer.place(token));
        let channels = self.curves.into_iter().enumerate();
        LooseClip {
            clip: ClipDraft {
                range: self.range.unwrap_or_default(),
                channels: channels
                    .map(|(number, curve)| ChannelDraft::Dof {
                        target: ChannelTarget::Dof(target(number)),
                        curve,
                    })
                    .collect(),
                ..ClipDraft::default()
            },
            channels_counted_at: place,
        }
    }
}

/// What the channel of a number sets.
fn target(number: usize) -> DofKind {
    let axis = Axis::ALL[number % 3];
    match (number / 3).checked_sub(1) {
        None => DofKind::Translation { joint: 0, axis },
        Some(joint) => DofKind::Rotation { joint, axis },
    }
}

/// A key as it is written.
struct FileKey {
    time: f64,
    value: f64,
    /// In and out.
    tangents: [Tangent; 2],
}

#[derive(Clone, Copy)]
enum Tangent {
    Flat,
    Linear,
    Smooth,
    Slope(f64),
}

fn read_tangent(lexer: &mut Lexer, place: impl Fn() -> String) -> Result<Tangent, FileFault> {
    let token = lexer.peek();
    let tangent = match token.text {
        "flat" => Tangent::Flat,
        "linear" => Tangent::Linear,
        "smooth" => Tangent::Smooth,
        text if parse_number(text).is_some() => {
            return lexer.number(place).map(Tangent::Slope);
        }
        _ => {
            lexer.next();
            let expected = format!("`flat`, `linear`, `smooth` or a number {}", place());
            return Err(lexer.fault(token, expected));
        }
    };
    lexer.next();
    Ok(tangent)
}

fn resolved(keys: &[FileKey], index: usize) -> Key<f64> {
    let key = &keys[index];
    let before = index.checked_sub(1).map_or(key, |before| &keys[before]);
    let behind = keys.get(index + 1).unwrap_or(key);
    let smooth = line(before, behind);
    // At an end one of the two keys around this one is itself, so that `smooth` is the slope of the one line there is.
    let linear = |[from, to]: [&FileKey; 2]| {
        if from.time < to.time {
            line(from, to)
        } else {
            smooth
        }
    };
    let slope = |tangent, around| match tangent {
        Tangent::Flat => 0.0,
        Tangent::Slope(slope) => slope,
        Tangent::Linear => linear(around),
        Tangent::Smooth => smooth,
    };
    Key {
        time: key.time,
        value: key.value,
        slope_in: slope(key.tangents[0], [before, key]),
        slope_out: slope(key.tangents[1], [key, behind]),
    }
}

/// The slope of the line from one key to another; 0 from a key to itself.
fn line(from: &FileKey, to: &FileKey) -> f64 {
    if from.time < to.time {
        (to.value - from.value) / (to.time - from.time)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests;
