//! How cost grows with size: tables and plots, the floor beside the daemon. Never lives here: what is wanted of either.

use crate::capsule::{Capsule, USUAL};
use crate::floor::Floor;
use crate::plot::{Line, Plot};
use crate::rounds::{Effort, Side};
use crate::scenes::{Shots, Subject};
use crate::served::{Batch, Daemon};
use crate::table::by_size;
use crate::wanted::{IN_FLIGHT, crowded};

/// One size after another.
pub struct Growth {
    /// Of its plot's file.
    pub name: &'static str,
    pub title: &'static str,
    size: &'static str,
    columns: Vec<String>,
    /// Milliseconds, of the daemon and of the floor by turns; of what cannot be measured there is nothing.
    rows: Vec<(f64, Vec<f64>)>,
}

impl Growth {
    fn new(name: &'static str, title: &'static str, size: &'static str) -> Self {
        println!("{title}");
        Self {
            name,
            title,
            size,
            columns: vec!["daemon".to_owned(), "floor".to_owned()],
            rows: Vec::new(),
        }
    }

    fn push(&mut self, size: usize, seconds: Vec<f64>) {
        let millis: Vec<f64> = seconds.into_iter().map(|value| 1e3 * value).collect();
        println!("  {size}: {millis:.3?}");
        self.rows.push((size as f64, millis));
    }

    pub fn plot(&self) -> Plot {
        let lines = self.columns.iter().enumerate().map(|(column, label)| Line {
            label: label.clone(),
            is_floor: column % 2 == 1,
            points: self
                .rows
                .iter()
                .map(|(size, values)| (*size, values[column]))
                .collect(),
        });
        Plot {
            title: self.title.to_owned(),
            x: self.size,
            y: "ms a frame",
            lines: lines.collect(),
        }
    }

    pub fn table(&self) -> String {
        let columns: Vec<String> = self
            .columns
            .iter()
            .map(|column| format!("{column}, ms"))
            .collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        by_size(self.size, &columns, &self.rows)
    }
}

pub struct Sizes<'a> {
    pub adapter: &'a str,
    pub daemon: &'a Daemon,
    pub effort: Effort,
}

