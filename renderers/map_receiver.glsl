// Where a receiver lies on a light's map, moved out of its own shadow. Needs receiver.glsl.
layout(std140, binding = 2) uniform MapBlock {
    mat4 atlas_from_scene[6];   // homogeneous atlas coordinates and depth, all in [0, 1]
    vec4 texel_offset;          // size of a texel in atlas coordinates, normal offset in texels, taps of the filter
};

// The least length of a normal as it is decoded, in the diagonals of the octahedron.
const float SHORTEST_NORMAL = 0.57735;

// Square of the side of a map texel at the place that projects to `q`, the longer of the two, in scene units:
// texels over the gradient of the projection.
float texel_side_squared(mat4 map_matrix, vec4 q) {
    vec3 row_w = vec3(map_matrix[0].w, map_matrix[1].w, map_matrix[2].w);
    vec2 ratio = q.xy * (1.0 / q.w);
    vec3 gradient_x = vec3(map_matrix[0].x, map_matrix[1].x, map_matrix[2].x) - ratio.x * row_w;
    vec3 gradient_y = vec3(map_matrix[0].y, map_matrix[1].y, map_matrix[2].y) - ratio.y * row_w;
    float x = dot(gradient_x, gradient_x), y = dot(gradient_y, gradient_y);
    vec2 texel = texel_offset.xy * texel_offset.xy;
    return q.w * q.w * max(texel.x * y, texel.y * x) / (x * y);
}

// The receiver is moved along its normal by a share of a texel, less the more it faces the light, and by what
// its position is rounded to: polygon offset does not know of that, and facing the light it may exceed any slope.
vec4 offset_place(mat4 map_matrix, Receiver receiver) {
    vec3 to_light = towards_light(receiver.position);
    float normal_squared = dot(receiver.normal, receiver.normal);
    float light_squared = dot(to_light, to_light);
    float cosine = dot(receiver.normal, to_light);
    vec4 q = map_matrix * vec4(receiver.position, 1.0);
    float sine_squared = max(normal_squared * light_squared - cosine * cosine, 0.0);
    // Both divided by the square of the normal's length, which the normal itself brings back.
    float share = sine_squared / (normal_squared * normal_squared * light_squared);
    float moved = texel_offset.z * sqrt(texel_side_squared(map_matrix, q) * share)
        + eye_rounding.w / SHORTEST_NORMAL;
    return q + map_matrix * vec4(moved * receiver.normal, 0.0);
}

// Faces stand in the order +X -X +Y -Y +Z -Z.
int face_of(vec3 from_light) {
    vec3 size = abs(from_light);
    if (size.x >= size.y && size.x >= size.z) return from_light.x >= 0.0 ? 0 : 1;
    if (size.y >= size.z) return from_light.y >= 0.0 ? 2 : 3;
    return from_light.z >= 0.0 ? 4 : 5;
}
