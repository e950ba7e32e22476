//! `rigd call`: one request to a running daemon.

use super::files::{self, Destination, numbered};
use super::terminal::{note, print, print_to_reader};
use super::values::address;
use crate::client::{Client, Message, Notification};
use crate::protocol::Blob;
use anyhow::{Context, anyhow, bail};
use clap::Args;
use serde_json::{Map, Value, json};
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(super) struct CallArgs {
    /// E.g. server.info or frame.render
    method: String,
    /// A JSON object, @FILE to read one, or - for standard input
    #[arg(default_value = "{}")]
    params: String,
    /// Save the pictures and arrays of the result, and print where each is in place of its data
    ///
    /// A single one is saved under this name. Several are numbered in the order in which the result is printed, e.g. out_0000.f32 and
    /// out_0001.f32 for out.f32. The items of a stream are numbered as well, e.g. walk_0000.png for walk.png, and several of one item once
    /// more, e.g. out_0007_0001.f32. With - a single one goes to standard output, and the result to standard error.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Where the daemon listens
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:7443", value_parser = address)]
    connect: String,
}

/// Letters of what cannot be read that are enough to know it again.
const SHOWN: usize = 160;

pub(super) fn run(args: &CallArgs) -> anyhow::Result<()> {
    let params = args.params()?;
    let output = args.output.as_deref().map(Destination::of).transpose()?;
    let streams = params.get("stream") == Some(&Value::Bool(true));
    if streams && output == Some(Destination::StandardOutput) {
        bail!("--output: a stream needs a file's name, but found `-`");
    }
    let mut client = Client::connect(args.connect.as_str()).map_err(|error| {
        anyhow!(
            "no daemon answers at {}: {error}; start one with `rigd serve`",
            args.connect
        )
    })?;
    client.send(&args.method, &params)?;
    let mut items = Items {
        count: asked_for(&params),
        came: 0,
        saved: 0,
    };
    let reply = loop {
        match client.next()? {
            Message::Notification(item) => {
                let is_read = items.take(item, args.output.as_deref())?;
                if !is_read && output.is_none() {
                    // Nobody is left who would want the rest, and the closed connection tells the server.
                    return Ok(());
                }
            }
            Message::Reply(reply) => break reply,
        }
    };
    let mut result = match reply.outcome {
        Ok(result) => serde_json::from_str(result.get())?,
        Err(error) => {
            // On standard output as well: whoever reads the result by program wants the error the same way.
            print(&serde_json::to_string_pretty(&error)?)?;
            bail!("{error}");
        }
    };
    let saved = match &output {
        None => Ok(warn_of_unsaved(&reply.attached)),
        Some(Destination::File(path)) => save(&mut result, &reply.attached, path, ""),
        Some(Destination::StandardOutput) => pass_on(&mut result, &reply.attached),
    };
    let text = serde_json::to_string_pretty(&result)?;
    match (&output, &saved) {
        // Its blobs are still in it.
        (Some(Destination::StandardOutput), Err(_)) => {}
        (Some(Destination::StandardOutput), Ok(_)) => note(&text),
        // What was done is told whether its blobs could be saved or not.
        _ => print(&text)?,
    }
    if saved? + items.saved == 0 && output.is_some() {
        bail!("the result has no picture and no array to save");
    }
    Ok(())
}

/// The items of a stream.
struct Items {
    /// How many were asked for, as far as the request says.
    count: usize,
    came: usize,
    /// Files that were written.
    saved: usize,
}

impl Items {
    /// Prints one on a line of its own; whether anybody still reads.
    fn take(&mut self, item: Notification, output: Option<&Path>) -> anyhow::Result<bool> {
        let mut params: Value = serde_json::from_str(item.params.get())?;
        self.saved += match output {
            Some(path) => {
                let path = numbered(path, self.came, self.count);
                let before = format!("item {}, ", self.came);
                save(&mut params, &item.attached, &path, &before)?
            }
            None => warn_of_unsaved(&item.attached),
        };
        self.came += 1;
        let method = item.method;
        print_to_reader(&json!({"method": method, "params": params}).to_string())
    }
}