impl Sizes<'_> {
    pub fn measure(&self) -> Vec<Growth> {
        let floor = Floor::of(self.daemon.engine());
        let mut all = vec![
            self.capsules(
                &floor,
                Growth::new("vertices", "Vertices of the capsule, 256x256", "vertices"),
                [(31, 32), (99, 100), (316, 316), (999, 1000)].map(|(rings, segments)| Capsule {
                    rings,
                    segments,
                    ..USUAL
                }),
                |capsule| capsule.vertex_count(),
            ),
            self.capsules(
                &floor,
                Growth::new("joints", "Joints of the capsule, 256x256", "joints"),
                [10, 30, 100, 300, 1000].map(|joints| Capsule { joints, ..USUAL }),
                |capsule| capsule.joints,
            ),
            self.capsules(
                &floor,
                Growth::new(
                    "influences",
                    "Influences of a vertex, 256x256",
                    "influences",
                ),
                [1, 2, 4, 8, 16, 32].map(|influences| Capsule {
                    influences,
                    ..USUAL
                }),
                |capsule| capsule.influences,
            ),
            self.capsules(
                &floor,
                Growth::new(
                    "morphs",
                    "Morph targets, each of every vertex, 256x256",
                    "targets",
                ),
                [0, 1, 3, 10, 30, 100, 300].map(|morphs| Capsule { morphs, ..USUAL }),
                |capsule| capsule.morphs,
            ),
        ];
        let capsule = Subject::load(self.daemon.engine(), "capsule", &USUAL.files());
        all.extend(self.batches(&floor, &capsule));
        all.push(self.pictures(&floor, &capsule));
        all.push(self.connections(&floor, &capsule));
        all.push(self.rigs());
        all
    }

    fn capsules<const N: usize>(
        &self,
        floor: &Floor,
        mut growth: Growth,
        capsules: [Capsule; N],
        size: impl Fn(&Capsule) -> usize,
    ) -> Growth {
        for capsule in capsules {
            let subject = Subject::load(self.daemon.engine(), "grown", &capsule.files());
            let seconds = self.frames(floor, self.daemon, &subject, Shots::new(256, 4), 1);
            growth.push(size(&capsule), seconds.into());
            drop(subject);
            self.daemon.engine().unload("grown").expect("it is loaded");
        }
        growth
    }

    /// Seconds a frame, of the daemon and of the floor: of the best rounds, for a curve has no ratio that noise falls out of.
    fn frames(
        &self,
        floor: &Floor,
        daemon: &Daemon,
        subject: &Subject,
        shots: Shots,
        clients: usize,
    ) -> [f64; 2] {
        let each = if clients == 1 { IN_FLIGHT } else { 1 };
        let sides: Vec<Side> = vec![
            Box::new(|count| daemon.frames(subject, shots, clients, each, count)),
            Box::new(|count| floor.frames(subject, shots, IN_FLIGHT, count)),
        ];
        let rounds = self.effort.in_turn(IN_FLIGHT.max(clients), sides);
        rounds.best()
    }

    fn batches(&self, floor: &Floor, subject: &Subject) -> Option<Growth> {
        if !self.daemon.has_batches(subject) {
            println!("Frames of a batch: not measured, there is no `frame.batch`");
            return None;
        }
        let mut growth = Growth::new("batch", "Frames of a batch, 64x64", "frames");
        let shots = Shots::new(64, 4);
        for frames in [1, 4, 16, 64, 256] {
            let batch = Batch {
                frames,
                stream: false,
            };
            let sides: Vec<Side> = vec![
                Box::new(|count| self.daemon.batches(subject, shots, batch, 1, count)),
                Box::new(|count| floor.frames(subject, shots, frames.min(IN_FLIGHT), count)),
            ];
            let rounds = self.effort.in_turn(frames, sides);
            growth.push(frames, rounds.best().into());
        }
        Some(growth)
    }

    fn pictures(&self, floor: &Floor, subject: &Subject) -> Growth {
        let mut growth = Growth::new("pixels", "Pixels to a side", "pixels");
        growth.columns = ["4 samples", "floor of 4", "1 sample", "floor of 1"]
            .map(str::to_owned)
            .into();
        for side in [64, 128, 256, 512, 1024, 2048] {
            let of_samples = [4, 1].map(|samples| {
                let shots = Shots::new(side, samples);
                self.frames(floor, self.daemon, subject, shots, 1)
            });
            growth.push(side as usize, of_samples.concat());
        }
        growth
    }

    fn connections(&self, floor: &Floor, subject: &Subject) -> Growth {
        let title = "Connections, one frame in flight each, 64x64";
        let mut growth = Growth::new("connections", title, "connections");
        let shots = Shots::new(64, 4);
        // A single one has a floor of its own, where one frame is drawn by all threads.
        let sides: Vec<Side> = vec![
            Box::new(|count| self.daemon.frames(subject, shots, 1, 1, count)),
            Box::new(|count| floor.frames(subject, shots, 1, count)),
        ];
        let rounds = self.effort.in_turn(IN_FLIGHT, sides);
        growth.push(1, rounds.best().into());
        for clients in [2, 4, 8, 16, 32, 64] {
            let seconds = self.frames(floor, self.daemon, subject, shots, clients);
            growth.push(clients, seconds.into());
        }
        growth
    }

    fn rigs(&self) -> Growth {
        let mut growth = Growth::new("rigs", "Rigs that are loaded, 64x64", "rigs");
        for rigs in [1, 10, 100, 1000] {
            let (daemon, subject) = crowded(self.adapter, rigs);
            let floor = Floor::of(daemon.engine());
            let seconds = self.frames(&floor, &daemon, &subject, Shots::new(64, 4), 1);
            growth.push(rigs, seconds.into());
        }
        growth
    }
}
