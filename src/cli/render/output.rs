//! The files of a sequence. Never lives here: how frames are drawn or packed.

use super::format::Format;
use super::shots::Motion;
use crate::cli::files::{self, Destination, Unfinished, numbered};
use crate::encode::{self, AnimatedGif, AnimatedPng, Compression, FrameRate};
use crate::frame::{ImageKind, Raster};
use crate::protocol::Fault;
use crate::scene::Size;
use anyhow::Context;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

/// How a sequence is to be written.
#[derive(Debug, Clone)]
pub(super) struct Terms {
    pub output: Destination,
    pub format: Format,
    pub rate: FrameRate,
    pub compression: Compression,
    pub motion: Motion,
    /// How many there will be.
    pub frames: u32,
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
    pub(super) fn new(terms: Terms, size: Size) -> Self {
        Self {
            terms,
            size,
            animation: None,
            taken: 0,
            bytes: 0,
        }
    }

    /// What is to be made of a frame, on any thread, before it is pushed: a PNG file, or bare pixels for an animation.
    pub(super) fn packing(&self) -> impl FnOnce(Raster) -> Result<Vec<u8>, Fault> + Send + use<> {
        let (format, compression) = (self.terms.format, self.terms.compression);
        move |frame| match format {
            Format::Png => encode::png(&frame, compression).map_err(|error| Fault::Internal {
                message: error.to_string(),
            }),
            Format::Gif | Format::Apng => Ok(frame.bytes.into_inner()),
        }
    }

    /// `picture` is as [`Reel::packing`] makes it.
    pub(super) fn push(&mut self, picture: Vec<u8>) -> anyhow::Result<()> {
        let (number, size) = (self.taken, self.size);
        self.taken += 1;
        match (&self.terms.output, self.terms.format) {
            (Destination::StandardOutput, _) => files::write_to_stdout(&picture),
            (Destination::File(path), Format::Png) => {
                self.bytes += picture.len() as u64;
                files::write(&self.terms.name(path, number), &picture)
            }
            (Destination::File(path), Format::Gif | Format::Apng) => {
                let context = format!("cannot write {}", path.display());
                let raster = Raster {
                    kind: ImageKind::Color,
                    size,
                    bytes: picture.into(),
                };
                let begun = &mut self.animation;
                self.terms.animate(path, begun, &raster).context(context)
            }
        }
    }

    /// Gives the files their names, and says what was written, where that is not on standard output.
    pub(super) fn finish(mut self) -> anyhow::Result<Option<String>> {
        let Destination::File(output) = &self.terms.output else {
            return Ok(None);
        };
        let path = output.display();
        if let Some((animation, unfinished)) = self.animation.take() {
            let context = || format!("cannot write {path}");
            match animation {
                Animation::Gif(gif) => gif.finish(),
                Animation::Apng(apng) => apng.finish(),
            }
            .with_context(context)?;
            unfinished.name().with_context(context)?;
            self.bytes = fs::metadata(output).map_or(0, |file| file.len());
        }
        let rate = self.terms.rate.per_second();
        let size = format!("{}x{}", self.size.width, self.size.height);
        let bytes = self.bytes;
        let Terms { motion, frames, .. } = self.terms;
        let name = |frame| self.terms.name(output, frame);
        Ok(Some(match (self.terms.format, motion, frames) {
            (Format::Png, Motion::Still, _) => format!("{path} ({size}, {bytes} bytes)"),
            (_, _, 1) => {
                let path = name(0);
                let path = path.display();
                let why = match motion {
                    Motion::Still => "; --turntable, or --clip without --time, draws more",
                    Motion::Turntable(_) => "",
                    Motion::Clip => &format!("; the clip has room for no more at --fps {rate}"),
                };
                format!("{path} (a single frame of {size}, {bytes} bytes{why})")
            }
            (Format::Png, ..) => {
                let (first, last) = (name(0), name(frames - 1));
                let (first, last) = (first.display(), last.display());
                format!("{first} to {last} ({frames} frames of {size}, {bytes} bytes)")
            }
            (Format::Gif | Format::Apng, ..) => {
                format!("{path} ({frames} frames of {size} at {rate} a second, {bytes} bytes)")
            }
        }))
    }
}

impl Terms {
    /// The file of one frame.
    fn name(&self, path: &Path, frame: u32) -> PathBuf {
        match (self.format, self.motion) {
            (Format::Png, Motion::Turntable(_) | Motion::Clip) => {
                numbered(path, frame as usize, self.frames as usize)
            }
            _ => path.to_owned(),
        }
    }

    fn animate(
        &self,
        path: &Path,
        begun: &mut Option<(Animation, Unfinished)>,
        frame: &Raster,
    ) -> anyhow::Result<()> {
        let (animation, _) = match begun {
            Some(begun) => begun,
            none => none.insert(self.begin(path, frame.size)?),
        };
        match animation {
            Animation::Gif(gif) => gif.push(frame)?,
            Animation::Apng(apng) => apng.push(frame)?,
        }
        Ok(())
    }

    fn begin(&self, path: &Path, size: Size) -> anyhow::Result<(Animation, Unfinished)> {
        let (unfinished, file) = Unfinished::create(path)?;
        let (file, rate, compression) = (BufWriter::new(file), self.rate, self.compression);
        let animation = match self.format {
            Format::Apng => Animation::Apng(AnimatedPng::new(
                file,
                size,
                self.frames,
                rate,
                compression,
            )?),
            _ => Animation::Gif(AnimatedGif::new(file, size, rate, compression)?),
        };
        Ok((animation, unfinished))
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

    fn terms(path: &Path, frames: u32) -> Terms {
        let output = Destination::of(path).unwrap();
        Terms {
            format: Format::of(&output).unwrap(),
            output,
            rate: FrameRate::new(24.0).unwrap(),
            compression: Compression::Fast,
            motion: Motion::Turntable(frames),
            frames,
        }
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        names.collect()
    }

    #[test]
    fn a_file_that_is_not_finished_leaves_no_trace_and_what_was_there_stays() {
        let folder = folder("unfinished");
        for name in ["walk.gif", "walk.apng"] {
            let path = folder.join(name);
            fs::write(&path, "old").unwrap();
            let mut reel = Reel::new(terms(&path, 3), SIZE);
            reel.push(vec![9; 24]).unwrap();
            assert_eq!(names(&folder).len(), 2, "the file and its part");
            drop(reel);
            assert_eq!(fs::read(&path).unwrap(), b"old");
            assert_eq!(names(&folder), [name]);
            fs::remove_file(&path).unwrap();
        }
        // One frame of the three that its header promises.
        let mut reel = Reel::new(terms(&folder.join("walk.apng"), 3), SIZE);
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
        let mut reel = Reel::new(terms(&path, 2), SIZE);
        reel.push(vec![9; 24]).unwrap();
        reel.push(vec![200; 24]).unwrap();
        let said = reel.finish().unwrap().unwrap();
        assert!(said.contains("2 frames of 3x2 at 24"), "{said}");
        assert!(fs::read(&path).unwrap().starts_with(b"GIF89a"));
        assert_eq!(names(&folder), ["walk.gif"]);
        fs::remove_dir_all(&folder).unwrap();
    }
}
