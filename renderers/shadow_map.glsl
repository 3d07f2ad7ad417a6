// Williams 1978, "Casting curved shadows on curved surfaces": lit where nothing on the map is nearer.
#include "receiver.glsl"

#section visibility
layout(std140, binding = 2) uniform MapBlock {
    mat4 map_from_scene[6];
    vec4 atlas;         // size of one face in atlas coordinates, texels along a face, faces
    vec4 offset;        // normal offset in texels, 0, 0, 0
};
layout(binding = 2) uniform sampler2DShadow map;
layout(location = 0) out float lit;

const float COLUMNS = 3.0;

// Faces stand in the order +X -X +Y -Y +Z -Z.
int face_of(vec3 from_light) {
    vec3 size = abs(from_light);
    if (size.x >= size.y && size.x >= size.z) return from_light.x >= 0.0 ? 0 : 1;
    if (size.y >= size.z) return from_light.y >= 0.0 ? 2 : 3;
    return from_light.z >= 0.0 ? 4 : 5;
}

// Side of a map texel at `position` in scene units, the longer of the two: the gradient of the projection.
float texel_side(mat4 map, vec4 q) {
    vec3 row_w = vec3(map[0].w, map[1].w, map[2].w);
    vec3 gradient_x = vec3(map[0].x, map[1].x, map[2].x) - q.x / q.w * row_w;
    vec3 gradient_y = vec3(map[0].y, map[1].y, map[2].y) - q.y / q.w * row_w;
    float squared = min(dot(gradient_x, gradient_x), dot(gradient_y, gradient_y));
    return 2.0 * q.w * inversesqrt(squared) / atlas.z;
}

void main() {
    Receiver receiver = visible_receiver();
    if (!answers(receiver)) {
        lit = 0.0;
        return;
    }
    vec3 to_light = towards_light(receiver.position);
    int face = atlas.w > 1.0 ? face_of(-to_light) : 0;
    mat4 map_matrix = map_from_scene[face];
    vec4 q = map_matrix * vec4(receiver.position, 1.0);
    vec3 normal = normalize(receiver.normal);
    float cosine = dot(normal, to_light) * inversesqrt(dot(to_light, to_light));
    float sine = sqrt(max(1.0 - cosine * cosine, 0.0));
    q += map_matrix * vec4(normal * (offset.x * sine * texel_side(map_matrix, q)), 0.0);
    vec3 ndc = q.xyz / q.w;
    vec2 cell = vec2(mod(float(face), COLUMNS), floor(float(face) / COLUMNS));
    vec2 place = (0.5 * ndc.xy + 0.5 + cell) * atlas.xy;
    lit = texture(map, vec3(place, ndc.z));
}
