//! Reads a material library, the `.mtl` of an OBJ. What is wrong in one changes looks alone, so that it is never a fault.
//! Never lives here: opening textures, and which materials are used.
//!
//! ```text
//! mtl      := (newmtl | property | other)*
//! newmtl   := "newmtl" NAME
//! property := ("Kd" | "Ks" | "Ke") r [g b]               diffuse, specular, emissive: sRGB, as other programs show it
//!           | "Ns" exponent | "d" opacity | "Tr" 1 - opacity
//!           | ("map_Kd" | "map_Ke") option* FILE
//! option   := "-s" u [v [w]] | "-o" u [v [w]] | "-clamp" ("on" | "off") | other        scale, offset, no repeating
//! ```

use super::statements::Statements;
use crate::formats::error::quoted;
use crate::formats::text::lexer::{Token, parse_number};
use crate::formats::text::mention::Mention;
use crate::rig::{TextureTransform, Warnings, Wrap, linear_from_srgb};
use glam::{Vec2, Vec3};
use std::collections::HashSet;

/// A material as its file has it. Colors are linear.
#[derive(Debug, Default)]
pub(super) struct Mtl {
    pub name: String,
    pub diffuse: Option<Vec3>,
    pub specular: Option<Vec3>,
    pub shininess: Option<f32>,
    pub emissive: Vec3,
    /// From 0 to 1.
    pub opacity: Option<f32>,
    pub diffuse_map: Option<Map>,
    pub emissive_map: Option<Map>,
}

/// A picture and how it lies.
#[derive(Debug)]
pub(super) struct Map {
    pub file: Mention,
    pub wrap: Wrap,
    pub picture_from_texcoord: TextureTransform,
}

/// What a library has.
#[derive(Debug)]
pub(super) struct Library {
    /// Each name comes once.
    pub materials: Vec<Mtl>,
    /// Files of textures that are not shown.
    pub passed_over: Vec<String>,
}

pub(super) fn read(file: &str, text: &str, warnings: &mut Warnings) -> Library {
    let mut reader = Reader {
        statements: Statements::new(file, text),
        materials: Vec::new(),
        passed_over: Vec::new(),
        names: HashSet::new(),
        is_second: false,
        oddities: [None; 4],
    };
    reader.read_statements();
    reader.warn(warnings);
    Library {
        materials: reader.materials,
        passed_over: reader.passed_over,
    }
}

struct Reader<'a> {
    statements: Statements<'a>,
    materials: Vec<Mtl>,
    passed_over: Vec<String>,
    names: HashSet<String>,
    /// Whether the material that is being read has the name of an earlier one.
    is_second: bool,
    /// The first place of each [`Oddity`].
    oddities: [Option<Token<'a>>; 4],
}

#[derive(Debug, Clone, Copy)]
enum Oddity {
    /// Something of the looks that is not shown.
    NotShown,
    Value,
    Second,
    BeforeNewmtl,
}

impl<'a> Reader<'a> {
    fn read_statements(&mut self) {
        loop {
            let keyword = self.statements.next();
            if keyword.is_end() {
                return;
            }
            let rest = self.statements.rest();
            match keyword.text {
                "newmtl" => self.begin_material(rest.unwrap_or(Token {
                    text: "",
                    ..keyword
                })),
                text if is_read_over(text) => self.pass_over_texture(text, rest),
                text => match self.read_property(text, rest) {
                    Ok(property) => self.add(property, keyword),
                    Err(oddity) => {
                        self.note(oddity, keyword);
                        self.pass_over_texture(text, rest);
                    }
                },
            }
        }
    }

    fn begin_material(&mut self, name: Token<'a>) {
        self.is_second = !self.names.insert(name.text.to_owned());
        if self.is_second {
            self.note(Oddity::Second, name);
        } else {
            self.materials.push(Mtl {
                name: name.text.to_owned(),
                ..Mtl::default()
            });
        }
    }

    fn pass_over_texture(&mut self, keyword: &str, rest: Option<Token<'a>>) {
        let names_a_file = keyword.starts_with("map_")
            || matches!(keyword, "bump" | "disp" | "decal" | "refl" | "norm");
        if let Some(map) = rest
            .filter(|_| names_a_file)
            .and_then(|rest| self.read_map(rest))
        {
            self.passed_over.push(map.file.name);
        }
    }

    fn read_property(
        &mut self,
        keyword: &str,
        rest: Option<Token<'a>>,
    ) -> Result<Property, Oddity> {
        let rest = rest.unwrap_or(Token {
            text: "",
            offset: 0,
        });
        let property = match keyword {
            "Kd" => color(rest.text).map(Property::Diffuse),
            "Ks" => color(rest.text).map(Property::Specular),
            "Ke" => color(rest.text).map(Property::Emissive),
            "Ns" => first_number(rest.text).map(Property::Shininess),
            "d" => first_number(rest.text).map(Property::Opacity),
            "Tr" => first_number(rest.text).map(Property::Transparency),
            "map_Kd" => self.read_map(rest).map(Property::DiffuseMap),
            "map_Ke" => self.read_map(rest).map(Property::EmissiveMap),
            _ => return Err(Oddity::NotShown),
        };
        property.ok_or(Oddity::Value)
    }

