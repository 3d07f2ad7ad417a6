// Chan and Durand 2004, "An efficient hybrid shadow rendering algorithm": a small map answers wherever all texels
// around a pixel agree, shadow volumes wherever they do not.
#include "receiver.glsl"
#include "map_receiver.glsl"

layout(binding = 2) uniform sampler2D map;
layout(binding = 3) uniform sampler2D covering_map;     // of casters that cover every texel they touch
layout(binding = 4) uniform sampler2D scene_depth;
uniform int faces;
uniform float grazing;      // cosine of incidence up to which volumes decide
layout(location = 0) out float lit;

struct Place {
    float scene_depth;
    vec2 corner;    // of the four texels around the receiver, in texels from the map's corner
    float depth;
    bool grazed;
};

bool grazes(Receiver receiver) {
    vec3 to_light = towards_light(receiver.position);
    float height = max(dot(receiver.normal, to_light), 0.0);
    float squared = dot(receiver.normal, receiver.normal) * dot(to_light, to_light);
    return height * height < grazing * grazing * squared;
}

// False where no answer counts; volumes are then counted against depth 0, behind which nothing lies.
bool locate(out Place place) {
    lit = 0.0;
    gl_FragDepth = 0.0;
    place.scene_depth = texelFetch(scene_depth, ivec2(gl_FragCoord.xy), 0).r;
    Receiver receiver = visible_receiver();
    if (place.scene_depth == 0.0 || !answers(receiver)) return false;
    vec4 q = offset_place(atlas_from_scene[faces == 1 ? 0 : face_of(-towards_light(receiver.position))], receiver);
    place.corner = floor(q.xy / (q.w * texel_offset.xy) - 0.5) + 1.0;
    place.depth = q.z / q.w;
    place.grazed = grazing > 0.0 && grazes(receiver);
    return true;
}

// Lowest and highest depth of four texels; at the corner between them the sampler cannot choose others.
vec2 depths_around(sampler2D depths, vec2 corner) {
    vec4 four = textureGather(depths, corner * texel_offset.xy);
    vec2 low = min(four.xy, four.zw), high = max(four.xy, four.zw);
    return vec2(min(low.x, low.y), max(high.x, high.y));
}

void decide(Place place, float lowest, float highest) {
    bool dark = place.depth < lowest, bright = place.depth >= highest;
    lit = float(bright);
    if (!(dark || bright) || place.grazed) gl_FragDepth = place.scene_depth;
}

#section kernel_2x2
// The map's answer, and the depth that volumes are counted against: the surface's where the texels disagree.
void main() {
    Place place;
    if (!locate(place)) return;
    vec2 depths = depths_around(map, place.corner);
    decide(place, depths.x, depths.y);
}

#section kernels
// The same from any number of texels, and from two maps.
void main() {
    Place place;
    if (!locate(place)) return;
    int gathers = int(texel_offset.w + 1.0) / 2;
    float lowest = 1.0, highest = 0.0;
    for (int i = 0; i < gathers * gathers; ++i) {
        vec2 step = 2.0 * vec2(i % gathers, i / gathers) - float(gathers - 1);
        lowest = min(lowest, depths_around(map, place.corner + step).x);
        highest = max(highest, depths_around(covering_map, place.corner + step).y);
    }
    decide(place, lowest, highest);
}

#section visibility
layout(binding = 5) uniform sampler2D volume_counts;

void main() {
    lit = float(texelFetch(volume_counts, ivec2(gl_FragCoord.xy), 0).r < 0.5);
}
