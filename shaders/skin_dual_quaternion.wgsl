// How a vertex follows several joints, as dual quaternions: scale and shear are averaged as matrices, then rigid motions as unit dual
// quaternions, whose signs follow the first influence, the heaviest. Five rows of the palette to a binding: real, dual, stretch.

fn follow(vertex: u32, bound: Vertex) -> Vertex {
    let first = influence_starts[vertex];
    let pivot = palette[job.first_row + 5u * influences[first].binding];
    var real = vec4<f32>(0.0);
    var dual = vec4<f32>(0.0);
    var x = vec3<f32>(0.0);
    var y = vec3<f32>(0.0);
    var z = vec3<f32>(0.0);
    for (var i = first; i < influence_starts[vertex + 1u]; i++) {
        let influence = influences[i];
        let row = job.first_row + 5u * influence.binding;
        // Either sign is the same rotation; of the two ways to the heaviest one's the shorter is meant.
        let signed_weight = select(influence.weight, -influence.weight, dot(pivot, palette[row]) < 0.0);
        real += palette[row] * signed_weight;
        dual += palette[row + 1u] * signed_weight;
        x += palette[row + 2u].xyz * influence.weight;
        y += palette[row + 3u].xyz * influence.weight;
        z += palette[row + 4u].xyz * influence.weight;
    }
    let shrink = 1.0 / length(real);
    real *= shrink;
    dual *= shrink;
    let translation = 2.0 * (real.w * dual.xyz - dual.w * real.xyz + cross(real.xyz, dual.xyz));
    let stretched = vec3(dot(x, bound.position), dot(y, bound.position), dot(z, bound.position));
    let normal = unit_or(cofactor_transform(x, y, z, bound.normal), bound.normal);
    return Vertex(turned(real, stretched) + translation, unit_or(turned(real, normal), bound.normal));
}

fn turned(real: vec4<f32>, v: vec3<f32>) -> vec3<f32> {
    return v + 2.0 * cross(real.xyz, cross(real.xyz, v) + real.w * v);
}