    fn add(&mut self, property: Property, keyword: Token<'a>) {
        if self.is_second {
            return;
        }
        let Some(material) = self.materials.last_mut() else {
            self.note(Oddity::BeforeNewmtl, keyword);
            return;
        };
        match property {
            Property::Diffuse(color) => material.diffuse = Some(color),
            Property::Specular(color) => material.specular = Some(color),
            Property::Emissive(color) => material.emissive = color,
            Property::Shininess(exponent) => {
                /// As that of a frame request.
                const MOST: f32 = 10_000.0;
                material.shininess = Some(exponent.clamp(0.0, MOST));
            }
            Property::Opacity(opacity) => material.opacity = Some(opacity.clamp(0.0, 1.0)),
            // Programs disagree about which of the two ends is opaque; of `d` there is no doubt.
            Property::Transparency(transparency) => {
                let opacity = 1.0 - transparency.clamp(0.0, 1.0);
                material.opacity.get_or_insert(opacity);
            }
            Property::DiffuseMap(map) => material.diffuse_map = Some(map),
            Property::EmissiveMap(map) => material.emissive_map = Some(map),
        }
    }

    /// Options, then a name, which may have spaces in it.
    fn read_map(&mut self, rest: Token<'a>) -> Option<Map> {
        let (mut scale, mut offset) = (Vec2::ONE, Vec2::ZERO);
        let mut wrap = Wrap::Repeat;
        let mut left = rest.text;
        loop {
            let (word, after) = first_word(left)?;
            let token = Token {
                text: left,
                offset: rest.offset + rest.text.len() - left.len(),
            };
            if !word.starts_with('-') {
                return Some(Map {
                    file: Mention::new(token, &self.statements.lexer),
                    wrap,
                    picture_from_texcoord: transform(scale, offset),
                });
            }
            left = after;
            match word {
                "-s" => left = numbers(left, scale.as_mut()),
                "-o" => left = numbers(left, offset.as_mut()),
                _ => {
                    let (value, after) = first_word(left)?;
                    match (word, value) {
                        ("-clamp", "on") => wrap = Wrap::Clamp,
                        ("-clamp" | "-blendu" | "-blendv" | "-texres", _) => {}
                        _ => self.note(
                            Oddity::NotShown,
                            Token {
                                text: word,
                                ..token
                            },
                        ),
                    }
                    // Some take several.
                    left = numbers(after, &mut [0.0; 2]);
                }
            }
        }
    }

    fn note(&mut self, oddity: Oddity, token: Token<'a>) {
        self.oddities[oddity as usize].get_or_insert(token);
    }

    fn warn(&self, warnings: &mut Warnings) {
        let mut found = [
            (Oddity::NotShown, "is not shown, nor are others like it"),
            (
                Oddity::Value,
                "has no value that can be read; it is left out, and so are others like it",
            ),
            (
                Oddity::Second,
                "is a second material of that name; it is left out, and so are others like it",
            ),
            (
                Oddity::BeforeNewmtl,
                "stands before any `newmtl`; it is left out, and so are others like it",
            ),
        ]
        .map(|(oddity, what)| (self.oddities[oddity as usize], what));
        found.sort_by_key(|(token, _)| token.map(|token| token.offset));
        for (token, what) in found {
            if let Some(token) = token {
                let lexer = &self.statements.lexer;
                warnings.push(|| format!("{}: {} {what}", lexer.place(token), quoted(token.text)));
            }
        }
    }
}

enum Property {
    Diffuse(Vec3),
    Specular(Vec3),
    Emissive(Vec3),
    Shininess(f32),
    Opacity(f32),
    Transparency(f32),
    DiffuseMap(Map),
    EmissiveMap(Map),
}

/// And what follows it, from its own first word on.
fn first_word(text: &str) -> Option<(&str, &str)> {
    let word = text.split_ascii_whitespace().next()?;
    Some((
        word,
        text.trim_ascii_start()[word.len()..].trim_ascii_start(),
    ))
}

fn number(word: &str) -> Option<f32> {
    let number = parse_number(word)? as f32;
    number.is_finite().then_some(number)
}

/// That of `0.5` and of `-halo 0.5`, which is less opaque in the middle.
fn first_number(text: &str) -> Option<f32> {
    number(
        text.trim_start_matches("-halo")
            .split_ascii_whitespace()
            .next()?,
    )
}

/// Linear. One channel stands for all three.
fn color(text: &str) -> Option<Vec3> {
    let channels: Option<Vec<f32>> = text.split_ascii_whitespace().take(3).map(number).collect();
    let color = match channels?[..] {
        [r, g, b] => [r, g, b],
        [grey] => [grey; 3],
        _ => return None,
    };
    let linear = |channel: f32| linear_from_srgb(channel.clamp(0.0, 1.0).into());
    Some(Vec3::from_array(color.map(linear)))
}

