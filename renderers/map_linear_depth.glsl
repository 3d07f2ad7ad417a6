// Depth of a perspective map that falls evenly from 1 at its near plane to 0 at its far plane; `w` is the distance
// along the axis. The matrix holds z / w = a + b / w.
float linear_depth(mat4 map_matrix, float w) {
    vec3 row_z = vec3(map_matrix[0].z, map_matrix[1].z, map_matrix[2].z);
    vec3 row_w = vec3(map_matrix[0].w, map_matrix[1].w, map_matrix[2].w);
    float a = dot(row_z, row_w) / dot(row_w, row_w);
    float b = map_matrix[3].z - a * map_matrix[3].w;
    float near = b / (1.0 - a), far = -b / a;
    return (far - w) / (far - near);
}
