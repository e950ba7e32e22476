// Lines of constant width in pixels, drawn as quads: native lines differ between drivers. In: each segment six times, in model space.
// Out: its flat color.

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> instance: InstanceParams;

struct Corner {
    @builtin(position) position_in_clip: vec4<f32>,
    @location(0) color: vec3<f32>,
}

// Where a line is cut so that its pixels are defined: a little before the eye's own plane.
const LEAST_W: f32 = 1e-6;

@vertex
fn line_vertex(
    @builtin(vertex_index) index: u32,
    @location(0) from_in_model: vec3<f32>,
    @location(1) width_pixels: f32,
    @location(2) to_in_model: vec3<f32>,
    @location(3) color: vec3<f32>,
) -> Corner {
    var from_in_clip = instance.clip_from_model * vec4(from_in_model, 1.0);
    var to_in_clip = instance.clip_from_model * vec4(to_in_model, 1.0);
    // Distance inside the near plane: depth at most 1. A line that is wholly outside it draws nothing.
    let from_inside = from_in_clip.w - from_in_clip.z;
    let to_inside = to_in_clip.w - to_in_clip.z;
    if from_inside < 0.0 && to_inside < 0.0 {
        return Corner(vec4(2.0, 2.0, 2.0, 1.0), color);
    }
    if from_inside < 0.0 {
        from_in_clip = mix(from_in_clip, to_in_clip, from_inside / (from_inside - to_inside));
    } else if to_inside < 0.0 {
        to_in_clip = mix(to_in_clip, from_in_clip, to_inside / (to_inside - from_inside));
    }
    let half_size = view.size_pixels / 2.0;
    let from_pixels = from_in_clip.xy / max(from_in_clip.w, LEAST_W) * half_size;
    let to_pixels = to_in_clip.xy / max(to_in_clip.w, LEAST_W) * half_size;
    let along = to_pixels - from_pixels;
    let length_squared = dot(along, along);
    let is_line = length_squared > 1e-12;
    let direction = select(vec2(1.0, 0.0), along * inverseSqrt(max(length_squared, 1e-12)), is_line);

    let corner = index % 6u;
    // Corners of two triangles: (from, left) (to, left) (from, right) and (from, right) (to, left) (to, right).
    let at_end = corner == 1u || corner == 4u || corner == 5u;
    let on_left = corner == 0u || corner == 1u || corner == 4u;
    let half_width = width_pixels / 2.0;
    let across = vec2(-direction.y, direction.x) * select(-half_width, half_width, on_left);
    // Ends reach half a width further, so that bones meet without a notch and a point becomes a square.
    let beyond = direction * select(-half_width, half_width, at_end);
    let end_in_clip = select(from_in_clip, to_in_clip, at_end);
    let offset_in_clip = (across + beyond) / half_size * max(end_in_clip.w, LEAST_W);
    return Corner(end_in_clip + vec4(offset_in_clip, 0.0, 0.0), color);
}

@fragment
fn line_fragment(corner: Corner) -> @location(0) vec4<f32> {
    return vec4(corner.color, 1.0);
}