/// Puts as many numbers as `text` starts with into `found`, of up to three, and returns what follows.
fn numbers<'a>(mut text: &'a str, found: &mut [f32; 2]) -> &'a str {
    for place in 0..3 {
        let Some((word, after)) = first_word(text) else {
            break;
        };
        let Some(number) = number(word) else { break };
        if let Some(slot) = found.get_mut(place) {
            *slot = number;
        }
        text = after;
    }
    text
}

/// `v` runs up in texture coordinates, and down in what a texture's transform is of.
fn transform(scale: Vec2, offset: Vec2) -> TextureTransform {
    TextureTransform {
        columns: [Vec2::new(scale.x, 0.0), Vec2::new(0.0, scale.y)],
        offset: Vec2::new(offset.x, 1.0 - scale.y - offset.y),
    }
}

/// What is given otherwise here, or says nothing that can be shown: ambient light is the request's, and there
/// is neither refraction nor a choice of lighting models.
fn is_read_over(keyword: &str) -> bool {
    matches!(
        keyword,
        "Ka" | "map_Ka" | "Ni" | "illum" | "sharpness" | "map_aat"
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mtl(text: &str) -> (Vec<Mtl>, Vec<String>) {
        let mut warnings = Warnings::default();
        let library = read("a.mtl", text, &mut warnings);
        (library.materials, warnings.into_sentences())
    }

    #[test]
    fn looks_are_those_of_the_material_above() {
        let text = "# by hand\nnewmtl two words #1\n Kd 1 0 .5\n\tKs 0.5\nNs 90\nNi 1.5\nillum 2\nKa 1 1 1\n\
            Tr 0.25\nmap_Kd -s 2 4 1 -o .5 0 -clamp on C:\\my files\\a 1.png\n\
            newmtl glass\nTr 1\nd -halo 0.5\nKe 0 1 0\nmap_Ke glow.png\nnewmtl bare";
        let (materials, warnings) = mtl(text);
        assert_eq!(warnings, [""; 0]);
        let [one, glass, bare] = materials.as_slice() else {
            panic!("{materials:?}");
        };
        assert_eq!(
            (one.name.as_str(), bare.name.as_str()),
            ("two words", "bare")
        );
        let half = 0.214_041_14;
        assert_eq!(one.diffuse, Some(Vec3::new(1.0, 0.0, half)));
        assert_eq!(one.specular, Some(Vec3::splat(half)));
        assert_eq!((one.shininess, one.opacity), (Some(90.0), Some(0.75)));
        let map = one.diffuse_map.as_ref().expect("it has one");
        assert_eq!(map.file.name, "C:\\my files\\a 1.png");
        assert_eq!(
            (map.file.place.as_str(), map.wrap),
            ("a.mtl:10:35", Wrap::Clamp)
        );
        // The picture's lower left corner, at 0 0, is its (0, 1) from above.
        let TextureTransform { columns, offset } = map.picture_from_texcoord;
        let placed = |u: f32, v: f32| columns[0] * u + columns[1] * (1.0 - v) + offset;
        assert_eq!(placed(0.0, 0.0), Vec2::new(0.5, 1.0));
        assert_eq!(placed(0.25, 0.25), Vec2::new(1.0, 0.0));
        assert_eq!(glass.opacity, Some(0.5));
        assert_eq!(glass.emissive, Vec3::Y);
        assert!(glass.emissive_map.is_some() && bare.diffuse.is_none());
    }

    #[test]
    fn what_is_odd_is_left_out_with_one_warning_of_its_kind() {
        let not_shown = "a.mtl:2:1: `map_Bump` is not shown, nor are others like it";
        for (text, wanted) in [
            ("map_Bump a.png\nPr 0.5\nnorm b.png\n", vec![not_shown]),
            (
                "Kd spectral a.rfl\nNs\nd nan\nmap_Kd\nmap_Kd -s 1 1\n",
                vec![
                    "a.mtl:2:1: `Kd` has no value that can be read; it is left out, and so are others like it",
                ],
            ),
            (
                "newmtl a\nKd 1 1 1\n",
                vec![
                    "a.mtl:2:8: `a` is a second material of that name; it is left out, and so are others like it",
                ],
            ),
            (
                "map_Kd -mm 0 1 a.png\n",
                vec!["a.mtl:2:8: `-mm` is not shown, nor are others like it"],
            ),
        ] {
            let (materials, warnings) = mtl(&format!("newmtl a\n{text}"));
            assert_eq!(warnings, wanted, "{text}");
            assert_eq!((materials.len(), materials[0].diffuse), (1, None), "{text}");
        }
        let (materials, warnings) = mtl("Kd 1 1 1\nnewmtl a\n");
        assert_eq!(materials.len(), 1);
        let wanted =
            "a.mtl:1:1: `Kd` stands before any `newmtl`; it is left out, and so are others like it";
        assert_eq!(warnings, [wanted]);
    }
}
