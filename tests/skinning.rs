//! Are joints and vertices where the definition puts them? Both skinners are measured against an oracle in f64 that reads the files itself.

mod support;

use glam::DVec3;
use rigd::engine::Base;
use rigd::pose::{LimitPolicy, PoseEdit};
use rigd::render::cpu;
use rigd::service::Service;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;
use std::sync::{Arc, LazyLock};
use support::oracle::{self, Found, Pose, Random, Worst, compare};
use support::pictures::{ask_attached, attached_bytes};
use support::{ask_ok, real_rigs};

static SERVICE: LazyLock<Arc<Service>> = LazyLock::new(support::service);

/// How many random poses each rig is put into besides its rest pose.
const POSES: u64 = 100;

/// A rig that the service and the oracle have read from the same text.
struct Subject {
    name: String,
    oracle: oracle::Rig,
}

impl Subject {
    fn load(name: &str, skel: Option<&str>, skin: Option<&str>) -> Self {
        let file =
            |ending: &str, text: &str| json!({"name": format!("{name}.{ending}"), "text": text});
        let mut files: Vec<Value> = skel.map(|text| file("skel", text)).into_iter().collect();
        files.extend(skin.map(|text| file("skin", text)));
        ask_ok(&SERVICE, "rig.load", json!({"name": name, "files": files}));
        Self {
            name: name.to_owned(),
            oracle: oracle::Rig::read(skel, skin),
        }
    }

    /// `None` where there are no real rigs here.
    fn real(skel: Option<&str>, skin: Option<&str>) -> Option<Self> {
        let folder = real_rigs()?.join("cse169");
        let [skel_text, skin_text] = [skel, skin].map(|file| file.map(|file| read(&folder, file)));
        let name = [skel, skin]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join("+");
        Some(Self::load(
            &name,
            skel_text.as_deref(),
            skin_text.as_deref(),
        ))
    }

    fn request(&self, pose: &Pose) -> Value {
        let wire = json!({"base": "rest", "dof_values": pose.dof_values(), "limits": "ignore"});
        let pose = if self.oracle.joints.is_empty() {
            json!({})
        } else {
            wire
        };
        json!({"rig": self.name, "pose": pose})
    }

