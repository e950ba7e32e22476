//! What is wrong with a field of a frame request, told by the option that filled it in.
//! Never lives here: what may be in a field.

use super::args::RenderArgs;
use super::typed::rotation_named;
use crate::cli::values::Weight;
use crate::protocol::rig::RigDescription;
use crate::protocol::{ErrorObject, Fault, FieldFault, FieldPath, Segment};

/// The error with options in place of fields. One that is of no option stays as it is.
pub(super) fn naming_the_option(
    error: anyhow::Error,
    args: &RenderArgs,
    rig: &RigDescription,
) -> anyhow::Error {
    match error.downcast::<Fault>() {
        Ok(fault) => match told(&fault, args, rig) {
            Some(told) => anyhow::Error::msg(told),
            None => ErrorObject::from(fault).into(),
        },
        Err(other) => other,
    }
}

fn told(fault: &Fault, args: &RenderArgs, rig: &RigDescription) -> Option<String> {
    let (option, message) = match fault {
        Fault::InvalidParams(FieldFault { path, message }) => {
            let past_limits = past_limits(path, args, rig);
            (
                option_of(path, args)?,
                past_limits.unwrap_or_else(|| message.clone()),
            )
        }
        Fault::LimitExceeded { limit, .. } => {
            let option = match limit.as_str() {
                "lights" => "--light",
                "side" | "pixels" | "adapter_side" | "adapter_buffer_bytes" => "--size",
                _ => return None,
            };
            (option.to_owned(), fault.to_string())
        }
        _ => return None,
    };
    Some(format!("{option}: {message}"))
}

/// What is given for a name inside of a field of the pose.
fn named_in_pose<'a>(path: &'a FieldPath, field: &str) -> Option<&'a str> {
    match path.segments() {
        [Segment::Name(pose), Segment::Name(of), Segment::Name(name)]
            if pose == "pose" && of == field =>
        {
            Some(name)
        }
        _ => None,
    }
}

/// The option that fills in the field at `path` of a frame request.
fn option_of(path: &FieldPath, args: &RenderArgs) -> Option<String> {
    if let Some(dof) = named_in_pose(path, "dofs") {
        let is_this = |weight: &&Weight| weight.dof() == dof;
        let weight = args.pose.morphs.iter().find(is_this);
        return Some(weight.map_or_else(
            || format!("--set {dof}"),
            |weight| format!("--morph {}", weight.morph),
        ));
    }
    if let Some(joint) = named_in_pose(path, "rotations") {
        return Some(format!("--rotate {joint}"));
    }
    if let [Segment::Name(lights), Segment::Index(index), inner @ ..] = path.segments()
        && lights == "lights"
    {
        let of = match inner {
            [Segment::Name(field)] => format!(", its {field}"),
            _ => String::new(),
        };
        return Some(format!("--light number {}{of}", index + 1));
    }
    let view = &args.camera;
    let from = if view.eye.is_some() {
        "--eye"
    } else {
        "--camera"
    };
    let goes_by_target = view.target.is_some() && view.eye.is_none() && view.camera.is_none();
    let clip = || Some(format!("--clip {}", args.pose.clip.as_deref()?));
    let option = match path.to_string().as_str() {
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
fn past_limits(path: &FieldPath, args: &RenderArgs, rig: &RigDescription) -> Option<String> {
    let dof = named_in_pose(path, "dofs")?;
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
    use serde_json::Value;
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
    fn paths(value: &Value, path: &FieldPath, found: &mut Vec<FieldPath>) {
        match value {
            Value::Object(members) => {
                for (name, inner) in members {
                    paths(inner, &path.clone().field(name.clone()), found);
                }
            }
            Value::Array(items) if *path == "lights".into() => {
                for (index, light) in items.iter().enumerate() {
                    paths(light, &path.clone().index(index), found);
                }
            }
            _ => {}
        }
        found.push(path.clone());
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
            "params",
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
            let request = serde_json::to_value(request).unwrap();
            paths(&request, &FieldPath::default(), &mut found);
            found.push("lights".into());
            for path in found {
                match option_of(&path, &args) {
                    Some(option) => {
                        told.insert(option.split([' ', ',']).next().unwrap().to_owned())
                    }
                    None => {
                        let path = path.to_string();
                        let is_own = own.contains(&path.as_str()) || path.ends_with("kind");
                        assert!(is_own, "{path}");
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
            let path = FieldPath::from(["pose", "dofs"]).field(dof);
            assert_eq!(option_of(&path, &args).as_deref(), Some(option));
        }
    }
}
