// Depth, packed geometric normal and albedo of the nearest surface.
#section surface_vertex
#include "frame.glsl"
in vec3 position;
invariant gl_Position;

void main() {
    gl_Position = clip_from_scene * vec4(position, 1.0);
}

#section surface_fragment
layout(std430, binding = 0) readonly buffer FaceTable { uvec2 faces[]; };   // normal, albedo
layout(location = 0) out uint normal;
layout(location = 1) out vec4 albedo;

void main() {
    uvec2 face = faces[gl_PrimitiveID];
    normal = face.x;
    albedo = unpackUnorm4x8(face.y);
}
