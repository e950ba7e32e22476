//! Lines that are requests, and lines that are not.

use super::*;
use crate::protocol::{ErrorKind, ErrorObject};

fn bad(line: &[u8]) -> BadRequest {
    match Request::parse(line) {
        Ok(request) => panic!("{} was taken: {request:?}", line.escape_ascii()),
        Err(bad) => bad,
    }
}

#[test]
fn a_request_is_taken_apart() {
    let line = br#" {"method":"a.b","params":{"x":[1,{"y":2}]},"deadline_ms":250,"id":"q7","jsonrpc":"2.0","attach_bytes":12} "#;
    let request = Request::parse(line).unwrap();
    assert_eq!(request.id, Some(Id::Text("q7".into())));
    assert_eq!(request.method, "a.b");
    assert_eq!(request.params.unwrap().get(), r#"{"x":[1,{"y":2}]}"#);
    assert_eq!(request.deadline_ms, Some(250));
    assert_eq!(request.attach_bytes, 12);

    let floats = br#"{"jsonrpc":"2.0","method":"a","deadline_ms":1e2,"attach_bytes":12.0}"#;
    let floats = Request::parse(floats).unwrap();
    assert_eq!((floats.deadline_ms, floats.attach_bytes), (Some(100), 12));

    let bare = Request::parse(b"{\"jsonrpc\":\"2.0\",\"method\":\"a\"}\r\n").unwrap();
    assert_eq!(
        (bare.id, bare.deadline_ms, bare.attach_bytes),
        (None, None, 0)
    );
    assert!(bare.params.is_none());
}

#[test]
fn an_id_is_an_integer_a_short_string_or_null() {
    let parsed = |id: &str| {
        Request::parse(format!(r#"{{"jsonrpc":"2.0","method":"a","id":{id}}}"#).as_bytes())
    };
    let longest = "x".repeat(Id::LONGEST);
    for (text, id) in [
        ("0", Id::Integer(0)),
        ("-9223372036854775808", Id::Integer(i64::MIN.into())),
        ("18446744073709551615", Id::Integer(u64::MAX.into())),
        ("\"\"", Id::Text(String::new())),
        ("\"\\u0061\\n\"", Id::Text("a\n".into())),
        (&format!("\"{longest}\""), Id::Text(longest.clone())),
        ("null", Id::Null),
        ("1.0", Id::Integer(1)),
        ("-1e2", Id::Integer(-100)),
        ("-0", Id::Integer(0)),
        ("9007199254740991.0", Id::Integer((1 << 53) - 1)),
    ] {
        let taken = parsed(text).unwrap().id.unwrap();
        assert_eq!(taken, id);
        let written = serde_json::to_string(&taken).unwrap();
        assert_eq!(serde_json::from_str::<Id>(&written).unwrap(), id);
    }
    for text in [
        "1.5",
        "1e-1",
        "1e300",
        "1e999",
        "9007199254740992.0",
        "18446744073709551616",
        "true",
        "[]",
        "{}",
        "\"\\ud800\"",
        &format!("\"{longest}x\""),
        // 65 bytes of 33 characters.
        &format!("\"x{}\"", "é".repeat(32)),
    ] {
        let bad = parsed(text).unwrap_err();
        assert_eq!(bad.id, Id::Null, "{text}");
        assert_eq!(bad.fault.kind(), ErrorKind::InvalidRequest, "{text}");
    }
}

#[test]
fn a_line_that_is_no_request_says_why_and_keeps_what_could_be_read() {
    let cases: [(&str, i128, Option<u64>, &str, &str); 16] = [
        (
            r#"{"jsonrpc":"2.0","id":5,"attach_bytes":3}"#,
            5,
            Some(3),
            "method",
            "method: the member is missing",
        ),
        (
            r#"{"method":"a","id":5,"attach_bytes":3}"#,
            5,
            Some(3),
            "jsonrpc",
            "jsonrpc: expected `\"2.0\"`, but the member is missing",
        ),
        (
            r#"{"jsonrpc":"1.0","method":"a","id":5}"#,
            5,
            Some(0),
            "jsonrpc",
            "jsonrpc: expected `\"2.0\"`, but found `\"1.0\"`",
        ),
        (
            r#"{"jsonrpc":2.0,"method":"a","id":5}"#,
            5,
            Some(0),
            "jsonrpc",
            "jsonrpc: expected `\"2.0\"`, but found `2.0`",
        ),
        (
            r#"{"jsonrpc":"2.0","method":7,"id":5}"#,
            5,
            Some(0),
            "method",
            "method: expected a string, but found integer `7`",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","params":[1],"id":5}"#,
            5,
            Some(0),
            "params",
            "params: expected an object: parameters go by name",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","params":null,"id":5}"#,
            5,
            Some(0),
            "params",
            "params: expected an object: parameters go by name",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","parms":{},"id":5,"attach_bytes":9}"#,
            5,
            Some(9),
            "parms",
            "parms: unknown field `parms`; did you mean `params`?",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","token":"","id":5}"#,
            5,
            Some(0),
            "token",
            "token: unknown field `token`; expected one of `jsonrpc`, `id`, `method`, `params`, `deadline_ms`, `attach_bytes`",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","method":"b","id":5}"#,
            5,
            Some(0),
            "method",
            "method: `method` is given twice",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","id":5,"id":6}"#,
            5,
            Some(0),
            "id",
            "id: `id` is given twice",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","id":5,"deadline_ms":-1}"#,
            5,
            Some(0),
            "deadline_ms",
            "deadline_ms: expected an integer from 0 to 18446744073709551615, but found integer `-1`",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","id":5,"deadline_ms":null}"#,
            5,
            Some(0),
            "deadline_ms",
            "deadline_ms: expected an integer from 0 to 18446744073709551615, but found null",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","id":5,"attach_bytes":-1}"#,
            5,
            None,
            "attach_bytes",
            "attach_bytes: expected an integer from 0 to 18446744073709551615, but found integer `-1`",
        ),
        (
            r#"{"jsonrpc":"2.0","method":"a","id":5,"attach_bytes":1.5}"#,
            5,
            None,
            "attach_bytes",
            "attach_bytes: expected an integer from 0 to 18446744073709551615, but found floating point `1.5`",
        ),
        (
            r#"{"a":1,"jsonrpc":"1.0","method":[],"id":5}"#,
            5,
            Some(0),
            "a",
            "a: unknown field `a`; expected one of `jsonrpc`, `id`, `method`, `params`, `deadline_ms`, `attach_bytes`",
        ),
    ];
    for (line, id, attach_bytes, path, message) in cases {
        let bad = bad(line.as_bytes());
        assert_eq!(bad.id, Id::Integer(id), "{line}");
        assert_eq!(bad.attach_bytes, attach_bytes, "{line}");
        let error = ErrorObject::from(bad.fault);
        assert_eq!(error.kind(), Some(ErrorKind::InvalidRequest), "{line}");
        assert_eq!(error.message, message, "{line}");
        assert_eq!(error.detail("path"), Some(&path.into()), "{line}");
    }
}

#[test]
fn a_list_is_told_to_pipeline_and_other_values_are_no_request() {
    for line in ["[]", r#"[{"jsonrpc":"2.0","method":"a","id":1}]"#] {
        let bad = bad(line.as_bytes());
        assert_eq!(bad.fault.kind(), ErrorKind::InvalidRequest);
        let message = bad.fault.to_string();
        assert!(message.contains("one request to a line"), "{message}");
    }
    for line in ["7", "null", "true", "\"GET\"", "-1.5"] {
        let bad = bad(line.as_bytes());
        assert_eq!(bad.fault.kind(), ErrorKind::InvalidRequest, "{line}");
        let message = bad.fault.to_string();
        assert!(
            message.starts_with("expected a request, which is an object"),
            "{message}"
        );
    }
}

#[test]
fn broken_json_has_a_position_and_keeps_what_stood_before_it() {
    let cases: [(&[u8], Id, Option<u64>, &str); 9] = [
        (
            b"{\"id\":4,\"attach_bytes\":2,}",
            Id::Integer(4),
            Some(2),
            "trailing comma at column 26 of the line",
        ),
        (
            b"{\"id\":4 \"attach_bytes\":2}",
            Id::Integer(4),
            None,
            "expected `,` or `}` at column 9 of the line",
        ),
        (
            b"{\"id\":4",
            Id::Integer(4),
            Some(0),
            "EOF while parsing an object at column 7 of the line",
        ),
        (
            b"{} {}",
            Id::Null,
            Some(0),
            "trailing characters at column 4 of the line",
        ),
        (
            b"[1,",
            Id::Null,
            Some(0),
            "EOF while parsing a value at column 3 of the line",
        ),
        (
            b"hello",
            Id::Null,
            Some(0),
            "expected value at column 1 of the line",
        ),
        (
            b"",
            Id::Null,
            Some(0),
            "EOF while parsing a value at column 0 of the line",
        ),
        (
            b"{\"a\":NaN}",
            Id::Null,
            Some(0),
            "expected value at column 6 of the line",
        ),
        (
            b"{\"id\":\"\xff\"}",
            Id::Null,
            Some(0),
            "the line is not UTF-8: see byte 8",
        ),
    ];
    for (line, id, attach_bytes, message) in cases {
        let bad = bad(line);
        let line = line.escape_ascii();
        assert_eq!(bad.fault.kind(), ErrorKind::ParseError, "{line}");
        assert_eq!(bad.fault.to_string(), message, "{line}");
        assert_eq!((bad.id, bad.attach_bytes), (id, attach_bytes), "{line}");
    }
}

#[test]
fn depth_and_length_are_only_numbers() {
    let deep = "[".repeat(200_000) + &"]".repeat(200_000);
    let line = format!(r#"{{"jsonrpc":"2.0","method":"a","params":{{"x":{deep}}},"id":1}}"#);
    assert!(Request::parse(line.as_bytes()).is_ok());
    bad(deep.as_bytes());
    bad("[".repeat(200_000).as_bytes());
    bad("{\"a\":".repeat(200_000).as_bytes());
    let many = "\"x\":1,".repeat(100_000);
    let line = format!(r#"{{{many}"id":3}}"#);
    assert_eq!(bad(line.as_bytes()).id, Id::Integer(3));
    let long = "m".repeat(100_000);
    let line = format!(r#"{{"jsonrpc":"2.0","{long}":1,"method":"a"}}"#);
    assert!(bad(line.as_bytes()).fault.to_string().len() < 1000);
}
