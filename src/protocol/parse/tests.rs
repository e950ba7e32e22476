//! The table of bad parameters, and good ones.

use super::*;
use crate::protocol::camera::{Camera, Light, Lights, NamedLights, Orbit};
use crate::protocol::frame::{FrameParams, Samples, Show};
use crate::protocol::mesh::{Attribute, VerticesParams};
use crate::protocol::pose::{DofValues, Pose, PoseSetParams};
use crate::protocol::rig::{LoadParams, RigFile, RigParams};
use crate::protocol::server::Cancel;
use crate::protocol::{Attach, Id, NoParams};
use serde_json::{from_str, json};

fn parsed<T: DeserializeOwned>(text: &str) -> Result<T, Fault> {
    let raw: Box<RawValue> = from_str(text).unwrap();
    params(Some(&raw))
}

/// Each is the text of the parameters, the path of the fault, and its message.
fn check<T: DeserializeOwned + std::fmt::Debug>(cases: &[(&str, &str, &str)]) {
    for (text, expected_path, expected_message) in cases {
        let Fault::InvalidParams(fault) = parsed::<T>(text).unwrap_err() else {
            panic!("{text} gave another fault")
        };
        assert_eq!(&fault.path.to_string(), expected_path, "{text}");
        assert_eq!(&fault.message, expected_message, "{text}");
    }
}

