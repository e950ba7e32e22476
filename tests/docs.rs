//! Is what the documentation lists what the program has?

use rigd::limits::Limits;
use rigd::protocol::{ErrorKind, Method, openrpc};
use rigd::scene::{Color, Surface};
use serde_json::Value;
use std::path::Path;

#[test]
fn operations_lists_every_limit_with_its_value() {
    let text = include_str!("../docs/operations.md");
    for (name, value) in Limits::default().entries() {
        let digits = value.to_string();
        let groups: Vec<&str> = digits
            .as_bytes()
            .rchunks(3)
            .rev()
            .filter_map(|group| std::str::from_utf8(group).ok())
            .collect();
        let row = format!("| `{name}` | {} |", groups.join(","));
        assert!(text.contains(&row), "docs/operations.md lacks {row}");
    }
}

#[test]
fn the_protocol_lists_every_method_and_every_kind_of_error() {
    let text = include_str!("../docs/protocol.md");
    for method in Method::ALL {
        assert!(
            text.contains(method.name()),
            "docs/protocol.md lacks {}",
            method.name()
        );
    }
    // Nothing asks for a token yet.
    for kind in ErrorKind::ALL
        .iter()
        .filter(|kind| **kind != ErrorKind::Unauthorized)
    {
        let row = text
            .lines()
            .find(|line| line.starts_with('|') && line.contains(&format!("`{}`", kind.name())));
        let row = row.unwrap_or_else(|| panic!("docs/protocol.md lacks {}", kind.name()));
        assert!(
            row.contains(&kind.code().to_string().replace('-', "−")),
            "{row}"
        );
        assert_eq!(row.contains("yes"), kind.retryable(), "{row}");
    }
}

/// Numbers and words of a JSON value, as the documentation spells them.
fn spelled(value: &Value) -> Vec<String> {
    match value {
        Value::Array(items) => items.iter().flat_map(spelled).collect(),
        Value::Object(members) => members.values().flat_map(spelled).collect(),
        Value::Number(number) => {
            let number = number.as_f64().expect("a number");
            // Radians are told to four digits.
            let digits = number.to_string();
            vec![if digits.len() > 6 {
                format!("{number:.4}")
            } else {
                digits
            }]
        }
        Value::String(word) => vec![word.clone()],
        other => vec![other.to_string()],
    }
}

#[test]
fn the_protocol_lists_the_default_of_every_field_of_a_frame_request() {
    let text = include_str!("../docs/protocol.md");
    let cell = |field: &str| {
        let rows = text.lines().filter(|line| line.matches('|').count() == 4);
        let named = format!("`{field}`");
        let mut of_field = rows.filter(|row| {
            row.split('|')
                .nth(1)
                .is_some_and(|cell| cell.contains(&named))
        });
        let row = of_field
            .next()
            .unwrap_or_else(|| panic!("docs/protocol.md lacks {field}"));
        row.split('|').nth(3).expect("three cells").to_owned()
    };
    let holds = |field: &str, default: &Value| {
        let cell = cell(field);
        for spelling in spelled(default) {
            assert!(
                cell.contains(&spelling),
                "{field}: {spelling} is not in {cell}"
            );
        }
    };
    let document = openrpc();
    let methods = document["methods"].as_array().expect("methods");
    let render = methods
        .iter()
        .find(|method| method["name"] == "frame.render");
    let params = render.expect("it is there")["params"]
        .as_array()
        .expect("params");
    for param in params {
        let name = param["name"].as_str().expect("a name");
        // A rig has none, and a pose has a table of its own.
        if ["rig", "pose"].contains(&name) {
            continue;
        }
        let default = param["schema"].get("default");
        holds(
            name,
            default.unwrap_or_else(|| panic!("{name} has no default")),
        );
    }
    let orbit = &document["components"]["schemas"]["Camera"]["oneOf"][0]["properties"];
    for field in ["azimuth", "inclination", "fov_y"] {
        holds("camera", &orbit[field]["default"]);
    }
    // What is left out of a material is the file's business first, so that its schema can only tell in words.
    let material = &document["components"]["schemas"]["Material"]["properties"];
    let list = |color: Color| {
        format!(
            "[{}]",
            color.rgb().to_array().map(|it| it.to_string()).join(", ")
        )
    };
    for (field, default) in [
        ("diffuse", list(Surface::DIFFUSE)),
        ("specular", list(Surface::SPECULAR)),
        ("shininess", Surface::SHININESS.to_string()),
    ] {
        let description = material[field]["description"].as_str().expect("a sentence");
        assert!(
            description.contains(&default),
            "{field}: {default} is not in {description}"
        );
        let cell = cell("material");
        assert!(
            cell.contains(&default),
            "{field}: {default} is not in {cell}"
        );
    }
}

#[test]
fn every_link_leads_somewhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let documents = [
        "README.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
        "docs/protocol.md",
        "docs/formats.md",
        "docs/operations.md",
        "docs/benchmarks.md",
        "docs/benchmarks/service.md",
    ];
    for document in documents {
        let text = std::fs::read_to_string(root.join(document))
            .unwrap_or_else(|error| panic!("{document}: {error}"));
        for target in text
            .split("](")
            .skip(1)
            .filter_map(|rest| rest.split([')', '#']).next())
        {
            if target.is_empty() || target.starts_with("http") {
                continue;
            }
            let path = root.join(document).parent().expect("a folder").join(target);
            assert!(path.exists(), "{document} links to {target}");
        }
    }
}
