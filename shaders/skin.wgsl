// Stage 1, skin. In: bind-space vertices of one mesh, their influences, the palette. Out: positions and normals in world space.
// CPU twin: `render/cpu/skin.rs`.

struct SkinJob {
    vertex_count: u32,
    // Index of the job's first matrix in the palette.
    first_matrix: u32,
    // Indices of the job's first float in `skinned`.
    positions_start: u32,
    normals_start: u32,
}

struct SkinMatrix {
    rows: array<vec4<f32>, 3>,
}

struct Influence {
    binding: u32,
    weight: f32,
}

@group(0) @binding(0) var<uniform> job: SkinJob;
@group(0) @binding(1) var<storage, read> palette: array<SkinMatrix>;
// Three floats a position, then three floats a normal: tightly packed, so that queries copy them and draws read them in place.
@group(0) @binding(2) var<storage, read_write> skinned: array<f32>;

// Three floats a position of every vertex, then three floats a normal of every vertex.
@group(1) @binding(0) var<storage, read> bind_vertices: array<f32>;
@group(1) @binding(1) var<storage, read> influence_starts: array<u32>;
@group(1) @binding(2) var<storage, read> influences: array<Influence>;

fn bind_vector(first: u32) -> vec3<f32> {
    return vec3(bind_vertices[first], bind_vertices[first + 1u], bind_vertices[first + 2u]);
}

fn store_vector(first: u32, vector: vec3<f32>) {
    skinned[first] = vector.x;
    skinned[first + 1u] = vector.y;
    skinned[first + 2u] = vector.z;
}

@compute @workgroup_size(WORKGROUP)
fn skin(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    // Large meshes wrap into a second row of workgroups: one dimension ends at 65,535.
    let vertex = id.y * groups.x * WORKGROUP + id.x;
    if vertex >= job.vertex_count {
        return;
    }
    var x = vec4<f32>(0.0);
    var y = vec4<f32>(0.0);
    var z = vec4<f32>(0.0);
    for (var i = influence_starts[vertex]; i < influence_starts[vertex + 1u]; i++) {
        let influence = influences[i];
        let matrix = job.first_matrix + influence.binding;
        x += palette[matrix].rows[0] * influence.weight;
        y += palette[matrix].rows[1] * influence.weight;
        z += palette[matrix].rows[2] * influence.weight;
    }
    let position_in_bind = vec4(bind_vector(3u * vertex), 1.0);
    let position_in_world = vec3(dot(x, position_in_bind), dot(y, position_in_bind), dot(z, position_in_bind));

    let normal_in_bind = bind_vector(3u * (job.vertex_count + vertex));
    let a = vec3(x.x, y.x, z.x);
    let b = vec3(x.y, y.y, z.y);
    let c = vec3(x.z, y.z, z.z);
    let cofactor = mat3x3(cross(b, c), cross(c, a), cross(a, b));
    var normal_in_world = cofactor * normal_in_bind;
    let length_squared = dot(normal_in_world, normal_in_world);
    // Also false for a NaN: the bind normal then stands in.
    if length_squared > 0.0 {
        normal_in_world *= inverseSqrt(length_squared);
    } else {
        normal_in_world = normal_in_bind;
    }
    store_vector(job.positions_start + 3u * vertex, position_in_world);
    store_vector(job.normals_start + 3u * vertex, normal_in_world);
}
