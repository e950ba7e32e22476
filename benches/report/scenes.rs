//! What is asked for: rigs in poses that differ from request to request, and pictures of them, for the bare renderer and as JSON.
//! Never lives here: asking.

use rigd::engine::{Base, Engine, LoadedRig};
use rigd::formats::{FileRef, Source};
use rigd::limits::Limits;
use rigd::pose::{Pose, PoseEdit, Posed};
use rigd::scene::{Background, Camera, Light, Orbit, Samples, Scene, Size, VertexQuery};
use std::sync::Arc;

/// A loaded rig, its stored pose a little bent, all of its morph targets at work.
pub struct Subject {
    pub loaded: Arc<LoadedRig>,
    start: Pose,
}

impl Subject {
    pub fn load(engine: &Engine, name: &str, files: &[FileRef]) -> Self {
        let loaded = engine
            .load(Some(name), files, &Source::inline_only(), false)
            .expect("the rig loads");
        let value = |name: &str| match name {
            _ if name.ends_with(".rz") => Some(0.01),
            _ if name.starts_with("morph.") => Some(0.1),
            _ => None,
        };
        let dofs = loaded.rig.dofs().all().iter().enumerate();
        let edit = PoseEdit {
            dofs: dofs
                .filter_map(|(index, dof)| Some((index, value(&dof.name)?)))
                .collect(),
            ..PoseEdit::default()
        };
        engine
            .set_pose(name, |_| Ok((Base::Rest, edit)))
            .expect("the pose is kept");
        let start = engine.rig(name).expect("it is loaded").stored;
        Self { loaded, start }
    }

    pub fn name(&self) -> &str {
        &self.loaded.name
    }

    /// The stored pose but for the root's first degree of freedom, which has no limits: no two poses have one palette.
    pub fn posed(&self, index: usize) -> Arc<Posed> {
        let edit = PoseEdit {
            dofs: vec![(0, step(index))],
            ..PoseEdit::default()
        };
        let (pose, _) = self.start.edited(&edit).expect("it has no limits");
        Arc::new(Posed::new(&pose).expect("a small pose"))
    }

    /// The same pose as JSON.
    pub fn pose(&self, index: usize) -> String {
        let dof = &self.loaded.rig.dofs().all()[0].name;
        format!("{{\"dofs\":{{\"{dof}\":{}}}}}", step(index))
    }

    /// Positions and normals of everything.
    pub fn queries(&self) -> Vec<VertexQuery> {
        let meshes = self.loaded.rig.meshes().iter().enumerate();
        meshes
            .map(|(mesh, of_mesh)| VertexQuery {
                instance: 0,
                mesh,
                start: 0,
                count: of_mesh.vertex_count(),
                positions: true,
                normals: true,
            })
            .collect()
    }

    pub fn vertices_params(&self, index: usize) -> String {
        let (rig, pose) = (self.name(), self.pose(index));
        format!("{{\"rig\":\"{rig}\",\"pose\":{pose},\"transport\":\"attach\"}}")
    }
}

/// Too small to be seen.
fn step(index: usize) -> f64 {
    1e-5 * (index % 9973) as f64
}

/// Pictures that are asked for one after another.
#[derive(Clone, Copy)]
pub struct Shots {
    /// Pixels.
    pub side: u32,
    pub samples: u32,
    /// After as many pictures comes the next pose.
    pub of_a_pose: usize,
}

/// Cameras go round.
const CAMERAS: usize = 4;

impl Shots {
    pub fn new(side: u32, samples: u32) -> Self {
        Self {
            side,
            samples,
            of_a_pose: 1,
        }
    }

    fn azimuth(index: usize) -> f64 {
        0.25 * (index % CAMERAS) as f64
    }

    pub fn posed(self, subject: &Subject, index: usize) -> Arc<Posed> {
        subject.posed(index / self.of_a_pose)
    }

    /// With the defaults of a request.
    pub fn scene(self, subject: &Subject, index: usize) -> Scene {
        let limits = Limits::default();
        let size = Size::new(self.side, self.side, &limits).expect("a size within limits");
        let orbit = Orbit {
            azimuth: Some(Self::azimuth(index)),
            ..Orbit::default()
        };
        Scene {
            size,
            samples: match self.samples {
                1 => Samples::One,
                _ => Samples::Four,
            },
            camera: Camera::orbit(orbit, &subject.loaded.extents.bounds(), size).expect("a camera"),
            lights: Light::default_pair(),
            ambient: Scene::DEFAULT_AMBIENT,
            background: Background::default(),
        }
    }

    /// What all pictures share, as members of JSON.
    fn shared(self, subject: &Subject) -> String {
        let (rig, side, samples) = (subject.name(), self.side, self.samples);
        format!(
            "\"rig\":\"{rig}\",\"size\":[{side},{side}],\"samples\":{samples},\"transport\":\"attach\""
        )
    }

    /// What is one picture's own.
    fn own(self, subject: &Subject, index: usize) -> String {
        let (pose, azimuth) = (subject.pose(index / self.of_a_pose), Self::azimuth(index));
        format!("\"pose\":{pose},\"camera\":{{\"kind\":\"orbit\",\"azimuth\":{azimuth}}}")
    }

    pub fn params(self, subject: &Subject, index: usize) -> String {
        format!("{{{},{}}}", self.shared(subject), self.own(subject, index))
    }

    /// So many pictures of one request, from the `first` on.
    pub fn batch_params(
        self,
        subject: &Subject,
        first: usize,
        count: usize,
        stream: bool,
    ) -> String {
        let frame = |index| format!("{{{}}}", self.own(subject, index));
        let frames: Vec<String> = (first..first + count).map(frame).collect();
        let (shared, frames) = (self.shared(subject), frames.join(","));
        format!("{{{shared},\"frames\":[{frames}],\"stream\":{stream}}}")
    }
}