#[test]
fn a_fault_in_a_frame_request_has_its_path_and_says_what_was_expected() {
    check::<FrameParams>(&[
        ("{}", "rig", "the field is missing"),
        (
            r#"{"rig":7}"#,
            "rig",
            "expected a string, but found integer `7`",
        ),
        (
            r#"{"rig":"a","rigg":1}"#,
            "rigg",
            "unknown field `rigg`; did you mean `rig`?",
        ),
        (
            r#"{"rig":"a","eye":1}"#,
            "eye",
            "unknown field `eye`; expected one of `rig`, `pose`, `skinning`, `show`, `camera`, `lights`, `ambient`, `material`, `background`, `cull`, `size`, `samples`, `out…",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"orbit","fovy":1}}"#,
            "camera.fovy",
            "unknown field `fovy`; did you mean `fov_y`?",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"orbit","fov_y":"wide"}}"#,
            "camera.fov_y",
            "expected a number, but found string \"wide\"",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"orbit","fov_y":1e999}}"#,
            "camera.fov_y",
            "expected a finite number of 64 bits",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"orbital"}}"#,
            "camera.kind",
            "expected one of `orbit`, `look_at`, `pinhole`, but found string \"orbital\"",
        ),
        (
            r#"{"rig":"a","camera":{"eye":[0,0,1],"kind":"orbit"}}"#,
            "camera.eye",
            "there is no such field in an `orbit` camera, which is the kind where none is given",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"look_at","eye":[0,0,1]}}"#,
            "camera.target",
            "the field is missing",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"look_at","eye":[0,0,1],"target":[0,0,0],"fov_y":1,"height":2}}"#,
            "camera.height",
            "expected either `fov_y` or `height`, but found both",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"look_at","eye":[0,0],"target":[0,0,0]}}"#,
            "camera.eye",
            "expected a list of 3, but found only 2",
        ),
        (
            r#"{"rig":"a","camera":{"kind":"pinhole","fx":1,"fy":1,"cx":1,"cy":1}}"#,
            "camera.world_from_camera",
            "the field is missing",
        ),
        (
            r#"{"rig":"a","camera":["orbit"]}"#,
            "camera",
            "expected an object, but found a list",
        ),
        (
            r#"{"rig":"a","camera":null}"#,
            "camera",
            "expected an object, but found null",
        ),
        (
            r#"{"rig":"a","lights":[{"kind":"point","position":[0,0,0]},{"kind":"point","color":"red"}]}"#,
            "lights[1].color",
            "expected a list of 3, but found string \"red\"",
        ),
        (
            r#"{"rig":"a","lights":[{"kind":"point","position":[0,"high",0]}]}"#,
            "lights[0].position[1]",
            "expected a number, but found string \"high\"",
        ),
        (
            r#"{"rig":"a","lights":[{"kind":"point"}]}"#,
            "lights[0].position",
            "the field is missing",
        ),
        (
            r#"{"rig":"a","lights":[{"kind":"directional","direction":[0,-1,0],"falloff":"none"}]}"#,
            "lights[0].falloff",
            "there is no such field in a `directional` light",
        ),
        (
            r#"{"rig":"a","lights":[{"kind":"point","position":[0,0,0],"colour":[1,1,1]}]}"#,
            "lights[0].colour",
            "unknown field `colour`; did you mean `color`?",
        ),
        (
            r#"{"rig":"a","lights":"fil"}"#,
            "lights",
            "expected a list of lights or `file`, but found string \"fil\"",
        ),
        (
            r#"{"rig":"a","lights":{}}"#,
            "lights",
            "expected a list of lights or `file`, but found an object",
        ),
        (
            r#"{"rig":"a","size":[512,512,512]}"#,
            "size",
            "expected a list of 2, but found more",
        ),
        (
            r#"{"rig":"a","size":[512]}"#,
            "size",
            "expected a list of 2, but found only 1",
        ),
        (
            r#"{"rig":"a","size":[512,-1]}"#,
            "size[1]",
            "expected an integer from 0 to 4294967295, but found integer `-1`",
        ),
        (
            r#"{"rig":"a","size":[512,4294967296]}"#,
            "size[1]",
            "expected an integer from 0 to 4294967295, but found integer `4294967296`",
        ),
        (
            r#"{"rig":"a","size":[512,0.5]}"#,
            "size[1]",
            "expected an integer from 0 to 4294967295, but found floating point `0.5`",
        ),
        (
            r#"{"rig":"a","size":[512,256.5]}"#,
            "size[1]",
            "expected an integer from 0 to 4294967295, but found floating point `256.5`",
        ),
        (
            r#"{"rig":"a","size":[1e300,512]}"#,
            "size[0]",
            "expected an integer from 0 to 4294967295, but found floating point `1e+300`",
        ),
        (
            r#"{"rig":"a","size":[-1.0,512]}"#,
            "size[0]",
            "expected an integer from 0 to 4294967295, but found floating point `-1.0`",
        ),
        (
            r#"{"rig":"a","samples":2.0}"#,
            "samples",
            "expected 1 or 4, but found 2",
        ),
        (
            r#"{"rig":"a","samples":2}"#,
            "samples",
            "expected 1 or 4, but found 2",
        ),
        (
            r#"{"rig":"a","show":{"skin":"possed"}}"#,
            "show.skin",
            "expected one of `posed`, `bind`, `none`, but found string \"possed\"",
        ),
        (
            r#"{"rig":"a","show":{"skin":{"posed":null}}}"#,
            "show.skin",
            "expected one of `posed`, `bind`, `none`, but found an object",
        ),
        (
            r#"{"rig":"a","show":{"skeleton":"bones"}}"#,
            "show.skeleton",
            "expected one of `none`, `wireframe`, `boxes`, `sticks`, `cylinders`, but found string \"bones\"",
        ),
        (
            r#"{"rig":"a","skinning":"dual"}"#,
            "skinning",
            "expected one of `linear`, `dual_quaternion`, but found string \"dual\"",
        ),
        (
            r#"{"rig":"a","outputs":["color","depth"]}"#,
            "outputs[1]",
            "expected `color`, but found string \"depth\"",
        ),
        (
            r#"{"rig":"a","transport":"json"}"#,
            "transport",
            "expected one of `base64`, `attach`, but found string \"json\"",
        ),
        (
            r#"{"rig":"a","material":{"shine":1}}"#,
            "material.shine",
            "unknown field `shine`; did you mean `shininess`?",
        ),
        (
            r#"{"rig":"a","material":{"wetness":1}}"#,
            "material.wetness",
            "unknown field `wetness`; expected one of `diffuse`, `specular`, `shininess`, `variant`",
        ),
        (r#"{"rig":"\ud800"}"#, "rig", "unexpected end of hex escape"),
    ]);
}

