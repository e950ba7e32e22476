// What several stages share. Joined before each stage's own file.

// Threads of one compute workgroup along its only dimension.
const WORKGROUP: u32 = 64u;

// Of a picture at the most.
const LIGHTS: u32 = 16u;

// Mirrored by `render/view.rs`; a test compares every offset.
struct View {
    // The eye's position (w = 1), or the direction back to it where it is infinitely far (w = 0).
    eye_in_world: vec4<f32>,
    ambient: vec3<f32>,
    size_pixels: vec2<f32>,
    lights: array<Light, LIGHTS>,
}

// Mirrored by `render/instance_params.rs`; a test compares every offset.
struct InstanceParams {
    clip_from_model: mat4x4<f32>,
    // Rows of the affine map.
    world_from_model: array<vec4<f32>, 3>,
    // Rows of the map of normals; the fourth numbers are 0.
    world_from_model_normal: array<vec4<f32>, 3>,
    diffuse: vec3<f32>,
    opacity: f32,
    specular: vec3<f32>,
    shininess: f32,
    // What textures are multiplied by.
    textured_diffuse: vec3<f32>,
    // 1: light each triangle by its own normal.
    flat_normals: u32,
    // Smallest squared distance that an inverse-square light is divided by.
    least_distance_squared: f32,
}

struct Light {
    // Directional (w = 0): unit vector toward the light. Point (w = 1): its position in world space. Behind the last light (w = 2): nothing.
    toward_or_position: vec4<f32>,
    // Linear RGB; w = 1 divides by the squared distance.
    radiance: vec4<f32>,
    // Of the unit vector l toward the light, the square of clamp(dot(l, xyz) + w, 0, 1) is what of it gets there: 1 everywhere but around a
    // spot light.
    cone: vec4<f32>,
}