/// The items that a request for a batch asks for; 0 where it does not say so in a list.
fn asked_for(params: &Value) -> usize {
    let lists = ["frames", "poses", "dof_values"].map(|field| params.get(field)?.as_array());
    lists
        .iter()
        .flatten()
        .map(|list| list.len())
        .max()
        .unwrap_or(0)
}

/// Saves every blob in `value`, which then says where in place of how it travelled. How many there were. What is told of each has its place
/// in `value` after `before`.
fn save(value: &mut Value, attached: &[u8], output: &Path, before: &str) -> anyhow::Result<usize> {
    let blobs = blobs(value);
    let count = blobs.len();
    for (index, (place, blob)) in blobs.into_iter().enumerate() {
        let path = match count {
            1 => output.to_owned(),
            _ => numbered(output, index, count),
        };
        let bytes = take(blob, attached)?;
        files::write(&path, &bytes)?;
        let path = path.to_string_lossy();
        note(&format!("{path} ({before}{place}, {} bytes)", bytes.len()));
        blob.insert("file".to_owned(), path.into());
    }
    Ok(count)
}

/// Writes the only blob in `value` to standard output.
fn pass_on(value: &mut Value, attached: &[u8]) -> anyhow::Result<usize> {
    match blobs(value).as_mut_slice() {
        [] => Ok(0),
        [(_, only)] => files::write_to_stdout(&take(only, attached)?).map(|()| 1),
        several => bail!(
            "--output: the result has {} pictures or arrays, and standard output takes one: name a file",
            several.len()
        ),
    }
}

/// Raw bytes that came although nothing is to be saved. None are.
fn warn_of_unsaved(attached: &[u8]) -> usize {
    if !attached.is_empty() {
        let bytes = attached.len();
        note(&format!(
            "warning: {bytes} attached bytes are left out; --output saves them"
        ));
    }
    0
}

/// The content of a blob, which then has nothing left of how it travelled.
fn take(blob: &mut Map<String, Value>, attached: &[u8]) -> anyhow::Result<Vec<u8>> {
    let travelled = ["encoding", "offset", "data"].map(|field| blob.remove_entry(field));
    let mut whole = blob.clone();
    whole.extend(travelled.into_iter().flatten());
    let whole: Blob = serde_json::from_value(Value::Object(whole))
        .context("the server sent a blob that cannot be read")?;
    Ok(whole.bytes(attached)?.into_owned())
}

/// The blobs in `value`, in the order in which it is printed, each with its place in there, e.g. `meshes[0].positions`.
fn blobs(value: &mut Value) -> Vec<(String, &mut Map<String, Value>)> {
    let mut found = Vec::new();
    collect(value, String::new(), &mut found);
    found
}

/// No deeper than the reader of JSON goes.
fn collect<'a>(
    value: &'a mut Value,
    place: String,
    found: &mut Vec<(String, &'a mut Map<String, Value>)>,
) {
    match value {
        Value::Object(members) => {
            if is_blob(members) {
                return found.push((place, members));
            }
            let separator = if place.is_empty() { "" } else { "." };
            for (name, inner) in members {
                collect(inner, format!("{place}{separator}{name}"), found);
            }
        }
        Value::Array(items) => {
            for (index, inner) in items.iter_mut().enumerate() {
                collect(inner, format!("{place}[{index}]"), found);
            }
        }
        _ => {}
    }
}

/// Another object may have a member of the same name, e.g. a joint's, but none that is a string.
fn is_blob(members: &Map<String, Value>) -> bool {
    members.get("encoding").is_some_and(Value::is_string)
}

impl CallArgs {
    fn params(&self) -> anyhow::Result<Value> {
        let text = match self.params.as_str() {
            "-" => {
                let mut text = String::new();
                std::io::stdin()
                    .read_to_string(&mut text)
                    .context("cannot read standard input")?;
                text
            }
            params => match params.strip_prefix('@') {
                Some(file) => {
                    std::fs::read_to_string(file).with_context(|| format!("cannot read {file}"))?
                }
                None => params.to_owned(),
            },
        };
        serde_json::from_str(&text).with_context(|| {
            let start: String = text.chars().take(SHOWN).collect();
            let rest = if start.len() < text.len() { "…" } else { "" };
            format!("the parameters are not JSON: {start}{rest}")
        })
    }
}
