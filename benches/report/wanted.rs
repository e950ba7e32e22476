//! What is wanted of the service: a ratio for each wish, both sides measured in one run. Never lives here: how cost grows.

use crate::capsule::{Capsule, USUAL};
use crate::floor::Floor;
use crate::poses;
use crate::process::DaemonProcess;
use crate::rounds::{Effort, Rounds, Side, Spread};
use crate::scenes::{Shots, Subject};
use crate::served::{Batch, Daemon, ask};
use crate::table::{Outcome, Row, Wanted, digits};
use crate::wire::{Wire, echo, pings, request};
use std::sync::atomic::{AtomicU64, Ordering};

/// Requests of one connection at a time, where there are several.
pub const IN_FLIGHT: usize = 8;

pub struct Wishes<'a> {
    pub adapter: &'a str,
    pub daemon: &'a Daemon,
    pub effort: Effort,
    /// Pictures of which the later ones must not take more memory.
    pub enduring: usize,
}

/// How to tell what both sides came to.
#[derive(Clone, Copy)]
enum Unit {
    /// Things a second; the ratio is of rates.
    Rate(&'static str, f64),
    /// Milliseconds a thing; the ratio is of times.
    Millis,
}

fn row(what: &str, wanted: Wanted, unit: Unit, rounds: &Rounds) -> Row {
    let (ratio, [daemon, floor]) = match unit {
        Unit::Rate(name, things) => {
            let shown = |side| format!("{} {name}/s", digits(things / rounds.median(side)));
            (rounds.ratio(1, 0), [0, 1].map(shown))
        }
        Unit::Millis => {
            let shown = |side| format!("{} ms", digits(1e3 * rounds.median(side)));
            (rounds.ratio(0, 1), [0, 1].map(shown))
        }
    };
    Row {
        what: what.to_owned(),
        wanted,
        outcome: Outcome::Measured {
            ratio,
            daemon,
            floor,
        },
    }
}

const FRAMES: Unit = Unit::Rate("frames", 1.0);

impl Wishes<'_> {
    /// All rows, each written to the terminal once it is there.
    pub fn measure(&self) -> Vec<Row> {
        let floor = Floor::of(self.daemon.engine());
        let mut rows = Vec::new();
        let mut tell = |row: Row| {
            print!("{}", row.line());
            rows.push(row);
        };
        let capsule = Subject::load(self.daemon.engine(), "capsule", &USUAL.files());
        let figure = Subject::load(self.daemon.engine(), "figure", &rigd::cli::figure());
        tell(self.memory(&figure));
        for subject in [&capsule, &figure] {
            tell(self.frames(&floor, subject, 1, IN_FLIGHT));
            tell(self.frames(&floor, subject, 8, 1));
            tell(self.latency(&floor, subject));
        }
        for stream in [false, true] {
            tell(self.batch(&capsule, stream));
        }
        let morphed = Capsule {
            morphs: 300,
            ..USUAL
        };
        let million = Capsule {
            rings: 1000,
            segments: 1000,
            ..USUAL
        };
        for (name, capsule) in [("1M vertices", million), ("300 morph targets", morphed)] {
            let subject = Subject::load(self.daemon.engine(), name, &capsule.files());
            tell(self.sharing(&floor, &subject));
            drop(subject);
            self.daemon.engine().unload(name).expect("it is loaded");
        }
        tell(self.vertices(&floor, &capsule));
        tell(self.rigs());
        tell(self.pings("one at a time", Wanted::AtLeast(0.8), 1));
        tell(self.pings("32 in flight", Wanted::AtLeast(0.5), 16));
        for method in ["pose.set", "joint.transforms"] {
            let form = poses::FORMS;
            let rounds = self.effort.in_turn(IN_FLIGHT, self.poses(&capsule, method));
            for (side, form) in form.into_iter().enumerate().skip(1) {
                let what = format!("`{method}`, 192 DOFs {form}, over {}", poses::FORMS[0]);
                let shown = |side| format!("{} requests/s", digits(1.0 / rounds.median(side)));
                tell(Row {
                    what,
                    wanted: Wanted::Nothing,
                    outcome: Outcome::Measured {
                        ratio: rounds.ratio(0, side),
                        daemon: shown(side),
                        floor: shown(0),
                    },
                });
            }
        }
        for rig in ["capsule", "figure"] {
            self.daemon.engine().unload(rig).expect("it is loaded");
        }
        rows
    }

