//! `rig.*`: files in, summaries and descriptions out.
//! Never lives here: the formats of those files.

use super::attach::{Attach, Base64};
use super::strict::field_error;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// Loads a rig from its files.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LoadParams {
    /// What to call the rig from here on. Without it, the stem of the first file's name.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// All files of the rig, in any order but for the name that the first one may give it. Files that these refer to are found below the
    /// server's root, beside the file that names them, or inline by their name.
    pub files: Vec<RigFile>,
    /// Whether this rig may take the place of another one of the same name. The same rig may always be loaded again.
    #[serde(default)]
    pub replace: bool,
}

/// One file: a path below the server's root, or the file itself under a name of its own.
#[derive(Debug, Clone, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
#[schemars(deny_unknown_fields)]
pub enum RigFile {
    /// A path below the server's root, with `/` between its parts.
    Path(String),
    /// A file of text.
    Text {
        /// Base name; its extension is a hint at the format.
        name: String,
        /// The whole content.
        text: String,
    },
    /// A file of any bytes.
    Base64 {
        /// Base name; its extension is a hint at the format.
        name: String,
        /// The whole content, in base64.
        base64: Base64,
    },
    /// A file among the raw bytes that follow the request.
    Attached {
        /// Base name; its extension is a hint at the format.
        name: String,
        /// Where its content lies.
        attach: Attach,
    },
}

impl<'de> Deserialize<'de> for RigFile {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FileVisitor)
    }
}

struct FileVisitor;

impl<'de> Visitor<'de> for FileVisitor {
    type Value = RigFile;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a path or an object with a `name` and one of `text`, `base64`, `attach`")
    }

    fn visit_str<E: Error>(self, path: &str) -> Result<RigFile, E> {
        Ok(RigFile::Path(path.to_owned()))
    }

    fn visit_map<A: MapAccess<'de>>(self, members: A) -> Result<RigFile, A::Error> {
        let FileFields {
            name,
            text,
            base64,
            attach,
        } = FileFields::deserialize(MapAccessDeserializer::new(members))?;
        match (text, base64, attach) {
            (Some(text), None, None) => Ok(RigFile::Text { name, text }),
            (None, Some(base64), None) => Ok(RigFile::Base64 { name, base64 }),
            (None, None, Some(attach)) => Ok(RigFile::Attached { name, attach }),
            (None, None, None) => Err(A::Error::missing_field("text")),
            (Some(_), _, _) => Err(only_one("text")),
            _ => Err(only_one("base64")),
        }
    }
}

fn only_one<E: Error>(field: &str) -> E {
    field_error(
        field,
        "expected only one of `text`, `base64`, `attach`, but found several",
    )
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct FileFields {
    name: String,
    text: Option<String>,
    base64: Option<Base64>,
    attach: Option<Attach>,
}

/// Names a rig.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RigParams {
    /// Name or digest of a loaded rig.
    pub rig: String,
}

/// The loaded rigs.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RigList {
    /// Sorted by name.
    pub rigs: Vec<RigSummary>,
}

/// A loaded rig in a few numbers.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct RigSummary {
    /// What the rig was loaded as. Requests name it by this or by its digest.
    pub name: String,
    /// `sha256:` and 64 hexadecimal digits: the same on every server that has the same files. Of a rig that is one file which its content
    /// alone tells the format of (glTF, most files of CSE 169), the SHA-256 of that file, whatever its name; else over names and contents.
    pub digest: String,
    /// The readers that were used, e.g. `cse169 skel`; each once, in the order of `formats` in `server.info`.
    pub dialects: Vec<String>,
    /// Joints of the skeleton, also those that move nothing.
    pub joint_count: u64,
    /// Numbers that make up a pose: the length of `dof_values`.
    pub dof_count: u64,
    /// Vertices of all meshes, as the files count them; 0 for a rig that has no skin.
    pub vertex_count: u64,
    /// Triangles of all meshes; polygons of a file are cut into triangles.
    pub triangle_count: u64,
    /// Morph targets, each with a degree of freedom of its own.
    pub morph_count: u64,
    /// Animations that a pose can take.
    pub clip_count: u64,
    /// What was odd in the files but could be worked with, a sentence each.
    pub warnings: Vec<String>,
}

/// Everything about a rig but its vertices and triangles.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RigDescription {
    /// On the wire its fields stand beside the others.
    #[serde(flatten)]
    pub summary: RigSummary,
    /// In file order, which puts parents before their children.
    pub joints: Vec<JointDescription>,
    /// In the order that `dof_values` of a pose goes by.
    pub dofs: Vec<DofDescription>,
    /// In the order of `mesh.vertices` and `mesh.topology`.
    pub meshes: Vec<MeshDescription>,
    /// What meshes and their parts name as `material`.
    pub materials: Vec<MaterialDescription>,
    /// What `variant` of a material can name.
    pub variants: Vec<String>,
    /// What `lights` of a frame request means by `file`.
    pub lights: Vec<LightDescription>,
    /// In load order; each is moved by the degree of freedom `morph.<name>`.
    pub morphs: Vec<MorphDescription>,
    /// What `clip` of a pose can name.
    pub clips: Vec<ClipDescription>,
    /// Of the rig at rest: where it says that they are of `vertices`, those that are skinned, else the joints.
    pub bounds: RigBounds,
    /// Of the origins of all joints at rest, also of those that move nothing; null where there are none.
    pub joint_bounds: Option<Bounds>,
}

