//! Documents changed at random.

use crate::support::everything::good;
use crate::support::random::Random;
use rigd::formats::{File, FileRef, LoadError, Source, load};
use rigd::limits::Limits;
use rigd::pose::{ClipAt, Pose, PoseEdit, Posed, Skinning};
use rigd::render::cpu::skin_mesh;
use serde_json::{Value, json};
use std::sync::Arc;

/// Puts something else in the place of a member somewhere in a document, or takes it away.
fn mutate(random: &mut Random, value: &mut Value) {
    let inside = match value {
        Value::Array(items) if !items.is_empty() && random.below(8) > 0 => {
            let at = random.below(items.len());
            if random.below(12) == 0 {
                items.remove(at);
                return;
            }
            &mut items[at]
        }
        Value::Object(members) if !members.is_empty() && random.below(8) > 0 => {
            let keys: Vec<String> = members.keys().cloned().collect();
            let key = &keys[random.below(keys.len())];
            if random.below(12) == 0 {
                members.remove(key);
                return;
            }
            members.get_mut(key).expect("it is there")
        }
        leaf => {
            let others = [
                json!(null),
                json!(true),
                json!(-1),
                json!(0),
                json!(1),
                json!(2),
                json!(7),
                json!(255),
                json!(5126),
                json!(4294967295u32),
                json!(9007199254740993u64),
                json!(u64::MAX),
                json!(0.5),
                json!(-1e9),
                json!(1e300),
                json!("MAT4"),
                json!("translation"),
                json!("CUBICSPLINE"),
                json!([]),
                json!([0]),
                json!([0, 0, 0]),
                json!({}),
            ];
            *leaf = others[random.below(others.len())].clone();
            return;
        }
    };
    mutate(random, inside);
}

#[test]
fn mutated_documents_give_a_rig_that_works_or_a_clear_fault() {
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let (mut rigs, mut faults) = (0, 0);
    for _ in 0..6000 {
        let mut gltf = good();
        for _ in 0..=random.below(2) {
            let members = gltf.json.as_object_mut().expect("an object");
            let lists: Vec<String> = members.keys().cloned().collect();
            let list = &lists[random.below(lists.len())];
            mutate(&mut random, &mut members[list]);
        }
        for _ in 0..random.below(3) {
            let at = random.below(gltf.bytes.len());
            gltf.bytes[at] = random.below(256) as u8;
        }
        let file = File {
            name: "x.glb".to_owned(),
            bytes: gltf.glb().into(),
        };
        let loaded = load(
            &[FileRef::Inline(file)],
            &Source::inline_only(),
            &Limits::default(),
        );
        match loaded {
            Ok(loaded) => {
                rigs += 1;
                let rig = Arc::new(loaded.rig);
                let clips = (0..rig.clips().len()).map(|clip| ClipAt {
                    clip,
                    time: 0.4,
                    weight: 0.7,
                });
                let edit = PoseEdit {
                    clips: clips.collect(),
                    ..PoseEdit::default()
                };
                let (pose, _) = Pose::rest(&rig).edited(&edit).expect("it has no limits");
                // One that is flung too far says so.
                let Ok(posed) = Posed::new(&pose) else {
                    continue;
                };
                for mesh in rig.meshes() {
                    let palette = posed.palette(Skinning::Linear);
                    let (positions, normals) = skin_mesh(mesh, palette, posed.morph_weights());
                    let numbers = positions.iter().chain(&normals).flatten();
                    assert!(
                        numbers.into_iter().all(|number| number.is_finite()),
                        "{}",
                        gltf.json
                    );
                }
            }
            Err(LoadError::Invalid(fault)) => {
                faults += 1;
                let message = fault.to_string();
                assert!(message.len() < 600 && !message.contains('\n'), "{message}");
            }
            Err(LoadError::Limit(_)) => faults += 1,
            Err(other) => panic!("{other}: {}", gltf.json),
        }
    }
    // Both must have been tried.
    assert!(rigs > 300 && faults > 300, "{rigs} rigs, {faults} faults");
}