    /// As the service answers, in the order of its answer.
    fn by_gpu(&self, pose: &Pose) -> Found {
        let mut request = self.request(pose);
        request["transport"] = json!("attach");
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

    /// As the twin of the shader has it.
    fn by_cpu(&self, pose: &Pose) -> Found {
        let found = SERVICE.engine().rig(&self.name).expect("a loaded rig");
        let values = if self.oracle.joints.is_empty() {
            Vec::new()
        } else {
            pose.dof_values()
        };
        let edit = PoseEdit {
            dofs: values.into_iter().enumerate().collect(),
            limits: LimitPolicy::Ignore,
            ..PoseEdit::default()
        };
        let (posed, _) = found.posed(Base::Rest, &edit).expect("a pose");
        let vertices = cpu::skin_mesh(&posed.rig().meshes()[0], posed.palette());
        vertices
            .map(|vertex| [vertex.position.to_array(), vertex.normal.to_array()])
            .collect()
    }

    /// Rest, then random ones, the same in every run.
    fn poses(&self) -> impl Iterator<Item = Pose> {
        // Each rig has its own sequence.
        let mut random = Random(self.name.bytes().map(u64::from).sum());
        let rest = std::iter::once(self.oracle.rest());
        rest.chain((0..POSES).map(move |_| self.oracle.random_pose(&mut random)))
    }

    /// Panics where either skinner is off in any pose.
    fn check_vertices(&self) {
        let mut worst = [Worst::default(); 2];
        for (index, pose) in self.poses().enumerate() {
            let wanted = self.oracle.skin(&pose);
            for (which, found) in [self.by_gpu(&pose), self.by_cpu(&pose)].iter().enumerate() {
                let off = compare(found, &wanted);
                let skinner = ["GPU", "CPU"][which];
                assert!(
                    off.is_close(),
                    "{}, pose {index}, {skinner}: {off:?}",
                    self.name
                );
                worst[which] = worst[which].and(off);
            }
        }
        let all = self.oracle.positions.len() as u64 * (POSES + 1);
        // A comparison that looks at next to nothing proves nothing.
        assert!(
            worst[0].skipped as u64 <= all / 100,
            "{}: {worst:?} of {all}",
            self.name
        );
        println!("{}: GPU {:?}, CPU {:?}", self.name, worst[0], worst[1]);
    }

    fn joint_transforms(&self, pose: &Pose) -> Vec<[f64; 16]> {
        let result = ask_ok(&SERVICE, "joint.transforms", self.request(pose));
        let joints = result["joints"].as_array().expect("joints");
        let matrix = |joint: &Value| {
            serde_json::from_value(joint["world_from_joint"].clone()).expect("16 numbers")
        };
        joints.iter().map(matrix).collect()
    }

    /// Panics where a joint is off in any pose. Gives the largest error.
    fn check_joints(&self) -> f64 {
        let mut worst = 0.0f64;
        for (index, pose) in self.poses().enumerate() {
            let wanted = self.oracle.world_from_joint(&pose);
            let found = self.joint_transforms(&pose);
            assert_eq!(found.len(), wanted.len());
            let size = wanted
                .iter()
                .flatten()
                .flatten()
                .fold(1.0f64, |a, x| a.max(x.abs()));
            for (joint, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
                for entry in 0..16 {
                    let off = (found[entry] - wanted[entry % 4][entry / 4]).abs() / size;
                    assert!(
                        off <= JOINT,
                        "{}, pose {index}, joint {joint}: {off:e}",
                        self.name
                    );
                    worst = worst.max(off);
                }
            }
        }
        println!("{}: joints {worst:e}", self.name);
        worst
    }
}

/// Share of the largest matrix entry: both sides are f64, and a chain of 300 joints loses no more.
const JOINT: f64 = 1e-12;

fn read(folder: &Path, file: &str) -> String {
    std::fs::read_to_string(folder.join(file)).unwrap_or_else(|error| panic!("{file}: {error}"))
}

fn figure() -> Subject {
    let (skel, skin) = (
        include_str!("../assets/figure.skel"),
        include_str!("../assets/figure.skin"),
    );
    Subject::load("figure again", Some(skel), Some(skin))
}

/// A skeleton given as a tree of nested joints.
fn skel(parents: &[(Option<usize>, [f64; 3])]) -> String {
    fn joint(parents: &[(Option<usize>, [f64; 3])], index: usize, text: &mut String) {
        let [x, y, z] = parents[index].1;
        let _ = writeln!(text, "balljoint j{index} {{ offset {x} {y} {z}");
        for (child, _) in parents
            .iter()
            .enumerate()
            .filter(|(_, it)| it.0 == Some(index))
        {
            joint(parents, child, text);
        }
        text.push_str("}\n");
    }
    let mut text = String::new();
    joint(parents, 0, &mut text);
    text
}

struct SkinText {
    positions: Vec<[f64; 3]>,
    normals: Vec<[f64; 3]>,
    weights: Vec<Vec<(usize, f64)>>,
    /// Columns a, b, c and d.
    bindings: Vec<[[f64; 3]; 4]>,
}

impl SkinText {
    /// Random vertices within a unit, each following the joints that `weights` gives it.
    fn random(
        count: usize,
        bindings: Vec<[[f64; 3]; 4]>,
        weights: impl FnMut(usize) -> Vec<(usize, f64)>,
    ) -> Self {
        let mut random = Random(count as u64);
        let mut vectors = |most| -> Vec<[f64; 3]> {
            (0..count)
                .map(|_| [0; 3].map(|_| random.within(most)))
                .collect()
        };
        Self {
            positions: vectors(1.0),
            normals: vectors(2.0),
            weights: (0..count).map(weights).collect(),
            bindings,
        }
    }

    fn text(&self) -> String {
        let rows = |rows: &[[f64; 3]]| {
            let row = |[x, y, z]: &[f64; 3]| format!("{x:?} {y:?} {z:?}\n");
            rows.iter().map(row).collect::<String>()
        };
        let count = self.positions.len();
        let weights = self.weights.iter().map(|of_vertex| {
            let list = of_vertex
                .iter()
                .map(|(joint, weight)| format!(" {joint} {weight:?}"));
            format!("{}{}\n", of_vertex.len(), list.collect::<String>())
        });
        let bindings = self
            .bindings
            .iter()
            .map(|columns| format!("matrix {{\n{}}}\n", rows(columns)));
        format!(
            "positions {count} {{\n{}}}\nnormals {count} {{\n{}}}\nskinweights {count} {{\n{}}}\n\
             triangles 1 {{ 0 1 2 }}\nbindings {} {{\n{}}}\n",
            rows(&self.positions),
            rows(&self.normals),
            weights.collect::<String>(),
            self.bindings.len(),
            bindings.collect::<String>(),
        )
    }
}

/// Where joints stand that nobody has turned.
fn unturned(at: [f64; 3]) -> [[f64; 3]; 4] {
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], at]
}