    fn frames(&self, floor: &Floor, subject: &Subject, clients: usize, each: usize) -> Row {
        let shots = Shots::new(512, 4);
        let sides: Vec<Side> = vec![
            Box::new(|count| self.daemon.frames(subject, shots, clients, each, count)),
            Box::new(|count| floor.frames(subject, shots, IN_FLIGHT, count)),
        ];
        let who = match clients {
            1 => "1 client".to_owned(),
            _ => format!("{clients} clients"),
        };
        let what = format!(
            "frames, 512x512, {}, {who}, {each} in flight",
            subject.name()
        );
        let rounds = self.effort.in_turn(2 * IN_FLIGHT, sides);
        row(&what, Wanted::AtLeast(0.9), FRAMES, &rounds)
    }

    fn latency(&self, floor: &Floor, subject: &Subject) -> Row {
        let shots = Shots::new(256, 4);
        let sides: Vec<Side> = vec![
            Box::new(|count| self.daemon.frames(subject, shots, 1, 1, count)),
            Box::new(|count| floor.frames(subject, shots, 1, count)),
        ];
        let what = format!("a lone frame, 256x256, {}", subject.name());
        let rounds = self.effort.in_turn(4, sides);
        row(&what, Wanted::AtMost(1.25), Unit::Millis, &rounds)
    }

    fn batch(&self, subject: &Subject, stream: bool) -> Row {
        const FRAMES_OF_A_BATCH: usize = 200;
        let shots = Shots::new(256, 4);
        let wanted = Wanted::AtLeast(0.97);
        let how = if stream {
            "sent one by one"
        } else {
            "in one reply"
        };
        let what = format!("`frame.batch` of 200, 256x256, {how}, over 200 requests");
        if !self.daemon.has_batches(subject) {
            return not_measured(what, wanted);
        }
        let batch = Batch {
            frames: FRAMES_OF_A_BATCH,
            stream,
        };
        let sides: Vec<Side> = vec![
            Box::new(|count| self.daemon.batches(subject, shots, batch, 1, count)),
            Box::new(|count| self.daemon.frames(subject, shots, 1, IN_FLIGHT, count)),
        ];
        let rounds = self.effort.in_turn(FRAMES_OF_A_BATCH, sides);
        row(&what, wanted, FRAMES, &rounds)
    }

    /// Four cameras on each pose against a pose for each camera, in groups of four that come one behind another.
    fn sharing(&self, floor: &Floor, subject: &Subject) -> Row {
        let has_batches = self.daemon.has_batches(subject);
        let how = if has_batches {
            "batches of 4, two"
        } else {
            "requests, 8"
        };
        let (name, wanted) = (subject.name(), Wanted::AtLeast(0.7));
        let what = format!("skinning saved by 4 cameras on a pose, {name}, 64x64, {how} in flight");
        if floor.skinning(subject, 1).is_none() {
            return Row {
                what,
                wanted,
                outcome: Outcome::NotMeasured("skinning cannot be timed alone on this adapter"),
            };
        }
        let frames = move |of_a_pose, count| {
            let shots = Shots {
                of_a_pose,
                ..Shots::new(64, 4)
            };
            let batch = Batch {
                frames: 4,
                stream: false,
            };
            match has_batches {
                true => self.daemon.batches(subject, shots, batch, 2, count),
                false => self.daemon.frames(subject, shots, 1, IN_FLIGHT, count),
            }
        };
        let sides: Vec<Side> = vec![
            Box::new(move |count| frames(4, count)),
            Box::new(move |count| frames(1, count)),
            Box::new(|count| floor.skinning(subject, count).unwrap_or(f64::NAN)),
        ];
        let rounds = self.effort.in_turn(4 * IN_FLIGHT, sides);
        let shown = |side| digits(1e3 * rounds.median(side));
        Row {
            what,
            wanted,
            outcome: Outcome::Measured {
                ratio: rounds.spread(|secs| (secs[1] - secs[0]) / secs[2]),
                daemon: format!("{} ms a frame", shown(0)),
                floor: format!("{} ms, of which skinning {} ms", shown(1), shown(2)),
            },
        }
    }

