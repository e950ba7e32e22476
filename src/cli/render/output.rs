//! The files of a sequence, each of which takes its name when it is whole. Never lives here: how frames are drawn or packed.

use crate::encode::{AnimatedGif, AnimatedPng, Compression, FrameRate};
use crate::frame::Frame;
use crate::protocol::frame::ImageFormat;
use crate::scene::Size;
use anyhow::{Context, bail};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};

/// What the ending of the output's name asks for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Gif,
    Apng,
}

impl Format {
    pub fn of(path: &Path) -> anyhow::Result<Self> {
        let ending = path.extension().unwrap_or_default().to_ascii_lowercase();
        match ending.to_str() {
            Some("png") => Ok(Self::Png),
            Some("gif") => Ok(Self::Gif),
            Some("apng") => Ok(Self::Apng),
            _ => bail!(
                "expected an output that ends in .png, .gif or .apng, but found `{}`",
                path.display()
            ),
        }
    }

    /// What to ask a frame as.
    pub fn image(self) -> ImageFormat {
        match self {
            Self::Png => ImageFormat::Png,
            Self::Gif | Self::Apng => ImageFormat::Rgba8,
        }
    }
}

/// How a sequence is to be written.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    pub path: PathBuf,
    pub format: Format,
    pub rate: FrameRate,
    pub compression: Compression,
    /// How many frames there will be; `None` for a single picture.
    pub frames: Option<u32>,
}

/// Takes one frame after another.
pub(super) struct Reel {
    terms: Terms,
    /// The one file of an animation, from its first frame on.
    animation: Option<(Animation, Unfinished)>,
    size: Size,
    taken: u32,
    bytes: u64,
}

enum Animation {
    Gif(AnimatedGif<BufWriter<File>>),
    Apng(AnimatedPng<BufWriter<File>>),
}

impl Reel {
    pub fn new(terms: Terms, size: Size) -> Self {
        Self {
            terms,
            size,
            animation: None,
            taken: 0,
            bytes: 0,
        }
    }

    /// `picture` is as [`Format::image`] has it.
    pub fn push(&mut self, picture: Vec<u8>) -> anyhow::Result<()> {
        let path = match self.terms.format {
            Format::Png => self.terms.name(self.taken),
            Format::Gif | Format::Apng => self.terms.path.clone(),
        };
        let written = match self.terms.format {
            Format::Png => whole(&path, &picture).map(|()| self.bytes += picture.len() as u64),
            Format::Gif | Format::Apng => {
                let (size, pixels) = (self.size, picture);
                self.animate(&Frame {
                    size,
                    pixels: pixels.into(),
                })
            }
        };
        self.taken += 1;
        written.with_context(|| format!("cannot write {}", path.display()))
    }

    fn animate(&mut self, frame: &Frame) -> anyhow::Result<()> {
        let (animation, _) = match &mut self.animation {
            Some(begun) => begun,
            none => none.insert(self.terms.begin(frame.size)?),
        };
        match animation {
            Animation::Gif(gif) => gif.push(frame)?,
            Animation::Apng(apng) => apng.push(frame)?,
        }
        Ok(())
    }

    /// Gives the files their names, and says what was written.
    pub fn finish(mut self) -> anyhow::Result<String> {
        let path = self.terms.path.display().to_string();
        if let Some((animation, unfinished)) = self.animation.take() {
            let context = || format!("cannot write {path}");
            match animation {
                Animation::Gif(gif) => gif.finish(),
                Animation::Apng(apng) => apng.finish(),
            }
            .with_context(context)?;
            unfinished.name().with_context(context)?;
            self.bytes = fs::metadata(&self.terms.path).map_or(0, |file| file.len());
        }
        let rate = self.terms.rate.per_second();
        let size = format!("{}x{}", self.size.width, self.size.height);
        Ok(match (self.terms.frames, self.terms.format) {
            (None, _) => format!("{path} ({size}, {} bytes)", self.bytes),
            (Some(frames), Format::Png) => {
                let (first, last) = (self.terms.name(0), self.terms.name(frames - 1));
                format!(
                    "{} to {} ({frames} frames of {size}, {} bytes)",
                    first.display(),
                    last.display(),
                    self.bytes
                )
            }
            (Some(frames), _) => format!(
                "{path} ({frames} frames of {size} at {rate} a second, {} bytes)",
                self.bytes
            ),
        })
    }
}

impl Terms {
    /// The file of one frame: numbered from 0 with four digits, or as many as the last one needs.
    fn name(&self, frame: u32) -> PathBuf {
        let Some(frames) = self.frames else {
            return self.path.clone();
        };
        let digits = frames.saturating_sub(1).to_string().len().max(4);
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let ending = self.path.extension().unwrap_or_default().to_string_lossy();
        let name = format!("{stem}_{frame:0digits$}.{ending}");
        self.path.with_file_name(name)
    }

