//! `rigd call`: one request to a running daemon.

use crate::client::{Ahead, Client, Message};
use crate::protocol::Blob;
use anyhow::{Context, anyhow, bail};
use clap::Args;
use serde_json::{Value, json};
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub(super) struct CallArgs {
    /// E.g. server.info or frame.render
    method: String,
    /// A JSON object, @FILE to read one, or - for standard input
    #[arg(default_value = "{}")]
    params: String,
    /// Save the first picture or array of the result here, and leave its data out of what is printed; of a stream that of each item,
    /// numbered
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Where the daemon listens
    #[arg(long, value_name = "ADDR", default_value = "127.0.0.1:7443")]
    connect: String,
}

pub(super) fn run(args: &CallArgs) -> anyhow::Result<()> {
    let params = args.params()?;
    let mut client = Client::connect(args.connect.as_str()).map_err(|error| {
        anyhow!(
            "no daemon answers at {}: {error}; start one with `rigd serve`",
            args.connect
        )
    })?;
    client.send(&args.method, &params)?;
    let mut ahead = 0;
    let reply = loop {
        match client.next()? {
            Message::Ahead(item) => {
                args.print_item(item, ahead)?;
                ahead += 1;
            }
            Message::Reply(reply) => break reply,
        }
    };
    let mut result = match reply.outcome {
        Ok(result) => serde_json::from_str(result.get())?,
        Err(error) => {
            // On standard output as well: whoever reads the result by program wants the error the same way.
            super::print(&serde_json::to_string_pretty(&error)?)?;
            bail!("{error}");
        }
    };
    // Those of a stream are saved already, and it may have none.
    let streams = params.get("stream") == Some(&Value::Bool(true));
    if let Some(output) = args.output.as_ref().filter(|_| !streams) {
        let bytes = take_blob(&mut result, &reply.attached)?
            .context("the result has no picture and no array to save")?;
        save(output, &bytes)?;
    }
    super::print(&serde_json::to_string_pretty(&result)?)
}

fn save(output: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    std::fs::write(output, bytes).with_context(|| format!("cannot write {}", output.display()))?;
    eprintln!("{} ({} bytes)", output.display(), bytes.len());
    Ok(())
}

impl CallArgs {
    /// An item of a stream, on a line of its own.
    fn print_item(&self, item: Ahead, index: usize) -> anyhow::Result<()> {
        let mut params: Value = serde_json::from_str(item.params.get())?;
        if let Some(output) = &self.output
            && let Some(bytes) = take_blob(&mut params, &item.attached)?
        {
            save(&numbered(output, index), &bytes)?;
        }
        let method = item.method;
        super::print(&json!({"method": method, "params": params}).to_string())
    }

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
        serde_json::from_str(&text).with_context(|| format!("the parameters are not JSON: {text}"))
    }
}

/// `out.png` with 7 is `out-0007.png`.
fn numbered(output: &Path, index: usize) -> PathBuf {
    let stem = output.file_stem().unwrap_or_default().to_string_lossy();
    let mut name = format!("{stem}-{index:04}");
    if let Some(extension) = output.extension() {
        name = format!("{name}.{}", extension.to_string_lossy());
    }
    output.with_file_name(name)
}

/// The content of the first blob in `value`, whose data is then gone from it.
fn take_blob(value: &mut Value, attached: &[u8]) -> anyhow::Result<Option<Vec<u8>>> {
    if value.get("encoding").is_some() {
        let blob: Blob = serde_json::from_value(value.clone())
            .context("the server sent a blob that cannot be read")?;
        let bytes = blob.bytes(attached)?.into_owned();
        if let Some(members) = value.as_object_mut() {
            members.remove("data");
        }
        return Ok(Some(bytes));
    }
    let inner: Vec<&mut Value> = match value {
        Value::Object(members) => members.values_mut().collect(),
        Value::Array(items) => items.iter_mut().collect(),
        _ => Vec::new(),
    };
    for inner in inner {
        if let Some(bytes) = take_blob(inner, attached)? {
            return Ok(Some(bytes));
        }
    }
    Ok(None)
}
