//! What is wrong with a field of the request, told by the option that filled it in.
//! Never lives here: what may be in a field.

use super::args::RenderArgs;
use super::typed::rotation_named;
use crate::cli::values::Weight;
use crate::protocol::rig::RigDescription;
use crate::protocol::{ErrorKind, ErrorObject};
use serde_json::Value;

/// The error with options in place of fields. One that is of no option stays as it is.
pub(super) fn told_by_option(
    error: anyhow::Error,
    args: &RenderArgs,
    rig: &RigDescription,
) -> anyhow::Error {
    let refused = error.chain().find_map(|cause| cause.downcast_ref());
    let told = refused.and_then(|refused| told(refused, args, rig));
    told.map_or(error, anyhow::Error::msg)
}

fn told(refused: &ErrorObject, args: &RenderArgs, rig: &RigDescription) -> Option<String> {
    let detail = |name| refused.detail(name).and_then(Value::as_str);
    let (option, message) = match refused.kind()? {
        ErrorKind::InvalidParams => {
            let path = detail("path")?;
            let message = refused.message.strip_prefix(path)?.strip_prefix(": ")?;
            let past_limits = past_limits(path, args, rig);
            let message = past_limits.unwrap_or_else(|| message.to_owned());
            (option_of(path, args)?, message)
        }
        ErrorKind::LimitExceeded => {
            let option = match detail("limit")? {
                "lights" => "--light",
                "side" | "pixels" | "adapter_side" | "adapter_buffer_bytes" => "--size",
                _ => return None,
            };
            (option.to_owned(), refused.message.clone())
        }
        _ => return None,
    };
    Some(format!("{option}: {message}"))
}

/// The option that fills in the field at `path` of a frame request.
fn option_of(path: &str, args: &RenderArgs) -> Option<String> {
    if let Some(dof) = path.strip_prefix("pose.dofs.") {
        let is_this = |weight: &&Weight| weight.dof() == dof;
        let weight = args.pose.morphs.iter().find(is_this);
        return Some(weight.map_or_else(
            || format!("--set {dof}"),
            |weight| format!("--morph {}", weight.morph),
        ));
    }
    if let Some(joint) = path.strip_prefix("pose.rotations.") {
        return Some(format!("--rotate {joint}"));
    }
    if let Some((index, field)) = path
        .strip_prefix("lights[")
        .and_then(|rest| rest.split_once(']'))
    {
        let number = index.parse::<usize>().ok()? + 1;
        let field = field.trim_start_matches('.');
        let of = if field.is_empty() { "" } else { ", its " };
        return Some(format!("--light number {number}{of}{field}"));
    }
    let view = &args.camera;
    let from = if view.eye.is_some() {
        "--eye"
    } else {
        "--camera"
    };
    let goes_by_target = view.target.is_some() && view.eye.is_none() && view.camera.is_none();
    let clip = || Some(format!("--clip {}", args.pose.clip.as_deref()?));
    let option = match path {
        "pose.clip" | "pose.clip.name" => return clip(),
        "camera" if goes_by_target => "--target, and the eye that goes by it",
        "camera" if view.target.is_some() => return Some(format!("{from}, --target")),
        "camera.distance" => return Some(format!("{from}, its distance")),
        "camera.near" => return Some(format!("{from}, its near plane")),
        "size" => "--size",
        "samples" => "--samples",
        "compression" => "--compression",
        "skinning" => "--skinning",
        "cull" => "--cull",
        "background" => "--background",
        "ambient" => "--ambient",
        "lights" => "--light",
        "material.diffuse" => "--diffuse",
        "material.specular" => "--specular",
        "material.shininess" => "--shininess",
        "material.variant" => "--variant",
        "show.skin" => "--skin",
        "show.skin_opacity" => "--skin-opacity",
        "show.skeleton" => "--skeleton",
        "show.normals" => "--flat",
        "camera.target" => "--target",
        "camera.fov_y" => "--fov",
        "camera.height" => "--ortho",
        "camera" | "camera.kind" | "camera.eye" | "camera.up" | "camera.azimuth"
        | "camera.inclination" => from,
        "pose.clip.time" => "--time",
        "pose.limits" => "--limits",
        "pose" => "the pose of --set, --rotate, --morph and --clip",
        "pose.rotations" => "--rotate",
        _ => return None,
    };
    Some(option.to_owned())
}

