// The scene as a light's map sees it, flat shaded, brighter where the camera sees it too.
#extension GL_ARB_shader_draw_parameters : require
#include "light.glsl"
#include "frame.glsl"

#section seen_vertex
in vec3 position;
uniform mat4 map_from_scene;
flat out int first_face;
out vec3 place;

void main() {
    gl_Position = map_from_scene * vec4(position, 1.0);
    place = position;
    first_face = gl_BaseInstanceARB;
}

#section seen_fragment
layout(binding = 4) uniform usamplerBuffer faces;   // normal, albedo
layout(binding = 2) uniform sampler2D scene_depth;
flat in int first_face;
in vec3 place;
layout(location = 0) out vec4 shaded;

// Of a surface's depth as the camera has it: what lies farther behind is hidden.
const float SAME_SURFACE = 0.995;

vec3 decode_octahedral(uint halves) {
    vec2 square = unpackSnorm2x16(halves);
    vec3 normal = vec3(square, 1.0 - abs(square.x) - abs(square.y));
    float fold = max(-normal.z, 0.0);
    normal.x += normal.x >= 0.0 ? -fold : fold;
    normal.y += normal.y >= 0.0 ? -fold : fold;
    return normalize(normal);
}

bool camera_sees(vec3 position) {
    vec4 clip = clip_from_scene * vec4(position, 1.0);
    if (clip.w <= 0.0 || any(greaterThan(abs(clip.xy), clip.ww)) || clip.z > clip.w) return false;
    // The farthest around: a surface seen edge-on gets much deeper within a pixel.
    ivec2 pixel = ivec2((0.5 + 0.5 * clip.xy / clip.w) * textureSize(scene_depth, 0));
    float depth = 1.0;
    for (int i = 0; i < 9; ++i) {
        ivec2 beside = clamp(pixel + ivec2(i % 3, i / 3) - 1, ivec2(0), textureSize(scene_depth, 0) - 1);
        depth = min(depth, texelFetch(scene_depth, beside, 0).r);
    }
    return clip.z / clip.w >= SAME_SURFACE * depth;
}

void main() {
    uvec2 face = texelFetch(faces, first_face + gl_PrimitiveID).xy;
    vec3 albedo = unpackUnorm4x8(face.y).rgb;
    float cosine = abs(dot(decode_octahedral(face.x), normalize(towards_light(place))));
    vec3 bright = sqrt(albedo * (0.25 + 0.75 * cosine));
    float grey = dot(bright, vec3(0.2126, 0.7152, 0.0722));
    shaded = vec4(camera_sees(place) ? bright : mix(vec3(grey), bright, 0.35) * 0.42, 1.0);
}
