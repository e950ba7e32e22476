//! What the service costs: the daemon over loopback against the same work in a bare loop, in one run. Writes `docs/benchmarks/service.md`
//! and its plots. Never lives here: what the renderers cost against each other, and loading.
//!
//! `RIGD_BENCH_ADAPTER` names another adapter than rigd's own renderer; the page is then named after it. With `--quick`, or with
//! `RIGD_BENCH_QUICK` set, all of it runs once and shortly, and the page goes to cargo's folder for temporary files.

#[path = "../support/capsule.rs"]
mod capsule;
mod floor;
mod growth;
mod machine;
mod plot;
mod poses;
mod process;
mod rounds;
mod scenes;
mod served;
mod table;
mod wanted;
mod wire;

use growth::{Growth, Sizes};
use machine::Machine;
use rounds::Effort;
use served::Daemon;
use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::time::Duration;
use table::Row;
use wanted::Wishes;

/// What each row means, where its words do not say it.
const EXPLAINED: &str = "\
- The floor is the same calls of the renderer and the same encoder in a bare loop, on as many threads as the daemon has: no service, no
  queue, no JSON, no socket. On an adapter of wgpu it is the engine, eight requests in flight.
- Pictures are PNG at the `fast` level with 4 samples, attached raw. No two requests have the same pose, but where several cameras look
  at one. The capsule has 10,100 vertices, 64 joints in a chain and 4 influences a vertex; the figure is the built-in one.
- Rounds of both sides are taken in turn. What came out is the median of the rounds' ratios: of rates for what is wanted to be at least
  something, of times or bytes for what is wanted to be at most something. Client, daemon and floor share the machine.
- Skinning saved is (a frame's time with a pose for each camera − its time with four cameras on each pose) / the time of skinning one pose, all
  of them the wall time of a long run divided by its frames, with all threads at work. Skinning four poses as one saves three quarters.
- Poses are measured in requests a second; the ratio is how many times as many there are as by name.
";

fn page(
    command: &str,
    machine: &Machine,
    rows: &[Row],
    growths: &[Growth],
    suffix: &str,
) -> String {
    let mut page = format!(
        "# What the service costs\n\nWritten by `{command}`. {machine}\n\n## What is wanted\n\n{}",
        Row::HEAD
    );
    page.extend(rows.iter().map(Row::line));
    let _ = write!(page, "\n{EXPLAINED}\n## How cost grows\n\n");
    page += "Milliseconds a frame with 8 in flight and, beside it, of the floor, each in the best of 5 rounds. The capsule, 4 samples, where nothing else\nis said.\n";
    for growth in growths {
        let (name, title) = (growth.name, growth.title);
        let _ = write!(
            page,
            "\n### {title}\n\n![{title}]({name}{suffix}.svg)\n\n{}",
            growth.table()
        );
    }
    page
}

fn main() {
    let quick = std::env::args().any(|argument| argument == "--quick")
        || std::env::var_os("RIGD_BENCH_QUICK").is_some();
    let named = std::env::var("RIGD_BENCH_ADAPTER").ok();
    let adapter = named.as_deref().unwrap_or("cpu");
    let effort = |rounds, milliseconds| Effort {
        rounds: if quick { 1 } else { rounds },
        round: Duration::from_millis(if quick { 30 } else { milliseconds }),
    };
    let daemon = Daemon::open(adapter);
    let machine = Machine::with(daemon.engine().adapter());
    println!("{machine}\n{}", Row::HEAD.trim_end());
    let rows = Wishes {
        adapter,
        daemon: &daemon,
        effort: effort(5, 500),
        enduring: if quick { 2000 } else { 20_000 },
    }
    .measure();
    let growths = Sizes {
        adapter,
        daemon: &daemon,
        effort: effort(5, 200),
    }
    .measure();

    let (command, suffix) = match &named {
        None => ("make bench".to_owned(), String::new()),
        Some(name) => {
            let is_word = |c: char| c.is_ascii_alphanumeric();
            let word = name.replace(|c| !is_word(c), "-");
            let command = format!("RIGD_BENCH_ADAPTER={name} cargo bench --bench report");
            (command, format!("-{word}"))
        }
    };
    let folder = if quick {
        Path::new(env!("CARGO_TARGET_TMPDIR")).join("benchmarks")
    } else {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/benchmarks")
    };
    fs::create_dir_all(&folder).expect("a folder to write to");
    let write = |name: String, text: String| {
        let path = folder.join(name);
        fs::write(&path, text).expect("a file that can be written");
        println!("wrote {}", path.display());
    };
    for growth in &growths {
        if let Some(svg) = growth.plot().svg() {
            write(format!("{}{suffix}.svg", growth.name), svg);
        }
    }
    let page = page(&command, &machine, &rows, &growths, &suffix);
    write(format!("service{suffix}.md"), page);
}
