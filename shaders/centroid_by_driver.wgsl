// The place that is shaded where the driver puts it: wgpu's GL backend has no way to read which samples are covered. Mesa's has it at the
// same place as `centroid_by_mask.wgsl`.

struct Rasterized {
    @builtin(front_facing) is_front: bool,
}

// From the pixel's center, in pixels.
fn centroid_offset(rasterized: Rasterized, center: vec4<f32>, driver_centroid_in_clip: vec4<f32>) -> vec2<f32> {
    let half_size = view.size_pixels / 2.0;
    let from_middle = driver_centroid_in_clip.xy / driver_centroid_in_clip.w * half_size;
    return half_size + vec2(from_middle.x, -from_middle.y) - center.xy;
}
