//! A rig that the service and the oracle have read from the same texts, and how far apart they are. Never lives here: which rigs and which poses.

use crate::made::Made;
use crate::support::oracle::compare::{Found, Worst, compare};
use crate::support::oracle::{self, Pose, Signs, Skinning};
use crate::support::pictures::{ask_attached, attached_bytes};
use crate::support::random::Random;
use crate::support::{self, ask_ok, real_rigs};
use rigd::engine::Base;
use rigd::pose::{LimitPolicy, PoseEdit, Posed};
use rigd::render::cpu;
use rigd::service::Service;
use serde_json::{Value, json};
use std::sync::{Arc, LazyLock};

pub static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// How many random poses each rig is put into besides its rest pose.
pub const POSES: u64 = 100;

/// As files mean it, and as tests mean it where they do not say.
pub const LINEAR: Skinning = Skinning::Linear;
pub const DUAL: Skinning = Skinning::DualQuaternion(Signs::Heaviest);

/// Share of the largest matrix entry: both sides are f64, and a chain of 300 joints loses no more.
const JOINT: f64 = 1e-12;

pub struct Subject {
    pub name: String,
    pub oracle: oracle::Rig,
}

/// A pose as the wire has it and as the oracle has it.
pub struct Asked {
    what: String,
    wire: Value,
    pose: Pose,
}

impl Subject {
    pub fn load(made: &Made) -> Self {
        let file = |(name, text): &(String, String)| json!({"name": name, "text": text});
        let files: Vec<Value> = made.files.iter().map(file).collect();
        let request = json!({"name": made.name, "files": files});
        ask_ok(&SERVICE, "rig.load", request);
        Self {
            name: made.name.clone(),
            oracle: made.oracle(),
        }
    }

    /// `None` where there are no real rigs here.
    pub fn real(files: &[&str]) -> Option<Self> {
        Some(Self::load(&real(files)?))
    }

    /// In radians, in file order, limits or not.
    pub fn values(&self, what: String, pose: Pose) -> Asked {
        let values = pose.dof_values();
        let wire = if values.is_empty() {
            json!({})
        } else {
            json!({"base": "rest", "dof_values": values, "limits": "ignore"})
        };
        Asked { what, wire, pose }
    }

    pub fn rest(&self) -> Asked {
        self.values("rest".to_owned(), self.oracle.rest())
    }

    /// Rest, then random ones, the same in every run.
    pub fn poses(&self) -> Vec<Asked> {
        // Each rig has its own sequence.
        let mut random = Random(self.name.bytes().map(u64::from).sum());
        let random_pose = |index| {
            let pose = self.oracle.random_pose(&mut random);
            self.values(format!("pose {index}"), pose)
        };
        let rest = std::iter::once(self.rest());
        rest.chain((0..POSES).map(random_pose)).collect()
    }

    /// A clip at times long before its first key and long after its last, limits applied.
    pub fn clip_poses(&self, name: &str) -> Vec<Asked> {
        let clip = self.oracle.clips.iter().find(|clip| clip.name == name);
        let clip = clip.expect("a clip of that name");
        let mut random = Random(name.bytes().map(u64::from).sum());
        let at = |time: f64| Asked {
            what: format!("{name} at {time}"),
            wire: json!({"base": "rest", "clip": {"name": name, "time": time}}),
            pose: self.oracle.sampled(clip, time),
        };
        (0..POSES)
            .map(|_| at(1.5 + random.within(6.5)))
            .chain(std::iter::once(at(0.0)))
            .collect()
    }

    /// As the service answers, in the order of its answer.
    pub fn by_gpu(&self, asked: &Asked, skinning: Skinning) -> Found {
        self.answered(&asked.wire, skinning)
    }

    /// In a pose that is given as the wire has it.
    pub fn answered(&self, pose: &Value, skinning: Skinning) -> Found {
        let request = json!({
            "rig": self.name, "pose": pose, "skinning": word(skinning), "transport": "attach",
        });
        let (result, attached) = ask_attached(&SERVICE, "mesh.vertices", &request);
        let vectors = |attribute: &str| {
            let bytes = attached_bytes(&result["meshes"][0][attribute], &attached);
            let numbers: Vec<f32> = bytes
                .as_chunks::<4>()
                .0
                .iter()
                .map(|word| f32::from_le_bytes(*word))
                .collect();
            numbers.as_chunks::<3>().0.to_vec()
        };
        let pairs = vectors("positions").into_iter().zip(vectors("normals"));
        pairs.map(|(position, normal)| [position, normal]).collect()
    }