    fn begin(&self, size: Size) -> anyhow::Result<(Animation, Unfinished)> {
        let (unfinished, file) = Unfinished::create(&self.path)?;
        let (file, rate, compression) = (BufWriter::new(file), self.rate, self.compression);
        let animation = match self.format {
            Format::Apng => {
                let frames = self.frames.unwrap_or(1);
                Animation::Apng(AnimatedPng::new(file, size, frames, rate, compression)?)
            }
            _ => Animation::Gif(AnimatedGif::new(file, size, rate, compression)?),
        };
        Ok((animation, unfinished))
    }
}

fn whole(path: &Path, content: &[u8]) -> anyhow::Result<()> {
    let (unfinished, mut file) = Unfinished::create(path)?;
    file.write_all(content)?;
    Ok(unfinished.name()?)
}

/// A file beside the one that it is to become. Dropped before it got its name, it is removed.
struct Unfinished {
    /// `None` for what is no file but e.g. a pipe, which is written to as it is.
    part: Option<PathBuf>,
    target: PathBuf,
}

impl Unfinished {
    fn create(path: &Path) -> std::io::Result<(Self, File)> {
        // A link is not replaced, but what it leads to.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        if fs::metadata(&target).is_ok_and(|found| !found.is_file()) {
            let file = File::options().write(true).open(&target)?;
            return Ok((Self { part: None, target }, file));
        }
        // Not made of the file's own name, which may be as long as names can be.
        let part = target.with_file_name(format!(".rigd-{}.part", std::process::id()));
        let file = File::create(&part)?;
        let part = Some(part);
        Ok((Self { part, target }, file))
    }

    fn name(mut self) -> std::io::Result<()> {
        if let Some(part) = &self.part {
            fs::rename(part, &self.target)?;
        }
        self.part = None;
        Ok(())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if let Some(part) = &self.part {
            // Whoever stopped has said why; that this is left over is the lesser trouble.
            let _ = fs::remove_file(part);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: Size = Size {
        width: 3,
        height: 2,
    };

    fn folder(name: &str) -> PathBuf {
        let folder = std::env::temp_dir().join(format!("rigd-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        folder
    }

    fn terms(path: PathBuf, frames: Option<u32>) -> Terms {
        Terms {
            format: Format::of(&path).unwrap(),
            path,
            rate: FrameRate::new(24.0).unwrap(),
            compression: Compression::Fast,
            frames,
        }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect()
    }

    #[test]
    fn frames_are_numbered_with_four_digits_or_as_many_as_it_takes() {
        for (frames, frame, name) in [
            (None, 0, "out/walk.one.png"),
            (Some(1), 0, "out/walk.one_0000.png"),
            (Some(10_000), 9_999, "out/walk.one_9999.png"),
            (Some(10_001), 7, "out/walk.one_00007.png"),
        ] {
            let terms = terms("out/walk.one.png".into(), frames);
            assert_eq!(terms.name(frame), Path::new(name), "{frames:?}");
        }
    }

    #[test]
    fn a_file_that_is_not_finished_leaves_no_trace_and_what_was_there_stays() {
        let folder = folder("unfinished");
        for name in ["walk.gif", "walk.apng"] {
            let path = folder.join(name);
            fs::write(&path, "old").unwrap();
            let mut reel = Reel::new(terms(path.clone(), Some(3)), SIZE);
            reel.push(vec![9; 24]).unwrap();
            assert_eq!(names(&folder).len(), 2, "the file and its part");
            drop(reel);
            assert_eq!(fs::read(&path).unwrap(), b"old");
            assert_eq!(names(&folder), [name]);
            fs::remove_file(&path).unwrap();
        }
        // One frame of the three that its header promises.
        let mut reel = Reel::new(terms(folder.join("walk.apng"), Some(3)), SIZE);
        reel.push(vec![9; 24]).unwrap();
        assert!(reel.finish().is_err());
        assert!(names(&folder).is_empty());
        fs::remove_dir(&folder).unwrap();
    }

    #[test]
    fn a_finished_file_takes_the_place_of_the_old_one() {
        let folder = folder("finished");
        let path = folder.join("walk.gif");
        fs::write(&path, "old").unwrap();
        let mut reel = Reel::new(terms(path.clone(), Some(2)), SIZE);
        reel.push(vec![9; 24]).unwrap();
        reel.push(vec![200; 24]).unwrap();
        assert!(reel.finish().unwrap().contains("2 frames of 3x2 at 24"));
        assert!(fs::read(&path).unwrap().starts_with(b"GIF89a"));
        assert_eq!(names(&folder), ["walk.gif"]);
        fs::remove_dir_all(&folder).unwrap();
    }
}
