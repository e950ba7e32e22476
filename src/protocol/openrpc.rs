//! The OpenRPC document, made from the types and the table of methods.
//! Never lives here: a word about any one method.

use super::PROTOCOL_VERSION;
use super::error::{ErrorKind, ErrorObject};
use super::methods::Method;
use schemars::Schema;
use schemars::generate::{SchemaGenerator, SchemaSettings};
use schemars::transform::RecursiveTransform;
use serde_json::{Map, Value, json};

/// The contract as an OpenRPC 1.3 document: the same bytes every time, with schemas in JSON Schema draft 7.
pub fn openrpc() -> Value {
    // What is read may leave out what has a default; what is sent always has it.
    let mut read = generator(SchemaSettings::for_deserialize);
    let mut sent = generator(SchemaSettings::for_serialize);
    let params: Vec<_> = Method::ALL
        .iter()
        .map(|method| method.params_schema(&mut read))
        .collect();
    let results: Vec<_> = Method::ALL
        .iter()
        .map(|method| method.result_schema(&mut sent))
        .collect();
    let error = sent.subschema_for::<ErrorObject>();
    let mut schemas = read.take_definitions(true);
    for (name, schema) in sent.take_definitions(true) {
        let shared = schemas.insert(name, schema.clone());
        debug_assert!(
            shared.is_none_or(|other| other == schema),
            "two types share a name"
        );
    }
    let methods: Vec<Value> = Method::ALL
        .iter()
        .zip(params.iter().zip(results))
        .map(|(method, (params, result))| {
            let params = schemas.get(params.as_ref()).unwrap_or(&Value::Null);
            describe(*method, params, &json!(result))
        })
        .collect();
    json!({
        "openrpc": "1.3.2",
        "info": {
            "title": "rigd",
            "version": format!("{PROTOCOL_VERSION}.0.0"),
            "description": "A headless daemon that keeps character rigs loaded, poses and skins them, and answers with pictures and vertices.",
        },
        "methods": methods,
        "components": {
            "schemas": schemas,
            "errors": ErrorKind::ALL.iter().map(|kind| (kind.name().to_owned(), error_of(*kind))).collect::<Map<_, _>>(),
        },
        "x-transport": transport(&json!(error)),
    })
}

fn generator(contract: fn(SchemaSettings) -> SchemaSettings) -> SchemaGenerator {
    let settings = SchemaSettings::draft07().with(|settings| {
        settings.definitions_path = "/components/schemas".into();
        settings.meta_schema = None;
        settings
            .transforms
            .push(Box::new(RecursiveTransform(unwrap)));
    });
    contract(settings).into_generator()
}

/// Where a doc comment breaks its lines is nobody's business but the source's.
fn unwrap(schema: &mut Schema) {
    if let Some(Value::String(description)) = schema.get_mut("description") {
        *description = description.replace('\n', " ");
    }
}

fn describe(method: Method, params: &Value, result: &Value) -> Value {
    let required = params["required"].as_array().map_or(&[][..], Vec::as_slice);
    let descriptors: Vec<Value> = params["properties"]
        .as_object()
        .into_iter()
        .flatten()
        .map(|(name, schema)| {
            json!({
                "name": name,
                "required": required.iter().any(|other| other == name),
                "schema": schema,
            })
        })
        .collect();
    let errors: Vec<Value> = Method::GENERAL_ERRORS
        .iter()
        .chain(method.errors())
        .map(|kind| json!({ "$ref": format!("#/components/errors/{}", kind.name()) }))
        .collect();
    let mut described = json!({
        "name": method.name(),
        "summary": method.summary(),
        "paramStructure": "by-name",
        "params": descriptors,
    });
    // OpenRPC tells a notification by its having no result.
    if !method.is_notification() {
        described["result"] = json!({ "name": "result", "schema": result });
        described["errors"] = errors.into();
    }
    described
}

fn error_of(kind: ErrorKind) -> Value {
    json!({
        "code": kind.code(),
        "message": kind.summary(),
        "data": { "kind": kind.name(), "retryable": kind.retryable() },
    })
}

/// What a client must know that OpenRPC has no place for.
fn transport(error: &Value) -> Value {
    json!({
        "framing": "TCP. One JSON-RPC 2.0 message to a line, UTF-8, ended by a line feed; the last one before a client closes its half may lack it. No batches: write many lines before reading, with somebody to read the replies. Replies come in the order of the requests.",
        "units": "Lengths in the rig's own units, angles in radians, colors linear RGB from 0 to 1. Matrices are 16 numbers, column-major, acting on column vectors. Right-handed.",
        "request_members": {
            "deadline_ms": {
                "description": "Milliseconds from arrival. A request that is not done by then is answered with `deadline_exceeded`.",
                "schema": { "type": "integer", "minimum": 0 },
            },
            "attach_bytes": {
                "description": "This many raw bytes follow the line at once. An `attach` in the parameters names a stretch of them.",
                "schema": { "type": "integer", "minimum": 0, "default": 0 },
            },
        },
        "reply_members": {
            "attach_bytes": {
                "description": "This many raw bytes follow the line at once; a blob of the encoding `attach` is a stretch of them. Only where the request asked for the transport `attach`.",
                "schema": { "type": "integer", "minimum": 0, "default": 0 },
            },
            "error": {
                "description": "Branch on `data.kind`.",
                "schema": error,
            },
        },
    })
}

#[cfg(test)]
mod tests;
