// View depth with the packed geometric normal, and albedo, of the nearest surface.
#extension GL_ARB_shader_draw_parameters : require

#section surface_vertex
#include "frame.glsl"
in vec3 position;
invariant gl_Position;
flat out int first_face;

void main() {
    gl_Position = clip_from_scene * vec4(position, 1.0);
    first_face = gl_BaseInstanceARB;
}

#section surface_fragment
layout(binding = 4) uniform usamplerBuffer faces;   // normal, albedo
flat in int first_face;
layout(location = 0) out uvec2 surface;
layout(location = 1) out vec4 albedo;

void main() {
    uvec2 face = texelFetch(faces, first_face + gl_PrimitiveID).xy;
    // 1 / w is the reciprocal of the view depth; one fetch brings both halves back.
    surface = uvec2(floatBitsToUint(1.0 / gl_FragCoord.w), face.x);
    albedo = unpackUnorm4x8(face.y);
}
