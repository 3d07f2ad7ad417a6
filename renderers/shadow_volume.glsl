// Crow 1977, counted by z-fail, for any set of triangles: each volume's boundary is summed with signs, so that
// what closes one triangle's volume cancels against its neighbour's. See docs/techniques.md.
#include "light.glsl"
#include "frame.glsl"

layout(std140, binding = 2) uniform VolumeBlock {
    vec4 end_plane;         // normal, distance; zeros for volumes that run to infinity
    vec4 reach_planes[5];   // inward planes of a spot's pyramid; zeros for other lights
    ivec4 sizes;            // faces, edges, 0, 0
};

layout(std430, binding = 0) readonly buffer Vertices { float coordinates[]; };

vec3 vertex(int index) {
    return vec3(coordinates[3 * index], coordinates[3 * index + 1], coordinates[3 * index + 2]);
}

// Where the ray from the light through `near` ends.
vec4 extruded(vec3 near) {
    vec3 along = light.w * near - light.xyz;
    if (end_plane.xyz == vec3(0.0)) return vec4(along, 0.0);
    float steps = (end_plane.w - dot(end_plane.xyz, near)) / dot(end_plane.xyz, along);
    return vec4(near + steps * along, 1.0);
}

#section face_signs
layout(local_size_x = 64) in;
layout(std430, binding = 1) readonly buffer Triangles { int corners[]; };
layout(std430, binding = 2) writeonly buffer Signs { int signs[]; };
layout(std430, binding = 3) writeonly buffer Caps { ivec4 caps[]; };       // corners, sign
layout(std430, binding = 4) buffer CapCommand { uint cap_vertices; };

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
    int facing = out_of_reach(a, b, c) ? 0 : int(sign(height));
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
    if (multiplicity != 0) sides[atomicAdd(side_vertices, 6u) / 6u] = ivec4(edges[edge], multiplicity, 0);
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
