// Stages 2 and 3, raster and shade. In: skinned vertices in world space. Out: premultiplied linear RGBA, one sample or four.
// CPU twin: to come with `render/cpu`'s drawing; the lighting equation stands in `render/plan.rs`.

@group(0) @binding(0) var<uniform> view: View;

struct Vertex {
    @builtin(position) position_in_clip: vec4<f32>,
    // Where a pixel's middle lies outside the triangle, these are of a place inside: carried on past the silhouette a normal turns
    // away from the eye and catches light from behind.
    @location(0) @interpolate(perspective, centroid) position_in_world: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal_in_world: vec3<f32>,
    // Of the pixel's middle in any case, so that its derivatives are the triangle's slope.
    @location(2) middle_in_world: vec3<f32>,
}

@vertex
fn skin_vertex(@location(0) position_in_world: vec3<f32>, @location(1) normal_in_world: vec3<f32>) -> Vertex {
    let position_in_clip = view.clip_from_world * vec4(position_in_world, 1.0);
    return Vertex(position_in_clip, position_in_world, normal_in_world, position_in_world);
}

@fragment
fn skin_fragment(vertex: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    let p = vertex.position_in_world;
    // Both ways of finding out which side is seen are turned toward the eye, so that skin turned inside out is lit as well.
    let back_to_eye = normalize(view.eye_in_world.xyz - p * view.eye_in_world.w);
    var n = vertex.normal_in_world;
    // Derivatives need uniform control flow, so the flat normal is found in any case.
    let flat_normal = cross(dpdx(vertex.middle_in_world), dpdy(vertex.middle_in_world));
    if view.flat_normals == 1u {
        n = select(flat_normal, -flat_normal, dot(flat_normal, back_to_eye) < 0.0);
    } else if !is_front {
        n = -n;
    }
    let length_squared = dot(n, n);
    n = select(back_to_eye, n * inverseSqrt(length_squared), length_squared > 0.0);
    return vec4(blinn_phong(p, n, back_to_eye) * view.opacity, view.opacity);
}

fn blinn_phong(p: vec3<f32>, n: vec3<f32>, back_to_eye: vec3<f32>) -> vec3<f32> {
    var color = view.ambient * view.diffuse;
    for (var i = 0u; i < view.light_count; i++) {
        let light = view.lights[i];
        let to_light = light.toward_or_position.xyz - p * light.toward_or_position.w;
        let distance_squared = dot(to_light, to_light);
        // A point that the light itself sits on is lit from nowhere.
        let l = to_light * select(0.0, inverseSqrt(distance_squared), distance_squared > 0.0);
        let n_dot_l = dot(n, l);
        if n_dot_l > 0.0 {
            let falloff = select(1.0, max(distance_squared, view.least_distance_squared), light.radiance.w == 1.0);
            let halfway = l + back_to_eye;
            let halfway_squared = dot(halfway, halfway);
            let h = halfway * select(0.0, inverseSqrt(halfway_squared), halfway_squared > 0.0);
            let n_dot_h = max(dot(n, h), 0.0);
            // pow(0, 0) is undefined in WGSL; an exponent of 0 means 1 everywhere.
            let highlight = select(pow(n_dot_h, view.shininess), 1.0, view.shininess == 0.0);
            color += light.radiance.rgb / falloff * (view.diffuse * n_dot_l + view.specular * highlight);
        }
    }
    return clamp(color, vec3(0.0), vec3(1.0));
}
