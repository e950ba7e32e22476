//! Nodes that are no tree, and numbers that cannot be worked with.

use super::{Break, assert_all_refused, assert_no_harm, assert_refused, broken, remove};
use crate::support::everything::good;
use serde_json::json;

#[test]
fn nodes_that_are_no_tree_are_refused() {
    assert_all_refused(&[
        (
            "a child of itself",
            |it| it.json["nodes"][1]["children"] = json!([1]),
            "nodes",
        ),
        (
            "a ring of two",
            |it| it.json["nodes"][1]["children"] = json!([0]),
            "nodes",
        ),
        (
            "a ring beside the scene",
            |it| {
                it.node(json!({"children": [4]}));
                it.node(json!({"children": [3]}));
            },
            "nodes",
        ),
        (
            "two parents",
            |it| it.json["nodes"][2]["children"] = json!([1]),
            "nodes",
        ),
        (
            "a child twice",
            |it| it.json["nodes"][0]["children"] = json!([1, 1]),
            "nodes",
        ),
        (
            "no such child",
            |it| it.json["nodes"][1]["children"] = json!([77]),
            "77",
        ),
        (
            "a child before the first",
            |it| it.json["nodes"][1]["children"] = json!([-1]),
            "-1",
        ),
        (
            "half a child",
            |it| it.json["nodes"][1]["children"] = json!([1.5]),
            "1.5",
        ),
        (
            "no such node in the scene",
            |it| it.json["scenes"][0]["nodes"] = json!([0, 77]),
            "77",
        ),
        ("no such scene", |it| it.json["scene"] = json!(77), "77"),
        (
            "no such mesh",
            |it| it.json["nodes"][2]["mesh"] = json!(77),
            "77",
        ),
        (
            "no such skin",
            |it| it.json["nodes"][2]["skin"] = json!(77),
            "77",
        ),
        (
            "a translation of two",
            |it| it.json["nodes"][1]["translation"] = json!([1, 2]),
            "nodes",
        ),
        (
            "a rotation of three",
            |it| it.json["nodes"][1]["rotation"] = json!([0, 0, 1]),
            "nodes",
        ),
        (
            "a matrix of fifteen",
            |it| it.json["nodes"][1]["matrix"] = json!(vec![1.0; 15]),
            "nodes",
        ),
        (
            "a scale of words",
            |it| it.json["nodes"][1]["scale"] = json!(["a", "b", "c"]),
            "nodes",
        ),
    ]);
}

#[test]
fn numbers_of_nodes_that_cannot_be_worked_with_do_no_harm() {
    let rows: [(&str, Break); 5] = [
        ("no rotation", |it| {
            it.json["nodes"][1]["rotation"] = json!([0, 0, 0, 0])
        }),
        ("a long rotation", |it| {
            it.json["nodes"][1]["rotation"] = json!([0, 0, 1e200, 1e200])
        }),
        ("a flat scale", |it| {
            it.json["nodes"][1]["scale"] = json!([0, 0, 0])
        }),
        ("a matrix of zeros", |it| {
            it.json["nodes"][1]["matrix"] = json!(vec![0; 16])
        }),
        ("a matrix that shears", |it| {
            it.json["nodes"][1]["matrix"] = json!([1, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
        }),
    ];
    for (what, by) in rows {
        assert_no_harm(what, broken(by).files());
    }
    for member in ["translation", "rotation", "scale", "matrix"] {
        for number in ["1e999", "-1e999", "1e300", "NaN", "null"] {
            let mut gltf = good();
            let tip = &mut gltf.json["nodes"][1];
            remove(tip, "translation");
            let mut numbers = vec![
                json!(0);
                match member {
                    "matrix" => 16,
                    "rotation" => 4,
                    _ => 3,
                }
            ];
            numbers[0] = json!(987_654_321);
            tip[member] = json!(numbers);
            let text = gltf.text().replace("987654321", number);
            let what = format!("{member} of {number}");
            let files = json!([{"name": "x.gltf", "text": text}]);
            if (member, number) == ("rotation", "1e300") {
                // Of a quaternion only the direction counts.
                assert_no_harm(&what, files);
            } else {
                let fragment = match number {
                    "NaN" => "a value of JSON",
                    "null" => "nodes[1]",
                    "1e300" => "finite",
                    _ => "number out of range",
                };
                assert_refused(&what, files, fragment);
            }
        }
    }
}
