// Stages 2 and 3, raster and shade, of the skin. In: skinned vertices in model space. Out: premultiplied linear RGBA, one sample or four.
// On the CPU: `render/cpu/raster.rs`, `interpolate.rs`, `texture.rs` and `shade.rs`; the rules stand in `render/plan.rs`.

@group(1) @binding(0) var texture: texture_2d<f32>;
@group(1) @binding(1) var repeated: sampler;

struct Vertex {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) position_in_world: vec3<f32>,
    @location(1) normal_in_world: vec3<f32>,
    // The w of the clip space.
    @location(2) w: f32,
    @location(3) @interpolate(perspective, centroid) driver_centroid_in_clip: vec4<f32>,
}

struct TexturedVertex {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) position_in_world: vec3<f32>,
    @location(1) normal_in_world: vec3<f32>,
    @location(2) w: f32,
    @location(3) @interpolate(perspective, centroid) driver_centroid_in_clip: vec4<f32>,
    // Of the pixel's center in any case: its derivatives choose the mipmap.
    @location(4) texcoord: vec2<f32>,
}

@vertex
fn plain_vertex(@location(0) position_in_model: vec3<f32>, @location(1) normal_in_model: vec3<f32>) -> Vertex {
    let position_in_clip = instance.clip_from_model * vec4(position_in_model, 1.0);
    let position_in_world = in_world(position_in_model);
    let normal_in_world = turned_to_world(normal_in_model);
    return Vertex(position_in_clip, position_in_world, normal_in_world, position_in_clip.w, position_in_clip);
}

@fragment
fn plain_fragment(vertex: Vertex, rasterized: Rasterized) -> @location(0) vec4<f32> {
    return lit(vertex, rasterized, instance.diffuse);
}

@vertex
fn textured_vertex(
    @location(0) position_in_model: vec3<f32>,
    @location(1) normal_in_model: vec3<f32>,
    @location(2) texcoord: vec2<f32>,
) -> TexturedVertex {
    let position_in_clip = instance.clip_from_model * vec4(position_in_model, 1.0);
    let position_in_world = in_world(position_in_model);
    let normal_in_world = turned_to_world(normal_in_model);
    return TexturedVertex(position_in_clip, position_in_world, normal_in_world, position_in_clip.w, position_in_clip, texcoord);
}

@fragment
fn textured_fragment(vertex: TexturedVertex, rasterized: Rasterized) -> @location(0) vec4<f32> {
    let diffuse = instance.textured_diffuse * sampled(vertex.texcoord);
    let untextured = Vertex(
        vertex.position_in_clip,
        vertex.position_in_world,
        vertex.normal_in_world,
        vertex.w,
        vertex.driver_centroid_in_clip,
    );
    return lit(untextured, rasterized, diffuse);
}

// The level of detail is worked out here and its two neighbours are mixed here: drivers have formulas of their own for both.
fn sampled(texcoord: vec2<f32>) -> vec3<f32> {
    let texels = vec2<f32>(textureDimensions(texture));
    let by_x = dpdxFine(texcoord) * texels;
    let by_y = dpdyFine(texcoord) * texels;
    let texels_squared = max(max(dot(by_x, by_x), dot(by_y, by_y)), 1.0);
    let level = min(0.5 * log2(texels_squared), f32(textureNumLevels(texture) - 1u));
    let lower = floor(level);
    // The picture's rows run from the top, its v from the bottom.
    let place = vec2(texcoord.x, 1.0 - texcoord.y);
    let nearer = textureSampleLevel(texture, repeated, place, lower).rgb;
    let further = textureSampleLevel(texture, repeated, place, lower + 1.0).rgb;
    return mix(nearer, further, level - lower);
}

fn lit(vertex: Vertex, rasterized: Rasterized, diffuse: vec3<f32>) -> vec4<f32> {
    let place = place_of(rasterized, vertex.position_in_clip, vertex.driver_centroid_in_clip, vertex.w);
    let p = at_place(vertex.position_in_world, place);
    let smooth_normal = at_place(vertex.normal_in_world, place);
    let back_to_eye = toward_eye(p);
    let is_flat = instance.flat_normals == 1u;
    let n = normal_seen(smooth_normal, vertex.position_in_world, rasterized.is_front, back_to_eye, is_flat);
    return vec4(blinn_phong(p, n, back_to_eye, diffuse) * instance.opacity, instance.opacity);
}