/// One joint, as the file has it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct JointDescription {
    /// Unique in the rig: `joint_<index>` where the file gives none, the second of two `knee` is `knee#2`.
    pub name: String,
    /// Null for the root.
    pub parent: Option<String>,
    /// From the parent's origin to this joint's, in the parent's space.
    pub offset: [f64; 3],
    /// The order in which the angles `rx`, `ry`, `rz` of this joint turn it.
    pub rotation_order: RotationOrder,
    /// Smallest and largest corner of the joint's own box, in its own space; null where the format knows of none.
    pub bounding_box: Option<Bounds>,
}

/// How the three Euler angles of a joint are multiplied, acting on column vectors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum RotationOrder {
    /// Rz·Ry·Rx: the turn about x comes first.
    Zyx,
    /// Rx·Ry·Rz: the turn about z comes first.
    Xyz,
}

/// One number that a pose sets.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DofDescription {
    /// The joint's name and one of `tx ty tz rx ry rz sx sy sz`, e.g. `elbow.rx`; or `morph.` and a morph target's name.
    pub name: String,
    /// Which unit its values have.
    pub kind: DofKind,
    /// Null for one that belongs to no joint.
    pub joint: Option<String>,
    /// Null without limit.
    pub min: Option<f64>,
    /// Null without limit.
    pub max: Option<f64>,
    /// The file's own value.
    pub rest: f64,
    /// In the stored pose.
    pub value: f64,
}

/// What a degree of freedom moves, and so its unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum DofKind {
    /// Displacement from rest along an axis of the parent, in the rig's units.
    Translation,
    /// Local Euler angle about an axis, in radians.
    Rotation,
    /// Local scale along an axis of the joint's own: 1 leaves it as it is.
    Scale,
    /// Weight of a morph target: 0 leaves the mesh as modelled, 1 is the target itself.
    Morph,
}

/// One mesh.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MeshDescription {
    /// Unique in the rig; `mesh_<index>` where the file gives none.
    pub name: String,
    /// Vertices, as the file counts them.
    pub vertex_count: u64,
    /// Triangles of all its parts.
    pub triangle_count: u64,
    /// That of the first part; null where the file names none.
    pub material: Option<String>,
    /// Its triangles by what they are made of, one part after another.
    pub parts: Vec<MeshPart>,
    /// Whether `mesh.topology` has `texcoords` or `corner_texcoords` for it.
    pub has_texcoords: bool,
}

/// Triangles of a mesh that are made of one material.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MeshPart {
    /// Triangles of this part, which follow those of the parts before it.
    pub triangle_count: u64,
    /// Null where the file names none.
    pub material: Option<String>,
}

/// A named surface.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct MaterialDescription {
    /// Unique in the rig; what meshes and parts refer to it by.
    pub name: String,
    /// The base name of the picture's file; null without one.
    pub texture: Option<String>,
    /// Linear RGB and opacity; null where the file gives none.
    pub color: Option<[f64; 4]>,
    /// What becomes of the opacity of color and texture.
    pub opacity: Opacity,
    /// Whether it is seen from the front alone.
    pub single_sided: bool,
    /// Whether light leaves it as it is.
    pub unlit: bool,
}

/// A light of the file. In its own space it shines along −Z, from the origin.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LightDescription {
    /// Unique in the rig; `light_<index>` where the file gives none.
    pub name: String,
    /// Where its light comes from, and so the unit of `intensity`.
    pub kind: LightKind,
    /// What it moves with; null for one that stands still.
    pub joint: Option<String>,
    /// Column-major; without a joint it leads to world space.
    pub joint_from_light: [f64; 16],
    /// Linear RGB from 0 to 1.
    pub color: [f64; 3],
    /// In candela; of a directional light in lux.
    pub intensity: f64,
    /// Of a spot light: radians from its direction up to which it shines in full, and up to which at all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cone: Option<[f64; 2]>,
}

/// What shape the light of a file has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LightKind {
    /// From so far away that it is the same everywhere.
    Directional,
    /// From one point.
    Point,
    /// From one point into a cone.
    Spot,
}

/// What becomes of the opacity of a material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Opacity {
    /// It counts for nothing.
    Opaque,
    /// Nothing is there where it is low, all is opaque elsewhere.
    Mask,
    /// It lets through what is behind.
    Blend,
}

/// A morph target.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct MorphDescription {
    /// Unique in the rig; `morph_<index>` where the file gives none.
    pub name: String,
    /// The mesh that it moves.
    pub mesh: String,
    /// Vertices that it moves.
    pub vertex_count: u64,
}

/// An animation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ClipDescription {
    /// Unique in the rig; `clip_<index>` where the file gives none.
    pub name: String,
    /// From when to when it is meant to be played, in seconds. A pose may take it at any time.
    pub range: [f64; 2],
    /// Degrees of freedom that it sets.
    pub channel_count: u64,
}

/// A box along the axes of its space, in the rig's units, and what is in it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RigBounds {
    /// Whether the box holds the skinned vertices or the joints.
    pub of: BoundsOf,
    /// In world space. On the wire its fields stand beside `of`.
    #[serde(flatten)]
    pub bounds: Bounds,
}

/// What a rig is measured by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum BoundsOf {
    /// The skinned vertices of all meshes.
    Vertices,
    /// Of a rig that has no vertices.
    Joints,
}

/// A box along the axes of its space, in the rig's units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Bounds {
    /// Smallest corner.
    pub min: [f64; 3],
    /// Largest corner.
    pub max: [f64; 3],
}
