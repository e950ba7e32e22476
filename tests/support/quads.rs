//! Squares made of any material, in front of each other, and pictures of them by either renderer.
//! Never lives here: what should be seen.

use super::pictures::Image;
use super::shot::Shot;
use glam::{DAffine3, DVec3, Vec2, Vec3, Vec4};
use rigd::frame::{Outputs, Raster};
use rigd::limits::Limits;
use rigd::pose::{Pose, Posed, Skinning};
use rigd::render::Plan;
use rigd::render::cpu::{Cores, Cpu, Parallelism};
use rigd::render::gpu::Gpu;
use rigd::rig::{
    BindPose, BindingDraft, Draft, Encoding, JointDraft, Material, MeshDraft, PartDraft, Texture,
    TextureLevel, TexturePlace,
};
use rigd::scene::{
    Background, Bounds, Camera, Color, Cull, Light, LookAt, Near, Samples, Show, Size, Surface,
};
use std::sync::Arc;

/// A square that faces the camera.
#[derive(Debug, Clone)]
pub struct Quad {
    pub material: Material,
    /// Lower left and upper right corner; what is from -1 to 1 is in the picture.
    pub reach: [Vec2; 2],
    /// Nearer where it is larger.
    pub z: f32,
    /// At the corners as they run around from the lower left: lower right, upper right, upper left.
    pub texcoords: Option<[Vec2; 4]>,
    pub colors: Option<[Vec4; 4]>,
    /// Of all corners.
    pub normal: Vec3,
    pub is_flat: bool,
    /// Wound so that its front faces away.
    pub is_turned: bool,
}

/// All of the picture, its texture upright.
pub fn quad(material: Material) -> Quad {
    Quad {
        material,
        reach: [Vec2::NEG_ONE, Vec2::ONE],
        z: 0.0,
        texcoords: Some([Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y]),
        colors: None,
        normal: Vec3::Z,
        is_flat: false,
        is_turned: false,
    }
}

/// Of a color, linear, and an opacity.
pub fn painted(color: [f32; 4]) -> Material {
    Material {
        color: Some(Vec4::from_array(color)),
        ..Material::named(String::new())
    }
}

/// Rows from the top.
pub fn texture(encoding: Encoding, rows: &[&[[u8; 4]]]) -> TexturePlace {
    let level = TextureLevel {
        width: rows[0].len() as u32,
        height: rows.len() as u32,
        texels: rows.concat(),
    };
    TexturePlace::plain(Arc::new(Texture::new(String::new(), encoding, level)))
}

impl Quad {
    fn mesh(&self, material: usize) -> MeshDraft {
        let [min, max] = self.reach;
        let corner = |x: f32, y: f32| Vec3::new(x, y, self.z);
        let triangles = [[0, 1, 2], [0, 2, 3]];
        let turned = triangles.map(|[a, b, c]| [a, c, b]);
        MeshDraft {
            positions: vec![
                corner(min.x, min.y),
                corner(max.x, min.y),
                corner(max.x, max.y),
                corner(min.x, max.y),
            ],
            normals: Some(vec![self.normal; 4]),
            texcoords: self.texcoords.map(|texcoords| texcoords.to_vec()),
            colors: self.colors.map(|colors| colors.to_vec()),
            triangles: if self.is_turned { turned } else { triangles }.to_vec(),
            parts: vec![PartDraft {
                triangle_count: 2,
                material: Some(material),
                is_flat: self.is_flat,
            }],
            ..MeshDraft::default()
        }
    }
}

/// One mesh each, drawn in this order.
pub fn draft(quads: &[Quad]) -> Draft {
    Draft {
        meshes: quads
            .iter()
            .enumerate()
            .map(|(index, quad)| quad.mesh(index))
            .collect(),
        materials: quads.iter().map(|quad| quad.material.clone()).collect(),
        ..Draft::default()
    }
}

/// The same on a joint that is scaled so.
pub fn scaled(quads: &[Quad], scale: DVec3) -> Draft {
    let mut draft = draft(quads);
    draft.joints = vec![JointDraft {
        rest_scale: scale,
        ..JointDraft::default()
    }];
    draft.bindings = vec![BindingDraft {
        joint: Some(0),
        file: None,
        bind_pose: BindPose::JointFromBind(DAffine3::IDENTITY),
    }];
    for mesh in &mut draft.meshes {
        mesh.influence_counts = vec![1; 4];
        mesh.influences = vec![(0, 1.0); 4];
    }
    draft
}

/// Seen straight on in even white light, before black.
pub fn scene(size: [u32; 2], samples: Samples) -> Shot {
    let size = Size {
        width: size[0],
        height: size[1],
    };
    let look = LookAt {
        eye: DVec3::new(0.0, 0.0, 10.0),
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov_y: None,
        height: Some(2.0),
        near: Near(None),
    };
    let bounds = Bounds {
        min: DVec3::NEG_ONE,
        max: DVec3::ONE,
    };
    Shot {
        size,
        samples,
        camera: Camera::look_at(look, &bounds, size).expect("a camera"),
        lights: Vec::new(),
        ambient: Color::WHITE,
        surface: Surface::default(),
        background: Background::new([0.0, 0.0, 0.0, 1.0]).expect("black"),
        show: Show::default(),
        cull: Cull::Auto,
    }
}

/// White, travelling so, and nothing beside it.
pub fn lit(mut scene: Shot, direction: DVec3) -> Shot {
    let white = Color::WHITE;
    scene.ambient = Color::constant(0.0, 0.0, 0.0);
    scene.lights = vec![Light::directional(direction, white, 1.0).expect("a light")];
    scene
}

pub fn plan(draft: Draft, scene: Shot) -> Plan {
    let rig = Arc::new(draft.build(&Limits::default()).expect("a rig"));
    let posed = Arc::new(Posed::new(&Pose::rest(&rig)).expect("a pose"));
    scene.plan(posed, Skinning::Linear, 2.0)
}

/// The only one there is.
pub fn image(outputs: Outputs) -> Image {
    let [Raster { size, bytes, .. }] = &outputs.images[..] else {
        panic!("a picture was asked for, and nothing else");
    };
    let size = [size.width, size.height].map(|side| side as usize);
    Image::from_bytes(size, bytes)
}

/// By rigd's own renderer.
pub fn own(plan: &Plan, cores: Cores) -> Image {
    let outputs = Cpu::default().render(plan, Parallelism::uncancelled(cores));
    image(outputs.expect("it is wanted"))
}

/// By wgpu.
pub fn by_gpu(gpu: &mut Gpu, plan: &Plan) -> Image {
    let in_flight = gpu.submit(&[plan]).expect("room");
    let finished = gpu.finish(in_flight).expect("a picture");
    image(finished.outputs.into_iter().next().expect("one picture"))
}