/// Two joints, bound turned about an axis off every coordinate axis, so that columns read as rows turn the other way.
fn bound_turned() -> (String, SkinText) {
    let columns = |x: f64, z: f64| {
        let matrix = glam::DMat3::from_rotation_z(z) * glam::DMat3::from_rotation_x(x);
        let [a, b, c] =
            [matrix.x_axis, matrix.y_axis, matrix.z_axis].map(|column| column.to_array());
        [a, b, c, [0.3, -0.2, x]]
    };
    let skel = skel(&[(None, [0.0, 0.5, 0.0]), (Some(0), [0.1, 1.0, 0.2])]);
    let weights = |vertex| vec![(0, 0.1 + vertex as f64), (1, 1.0)];
    (
        skel,
        SkinText::random(50, vec![columns(0.7, 0.4), columns(-0.2, 1.9)], weights),
    )
}

/// Two joints, bound while they were stretched.
fn bound_stretched() -> (String, SkinText) {
    let stretched = |[x, y, z]: [f64; 3], at| [[x, 0.0, 0.0], [0.0, y, 0.0], [0.0, 0.0, z], at];
    let bindings = vec![
        stretched([3.0, 0.5, 1.0], [0.0; 3]),
        stretched([0.4, 0.9, 2.5], [0.0, 1.0, 0.0]),
    ];
    let skel = skel(&[(None, [0.0; 3]), (Some(0), [0.0, 1.0, 0.0])]);
    let weights = |vertex| vec![(0, 1.0), (1, vertex as f64 / 10.0)];
    (skel, SkinText::random(50, bindings, weights))
}

#[test]
fn vertices_of_real_rigs_are_where_the_definition_puts_them() {
    for (skel, skin) in [
        (Some("tube.skel"), "tube.skin"),
        (Some("tube.skel"), "tube_smooth.skin"),
        (Some("wasp.skel"), "wasp.skin"),
        (Some("wasp_walk/wasp.skel"), "wasp_walk/wasp.skin"),
        (Some("head/head.skel"), "head/head_tex.skin"),
        (None, "triangle.skin"),
        (None, "tube.skin"),
        (None, "wasp.skin"),
        (None, "head/head_tex.skin"),
    ] {
        let Some(subject) = Subject::real(skel, Some(skin)) else {
            return;
        };
        subject.check_vertices();
    }
}

#[test]
fn joints_of_real_rigs_are_where_the_definition_puts_them() {
    for skel in [
        "test.skel",
        "tube.skel",
        "wasp.skel",
        "wasp_walk/wasp.skel",
        "head/head.skel",
        "horse.skel",
        "tree.skel",
        "chain.skel",
    ] {
        let Some(subject) = Subject::real(Some(skel), None) else {
            return;
        };
        subject.check_joints();
    }
}

#[test]
fn the_built_in_figure_is_where_the_definition_puts_it() {
    let figure = figure();
    figure.check_joints();
    figure.check_vertices();
}

#[test]
fn bindings_are_read_by_column() {
    // A quarter turn about z: (1, 0, 0) in the world was (0, -1, 0) in the joint, and still is in the joint that stands unturned.
    let quarter = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let one = SkinText::random(3, vec![quarter], |_| vec![(0, 1.0)]);
    let one = SkinText {
        positions: vec![[1.0, 0.0, 0.0]; 3],
        normals: vec![[0.0, 1.0, 0.0]; 3],
        ..one
    };
    let subject = Subject::load(
        "quarter turn",
        Some(&skel(&[(None, [0.0; 3])])),
        Some(&one.text()),
    );
    let wanted = [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0]];
    for found in [
        subject.by_gpu(&subject.oracle.rest()),
        subject.by_cpu(&subject.oracle.rest()),
    ] {
        assert_eq!(found, [wanted; 3]);
    }

    let (skel, skin) = bound_turned();
    Subject::load("bound turned", Some(&skel), Some(&skin.text())).check_vertices();
}

