// What several stages share. Joined before each stage's own file.

// Threads of one compute workgroup along its only dimension.
const WORKGROUP: u32 = 64u;

// Mirrored by `gpu/layout.rs`; a test compares every offset.
struct View {
    clip_from_world: mat4x4<f32>,
    // The eye's position (w = 1), or the direction back to it where it is infinitely far (w = 0).
    eye_in_world: vec4<f32>,
    size_pixels: vec2<f32>,
    light_count: u32,
    // 1: light each triangle by its own normal.
    flat_normals: u32,
    ambient: vec3<f32>,
    shininess: f32,
    diffuse: vec3<f32>,
    opacity: f32,
    specular: vec3<f32>,
    // Smallest squared distance that an inverse-square light is divided by.
    least_distance_squared: f32,
    // What textures are multiplied by.
    textured_diffuse: vec3<f32>,
    lights: array<Light, 16>,
}

struct Light {
    // Directional (w = 0): unit vector toward the light. Point (w = 1): its position in world space.
    toward_or_position: vec4<f32>,
    // Linear RGB; w = 1 divides by the squared distance.
    radiance: vec4<f32>,
    // Of the unit vector l toward the light, the square of clamp(dot(l, xyz) + w, 0, 1) is what of it gets there: 1 everywhere but around a
    // spot light.
    cone: vec4<f32>,
}