/// In the unit that was typed, where it was an angle past its limits.
fn past_limits(path: &str, args: &RenderArgs, rig: &RigDescription) -> Option<String> {
    let dof = path.strip_prefix("pose.dofs.")?;
    let mut assignments = args.pose.assignments.iter().rev();
    let typed = assignments.find(|assignment| assignment.dof == dof)?.value;
    let limits = rotation_named(rig, dof)?;
    let any = || "any".to_owned();
    let (found, min, max) = (
        typed.unit.show(typed.radians),
        limits
            .min
            .map_or_else(any, |min| typed.unit.show_least(min)),
        limits.max.map_or_else(any, |max| typed.unit.show_most(max)),
    );
    Some(format!(
        "expected an angle from {min} to {max}, its limits, but found {found}"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::{Cli, Command};
    use crate::protocol::frame::FrameParams;
    use crate::scene::Bounds;
    use clap::Parser;
    use std::collections::BTreeSet;

    fn parsed(arguments: &[&str]) -> (Box<RenderArgs>, FrameParams) {
        let arguments = [&["rigd", "render", "-o", "a.png"], arguments].concat();
        let Some(Command::Render(args)) = Cli::try_parse_from(arguments).unwrap().command else {
            panic!("it is `render`")
        };
        let mut request = args.request("a").unwrap();
        let view = args.camera.view(&Bounds::ORIGIN).unwrap();
        request.camera = view.camera(&Bounds::ORIGIN);
        request.pose.clip = args
            .pose
            .clip
            .clone()
            .map(|name| crate::protocol::pose::ClipAt { name, time: 0.0 });
        (args, request)
    }

    /// The paths of everything in a request that a fault can be in.
    fn paths(value: &Value, path: &str, found: &mut Vec<String>) {
        match value {
            Value::Object(members) => {
                for (name, inner) in members {
                    let dot = if path.is_empty() { "" } else { "." };
                    paths(inner, &format!("{path}{dot}{name}"), found);
                }
            }
            Value::Array(items) if path == "lights" => {
                for (index, light) in items.iter().enumerate() {
                    paths(light, &format!("{path}[{index}]"), found);
                }
            }
            _ => {}
        }
        found.push(path.to_owned());
    }

    #[test]
    fn every_field_that_an_option_fills_in_is_told_by_that_option() {
        let common = [
            "--size=8",
            "--samples=1",
            "--compression=best",
            "--clip=walk",
            "--time=1",
            "--rotate=a=0,0,0,1",
            "--set=a.rx=1",
            "--morph=smile=1",
            "--limits=reject",
            "--skinning=linear",
            "--target=0,0,0",
            "--skin=none",
            "--skeleton=boxes",
            "--skin-opacity=1",
            "--cull=never",
            "--flat",
            "--diffuse=1,1,1",
            "--specular=1,1,1",
            "--shininess=1",
            "--variant=red",
            "--background=1,1,1",
            "--light=dir:0,1,0",
            "--ambient=1,1,1",
        ];
        // Chosen by rigd itself.
        let own = [
            "",
            "rig",
            "image",
            "transport",
            "outputs",
            "material",
            "show",
            "camera.up",
            "pose.dofs",
        ];
        let mut told = BTreeSet::new();
        for camera in [
            ["--camera=1,1,1", "--fov=1"],
            ["--eye=1,1,1", "--fov=1"],
            ["--eye=1,1,1", "--ortho=1"],
            ["--camera=1,1", "--ortho=1"],
        ] {
            let arguments = [&common[..], &camera].concat();
            let (args, request) = parsed(&arguments);
            let mut found = Vec::new();
            paths(&serde_json::to_value(request).unwrap(), "", &mut found);
            found.push("lights".to_owned());
            for path in found {
                match option_of(&path, &args) {
                    Some(option) => {
                        told.insert(option.split([' ', ',']).next().unwrap().to_owned())
                    }
                    None => {
                        assert!(
                            own.contains(&path.as_str()) || path.ends_with("kind"),
                            "{path}"
                        );
                        continue;
                    }
                };
            }
            let options = arguments
                .iter()
                .map(|argument| argument.split('=').next().unwrap());
            for option in options {
                assert!(
                    told.contains(option),
                    "{option} is told by none of {told:?}"
                );
            }
        }
    }

    #[test]
    fn weights_are_told_as_they_were_typed() {
        let (args, _) = parsed(&[
            "--morph",
            "smile=1",
            "--set",
            "morph.blink=1",
            "--morph",
            "morph.frown=2",
        ]);
        for (dof, option) in [
            ("morph.smile", "--morph smile"),
            ("morph.blink", "--set morph.blink"),
            ("morph.frown", "--morph morph.frown"),
        ] {
            let path = format!("pose.dofs.{dof}");
            assert_eq!(option_of(&path, &args).as_deref(), Some(option));
        }
    }
}
