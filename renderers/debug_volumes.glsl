// Shadow volumes to look at: their silhouette edges as lines, their sides and caps as layers.
#include "extrusion.glsl"

#section line_vertex
layout(std430, binding = 1) readonly buffer Sides { ivec4 sides[]; };
uniform vec2 viewport;
uniform float half_width;       // pixels
uniform int line;               // 0: the edge; 1, 2: from its first and second end to where the volume ends; 3: there
flat out int weight;
noperspective out float across; // pixels from the middle of the line

const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);
const float HALF_PIXEL = 0.5;

vec4 clip_end(int index, bool far) {
    vec3 near = vertex(index);
    return clip_from_scene * (far ? extruded(near) : vec4(near, 1.0));
}

void main() {
    ivec4 side = sides[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    weight = side.z;
    vec4 a = clip_end(line == 2 ? side.y : side.x, line == 3);
    vec4 b = clip_end(line == 0 || line == 2 ? side.y : line == 1 ? side.x : side.y, line != 0);
    // What lies before the near plane, or behind the eye, is cut off.
    float room_a = a.w - a.z, room_b = b.w - b.z;
    across = 0.0;
    gl_Position = NOWHERE;
    if (room_a <= 0.0 && room_b <= 0.0) return;
    if (room_a < 0.0) a = mix(a, b, room_a / (room_a - room_b));
    if (room_b < 0.0) b = mix(b, a, room_b / (room_b - room_a));
    vec2 step = (b.xy * (1.0 / b.w) - a.xy * (1.0 / a.w)) * viewport;
    vec2 ahead = dot(step, step) > 0.0 ? normalize(step) : vec2(1.0, 0.0);
    bool second = corner == 1 || corner == 2 || corner == 4;
    bool left = corner == 2 || corner == 4 || corner == 5;
    across = (left ? 1.0 : -1.0) * (half_width + HALF_PIXEL);
    vec2 pixels = across * vec2(-ahead.y, ahead.x) + (second ? HALF_PIXEL : -HALF_PIXEL) * ahead;
    vec4 end = second ? b : a;
    gl_Position = end + vec4(2.0 * pixels / viewport * end.w, 0.0, 0.0);
}

#section line_fragment
layout(binding = 2) uniform sampler2D scene_depth;
uniform float half_width;
uniform vec3 colors[3];         // of weights 1, 2 and more
uniform float hidden_alpha;
flat in int weight;
noperspective in float across;
layout(location = 0) out vec4 covered;

// Of its depth: a line lies on the outline of what it belongs to, not behind it.
const float OUTLINE = 1.005;

void main() {
    float depth = texelFetch(scene_depth, ivec2(gl_FragCoord.xy), 0).r;
    float alpha = clamp(half_width + 0.5 - abs(across), 0.0, 1.0);
    alpha *= gl_FragCoord.z * OUTLINE < depth ? hidden_alpha : 1.0;
    covered = vec4(colors[clamp(abs(weight), 1, 3) - 1] * alpha, alpha);
}

#section cap_layer_vertex
layout(std430, binding = 1) readonly buffer Caps { ivec4 caps[]; };
invariant gl_Position;
flat out vec4 layer;

void main() {
    ivec4 cap = caps[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    vec3 position = vertex(cap[corner % 3]);
    if (corner < 3) gl_Position = clip_from_scene * vec4(position, 1.0);
    else gl_Position = clip_from_scene * extruded(position);
    layer = corner < 3 ? vec4(0.0, 1.0, 0.0, 0.0) : vec4(0.0, 0.0, 1.0, 0.0);
}

#section side_layer_vertex
layout(std430, binding = 1) readonly buffer Sides { ivec4 sides[]; };
flat out vec4 layer;

const int ENDS[6] = int[](1, 0, 0, 1, 0, 1);
const int FAR[6] = int[](0, 0, 1, 0, 1, 1);

void main() {
    ivec4 side = sides[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    vec3 position = vertex(side[ENDS[corner]]);
    if (FAR[corner] == 0) gl_Position = clip_from_scene * vec4(position, 1.0);
    else gl_Position = clip_from_scene * extruded(position);
    layer = vec4(1.0, 0.0, 0.0, 0.0);
}

#section layer_fragment
flat in vec4 layer;             // one side, one near cap or one far cap
layout(location = 0) out vec4 layers;

void main() {
    layers = layer;
}
