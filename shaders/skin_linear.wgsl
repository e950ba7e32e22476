// How a vertex follows several joints, linearly: their matrices are averaged by weight. Three rows of the palette to a binding.

fn follow(vertex: u32, bound: Vertex) -> Vertex {
    var x = vec4<f32>(0.0);
    var y = vec4<f32>(0.0);
    var z = vec4<f32>(0.0);
    for (var i = influence_starts[vertex]; i < influence_starts[vertex + 1u]; i++) {
        let influence = influences[i];
        let row = job.first_row + 3u * influence.binding;
        x += palette[row] * influence.weight;
        y += palette[row + 1u] * influence.weight;
        z += palette[row + 2u] * influence.weight;
    }
    let position = vec4(bound.position, 1.0);
    let normal = cofactor_transform(x.xyz, y.xyz, z.xyz, bound.normal);
    return Vertex(vec3(dot(x, position), dot(y, position), dot(z, position)), unit_or(normal, bound.normal));
}
