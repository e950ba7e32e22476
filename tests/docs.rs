//! Is what the documentation lists what the program has?

use rigd::limits::Limits;
use rigd::protocol::{Kind, Method};
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
    for kind in Kind::ALL.iter().filter(|kind| **kind != Kind::Unauthorized) {
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
