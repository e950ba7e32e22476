//! Accessors and views beyond their buffers.

use super::{
    accessor, assert_all_refused, assert_no_harm, assert_refused, outcome, primitive, remove,
};
use crate::support::everything::{BOUND, INDICES, JOINTS, POSITIONS, TARGET, TIMES, TURNS, good};
use serde_json::json;

#[test]
fn what_lies_outside_of_its_buffer_is_refused() {
    assert_all_refused(&[
        (
            "no such view",
            |it| accessor(it, POSITIONS)["bufferView"] = json!(77),
            "77",
        ),
        (
            "no such buffer",
            |it| it.json["bufferViews"][0]["buffer"] = json!(77),
            "77",
        ),
        (
            "no such accessor",
            |it| primitive(it)["attributes"]["POSITION"] = json!(77),
            "77",
        ),
        (
            "more than the view holds",
            |it| accessor(it, TIMES)["count"] = json!(3),
            "accessors[8]: 3 elements in the 8 bytes of its view",
        ),
        (
            "an offset past the view",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(4),
            "accessors[0]",
        ),
        (
            "a view past the buffer",
            |it| it.json["bufferViews"][0]["byteLength"] = json!(1_000_000),
            "ufferView",
        ),
        (
            "a view from past the buffer",
            |it| it.json["bufferViews"][0]["byteOffset"] = json!(1_000_000),
            "ufferView",
        ),
        (
            "an offset of the view of 2^64-1",
            |it| it.json["bufferViews"][0]["byteOffset"] = json!(u64::MAX),
            "bufferViews[0]: a part of the",
        ),
        (
            "a length of the view of 2^64-1",
            |it| it.json["bufferViews"][0]["byteLength"] = json!(u64::MAX),
            "bufferViews[0]: a part of the",
        ),
        (
            "an offset of the view of 2^63",
            |it| it.json["bufferViews"][0]["byteOffset"] = json!(1_u64 << 63),
            "bufferViews[0]: a part of the",
        ),
        (
            "an offset of 2^64-1",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(u64::MAX),
            "accessors[0]: 3 elements in the 36 bytes of its view",
        ),
        (
            "an offset of 2^64-4",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(u64::MAX - 3),
            "accessors[0]: 3 elements in the 36 bytes of its view",
        ),
        (
            "an offset of 2^63",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(1_u64 << 63),
            "accessors[0]: 3 elements in the 36 bytes of its view",
        ),
        (
            "an offset below zero",
            |it| accessor(it, POSITIONS)["byteOffset"] = json!(-4),
            "accessors[0].byteOffset: a whole number from 0",
        ),
        (
            "a stride below its element",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(8),
            "accessors[0]: a stride of at least the 12 bytes of an element",
        ),
        (
            "a stride of 256",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(256),
            "bufferViews[0].byteStride: a number from 4 to 252",
        ),
        (
            "a stride of 2^64-1",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(u64::MAX),
            "bufferViews[0].byteStride: a number from 4 to 252",
        ),
        (
            "a stride past the view",
            |it| it.json["bufferViews"][0]["byteStride"] = json!(16),
            "accessors[0]: 3 elements in the 36 bytes of its view",
        ),
        (
            "a buffer longer than its bytes",
            |it| {
                it.json["buffers"] =
                    json!([{"byteLength": it.bytes.len() + 1, "uri": it.data_uri()}])
            },
            "buffers[0]",
        ),
        (
            "a buffer of 2^64-1 bytes",
            |it| it.json["buffers"] = json!([{"byteLength": u64::MAX, "uri": it.data_uri()}]),
            "buffers[0]: 18446744073709551615 bytes",
        ),
        (
            "a buffer that is nowhere",
            |it| it.json["buffers"] = json!([{"byteLength": it.bytes.len()}]),
            "buffers[0]",
        ),
        (
            "sparse indices out of range",
            |it| {
                let (at, values) = (it.view(&[200]), it.view(&[0; 12]));
                accessor(it, POSITIONS)["sparse"] = json!({"count": 1, "values": {"bufferView": values},
                    "indices": {"bufferView": at, "componentType": 5121}});
            },
            "accessors[0]",
        ),
        (
            "sparse indices that do not ascend",
            |it| {
                let (at, values) = (it.view(&[1, 1]), it.view(&[0; 24]));
                accessor(it, POSITIONS)["sparse"] = json!({"count": 2, "values": {"bufferView": values},
                    "indices": {"bufferView": at, "componentType": 5121}});
            },
            "accessors[0]",
        ),
        (
            "more sparse values than there are",
            |it| {
                let (at, values) = (it.view(&[0, 1]), it.view(&[0; 12]));
                accessor(it, POSITIONS)["sparse"] = json!({"count": 2, "values": {"bufferView": values},
                    "indices": {"bufferView": at, "componentType": 5121}});
            },
            "accessors[0]",
        ),
    ]);
}

#[test]
fn counts_that_nothing_stands_behind_take_no_memory() {
    for count in [1_u64 << 31, 1 << 53, u64::MAX] {
        for index in [POSITIONS, JOINTS, INDICES, TARGET, TIMES, TURNS] {
            for is_sparse in [false, true] {
                let mut gltf = good();
                let (at, values) = (gltf.view(&[0]), gltf.view(&[0; 64]));
                let accessor = accessor(&mut gltf, index);
                remove(accessor, "bufferView");
                accessor["count"] = json!(count);
                if is_sparse {
                    accessor["sparse"] = json!({"count": 1, "values": {"bufferView": values},
                        "indices": {"bufferView": at, "componentType": 5121}});
                }
                let what = format!("accessors[{index}] of {count} zeros, sparse: {is_sparse}");
                let error = outcome(&what, gltf.files()).expect_err("far too many");
                let kind = error.data.kind.as_str();
                assert!(
                    ["rig_file_invalid", "limit_exceeded"].contains(&kind),
                    "{what}: {kind}"
                );
            }
        }
        // There may be more matrices than joints, and nobody needs to read them.
        let mut gltf = good();
        let bound = accessor(&mut gltf, BOUND);
        remove(bound, "bufferView");
        bound["count"] = json!(count);
        assert_no_harm(&format!("{count} matrices"), gltf.files());
        // All attributes agree on it.
        let mut gltf = good();
        for index in 0..7 {
            let accessor = accessor(&mut gltf, index);
            remove(accessor, "bufferView");
            accessor["count"] = json!(count);
        }
        let error = outcome(&format!("{count} of all"), gltf.files()).expect_err("far too many");
        assert!(["rig_file_invalid", "limit_exceeded"].contains(&error.data.kind.as_str()));
        let mut gltf = good();
        let (at, values) = (gltf.view(&[0]), gltf.view(&[0; 12]));
        accessor(&mut gltf, POSITIONS)["sparse"] = json!({"count": count, "values": {"bufferView": values},
            "indices": {"bufferView": at, "componentType": 5121}});
        let fragment = "accessors[0].sparse.count: no more than the 3 elements";
        assert_refused(&format!("{count} sparse"), gltf.files(), fragment);
    }
}