#[test]
fn a_fault_in_a_pose_has_its_path_and_says_what_was_expected() {
    check::<PoseSetParams>(&[
        (r#"{"rig":"a"}"#, "pose", "the field is missing"),
        (
            r#"{"rig":"a","pose":{"dofs":{"elbow.rx":"1"}}}"#,
            "pose.dofs.elbow.rx",
            "expected a number, but found string \"1\"",
        ),
        (
            r#"{"rig":"a","pose":{"dofs":{"elbow.rx":1e400}}}"#,
            "pose.dofs.elbow.rx",
            "expected a finite number of 64 bits",
        ),
        (
            r#"{"rig":"a","pose":{"dofs":[1]}}"#,
            "pose.dofs",
            "expected an object, but found a list",
        ),
        (
            r#"{"rig":"a","pose":{"rotations":{"elbow":[0,0,0,1,0]}}}"#,
            "pose.rotations.elbow",
            "expected a list of 4, but found more",
        ),
        (
            r#"{"rig":"a","pose":{"dof_values":[0,null]}}"#,
            "pose.dof_values[1]",
            "expected a number, but found null",
        ),
        (
            r#"{"rig":"a","pose":{"dof_values":7}}"#,
            "pose.dof_values",
            "expected a list of numbers or an object with `attach`, but found integer `7`",
        ),
        (
            r#"{"rig":"a","pose":{"dof_values":{"attach":{"offset":0}}}}"#,
            "pose.dof_values.attach.bytes",
            "the field is missing",
        ),
        (
            r#"{"rig":"a","pose":{"dof_values":{"atach":{}}}}"#,
            "pose.dof_values.atach",
            "unknown field `atach`; did you mean `attach`?",
        ),
        (
            r#"{"rig":"a","pose":{"base":"bind"}}"#,
            "pose.base",
            "expected one of `stored`, `rest`, but found string \"bind\"",
        ),
        (
            r#"{"rig":"a","pose":{"clips":[{"name":"walk","time":0,"wieght":1}]}}"#,
            "pose.clips[0].wieght",
            "unknown field `wieght`; did you mean `weight`?",
        ),
        (
            r#"{"rig":"a","pose":{"clip":{"name":"walk"}}}"#,
            "pose.clip.time",
            "the field is missing",
        ),
        (
            r#"{"rig":"a","pose":{"limits":null}}"#,
            "pose.limits",
            "expected one of `clamp`, `reject`, `ignore`, but found null",
        ),
    ]);
}

#[test]
fn a_fault_in_other_parameters_has_its_path_and_says_what_was_expected() {
    check::<LoadParams>(&[
        ("{}", "files", "the field is missing"),
        (
            r#"{"files":"wasp.skel"}"#,
            "files",
            "expected a list, but found string \"wasp.skel\"",
        ),
        (
            r#"{"files":[{"text":"x"}]}"#,
            "files[0].name",
            "the field is missing",
        ),
        (
            r#"{"files":["a",{"name":"b"}]}"#,
            "files[1].text",
            "the field is missing",
        ),
        (
            r#"{"files":[{"name":3,"text":""}]}"#,
            "files[0].name",
            "expected a string, but found integer `3`",
        ),
        (
            r#"{"files":[{"name":"b","txt":""}]}"#,
            "files[0].txt",
            "unknown field `txt`; did you mean `text`?",
        ),
        (
            r#"{"files":[{"name":"b","text":"","base64":""}]}"#,
            "files[0].text",
            "expected only one of `text`, `base64`, `attach`, but found several",
        ),
        (
            r#"{"files":[{"name":"b","base64":"$$"}]}"#,
            "files[0].base64",
            "expected a string in base64, but found one with a fault: byte 1 is none of its characters",
        ),
        (
            r#"{"files":[{"name":"b","attach":{"offset":-1,"bytes":1}}]}"#,
            "files[0].attach.offset",
            "expected an integer from 0 to 18446744073709551615, but found integer `-1`",
        ),
        (
            r#"{"files":[true]}"#,
            "files[0]",
            "expected a path or an object with a `name` and one of `text`, `base64`, `attach`, but found boolean `true`",
        ),
        (
            r#"{"files":[],"replace":1}"#,
            "replace",
            "expected a boolean, but found integer `1`",
        ),
    ]);
    check::<VerticesParams>(&[
        (
            r#"{"rig":"a","attributes":["tangents"]}"#,
            "attributes[0]",
            "expected one of `positions`, `normals`, but found string \"tangents\"",
        ),
        (
            r#"{"rig":"a","range":{"start":0}}"#,
            "range.count",
            "the field is missing",
        ),
        (
            r#"{"rig":"a","range":{"start":0,"count":18446744073709551616}}"#,
            "range.count",
            "expected an integer from 0 to 18446744073709551615, but found floating point `1.8446744073709552e+19`",
        ),
        (
            r#"{"rig":"a","range":{"start":9007199254740992.0,"count":1}}"#,
            "range.start",
            "expected an integer of 2^53 or more to be written without fraction or exponent, but found floating point `9007199254740992.0`",
        ),
        (
            r#"{"rig":"a","range":[0,1]}"#,
            "range",
            "expected an object, but found a list",
        ),
    ]);
    check::<Cancel>(&[
        (
            r#"{"request":1.5}"#,
            "request",
            "expected an integer of 64 bits, a string of at most 64 bytes, or null, but found floating point `1.5`",
        ),
        ("{}", "request", "the field is missing"),
    ]);
    check::<NoParams>(&[(
        r#"{"x":1}"#,
        "x",
        "unknown field `x`; there are no fields here",
    )]);
}

#[test]
fn duplicate_keys_are_refused_at_every_depth() {
    let twice = "the key is given twice";
    check::<RigParams>(&[(r#"{"rig":"a","rig":"b"}"#, "rig", twice)]);
    check::<FrameParams>(&[
        (
            r#"{"rig":"a","camera":{"kind":"orbit","near":1,"near":1}}"#,
            "camera.near",
            twice,
        ),
        (
            r#"{"rig":"a","lights":[{"kind":"point","kind":"point"}]}"#,
            "lights[0].kind",
            twice,
        ),
        (
            r#"{"rig":"a","pose":{"dofs":{"x":1,"y":1,"x":2}}}"#,
            "pose.dofs.x",
            twice,
        ),
        (
            r#"{"rig":"a","pose":{"dofs":{"x":1,"\u0078":2}}}"#,
            "pose.dofs.x",
            twice,
        ),
        (
            r#"{"rig":"a","pose":{"rotations":{"x":[0,0,0,1],"x":[0,0,0,1]}}}"#,
            "pose.rotations.x",
            twice,
        ),
        (
            r#"{"rig":"a","pose":{"dof_values":{"attach":{"offset":0,"offset":1}}}}"#,
            "pose.dof_values.attach.offset",
            twice,
        ),
    ]);
    check::<LoadParams>(&[(
        r#"{"files":[{"name":"b","text":"","name":"c"}]}"#,
        "files[0].name",
        twice,
    )]);
}

#[test]
fn a_message_repeats_only_so_much_of_the_request() {
    let long = "x".repeat(100_000);
    for text in [
        format!(r#"{{"rig":"a","size":"{long}"}}"#),
        format!(r#"{{"rig":"a","{long}":1}}"#),
        format!(r#"{{"rig":"a","pose":{{"dofs":{{"{long}":""}}}}}}"#),
        format!(r#"{{"rig":"a","cull":"{long}"}}"#),
    ] {
        let fault = parsed::<FrameParams>(&text).unwrap_err().to_string();
        assert!(fault.len() < 1000, "{} bytes", fault.len());
    }
}

#[test]
fn depth_is_refused_and_not_followed() {
    let deep = "[".repeat(100_000) + &"]".repeat(100_000);
    let text = format!(r#"{{"rig":"a","lights":{deep}}}"#);
    assert!(parsed::<FrameParams>(&text).is_err());
}

#[test]
fn what_is_left_out_has_its_default() {
    let frame: FrameParams = parsed(r#"{"rig":"wasp"}"#).unwrap();
    assert_eq!(frame, FrameParams::of("wasp"));
    assert_eq!(frame.camera, Camera::Orbit(Orbit::default()));
    assert_eq!((frame.size, frame.samples), ([512, 512], Samples::Four));
    let show: FrameParams = parsed(r#"{"rig":"a","show":{}}"#).unwrap();
    assert_eq!(show.show, Show::default());
    let vertices: VerticesParams = parsed(r#"{"rig":"a"}"#).unwrap();
    assert_eq!(
        vertices.attributes,
        [Attribute::Positions, Attribute::Normals]
    );
    assert_eq!(params::<NoParams>(None), Ok(NoParams {}));
}

#[test]
fn an_integer_may_be_written_as_a_float() {
    let frame: FrameParams = parsed(r#"{"rig":"a","size":[256.0,1e2],"samples":1.0}"#).unwrap();
    assert_eq!((frame.size, frame.samples), ([256, 100], Samples::One));
    let text = r#"{"rig":"a","range":{"start":-0.0,"count":9007199254740991.0}}"#;
    let range = parsed::<VerticesParams>(text).unwrap().range.unwrap();
    assert_eq!((range.start, range.count), (0, (1 << 53) - 1));
    let text = r#"{"rig":"a","range":{"start":9007199254740993,"count":18446744073709551615}}"#;
    let range = parsed::<VerticesParams>(text).unwrap().range.unwrap();
    assert_eq!((range.start, range.count), ((1 << 53) + 1, u64::MAX));
    let text = r#"{"files":[{"name":"d","attach":{"offset":1.0,"bytes":20e-1}}]}"#;
    let load: LoadParams = parsed(text).unwrap();
    assert!(matches!(
        &load.files[0],
        RigFile::Attached { attach, .. } if (attach.offset, attach.bytes) == (1, 2)
    ));
    let text = r#"{"dof_values":{"attach":{"offset":0e0,"bytes":8.0}}}"#;
    let attach = Attach {
        offset: 0,
        bytes: 8,
    };
    let pose: Pose = parsed(text).unwrap();
    assert_eq!(pose.dof_values, Some(DofValues::Attached { attach }));
    let cancel: Cancel = parsed(r#"{"request":7.0}"#).unwrap();
    assert_eq!(cancel.request, Id::from(7));
    // No parameter is of these types yet.
    let narrow: (i8, u8, i16, u16, i32, i64) = parsed("[-1.0,2.0,3.0,4.0,5.0,-6e0]").unwrap();
    assert_eq!(narrow, (-1, 2, 3, 4, 5, -6));
    assert!(parsed::<(u8, i8)>("[256.0,0]").is_err());
    assert!(parsed::<(u8, i8)>("[255.0,-129.0]").is_err());
}

#[test]
fn every_form_of_a_union_is_taken() {
    let load: LoadParams = parsed(
        r#"{"files":["a.skel",{"name":"b","text":"t"},{"base64":"aGk=","name":"c"},{"name":"d","attach":{"offset":1,"bytes":2}}]}"#,
    )
    .unwrap();
    let name = String::from;
    let expected = [
        RigFile::Path(name("a.skel")),
        RigFile::Text {
            name: name("b"),
            text: name("t"),
        },
        RigFile::Base64 {
            name: name("c"),
            base64: crate::protocol::attach::Base64(b"hi".to_vec()),
        },
        RigFile::Attached {
            name: name("d"),
            attach: Attach {
                offset: 1,
                bytes: 2,
            },
        },
    ];
    assert_eq!(load.files, expected);

    let values = |text: &str| parsed::<Pose>(text).unwrap().dof_values;
    assert_eq!(
        values(r#"{"dof_values":[1,-2.5]}"#),
        Some(DofValues::List(vec![1.0, -2.5]))
    );
    let attach = Attach {
        offset: 0,
        bytes: 8,
    };
    assert_eq!(
        values(r#"{"dof_values":{"attach":{"offset":0,"bytes":8}}}"#),
        Some(DofValues::Attached { attach })
    );
    let cancel: Cancel = parsed(r#"{"request":null}"#).unwrap();
    assert_eq!(cancel.request, Id::Null);
}

#[test]
fn what_a_client_writes_is_read_back_the_same() {
    let text = r#"{"rig":"a","camera":{"kind":"pinhole","fx":1,"fy":1,"cx":1,"cy":1,"axes":"cv","world_from_camera":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},
        "lights":[{"kind":"point","position":[1,2,3],"falloff":"inverse_square"},{"kind":"directional","direction":[0,-1,0],"intensity":2}],
        "pose":{"base":"rest","dofs":{"x.rx":0.5},"limits":"reject"},"samples":1,"material":{"shininess":3},"background":[0,0,0,0]}"#;
    let frame: FrameParams = parsed(text).unwrap();
    let Some(Lights::Given(lights)) = &frame.lights else {
        panic!("a list: {:?}", frame.lights);
    };
    assert!(matches!(
        lights.as_slice(),
        [Light::Point(_), Light::Directional(_)]
    ));
    let again = parsed(&json!(frame).to_string()).unwrap();
    assert_eq!(frame, again);
    let look =
        r#"{"rig":"a","camera":{"kind":"look_at","eye":[0,0,1],"target":[0,0,0],"height":2}}"#;
    let frame: FrameParams = parsed(look).unwrap();
    assert_eq!(frame, parsed(&json!(frame).to_string()).unwrap());
    let of_file = r#"{"rig":"a","lights":"file","material":{"variant":"matte"}}"#;
    let frame: FrameParams = parsed(of_file).unwrap();
    assert_eq!(frame.lights, Some(Lights::Named(NamedLights::File)));
    assert_eq!(frame, parsed(&json!(frame).to_string()).unwrap());
}
