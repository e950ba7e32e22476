// Stage 5, resolve. In: one layer or two of premultiplied linear color, samples averaged. Out: one packed RGBA8 word a pixel, sRGB,
// straight alpha, rows without padding.

struct ResolveJob {
    width: u32,
    height: u32,
    // 2: the skin's layer lies over the base.
    layers: u32,
}

@group(0) @binding(0) var<uniform> job: ResolveJob;
@group(0) @binding(1) var base_layer: texture_2d<f32>;
@group(0) @binding(2) var skin_layer: texture_2d<f32>;
@group(0) @binding(3) var<storage, read_write> pixels: array<u32>;

@compute @workgroup_size(WORKGROUP)
fn resolve(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= job.width {
        return;
    }
    // No branch: Mesa's software driver (22.3) compiles a shader that branches on a uniform anew for each dispatch, and keeps every one.
    let base = textureLoad(base_layer, id.xy, 0);
    let skin = select(vec4(0.0), textureLoad(skin_layer, id.xy, 0), job.layers == 2u);
    let color = skin + base * (1.0 - skin.a);
    let straight = select(vec3(0.0), color.rgb / max(color.a, 1e-6), color.a > 0.0);
    let encoded = vec4(srgb(clamp(straight, vec3(0.0), vec3(1.0))), clamp(color.a, 0.0, 1.0));
    pixels[id.y * job.width + id.x] = pack4x8unorm(encoded);
}

// IEC 61966-2-1.
fn srgb(linear: vec3<f32>) -> vec3<f32> {
    let curved = 1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055;
    return select(curved, linear * 12.92, linear <= vec3(0.0031308));
}
