//! What a message says of a name that is none of the known ones: what may have been meant, or else a few of those there are.
//! Never lives here: looking names up.

use crate::protocol::shortened;
use crate::rig::{DofKind, MORPH_PREFIX, Rig};
use crate::spelling::nearest;

/// As many as are read at a glance.
pub(super) const LISTED: usize = 8;

/// About a part of a rig, of which `known` are all.
pub(super) fn unknown<'a>(
    noun: &str,
    name: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> String {
    near_or_listed(noun, nearest(name, known.clone()), known)
}

fn near_or_listed<'a>(
    noun: &str,
    near: Option<&str>,
    known: impl Iterator<Item = &'a str> + Clone,
) -> String {
    if let Some(near) = near.map(quoted) {
        return format!("the rig has no such {noun}; did you mean {near}?");
    }
    let some = listed(known.clone().take(LISTED));
    if some.is_empty() {
        return format!("the rig has no such {noun}; it has none");
    }
    let more = match known.count().saturating_sub(LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("the rig has no such {noun}; it has {some}{more}")
}

pub(super) fn unknown_joint(name: &str, rig: &Rig) -> String {
    let joints = rig.skeleton().joints();
    let dof = rig.dofs().named(name).map(|dof| rig.dofs().all()[dof].kind);
    if let Some(joint) = dof.and_then(DofKind::joint) {
        let (dof, joint) = (quoted(name), quoted(&joints[joint].name));
        return format!("{dof} is a DOF; its joint is {joint}");
    }
    unknown(
        "joint",
        name,
        joints.iter().map(|joint| joint.name.as_str()),
    )
}

/// One that names a joint, alone or with an axis that it does not turn about, gets that joint's own.
pub(super) fn unknown_dof(name: &str, rig: &Rig) -> String {
    let (skeleton, dofs) = (rig.skeleton(), rig.dofs().all());
    let of_joint = |joint: usize| {
        let its = dofs.iter().filter(|dof| dof.kind.joint() == Some(joint));
        listed(its.map(|dof| dof.name.as_str()))
    };
    if let Some(joint) = skeleton.joint_named(name) {
        let joint_name = quoted(name);
        return format!("{joint_name} is a joint; its DOFs are {}", of_joint(joint));
    }
    let names = dofs.iter().map(|dof| dof.name.as_str());
    let same = names.clone().find(|dof| dof.eq_ignore_ascii_case(name));
    if same.is_some() {
        return near_or_listed("DOF", same, names);
    }
    let joint = match name.rsplit_once('.') {
        Some((joint, _)) => skeleton.joint_named(joint),
        None => {
            let joints = skeleton.joints().iter().map(|joint| joint.name.as_str());
            nearest(name, joints).and_then(|near| skeleton.joint_named(near))
        }
    };
    if let Some(joint) = joint {
        let joint_name = quoted(&skeleton.joints()[joint].name);
        let its = of_joint(joint);
        return format!("the rig has no such DOF; joint {joint_name} has {its}");
    }
    match name.strip_prefix(MORPH_PREFIX) {
        Some(morph) => unknown_morph(morph, rig),
        None => unknown("DOF", name, names),
    }
}

fn unknown_morph(name: &str, rig: &Rig) -> String {
    let dofs = rig.dofs().all().iter();
    // That of a joint may start like theirs.
    let morphs = dofs.filter(|dof| matches!(dof.kind, DofKind::Morph { .. }));
    // What all of them start with would make any two look alike.
    let known = morphs.filter_map(|dof| dof.name.strip_prefix(MORPH_PREFIX));
    unknown("morph target", name, known)
}

fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let quoted: Vec<String> = names.map(quoted).collect();
    quoted.join(", ")
}

fn quoted(name: &str) -> String {
    format!("`{}`", shortened(name))
}