#[test]
fn normals_stay_perpendicular_to_what_was_stretched() {
    // Halving x turns the plane with normal (1, 1, 0) into one with normal (2, 1, 0).
    let double = [[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0; 3]];
    let one = SkinText::random(3, vec![double], |_| vec![(0, 1.0)]);
    let one = SkinText {
        normals: vec![[1.0, 1.0, 0.0]; 3],
        ..one
    };
    let subject = Subject::load(
        "doubled",
        Some(&skel(&[(None, [0.0; 3])])),
        Some(&one.text()),
    );
    let wanted = DVec3::new(2.0, 1.0, 0.0) / 5f64.sqrt();
    for found in [
        subject.by_gpu(&subject.oracle.rest()),
        subject.by_cpu(&subject.oracle.rest()),
    ] {
        let normal = DVec3::from_array(found[0][1].map(f64::from));
        assert!(normal.distance(wanted) < Worst::LENGTH, "{normal}");
    }

    let (skel, skin) = bound_stretched();
    Subject::load("bound stretched", Some(&skel), Some(&skin.text())).check_vertices();
}

#[test]
fn a_vertex_may_follow_forty_joints() {
    let mut random = Random(40);
    let joints: Vec<_> = (0..40).map(|index| (index > 0).then_some(0)).collect();
    let joints: Vec<_> = joints
        .into_iter()
        .map(|parent| (parent, [0; 3].map(|_| random.within(1.0))))
        .collect();
    let bindings = joints.iter().map(|(_, at)| unturned(*at)).collect();
    // Off from a sum of 1, and each vertex by other weights.
    let mut weight = || 1.1 + random.within(1.0);
    let skin = SkinText::random(20, bindings, |_| {
        (0..40).map(|joint| (joint, weight())).collect()
    });
    Subject::load("forty", Some(&skel(&joints)), Some(&skin.text())).check_vertices();
}

#[test]
fn a_chain_may_have_three_hundred_joints() {
    let joints: Vec<_> = (0..300)
        .map(|index: usize| (index.checked_sub(1), [0.0, 0.1, 0.0]))
        .collect();
    let bindings = (1..=300)
        .map(|index| unturned([0.0, 0.1 * f64::from(index), 0.0]))
        .collect();
    let skin = SkinText::random(300, bindings, |vertex| {
        vec![(vertex, 0.75), (299 - vertex, 0.25)]
    });
    let subject = Subject::load("three hundred", Some(&skel(&joints)), Some(&skin.text()));
    subject.check_joints();
    subject.check_vertices();
}

/// Half a step of the last decimal of the numbers below, and what float32 adds.
const PRINTED: f64 = 1.1e-5 / 2.0;

fn assert_printed(what: &str, found: &Value, wanted: [f64; 3]) {
    let found: [f64; 3] = serde_json::from_value(found.clone()).expect("three numbers");
    let off = DVec3::from_array(found).distance(DVec3::from_array(wanted));
    assert!(
        off < PRINTED * 3f64.sqrt(),
        "{what}: {found:?}, wanted {wanted:?}"
    );
}

#[test]
fn joints_at_rest_agree_with_numbers_from_another_program() {
    // Which column of the matrix: 0 is the x axis, 3 the origin.
    for (skel, joint, column, wanted) in [
        ("test.skel", "knee_r", 3, [0.0995, -0.6, -0.009983]),
        ("wasp.skel", "knee_01_r", 3, [0.496202, -0.028606, 0.593412]),
        ("wasp.skel", "knee_01_r", 0, [0.492404, 0.642788, 0.586824]),
        ("wasp.skel", "wing_01_l", 0, [0.821394, -0.387628, 0.418398]),
        ("wasp.skel", "tail_04", 3, [0.0, -0.3, 1.5]),
        ("horse.skel", "head", 3, [0.0, 0.616839, 0.513019]),
        ("tree.skel", "branch_2_4", 3, [-2.120476, 5.122165, 0.0]),
    ] {
        let Some(subject) = Subject::real(Some(skel), None) else {
            return;
        };
        let result = ask_ok(&SERVICE, "joint.transforms", json!({"rig": subject.name}));
        let joints = result["joints"].as_array().expect("joints");
        let found = joints.iter().find(|it| it["name"] == joint).expect(joint);
        let matrix = found["world_from_joint"].as_array().expect("a matrix");
        let column = json!(matrix[4 * column..4 * column + 3]);
        assert_printed(&format!("{joint} of {skel}"), &column, wanted);
    }
}