    /// As it is on the CPU, in parity with the shader.
    pub fn by_cpu(&self, asked: &Asked, skinning: Skinning) -> Found {
        let found = SERVICE.engine().rig(&self.name).expect("a loaded rig");
        let edit = PoseEdit {
            dofs: asked.pose.dof_values().into_iter().enumerate().collect(),
            limits: LimitPolicy::Ignore,
            ..PoseEdit::default()
        };
        let (posed, _) = found.posed(Base::Rest, &edit).expect("a pose");
        skinned_by_cpu(&posed, skinning)
    }

    pub fn wanted(&self, asked: &Asked, skinning: Skinning) -> oracle::Skinned {
        self.oracle.skin(&asked.pose, skinning)
    }

    /// Panics where either skinner is off at rest or in any random pose, however it blends.
    pub fn check_vertices(&self) {
        self.check_vertices_in(&self.poses());
    }

    pub fn check_vertices_in(&self, poses: &[Asked]) {
        for skinning in [LINEAR, DUAL] {
            let mut worst = [Worst::default(); 2];
            for asked in poses {
                let wanted = self.wanted(asked, skinning);
                let found = [self.by_gpu(asked, skinning), self.by_cpu(asked, skinning)];
                for (which, found) in found.iter().enumerate() {
                    let off = compare(found, &wanted);
                    let skinner = ["GPU", "CPU"][which];
                    assert!(
                        off.is_close(),
                        "{}, {}, {}, {skinner}: {off:?}",
                        self.name,
                        asked.what,
                        word(skinning)
                    );
                    worst[which] = worst[which].and(off);
                }
            }
            let all = self.oracle.positions.len() * poses.len();
            // A comparison that looks at next to nothing proves nothing.
            assert!(
                worst[0].skipped <= all / 100,
                "{}: {worst:?} of {all}",
                self.name
            );
            let [gpu, cpu] = worst;
            println!(
                "{}, {}: GPU {gpu:?}, CPU {cpu:?}",
                self.name,
                word(skinning)
            );
        }
    }

    fn joint_transforms(&self, asked: &Asked) -> Vec<[f64; 16]> {
        let request = json!({"rig": self.name, "pose": asked.wire});
        let result = ask_ok(&SERVICE, "joint.transforms", request);
        let joints = result["joints"].as_array().expect("joints");
        let matrix = |joint: &Value| {
            serde_json::from_value(joint["world_from_joint"].clone()).expect("16 numbers")
        };
        joints.iter().map(matrix).collect()
    }

    /// Panics where a joint is off at rest or in any random pose.
    pub fn check_joints(&self) {
        self.check_joints_in(&self.poses());
    }

    pub fn check_joints_in(&self, poses: &[Asked]) {
        let mut worst = 0.0f64;
        for asked in poses {
            let wanted = self.oracle.world_from_joint(&asked.pose);
            let found = self.joint_transforms(asked);
            assert_eq!(found.len(), wanted.len());
            let entries = wanted.iter().flatten().flatten();
            let size = entries.fold(1.0f64, |a, x| a.max(x.abs()));
            for (joint, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
                for entry in 0..16 {
                    let off = (found[entry] - wanted[entry % 4][entry / 4]).abs() / size;
                    assert!(
                        off <= JOINT,
                        "{}, {}, joint {joint}: {off:e}",
                        self.name,
                        asked.what
                    );
                    worst = worst.max(off);
                }
            }
        }
        println!("{}: joints {worst:e}", self.name);
    }
}

/// Files below the folder of real rigs; `None` where there is none.
pub fn real(files: &[&str]) -> Option<Made> {
    let folder = real_rigs()?;
    let file = |path: &&str| {
        let text = std::fs::read_to_string(folder.join(path));
        let name = path.rsplit('/').next().unwrap_or(path);
        let text = text.unwrap_or_else(|error| panic!("{path}: {error}"));
        (name.to_owned(), text)
    };
    Some(Made {
        name: files.join("+").replace('/', "."),
        files: files.iter().map(file).collect(),
    })
}

/// The one place that knows how the shader is called.
fn skinned_by_cpu(posed: &Posed, skinning: Skinning) -> Found {
    let skinning = match skinning {
        Skinning::Linear => rigd::pose::Skinning::Linear,
        Skinning::DualQuaternion(_) => rigd::pose::Skinning::DualQuaternion,
    };
    let mesh = &posed.rig().meshes()[0];
    let palette = posed.palette(skinning);
    let (positions, normals) = cpu::skin_mesh(mesh, palette, posed.morph_weights());
    let vertices = positions.into_iter().zip(normals);
    vertices
        .map(|(position, normal)| [position, normal])
        .collect()
}

fn word(skinning: Skinning) -> &'static str {
    match skinning {
        Skinning::Linear => "linear",
        Skinning::DualQuaternion(_) => "dual_quaternion",
    }
}
