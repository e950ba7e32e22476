// Solids of a skeleton's view: a unit shape, once for each instance. In: the shape's vertices, and where an instance stands. Out: lit
// linear RGB, opaque. The shapes and their places: `render/solids.rs`, `render/skeleton.rs`.

struct Vertex {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) @interpolate(perspective, centroid) position_in_world: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal_in_world: vec3<f32>,
    @location(2) @interpolate(flat) color: vec3<f32>,
}

@vertex
fn solid_vertex(
    @location(0) position_in_shape: vec3<f32>,
    @location(1) normal_in_shape: vec3<f32>,
    @location(2) x: vec4<f32>,
    @location(3) y: vec4<f32>,
    @location(4) z: vec4<f32>,
    @location(5) color: vec4<f32>,
) -> Vertex {
    let p = vec4(position_in_shape, 1.0);
    let position_in_world = vec3(dot(x, p), dot(y, p), dot(z, p));
    // The cofactors' matrix, as in `skin.wgsl`: shapes are stretched.
    let a = vec3(x.x, y.x, z.x);
    let b = vec3(x.y, y.y, z.y);
    let c = vec3(x.z, y.z, z.z);
    let normal_in_world = mat3x3(cross(b, c), cross(c, a), cross(a, b)) * normal_in_shape;
    return Vertex(view.clip_from_world * vec4(position_in_world, 1.0), position_in_world, scaled(normal_in_world), color.rgb);
}

// Normals of a small shape are far shorter than 1, and get shorter where they are interpolated: here they keep digits to spare.
fn scaled(v: vec3<f32>) -> vec3<f32> {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    return v / max(largest, 1e-38);
}

@fragment
fn solid_fragment(vertex: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    let p = vertex.position_in_world;
    let back_to_eye = normalize(view.eye_in_world.xyz - p * view.eye_in_world.w);
    // Seen from inside, as skin is.
    var n = select(-vertex.normal_in_world, vertex.normal_in_world, is_front);
    let length_squared = dot(n, n);
    n = select(back_to_eye, n * inverseSqrt(length_squared), length_squared > 0.0);
    return vec4(blinn_phong(p, n, back_to_eye, vertex.color), 1.0);
}
