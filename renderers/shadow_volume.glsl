// Crow 1977, counted by z-fail, for any set of triangles: each volume's boundary is summed with signs, so that
// what closes one triangle's volume cancels against its neighbour's. See docs/techniques.md.
#include "extrusion.glsl"

#section face_signs
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Triangles { int corners[]; };
layout(std430, binding = 2) writeonly buffer Signs { int signs[]; };
layout(std430, binding = 3) writeonly buffer Caps { ivec4 caps[]; };       // corners, sign
layout(std430, binding = 4) buffer CapCommand { uint cap_vertices; };
layout(std430, binding = 5) readonly buffer LeastSigns { int least_signs[]; };

bool out_of_reach(vec3 a, vec3 b, vec3 c) {
    float range = inner_range.y;
    vec3 offset = clamp(light.xyz, min(a, min(b, c)), max(a, max(b, c))) - light.xyz;
    bool outside = light.w > 0.0 && range > 0.0 && dot(offset, offset) > range * range;
    for (int i = 0; i < 5; ++i) {
        vec4 plane = reach_planes[i];
        vec3 heights = vec3(dot(plane.xyz, a), dot(plane.xyz, b), dot(plane.xyz, c)) + plane.w;
        outside = outside || max(heights.x, max(heights.y, heights.z)) < 0.0;
    }
    return outside;
}

void main() {
    int face = int(gl_GlobalInvocationID.x);
    if (face >= sizes.x) return;
    ivec3 corner = ivec3(corners[3 * face], corners[3 * face + 1], corners[3 * face + 2]);
    vec3 a = vertex(corner.x), b = vertex(corner.y), c = vertex(corner.z);
    float height = dot(cross(b - a, c - a), light.xyz - light.w * a);
    int least = sizes.z == 2 ? least_signs[face] : sizes.z;
    int facing = out_of_reach(a, b, c) ? 0 : max(int(sign(height)), least);
    signs[face] = facing;
    if (facing != 0) caps[atomicAdd(cap_vertices, 6u) / 6u] = ivec4(corner, facing);
}

#section edge_multiplicities
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Edges { ivec2 edges[]; };
layout(std430, binding = 2) readonly buffer Signs { int signs[]; };
layout(std430, binding = 3) readonly buffer Offsets { int offsets[]; };
layout(std430, binding = 4) readonly buffer HalfEdges { int half_edges[]; };   // 2 * face + (runs first to second)
layout(std430, binding = 5) writeonly buffer Sides { ivec4 sides[]; };         // ends, multiplicity
layout(std430, binding = 6) buffer SideCommand { uint side_vertices; };

void main() {
    int edge = int(gl_GlobalInvocationID.x);
    if (edge >= sizes.y) return;
    int multiplicity = 0;
    for (int i = offsets[edge]; i < offsets[edge + 1]; ++i) {
        int half_edge = half_edges[i];
        multiplicity += signs[half_edge >> 1] * ((half_edge & 1) * 2 - 1);
    }
    if (multiplicity == 0) return;
    if (sizes.w == 0) {
        sides[atomicAdd(side_vertices, 6u) / 6u] = ivec4(edges[edge], multiplicity, 0);
        return;
    }
    ivec2 ends = multiplicity > 0 ? edges[edge] : edges[edge].yx;
    uint first = atomicAdd(side_vertices, 6u * uint(abs(multiplicity))) / 6u;
    for (int i = 0; i < abs(multiplicity); ++i) sides[first + uint(i)] = ivec4(ends, 1, 0);
}

#section triangle_sides
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Triangles { int corners[]; };
layout(std430, binding = 2) readonly buffer Signs { int signs[]; };
layout(std430, binding = 3) writeonly buffer Sides { ivec4 sides[]; };
layout(std430, binding = 4) buffer SideCommand { uint side_vertices; };

// Every face closes its own volume, as before silhouettes were looked for.
void main() {
    int face = int(gl_GlobalInvocationID.x);
    if (face >= sizes.x || signs[face] == 0) return;
    ivec3 corner = ivec3(corners[3 * face], corners[3 * face + 1], corners[3 * face + 2]);
    uint first = atomicAdd(side_vertices, 18u) / 6u;
    for (int i = 0; i < 3; ++i) {
        sides[first + uint(i)] = ivec4(corner[i], corner[(i + 1) % 3], signs[face], 0);
    }
}

#section cap_vertex
layout(std430, binding = 1) readonly buffer Caps { ivec4 caps[]; };
invariant gl_Position;
flat out float weight;

void main() {
    ivec4 cap = caps[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    vec3 position = vertex(cap[corner % 3]);
    // The near cap lies on the scene's own surface: same corner order and same expression as the surface pass,
    // so that its depth has the same bits.
    if (corner < 3) gl_Position = clip_from_scene * vec4(position, 1.0);
    else gl_Position = clip_from_scene * extruded(position);
    weight = float(corner < 3 ? cap.w : -cap.w);
}

#section unit_cap_vertex
layout(std430, binding = 1) readonly buffer Caps { ivec4 caps[]; };
invariant gl_Position;

// For counters without weights: the far cap winds the other way instead of weighing the other way.
void main() {
    ivec4 cap = caps[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    vec3 position = vertex(cap[corner < 3 ? corner : 5 - corner]);
    if (corner < 3) gl_Position = clip_from_scene * vec4(position, 1.0);
    else gl_Position = clip_from_scene * extruded(position);
}

#section side_vertex
layout(std430, binding = 1) readonly buffer Sides { ivec4 sides[]; };
invariant gl_Position;
flat out float weight;

// Two triangles (b, a, a') and (b, a', b'), with a' and b' extruded.
const int ENDS[6] = int[](1, 0, 0, 1, 0, 1);
const int FAR[6] = int[](0, 0, 1, 0, 1, 1);

void main() {
    ivec4 side = sides[gl_VertexID / 6];
    int corner = gl_VertexID % 6;
    vec3 position = vertex(side[ENDS[corner]]);
    if (FAR[corner] == 0) gl_Position = clip_from_scene * vec4(position, 1.0);
    else gl_Position = clip_from_scene * extruded(position);
    weight = float(side.z);
}

#section count_fragment
flat in float weight;
layout(location = 0) out float counted;

// Volumes that end behind the surface count up, those that begin there count down.
void main() {
    counted = gl_FrontFacing ? -weight : weight;
}

#section stencil_fragment
void main() {}
