// Williams 1978, "Casting curved shadows on curved surfaces": lit where nothing on the map is nearer. For every
// map that is a projection, warped or not.
#include "receiver.glsl"
#include "map_receiver.glsl"
#include "map_linear_depth.glsl"

layout(binding = 2) uniform sampler2DShadow map;
layout(location = 0) out float lit;

// A box of texel_offset.w texels, from as many bilinear comparisons along a side; the nearest texel for 0.
float filtered(vec4 q) {
    int taps = int(texel_offset.w);
    if (taps <= 1) return textureProj(map, q);
    float sum = 0.0;
    for (int i = 0; i < taps * taps; ++i) {
        vec2 step = vec2(i % taps, i / taps) - 0.5 * float(taps - 1);
        sum += textureProj(map, q + vec4(step * texel_offset.xy * q.w, 0.0, 0.0));
    }
    return sum / float(taps * taps);
}

float compared(mat4 map_matrix, Receiver receiver) {
    return filtered(offset_place(map_matrix, receiver));
}

float compared_linearly(mat4 map_matrix, Receiver receiver) {
    vec4 q = offset_place(map_matrix, receiver);
    return filtered(vec4(q.xy, linear_depth(map_matrix, q.w) * q.w, q.w));
}

#section one_face
void main() {
    lit = compared(atlas_from_scene[0], visible_receiver());
}

#section six_faces
void main() {
    Receiver receiver = visible_receiver();
    lit = compared(atlas_from_scene[face_of(-towards_light(receiver.position))], receiver);
}

#section one_face_linear
void main() {
    lit = compared_linearly(atlas_from_scene[0], visible_receiver());
}

#section six_faces_linear
void main() {
    Receiver receiver = visible_receiver();
    lit = compared_linearly(atlas_from_scene[face_of(-towards_light(receiver.position))], receiver);
}
