// What the camera sees in a pixel that shows a surface, rebuilt from the G-buffer, and whether this light's
// shadow matters there.
#include "frame.glsl"
#include "light.glsl"

layout(binding = 0) uniform usampler2D scene_surface;   // bits of the view depth, packed normal

in vec2 uv;
in vec3 view_ray;

struct Receiver {
    vec3 position;      // scene space
    vec3 normal;        // geometric, towards the eye; not of unit length
};

// Cigolle et al. 2014, section 3, without the final normalisation.
vec3 decode_octahedral(uint halves) {
    vec2 square = unpackSnorm2x16(halves);
    vec3 normal = vec3(square, 1.0 - abs(square.x) - abs(square.y));
    float fold = max(-normal.z, 0.0);
    normal.x += normal.x >= 0.0 ? -fold : fold;
    normal.y += normal.y >= 0.0 ? -fold : fold;
    return normal;
}

Receiver visible_receiver() {
    uvec2 surface = texture(scene_surface, uv).xy;
    vec3 normal = decode_octahedral(surface.y);
    Receiver receiver;
    receiver.position = eye_rounding.xyz + view_ray * uintBitsToFloat(surface.x);
    receiver.normal = dot(normal, view_ray) > 0.0 ? -normal : normal;
    return receiver;
}

// Cosine of incidence below which a surface counts as turned away: a light in the very plane of a wall lights it
// or not by the last bit of its position, and lights it with nothing.
const float GRAZING = 1e-4;

// Where a technique's answer counts: a surface that faces the light, within its range and cone. Elsewhere shading
// is dark whatever the mask says, and whoever reads the mask sees 0, for every technique alike.
bool answers(Receiver receiver) {
    vec3 to_light = towards_light(receiver.position);
    float height = max(dot(receiver.normal, to_light), 0.0);
    return height * height > GRAZING * GRAZING * dot(to_light, to_light) && in_reach(to_light);
}
