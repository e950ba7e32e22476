// Solids of a skeleton's view. In: their corners in model space. Out: lit linear RGB, opaque. Made by `render/solids.rs`.

struct Vertex {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) position_in_world: vec3<f32>,
    @location(1) normal_in_world: vec3<f32>,
    // The w of the clip space.
    @location(2) w: f32,
    @location(3) @interpolate(perspective, centroid) driver_centroid_in_clip: vec4<f32>,
    @location(4) @interpolate(flat) color: vec3<f32>,
}

@vertex
fn solid_vertex(
    @location(0) position_in_model: vec3<f32>,
    @location(1) normal_in_model: vec3<f32>,
    @location(2) color: vec3<f32>,
) -> Vertex {
    let position_in_clip = instance.clip_from_model * vec4(position_in_model, 1.0);
    let position_in_world = in_world(position_in_model);
    let normal_in_world = turned_to_world(normal_in_model);
    return Vertex(position_in_clip, position_in_world, normal_in_world, position_in_clip.w, position_in_clip, color);
}

@fragment
fn solid_fragment(vertex: Vertex, rasterized: Rasterized) -> @location(0) vec4<f32> {
    let place = place_of(rasterized, vertex.position_in_clip, vertex.driver_centroid_in_clip, vertex.w);
    let p = at_place(vertex.position_in_world, place);
    let smooth_normal = at_place(vertex.normal_in_world, place);
    let back_to_eye = toward_eye(p);
    // Seen from inside, as skin is.
    let toward_us = select(-smooth_normal, smooth_normal, rasterized.is_front);
    let n = unit_normal(toward_us, back_to_eye);
    return vec4(blinn_phong(p, n, back_to_eye, vertex.color), 1.0);
}
