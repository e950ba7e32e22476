// The lighting equation, Blinn-Phong; it stands in words in `render/plan.rs`. For every stage that draws lit surfaces.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> instance: InstanceParams;

fn in_world(position_in_model: vec3<f32>) -> vec3<f32> {
    let p = vec4(position_in_model, 1.0);
    let rows = instance.world_from_model;
    return vec3(dot(rows[0], p), dot(rows[1], p), dot(rows[2], p));
}

// Of any length.
fn turned_to_world(normal_in_model: vec3<f32>) -> vec3<f32> {
    let rows = instance.world_from_model_normal;
    return vec3(dot(rows[0].xyz, normal_in_model), dot(rows[1].xyz, normal_in_model), dot(rows[2].xyz, normal_in_model));
}

fn toward_eye(p: vec3<f32>) -> vec3<f32> {
    return normalize(view.eye_in_world.xyz - p * view.eye_in_world.w);
}

// Of a normal of any length; a surface without one faces the eye.
fn unit_normal(n: vec3<f32>, back_to_eye: vec3<f32>) -> vec3<f32> {
    let length_squared = dot(n, n);
    return select(back_to_eye, n * inverseSqrt(length_squared), length_squared > 0.0);
}

// The unit normal that a surface is lit by, turned toward the side that is seen. `middle` is the pixel's own, so that its derivatives are
// the triangle's slope. To be called in uniform control flow.
fn normal_seen(
    smooth_normal: vec3<f32>,
    middle: vec3<f32>,
    is_front: bool,
    back_to_eye: vec3<f32>,
    is_flat: bool,
) -> vec3<f32> {
    // Both ways of finding out which side is seen are turned toward the eye, so that skin turned inside out is lit as well.
    var n = smooth_normal;
    // Derivatives need uniform control flow, so the flat normal is found in any case.
    let flat_normal = cross(dpdx(middle), dpdy(middle));
    if is_flat {
        n = select(flat_normal, -flat_normal, dot(flat_normal, back_to_eye) < 0.0);
    } else if !is_front {
        n = -n;
    }
    return unit_normal(n, back_to_eye);
}

// Of the instance's own surface, which gives off nothing by itself.
fn blinn_phong(p: vec3<f32>, n: vec3<f32>, back_to_eye: vec3<f32>, diffuse: vec3<f32>) -> vec3<f32> {
    return clamp(reflected(p, n, back_to_eye, diffuse, instance.specular, instance.shininess), vec3(0.0), vec3(1.0));
}

// Not clamped.
fn reflected(
    p: vec3<f32>,
    n: vec3<f32>,
    back_to_eye: vec3<f32>,
    diffuse: vec3<f32>,
    specular: vec3<f32>,
    shininess: f32,
) -> vec3<f32> {
    var color = view.ambient * diffuse;
    for (var i = 0u; i < LIGHTS; i++) {
        let light = view.lights[i];
        if light.toward_or_position.w > 1.0 {
            break;
        }
        let to_light = light.toward_or_position.xyz - p * light.toward_or_position.w;
        let distance_squared = dot(to_light, to_light);
        // A point that the light itself sits on is lit from nowhere.
        let l = to_light * select(0.0, inverseSqrt(distance_squared), distance_squared > 0.0);
        let n_dot_l = dot(n, l);
        if n_dot_l > 0.0 {
            let falloff = select(1.0, max(distance_squared, instance.least_distance_squared), light.radiance.w == 1.0);
            let inside = clamp(dot(l, light.cone.xyz) + light.cone.w, 0.0, 1.0);
            let halfway = l + back_to_eye;
            let halfway_squared = dot(halfway, halfway);
            let h = halfway * select(0.0, inverseSqrt(halfway_squared), halfway_squared > 0.0);
            let n_dot_h = max(dot(n, h), 0.0);
            // pow(0, 0) is undefined in WGSL; an exponent of 0 means 1 everywhere.
            let highlight = select(pow(n_dot_h, shininess), 1.0, shininess == 0.0);
            color += light.radiance.rgb / falloff * (inside * inside) * (diffuse * n_dot_l + specular * highlight);
        }
    }
    return color;
}
