// Stage 1, skin. In: bind-space vertices of all meshes of a rig, their morph targets and influences, the weights, the palette. Out:
// positions and normals in model space, of as many vertices in a row as the job says, whichever meshes they are of. Joined with `skin_linear.wgsl` or `skin_dual_quaternion.wgsl`, which know how a palette is blended.
// On the CPU: `render/cpu/skin.rs`.

struct SkinJob {
    // Of the rig's vertices, one mesh after another.
    first_vertex: u32,
    vertex_count: u32,
    // Of the whole rig.
    rig_vertex_count: u32,
    // Index of the job's first row in `palette`, and of its first weight in `morph_weights`.
    first_row: u32,
    first_morph_weight: u32,
    // Indices in `skinned` of the first floats that the job writes.
    positions_start: u32,
    normals_start: u32,
}

struct Influence {
    binding: u32,
    weight: f32,
}

// Plain floats, as vectors would be padded.
struct MorphDisplacement {
    morph: u32,
    position: array<f32, 3>,
    normal: array<f32, 3>,
}

struct Vertex {
    position: vec3<f32>,
    // Unit length.
    normal: vec3<f32>,
}

@group(0) @binding(0) var<uniform> job: SkinJob;
// Rows of every job's palette, so many to a binding as the way of blending needs.
@group(0) @binding(1) var<storage, read> palette: array<vec4<f32>>;
@group(0) @binding(2) var<storage, read> morph_weights: array<f32>;
// Three floats a position, then three floats a normal: tightly packed, so that queries copy them and draws read them in place.
@group(0) @binding(3) var<storage, read_write> skinned: array<f32>;

// Three floats a position of every vertex of the rig, then three floats a normal of every vertex.
@group(1) @binding(0) var<storage, read> bind_vertices: array<f32>;
// Where those of each vertex start, and where the last one's end.
@group(1) @binding(1) var<storage, read> influence_starts: array<u32>;
@group(1) @binding(2) var<storage, read> influences: array<Influence>;
@group(1) @binding(3) var<storage, read> morph_starts: array<u32>;
@group(1) @binding(4) var<storage, read> morph_displacements: array<MorphDisplacement>;

@compute @workgroup_size(WORKGROUP)
fn skin(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    // Large rigs wrap into a second row of workgroups: one dimension ends at 65,535.
    let place = id.y * groups.x * WORKGROUP + id.x;
    if place >= job.vertex_count {
        return;
    }
    let vertex = job.first_vertex + place;
    let posed = follow(vertex, morphed(vertex));
    store_vector(job.positions_start + 3u * place, posed.position);
    store_vector(job.normals_start + 3u * place, posed.normal);
}

// The vertex in bind space.
fn morphed(vertex: u32) -> Vertex {
    let position = bind_vector(3u * vertex);
    let normal = bind_vector(3u * (job.rig_vertex_count + vertex));
    var moved = position;
    var turned = normal;
    for (var i = morph_starts[vertex]; i < morph_starts[vertex + 1u]; i++) {
        let weight = morph_weights[job.first_morph_weight + morph_displacements[i].morph];
        moved += weight * vector(morph_displacements[i].position);
        turned += weight * vector(morph_displacements[i].normal);
    }
    return Vertex(moved, unit_or(turned, normal));
}

fn vector(numbers: array<f32, 3>) -> vec3<f32> {
    return vec3(numbers[0], numbers[1], numbers[2]);
}

fn bind_vector(first: u32) -> vec3<f32> {
    return vec3(bind_vertices[first], bind_vertices[first + 1u], bind_vertices[first + 2u]);
}

fn store_vector(first: u32, vector: vec3<f32>) {
    skinned[first] = vector.x;
    skinned[first + 1u] = vector.y;
    skinned[first + 2u] = vector.z;
}

// By the cofactors of the matrix with these rows: right under any scale, and turned over with the winding where the matrix mirrors.
fn cofactor_transform(x: vec3<f32>, y: vec3<f32>, z: vec3<f32>, normal: vec3<f32>) -> vec3<f32> {
    let a = vec3(x.x, y.x, z.x);
    let b = vec3(x.y, y.y, z.y);
    let c = vec3(x.z, y.z, z.z);
    return mat3x3(cross(b, c), cross(c, a), cross(a, b)) * normal;
}

fn unit_or(v: vec3<f32>, otherwise: vec3<f32>) -> vec3<f32> {
    let length_squared = dot(v, v);
    // Also false for a NaN.
    if length_squared > 0.0 {
        return v * inverseSqrt(length_squared);
    }
    return otherwise;
}
