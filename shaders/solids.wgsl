// Solids of a skeleton's view. In: their corners in model space. Out: lit linear RGB, opaque. Made by `render/solids.rs`.

struct Vertex {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) @interpolate(perspective, centroid) position_in_world: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal_in_world: vec3<f32>,
    @location(2) @interpolate(flat) color: vec3<f32>,
}

@vertex
fn solid_vertex(
    @location(0) position_in_model: vec3<f32>,
    @location(1) normal_in_model: vec3<f32>,
    @location(2) color: vec3<f32>,
) -> Vertex {
    let position_in_clip = instance.clip_from_model * vec4(position_in_model, 1.0);
    return Vertex(position_in_clip, in_world(position_in_model), turned_to_world(normal_in_model), color);
}

@fragment
fn solid_fragment(vertex: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    let p = vertex.position_in_world;
    let back_to_eye = toward_eye(p);
    // Seen from inside, as skin is.
    let toward_us = select(-vertex.normal_in_world, vertex.normal_in_world, is_front);
    let n = unit_normal(toward_us, back_to_eye);
    return vec4(blinn_phong(p, n, back_to_eye, vertex.color), 1.0);
}
