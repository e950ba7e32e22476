//! Numbers as they were typed, held against what they are of: angles against lengths and weights, radians against degrees.
//! Never lives here: what the protocol can tell by itself.

use super::args::RenderArgs;
use crate::cli::angle::Unit;
use crate::cli::numbers::decimal;
use crate::cli::terminal::Warnings;
use crate::cli::values::{Assignment, Weight};
use crate::protocol::pose::Clamped;
use crate::protocol::rig::{DofDescription, DofKind, RigDescription};
use anyhow::bail;
use std::collections::BTreeSet;

impl RenderArgs {
    /// Doubts about angles without a unit, and what is typed in vain.
    ///
    /// # Errors
    /// Where an angle was typed for what is none, or a weight for what moves a joint.
    pub(super) fn check_numbers(
        &self,
        rig: &RigDescription,
        warnings: &mut Warnings,
    ) -> anyhow::Result<()> {
        for Assignment { dof, value } in &self.pose.assignments {
            let kind = dof_named(rig, dof).map(|dof| dof.kind);
            let of = match kind {
                Some(DofKind::Rotation) => {
                    if let Some(doubt) = value.doubt() {
                        warnings.tell(&format!("--set {dof}: {doubt}"));
                    }
                    continue;
                }
                Some(DofKind::Translation) => "a length in the rig's units",
                Some(DofKind::Scale) => "a scale",
                Some(DofKind::Morph) => "a weight",
                // The request will be told that there is none.
                None => continue,
            };
            if value.unit != Unit::None {
                let found = value.unit.show(value.radians);
                bail!("--set {dof}: expected {of}, but found the angle {found}");
            }
        }
        for weight in &self.pose.morphs {
            let (Weight { morph, weight }, dof) = (weight, weight.dof());
            if dof_named(rig, &dof).is_some_and(|found| found.kind != DofKind::Morph) {
                bail!(
                    "--morph {morph}: expected a morph target, but {dof} is a DOF of a joint; for that type --set {dof}={weight}"
                );
            }
        }
        let dofs = self.pose.assignments.iter().map(|set| set.dof.clone());
        let weights = self.pose.morphs.iter().map(Weight::dof);
        warn_of_repeats("--set", dofs.clone(), warnings);
        warn_of_repeats("--morph", weights.clone(), warnings);
        for dof in dofs.filter(|dof| weights.clone().any(|weight| weight == *dof)) {
            warnings.tell(&format!("--set {dof}: --morph gives it too, and holds"));
        }
        let joints = self.pose.rotations.iter().map(|turn| turn.joint.clone());
        warn_of_repeats("--rotate", joints, warnings);
        let view = self.camera.camera;
        let angles = view.map(|view| [view.azimuth, view.inclination]);
        for doubt in angles.iter().flatten().filter_map(|angle| angle.doubt()) {
            warnings.tell(&format!("--camera: {doubt}"));
        }
        Ok(())
    }
}

/// Of several values for one name the last one holds.
fn warn_of_repeats(option: &str, names: impl Iterator<Item = String>, warnings: &mut Warnings) {
    let mut seen = BTreeSet::new();
    for name in names {
        if let Some(name) = seen.replace(name) {
            warnings.tell(&format!(
                "{option} is given more than once for {name}; the last one holds"
            ));
        }
    }
}

/// Values that their limits changed, each degree of freedom told once, however many frames it is of.
pub(super) struct Clamps<'a> {
    args: &'a RenderArgs,
    rig: &'a RigDescription,
    told: BTreeSet<String>,
}

impl<'a> Clamps<'a> {
    pub(super) fn new(args: &'a RenderArgs, rig: &'a RigDescription) -> Self {
        let told = BTreeSet::new();
        Self { args, rig, told }
    }

    pub(super) fn tell(&mut self, found: &[Clamped], warnings: &mut Warnings) {
        for Clamped { dof, asked, used } in found {
            if self.told.insert(dof.clone()) {
                let (asked, used) = (self.show(dof, *asked), self.show(dof, *used));
                warnings.tell(&format!("{dof} of {asked} is past its limit; used {used}"));
            }
        }
    }

    /// An angle in the unit that was typed, in degrees where none was.
    fn show(&self, dof: &str, value: f64) -> String {
        if rotation_named(self.rig, dof).is_none() {
            return decimal(value);
        }
        let mut assignments = self.args.pose.assignments.iter().rev();
        let typed = assignments.find(|assignment| assignment.dof == dof);
        let unit = typed.map_or(Unit::Degrees, |typed| typed.value.unit);
        unit.show(value)
    }
}

/// The degree of freedom of that name, where it is an angle.
pub(super) fn rotation_named<'a>(rig: &'a RigDescription, dof: &str) -> Option<&'a DofDescription> {
    dof_named(rig, dof).filter(|dof| dof.kind == DofKind::Rotation)
}

fn dof_named<'a>(rig: &'a RigDescription, name: &str) -> Option<&'a DofDescription> {
    rig.dofs.iter().find(|dof| dof.name == name)
}
