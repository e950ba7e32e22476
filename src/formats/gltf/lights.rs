//! Lights of the scene (KHR_lights_punctual), which a picture is lit by where its request asks for them. A light that is not as it should be
//! is left out with a warning: no file is refused for it. Never lives here: where nodes stand.

use super::extensions::{LIGHTS, light_of};
use super::fault::Faults;
use super::json_fault::problem;
use super::nodes::{NodeTransform, Nodes};
use crate::limits::Limits;
use crate::rig::{FileLight, FileLightKind, LARGEST_COORDINATE, Warnings};
use glam::Vec3;
use gltf_json::Root;
use serde::Deserialize;
use serde_json::Value;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4};

/// In the order of the nodes that carry them, as many as a picture may have.
pub(super) fn read(
    faults: Faults<'_>,
    root: &Root,
    nodes: &Nodes,
    limits: &Limits,
    warnings: &mut Warnings,
) -> Vec<FileLight> {
    let in_scene = root.nodes.iter().enumerate();
    let in_scene = in_scene.filter(|(index, _)| nodes.is_in_scene[*index]);
    let carried: Vec<_> = in_scene
        .filter_map(|(index, node)| Some((index, light_of(node)?)))
        .collect();
    if carried.is_empty() {
        return Vec::new();
    }
    let listed = root.extensions.as_ref();
    let listed = listed.and_then(|it| it.others.get(LIGHTS)?.get("lights")?.as_array());
    let listed = listed.into_iter().flatten().enumerate();
    let described: Vec<_> = listed
        .map(|(index, light)| described(faults, index, light, warnings))
        .collect();
    if described
        .iter()
        .flatten()
        .any(|light| light.range.is_some())
    {
        warnings.push(|| faults.warning("ranges of lights are passed over: they reach everywhere"));
    }
    let mut lights = Vec::new();
    for (index, light) in carried {
        let path = format!("nodes[{index}].extensions.{LIGHTS}.light");
        let placed = named(light, &described).and_then(|light| match light {
            Some(light) => Ok(Some((light, carrier(nodes, index)?))),
            None => Ok(None),
        });
        match placed {
            Ok(Some((light, carrier))) => {
                let name = light.name.as_ref().or(root.nodes[index].name.as_ref());
                let name = faults.name(name.map(String::as_str), &path, warnings);
                lights.push(light.carried_by(carrier, name));
            }
            // A warning has said why it was left out.
            Ok(None) => {}
            Err(why) => warnings.push(|| faults.warning(&format!("{path} is left out: {why}"))),
        }
    }
    let most = usize::try_from(limits.lights).unwrap_or(usize::MAX);
    if lights.len() > most {
        let sentence = format!("of {} lights the first {most} are kept", lights.len());
        warnings.push(|| faults.warning(&sentence));
        lights.truncate(most);
    }
    lights
}

/// The light that a node names; `None` is one that was left out.
fn named<'a>(
    light: &Value,
    described: &'a [Option<LightInFile>],
) -> Result<Option<&'a LightInFile>, String> {
    let index = light.get("light").and_then(Value::as_u64);
    let found = index.and_then(|index| described.get(usize::try_from(index).ok()?));
    let count = described.len();
    let found = found.ok_or_else(|| format!("it is not one of the {count} lights"))?;
    Ok(found.as_ref())
}

fn carrier(nodes: &Nodes, index: usize) -> Result<NodeTransform, String> {
    let is_usable = |transform: &NodeTransform| {
        let numbers = transform.joint_from_node.to_cols_array();
        let mut numbers = numbers.iter();
        numbers.all(|number| number.abs() <= LARGEST_COORDINATE)
    };
    let transform = nodes.transform(index).filter(is_usable);
    transform.ok_or_else(|| format!("its node stands beyond ±{LARGEST_COORDINATE:e}"))
}

/// A light as the file describes it.
#[derive(Deserialize)]
struct LightInFile {
    name: Option<String>,
    #[serde(rename = "type")]
    kind: LightType,
    #[serde(default = "white")]
    color: [f32; 3],
    #[serde(default = "one")]
    intensity: f64,
    range: Option<f64>,
    #[serde(default)]
    spot: Cone,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum LightType {
    Directional,
    Point,
    Spot,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase", default)]
struct Cone {
    inner_cone_angle: f64,
    outer_cone_angle: f64,
}

impl Default for Cone {
    fn default() -> Self {
        Self {
            inner_cone_angle: 0.0,
            outer_cone_angle: FRAC_PI_4,
        }
    }
}

fn white() -> [f32; 3] {
    [1.0; 3]
}

fn one() -> f64 {
    1.0
}

impl LightInFile {
    fn carried_by(&self, node: NodeTransform, name: String) -> FileLight {
        FileLight {
            name,
            joint: node.joint,
            joint_from_light: node.joint_from_node,
            kind: self.kind(),
            color: Vec3::from_array(self.color),
            intensity: self.intensity,
        }
    }

    fn kind(&self) -> FileLightKind {
        match self.kind {
            LightType::Directional => FileLightKind::Directional,
            LightType::Point => FileLightKind::Point,
            LightType::Spot => FileLightKind::Spot {
                inner: self.spot.inner_cone_angle,
                outer: self.spot.outer_cone_angle,
            },
        }
    }

    /// Holds its numbers to what they may be, where that is near what the file has; and says which.
    fn hold(&mut self) -> Vec<&'static str> {
        let mut held = Vec::new();
        let mut set = |number: &mut f64, to: f64, what| {
            if *number != to {
                *number = to;
                held.push(what);
            }
        };
        let Cone {
            inner_cone_angle: inner,
            outer_cone_angle: outer,
        } = &mut self.spot;
        // Of float32, π/2 is above π/2.
        set(outer, outer.min(FRAC_PI_2), "outer angle is held to π/2");
        let most = outer.next_down();
        let within = inner.clamp(0.0, most);
        set(
            inner,
            within,
            "inner angle is held between 0 and the outer one",
        );
        let color = self.color.map(|channel| channel.clamp(0.0, 1.0));
        if std::mem::replace(&mut self.color, color) != color {
            held.push("color is held to numbers from 0 to 1");
        }
        held
    }

    /// What is wrong with it.
    fn problem(&self) -> Option<&'static str> {
        if !(0.0..=FileLight::MOST_INTENSITY).contains(&self.intensity) {
            Some("its intensity is no number from 0 to 1e12")
        } else if self.spot.outer_cone_angle <= 0.0 {
            Some("its cone has an outer angle that is not above 0")
        } else {
            None
        }
    }
}

fn described(
    faults: Faults<'_>,
    index: usize,
    light: &Value,
    warnings: &mut Warnings,
) -> Option<LightInFile> {
    let path = format!("extensions.{LIGHTS}.lights[{index}]");
    let read = LightInFile::deserialize(light).map_err(|error| problem(&error));
    let checked = read.and_then(|light| match light.problem() {
        Some(problem) => Err(problem.to_owned()),
        None => Ok(light),
    });
    match checked {
        Ok(mut light) => {
            for held in light.hold() {
                warnings.push(|| faults.warning(&format!("{path}: its {held}")));
            }
            Some(light)
        }
        Err(problem) => {
            warnings.push(|| faults.warning(&format!("{path} is left out: {problem}")));
            None
        }
    }
}
