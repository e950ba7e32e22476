// Stages 2 and 3, raster and shade, of skin with a material of its own. In: skinned vertices in model space, texture
// coordinates, vertex colors, the material. Out: premultiplied linear RGBA, one sample or four.
// On the CPU: `render/cpu/raster.rs`, `interpolate.rs`, `texture.rs` and `shade.rs`; the rules stand in `render/plan.rs`.

// Mirrored by `render/material_params.rs`; a test compares every offset.
struct MaterialParams {
    // Linear RGB that is scattered, and opacity: before texture and vertex color.
    color: vec4<f32>,
    specular: vec3<f32>,
    shininess: f32,
    emissive: vec3<f32>,
    // Nothing is there where alpha is less.
    least_alpha: f32,
    // Rows of the affine map from (u, 1 - v, 1) to a place on each picture, from its upper left corner.
    color_place: array<vec4<f32>, 2>,
    emissive_place: array<vec4<f32>, 2>,
    normal_place: array<vec4<f32>, 2>,
    normal_scale: f32,
    // 1: alpha lets through what is behind.
    is_translucent: u32,
    // 0: shown as it is, whatever light falls on it.
    is_lit: u32,
    // 1: lit by each triangle's own normal.
    is_flat: u32,
}

// Samplers know what lies beyond a picture's edges.
@group(1) @binding(0) var color_picture: texture_2d<f32>;
@group(1) @binding(1) var color_sampler: sampler;
@group(1) @binding(2) var emissive_picture: texture_2d<f32>;
@group(1) @binding(3) var emissive_sampler: sampler;
@group(1) @binding(4) var normal_picture: texture_2d<f32>;
@group(1) @binding(5) var normal_sampler: sampler;
@group(2) @binding(0) var<uniform> material: MaterialParams;

struct Vertex {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) position_in_world: vec3<f32>,
    @location(1) normal_in_world: vec3<f32>,
    // The w of the clip space.
    @location(2) w: f32,
    @location(3) @interpolate(perspective, centroid) driver_centroid_in_clip: vec4<f32>,
    @location(4) texcoord: vec2<f32>,
    @location(5) color: vec4<f32>,
}

@vertex
fn material_vertex(
    @location(0) position_in_model: vec3<f32>,
    @location(1) normal_in_model: vec3<f32>,
    @location(2) texcoord: vec2<f32>,
    @location(3) color: vec4<f32>,
) -> Vertex {
    let position_in_clip = instance.clip_from_model * vec4(position_in_model, 1.0);
    let position_in_world = in_world(position_in_model);
    let normal_in_world = turned_to_world(normal_in_model);
    return Vertex(position_in_clip, position_in_world, normal_in_world, position_in_clip.w, position_in_clip, texcoord, color);
}

@fragment
fn material_fragment(vertex: Vertex, rasterized: Rasterized) -> @location(0) vec4<f32> {
    // The picture's rows run from the top, v from the bottom.
    let from_above = vec3(vertex.texcoord.x, 1.0 - vertex.texcoord.y, 1.0);
    let texel = sampled(color_picture, color_sampler, place(material.color_place, from_above));
    let shaded = place_of(rasterized, vertex.position_in_clip, vertex.driver_centroid_in_clip, vertex.w);
    let vertex_color = at_place(vertex.color.rgb, shaded);
    let diffuse = material.color.rgb * texel.rgb * clamp(vertex_color, vec3(0.0), vec3(1.0));
    // Of the pixel's center, like the texture's: a mask takes all samples of a pixel or none.
    let alpha = material.color.a * texel.a * clamp(vertex.color.a, 0.0, 1.0);

    // All that is asked below is the same for every pixel of a draw, as derivatives need it; only then are pixels left out.
    var color = diffuse;
    if material.is_lit == 1u {
        let p = at_place(vertex.position_in_world, shaded);
        let smooth_normal = at_place(vertex.normal_in_world, shaded);
        let back_to_eye = toward_eye(p);
        let is_flat = (material.is_flat | instance.flat_normals) == 1u;
        var n = normal_seen(smooth_normal, vertex.position_in_world, rasterized.is_front, back_to_eye, is_flat);
        if material.normal_scale != 0.0 && instance.flat_normals == 0u {
            n = mapped(n, vertex.position_in_world, place(material.normal_place, from_above));
        }
        color = reflected(p, n, back_to_eye, diffuse, material.specular, material.shininess);
        if any(material.emissive != vec3(0.0)) {
            let given_off = sampled(emissive_picture, emissive_sampler, place(material.emissive_place, from_above));
            color += material.emissive * given_off.rgb;
        }
    }
    if alpha < material.least_alpha {
        discard;
    }
    let opacity = instance.opacity * select(1.0, clamp(alpha, 0.0, 1.0), material.is_translucent == 1u);
    return vec4(clamp(color, vec3(0.0), vec3(1.0)) * opacity, opacity);
}

fn place(rows: array<vec4<f32>, 2>, from_above: vec3<f32>) -> vec2<f32> {
    return vec2(dot(rows[0].xyz, from_above), dot(rows[1].xyz, from_above));
}

// The level of detail is worked out here and its two neighbours are mixed here, as in `shade.wgsl`. To be called in uniform control flow.
fn sampled(picture: texture_2d<f32>, edges: sampler, place: vec2<f32>) -> vec4<f32> {
    let texels = vec2<f32>(textureDimensions(picture));
    let by_x = dpdxFine(place) * texels;
    let by_y = dpdyFine(place) * texels;
    let texels_squared = max(max(dot(by_x, by_x), dot(by_y, by_y)), 1.0);
    let level = min(0.5 * log2(texels_squared), f32(textureNumLevels(picture) - 1u));
    let lower = floor(level);
    let nearer = textureSampleLevel(picture, edges, place, lower);
    let further = textureSampleLevel(picture, edges, place, lower + 1.0);
    return mix(nearer, further, level - lower);
}

// Leans `n` as the normal map says. The map's own directions are found from how the surface and the place on the map both move from pixel
// to pixel: that is the same all over a triangle, whatever the perspective. To be called in uniform control flow.
fn mapped(n: vec3<f32>, middle: vec3<f32>, place: vec2<f32>) -> vec3<f32> {
    let texel = sampled(normal_picture, normal_sampler, place);
    let m = (2.0 * texel.xyz - 1.0) * vec3(material.normal_scale, material.normal_scale, 1.0);
    let p_by_x = dpdxFine(middle);
    let p_by_y = dpdyFine(middle);
    let by_x = dpdxFine(place);
    let by_y = dpdyFine(place);
    // Twice the area that a pixel takes up on the map, negative where the map is seen mirrored.
    let area = by_x.x * by_y.y - by_y.x * by_x.y;
    // A place that does not move over the triangle still trembles by some steps of float32.
    let tremble = 1e-6 * max(abs(place.x), abs(place.y)) * max(max(abs(by_x.x), abs(by_x.y)), max(abs(by_y.x), abs(by_y.y)));
    if !(abs(area) > tremble) {
        return n;
    }
    let way = sign(area);
    let right = way * (p_by_x * by_y.y - p_by_y * by_x.y);
    // A place's second number grows downward.
    let up = way * (p_by_x * by_y.x - p_by_y * by_x.x);
    return unit_normal(m.x * along(right, n) + m.y * along(up, n) + m.z * n, n);
}

// The unit vector across `n` that `direction` leans to.
fn along(direction: vec3<f32>, n: vec3<f32>) -> vec3<f32> {
    let across = direction - n * dot(n, direction);
    return across * select(0.0, inverseSqrt(dot(across, across)), dot(across, across) > 0.0);
}