#[test]
fn vertices_at_rest_agree_with_numbers_from_another_program() {
    type Vertices = &'static [(usize, [f64; 3])];
    let tube: Vertices = &[(0, [0.47477, -0.186, 0.0]), (239, [0.087, 0.5, -0.05])];
    let wasp: Vertices = &[(0, [0.12623, -0.21983, -0.77655])];
    for (skel, skin, vertices, min, max) in [
        (
            "tube.skel",
            "tube.skin",
            tube,
            [-0.14161, -0.3543, -0.1],
            [0.47477, 0.5, 0.1],
        ),
        (
            "wasp.skel",
            "wasp.skin",
            wasp,
            [-1.14926, -0.96239, -0.84758],
            [1.1497, 0.61106, 2.00612],
        ),
    ] {
        let Some(subject) = Subject::real(Some(skel), Some(skin)) else {
            return;
        };
        let result = ask_ok(&SERVICE, "mesh.vertices", json!({"rig": subject.name}));
        let positions = result["meshes"][0]["positions"]["data"]
            .as_array()
            .expect("numbers");
        for &(vertex, wanted) in vertices {
            let found = json!(positions[3 * vertex..3 * vertex + 3]);
            assert_printed(&format!("vertex {vertex} of {skin}"), &found, wanted);
        }
        assert_printed(&format!("bounds of {skin}"), &result["bounds"]["min"], min);
        assert_printed(&format!("bounds of {skin}"), &result["bounds"]["max"], max);
    }
}

#[test]
fn a_joint_turned_a_thousandth_too_far_is_noticed() {
    let subject = figure();
    let found = subject.by_gpu(&subject.oracle.rest());
    let is_followed = |joint: usize| {
        let follows = |influences: &Vec<(usize, f64)>| {
            influences.iter().any(|it| it.0 == joint && it.1 > 0.1)
        };
        subject.oracle.weights.iter().any(follows)
    };
    let followed: Vec<usize> = (0..subject.oracle.joints.len())
        .filter(|&joint| is_followed(joint))
        .collect();
    assert!(followed.len() > 10);
    for joint in followed {
        for axis in 0..3 {
            let mut pose = subject.oracle.rest();
            pose.angles[joint][axis] += 1e-3;
            let off = compare(&found, &subject.oracle.skin(&pose));
            assert!(
                !off.is_close(),
                "{} axis {axis}: {off:?}",
                subject.oracle.joints[joint].name
            );
        }
    }
}

#[test]
fn vertices_out_of_order_are_noticed() {
    let subject = figure();
    let rest = subject.oracle.rest();
    let mut found = subject.by_gpu(&rest);
    found.swap(17, 18);
    assert!(!compare(&found, &subject.oracle.skin(&rest)).is_close());
}

#[test]
fn a_binding_read_by_row_is_noticed() {
    let (skel, skin) = bound_turned();
    let mut subject = Subject::load("bound turned", Some(&skel), Some(&skin.text()));
    let found = subject.by_gpu(&subject.oracle.rest());
    assert!(compare(&found, &subject.oracle.skin(&subject.oracle.rest())).is_close());
    let original = subject.oracle.bindings[0];
    for (row, entries) in subject.oracle.bindings[0].iter_mut().enumerate().take(3) {
        for (column, entry) in entries.iter_mut().enumerate().take(3) {
            *entry = original[column][row];
        }
    }
    assert!(!compare(&found, &subject.oracle.skin(&subject.oracle.rest())).is_close());
}

#[test]
fn weights_taken_as_they_are_are_noticed() {
    let (skel, skin) = bound_turned();
    let mut subject = Subject::load("bound turned", Some(&skel), Some(&skin.text()));
    let found = subject.by_gpu(&subject.oracle.rest());
    subject.oracle.weights[3][1].1 *= 1.01;
    assert!(!compare(&found, &subject.oracle.skin(&subject.oracle.rest())).is_close());
}

#[test]
fn normals_of_other_lengths_or_directions_and_nan_are_noticed() {
    let subject = figure();
    let rest = subject.oracle.rest();
    let (found, wanted) = (subject.by_gpu(&rest), subject.oracle.skin(&rest));
    assert!(compare(&found, &wanted).is_close());
    let disturbances: [fn(&mut [[f32; 3]; 2]); 5] = [
        |[_, normal]| *normal = normal.map(|x| x * 0.99),
        |[_, normal]| *normal = normal.map(|x| -x),
        |[_, normal]| *normal = [f32::NAN; 3],
        |[position, _]| position[0] = f32::NAN,
        |[position, _]| position[1] += 1e-3,
    ];
    for (index, disturb) in disturbances.iter().enumerate() {
        let mut found = found.clone();
        disturb(&mut found[200]);
        let off = compare(&found, &wanted);
        assert!(!off.is_close(), "disturbance {index}: {off:?}");
    }
}
