// The place in a pixel at which a triangle is shaded: its center, or the triangle's centroid in it. `centroid_by_mask.wgsl` has
// `centroid_offset`. On the CPU: `render/cpu/gather.rs`; the rule stands in `render/plan.rs`.
// Each driver has a centroid of its own, so that attributes are interpolated at the center and moved from there.

struct Place {
    // From the pixel's center, in pixels.
    offset: vec2<f32>,
    // At the center, and how it changes from pixel to pixel.
    inverse_w: f32,
    inverse_w_by_x: f32,
    inverse_w_by_y: f32,
}

// `center` and `driver_centroid_in_clip` are what the rasterizer gives of the position, `w` is that of the clip space, at the center. To be
// called in uniform control flow.
fn place_of(rasterized: Rasterized, center: vec4<f32>, driver_centroid_in_clip: vec4<f32>, w: f32) -> Place {
    let inverse_w = 1.0 / w;
    let offset = centroid_offset(rasterized, center, driver_centroid_in_clip);
    return Place(offset, inverse_w, dpdxFine(inverse_w), dpdyFine(inverse_w));
}

// An attribute at the place, of its value at the center: over w it is linear over the picture. To be called in uniform control flow.
fn at_place(value: vec3<f32>, place: Place) -> vec3<f32> {
    let over_w = value * place.inverse_w;
    let over_w_there = over_w + dpdxFine(over_w) * place.offset.x + dpdyFine(over_w) * place.offset.y;
    let inverse_w_there = place.inverse_w + place.inverse_w_by_x * place.offset.x + place.inverse_w_by_y * place.offset.y;
    let there = over_w_there / inverse_w_there;
    // The triangle's plane may reach that of the eye at the next pixel: then nothing is known of the slope.
    return select(value, there, abs(there) <= vec3(3e38));
}
