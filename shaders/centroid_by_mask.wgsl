// The place that is shaded by the samples that are covered, as `render/plan.rs` has it.

// Of a pixel.
override SAMPLES: u32 = 1u;

// What the rasterizer says of a fragment.
struct Rasterized {
    @builtin(front_facing) is_front: bool,
    // A bit for each sample of the pixel.
    @builtin(sample_mask) covered: u32,
}

// From the pixel's center, in pixels.
fn centroid_offset(rasterized: Rasterized, center: vec4<f32>, driver_centroid_in_clip: vec4<f32>) -> vec2<f32> {
    if SAMPLES == 1u || rasterized.covered == 15u {
        return vec2(0.0);
    }
    // Helper invocations cover none.
    let first = countTrailingZeros(rasterized.covered | 8u);
    // Vulkan's and Direct3D's standard positions, in eighths from the pixel's upper left corner: (3, 1) (7, 3) (1, 5) (5, 7).
    let eighths = vec2((0x5173u >> (4u * first)) & 15u, 2u * first + 1u);
    return vec2<f32>(eighths) / 8.0 - 0.5;
}