    fn vertices(&self, floor: &Floor, subject: &Subject) -> Row {
        let vertices = subject.loaded.rig.vertex_count() as f64;
        let ask = |count| {
            self.daemon.ask(1, IN_FLIGHT, count, |index| {
                request("mesh.vertices", &subject.vertices_params(index), &[])
            })
        };
        let sides: Vec<Side> = vec![
            Box::new(ask),
            Box::new(|count| floor.vertices(subject, IN_FLIGHT, count)),
        ];
        let rounds = self.effort.in_turn(4 * IN_FLIGHT, sides);
        let unit = Unit::Rate("M vertices", 1e-6 * vertices);
        let what = "vertices, positions and normals, over skinning and a socket";
        row(what, Wanted::AtLeast(0.85), unit, &rounds)
    }

    fn rigs(&self) -> Row {
        let [few, many] = [1, 1000].map(|rigs| crowded(self.adapter, rigs));
        let shots = Shots::new(256, 4);
        let side = |(daemon, subject): &(Daemon, Subject), count| {
            daemon.frames(subject, shots, 1, IN_FLIGHT, count)
        };
        let sides: Vec<Side> = vec![
            Box::new(|count| side(&many, count)),
            Box::new(|count| side(&few, count)),
        ];
        let rounds = self.effort.in_turn(2 * IN_FLIGHT, sides);
        let what = "a frame with 1,000 rigs loaded, over 1";
        row(what, Wanted::AtMost(1.05), Unit::Millis, &rounds)
    }

    /// Of a process of its own, which has `figure` loaded as well; over one connection, so that no thread is started in between.
    fn memory(&self, figure: &Subject) -> Row {
        const SETTLED: usize = 500;
        let daemon = DaemonProcess::start(self.adapter);
        let shots = Shots::new(64, 4);
        let [first, last] = [(); 2].map(|()| AtomicU64::new(0));
        ask(daemon.address, 1, IN_FLIGHT, self.enduring, |index| {
            if index == SETTLED {
                first.store(daemon.resident_bytes(), Ordering::Relaxed);
            } else if index == self.enduring - 1 {
                last.store(daemon.resident_bytes(), Ordering::Relaxed);
            }
            request("frame.render", &shots.params(figure, index), &[])
        });
        let [first, last] = [first, last].map(|bytes| bytes.into_inner() as f64);
        let shown = |bytes: f64| format!("{:.1} MiB", bytes / f64::from(1 << 20));
        let ratio = last / first;
        Row {
            what: format!(
                "resident memory after {} frames, over after 500",
                self.enduring
            ),
            wanted: Wanted::AtMost(1.02),
            outcome: Outcome::Measured {
                ratio: Spread {
                    low: ratio,
                    median: ratio,
                    high: ratio,
                },
                daemon: shown(last),
                floor: shown(first),
            },
        }
    }

    fn pings(&self, how: &str, wanted: Wanted, at_a_time: usize) -> Row {
        let ping = request("server.ping", "{}", &[]);
        let mut wire = Wire::connect(self.daemon.address);
        wire.send(&ping);
        wire.receive();
        let reply = wire.line().to_vec();
        let length = reply.len();
        let addresses = [self.daemon.address, echo(reply)];
        let sides = addresses.map(|address| -> Side {
            let ping = &ping;
            Box::new(move |count| pings(address, ping, length, at_a_time, count))
        });
        let rounds = self.effort.in_turn(512, sides.into());
        let what = format!("`server.ping`, {how}, over an echo of the same bytes");
        row(&what, wanted, Unit::Rate("pings", 1.0), &rounds)
    }

    fn poses<'a>(&'a self, subject: &'a Subject, method: &'a str) -> Vec<Side<'a>> {
        let side = |form: usize| -> Side<'a> {
            let requests = poses::requests(subject, method, form);
            Box::new(move |count| {
                let request = |index: usize| requests[index % requests.len()].clone();
                self.daemon.ask(1, IN_FLIGHT, count, request)
            })
        };
        (0..poses::FORMS.len()).map(side).collect()
    }
}

fn not_measured(what: String, wanted: Wanted) -> Row {
    Row {
        what,
        wanted,
        outcome: Outcome::NotMeasured("the daemon has no `frame.batch`"),
    }
}

/// A daemon with so many rigs: one to draw and others that are just there.
pub fn crowded(adapter: &str, rigs: usize) -> (Daemon, Subject) {
    let small = Capsule {
        rings: 10,
        segments: 10,
        joints: 8,
        ..USUAL
    };
    let (daemon, files) = (Daemon::open(adapter), small.files());
    let subject = Subject::load(daemon.engine(), "capsule", &USUAL.files());
    for other in 1..rigs {
        Subject::load(daemon.engine(), &format!("rig{other}"), &files);
    }
    (daemon, subject)
}
