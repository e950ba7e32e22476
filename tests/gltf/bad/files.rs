//! Buffers in data URIs and other files.

use super::{assert_is_clear, assert_refused, outcome, text};
use crate::support::ask;
use crate::support::everything::good;
use rigd::formats::Source;
use rigd::limits::Limits;
use serde_json::json;

#[test]
fn a_data_uri_is_base64_however_it_says_so() {
    let gltf = good();
    let uri = gltf.data_uri();
    for marker in ["; base64,", ";BASE64 ,", ";base64;charset=x,", "%3Bbase64,"] {
        let uri = uri.replace(";base64,", marker);
        let content = gltf.document(Some(&uri)).to_string();
        outcome(marker, text(&content)).expect("it is sound");
    }
}

#[test]
fn a_buffer_is_found_beside_its_file_or_nowhere() {
    let gltf = good();
    for (uri, fragment) in [
        ("missing.bin", "no such file"),
        ("../x.bin", "no such file"),
        ("a/../../x.bin", "no such file"),
        ("%2e%2e/x.bin", "no such file"),
        ("..%2Fx.bin", "no such file"),
        ("..\\x.bin", "no such file"),
        ("/etc/passwd", "no such file"),
        ("//host/x.bin", "no such file"),
        ("file:///etc/passwd", "a URI with a scheme"),
        ("file:x.bin", "a URI with a scheme"),
        ("http://localhost/x.bin", "a URI with a scheme"),
        ("https://localhost/x.bin", "a URI with a scheme"),
        ("C:\\x", "a URI with a scheme"),
        ("C:/x", "a URI with a scheme"),
        ("x.bin%00", "no such file"),
        ("x%zz.bin", "escapes that make no text"),
        ("", "no such file"),
        // The document itself, whose text makes no sense as numbers.
        ("x.gltf", "JOINTS_0"),
        ("data:", "no comma"),
        ("data:,", "found 0"),
        ("data:application/octet-stream;base64,", "found 0"),
        ("data:application/octet-stream;base64,!!!!", "not base64"),
        ("data:application/octet-stream;base64,AAA", "found 2"),
        ("data:application/octet-stream;base64,AAAA", "found 3"),
        ("data:application/octet-stream,AAAA", "found 4"),
    ] {
        let content = gltf.document(Some(uri)).to_string();
        assert_refused(&format!("a buffer at `{uri}`"), text(&content), fragment);
    }
}

#[test]
fn a_buffer_outside_of_the_root_is_not_opened() {
    let base = crate::support::places::output("gltf_outside");
    let root = base.join("root");
    std::fs::create_dir_all(&root).expect("a folder of the tests' own");
    let gltf = good();
    for secret in [base.join("secret.bin"), root.join("beside.bin")] {
        std::fs::write(secret, &gltf.bytes).expect("it can be written");
    }
    let outside = base.join("secret.bin");
    let outside = outside.to_str().expect("UTF-8");
    let source = Source::rooted(&root).expect("the folder is there");
    let service = crate::support::service_with(Limits::default(), source);
    let load = |uri: &str| {
        let content = gltf.document(Some(uri)).to_string();
        std::fs::write(root.join("x.gltf"), content).expect("it can be written");
        let params = json!({"name": "rooted", "files": ["x.gltf"], "replace": true});
        ask(&service, "rig.load", params)
    };
    load("beside.bin").expect("it lies beside");
    const LEADS_OUT: &str = "it leads out of the folder";
    for (uri, fragment) in [
        ("../secret.bin", LEADS_OUT),
        ("%2e%2e/secret.bin", LEADS_OUT),
        ("..%2fsecret.bin", LEADS_OUT),
        ("../root/../secret.bin", LEADS_OUT),
        (outside, LEADS_OUT),
        (&format!("file://{outside}"), "a URI with a scheme"),
    ] {
        let error = load(uri).expect_err("it lies outside");
        assert_is_clear(uri, &error, "x.gltf", fragment);
        // Neither may the server's own paths be told.
        let folder = base.to_str().expect("UTF-8");
        assert!(
            uri.contains(folder) || !error.message.contains(folder),
            "{}",
            error.message
        );
    }
}
