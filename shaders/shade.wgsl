// Stages 2 and 3, raster and shade, of the skin. In: skinned vertices in model space. Out: premultiplied linear RGBA, one sample or four.
// CPU twins: `render/cpu/raster.rs`, `interpolate.rs`, `texture.rs` and `shade.rs`; the rules stand in `render/plan.rs`.

@group(1) @binding(0) var texture: texture_2d<f32>;
@group(1) @binding(1) var repeated: sampler;

struct Vertex {
    @builtin(position) position_in_clip: vec4<f32>,
    // Where a pixel's middle lies outside the triangle, these are of a place inside: carried on past the silhouette a normal turns
    // away from the eye and catches light from behind.
    @location(0) @interpolate(perspective, centroid) position_in_world: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal_in_world: vec3<f32>,
    // Of the pixel's middle in any case, so that its derivatives are the triangle's slope.
    @location(2) middle_in_world: vec3<f32>,
}

struct TexturedVertex {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) @interpolate(perspective, centroid) position_in_world: vec3<f32>,
    @location(1) @interpolate(perspective, centroid) normal_in_world: vec3<f32>,
    @location(2) middle_in_world: vec3<f32>,
    // Of the pixel's middle as well: its derivatives choose the mipmap.
    @location(3) texcoord: vec2<f32>,
}

@vertex
fn plain_vertex(@location(0) position_in_model: vec3<f32>, @location(1) normal_in_model: vec3<f32>) -> Vertex {
    let position_in_clip = instance.clip_from_model * vec4(position_in_model, 1.0);
    let position_in_world = in_world(position_in_model);
    let normal_in_world = turned_to_world(normal_in_model);
    return Vertex(position_in_clip, position_in_world, normal_in_world, position_in_world);
}

@fragment
fn plain_fragment(vertex: Vertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    return lit(vertex.position_in_world, vertex.normal_in_world, vertex.middle_in_world, is_front, instance.diffuse);
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
    return TexturedVertex(position_in_clip, position_in_world, normal_in_world, position_in_world, texcoord);
}

@fragment
fn textured_fragment(vertex: TexturedVertex, @builtin(front_facing) is_front: bool) -> @location(0) vec4<f32> {
    let diffuse = instance.textured_diffuse * sampled(vertex.texcoord);
    return lit(vertex.position_in_world, vertex.normal_in_world, vertex.middle_in_world, is_front, diffuse);
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

fn lit(p: vec3<f32>, smooth_normal: vec3<f32>, middle: vec3<f32>, is_front: bool, diffuse: vec3<f32>) -> vec4<f32> {
    let back_to_eye = toward_eye(p);
    let n = normal_seen(smooth_normal, middle, is_front, back_to_eye, instance.flat_normals == 1u);
    return vec4(blinn_phong(p, n, back_to_eye, diffuse) * instance.opacity, instance.opacity);
}
