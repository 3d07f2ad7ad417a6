// Draws of the volumes' triangles only what can count: in tiles of the screen that hold pixels to count in, and not
// in front of all of them. A triangle worth cutting up is drawn once for each such tile and scissored to it, which
// changes no bit of what it leaves there; clipping would round its edges and depths anew. On llvmpipe even
// gl_ViewportIndex does (6,554 counts on the bench's box grid): tiles are drawn one after the other.
#include "extrusion.glsl"

layout(std430, binding = 1) readonly buffer Caps { ivec4 caps[]; };     // corners, weight
layout(std430, binding = 2) readonly buffer Sides { ivec4 sides[]; };   // ends, weight
uniform ivec4 grid;         // columns and rows of tiles, side of a tile in pixels, most triangles
uniform vec2 viewport;      // pixels

// Indirect draws, five words each: of whole triangles, of those that are cut up (never drawn), then of each tile.
const int WORDS = 5;
const int WHOLE = 0;
const int CUT = 1;
const int LISTS = 2;
const int OVERFLOW = 4;     // a word that no draw reads

struct Triangle {
    ivec3 corners;
    int ends;       // bits of the corners that are extruded
    int weight;
};

// Two triangles of every cap, near and far, then two of every side.
Triangle triangle(int number) {
    int piece = number >> 1;
    bool first = (number & 1) == 0;
    if (piece < sizes.x) {
        ivec4 cap = caps[piece];
        return Triangle(cap.xyz, first ? 0 : 7, first ? cap.w : -cap.w);
    }
    ivec4 side = sides[piece - sizes.x];
    return Triangle(first ? side.yxx : side.yxy, first ? 4 : 6, side.z);
}

#section triangle_vertex
layout(std430, binding = 3) readonly buffer Entries { int entries[]; };
invariant gl_Position;
flat out float weight;

void main() {
    int corner = gl_VertexID % 3;
    Triangle drawn = triangle(entries[gl_VertexID / 3]);
    vec3 position = vertex(drawn.corners[corner]);
    // The near cap lies on the scene's own surface: see shadow_volume.glsl.
    if ((drawn.ends >> corner & 1) == 0) gl_Position = clip_from_scene * vec4(position, 1.0);
    else gl_Position = clip_from_scene * extruded(position);
    weight = float(drawn.weight);
}

#section tile_depths
layout(local_size_x = 8, local_size_y = 8) in;
layout(binding = 2) uniform sampler2D depths;
layout(std430, binding = 3) writeonly buffer TileDepths { float tile_depths[]; };
shared float highest[64];

// The nearest depth that volumes are counted against, 0 in a tile where they are not.
void main() {
    ivec2 tile = ivec2(gl_WorkGroupID.xy);
    ivec2 low = tile * grid.z, high = min(low + grid.z, ivec2(viewport));
    float found = 0.0;
    for (int y = low.y + int(gl_LocalInvocationID.y); y < high.y; y += 8) {
        for (int x = low.x + int(gl_LocalInvocationID.x); x < high.x; x += 8) {
            found = max(found, texelFetch(depths, ivec2(x, y), 0).r);
        }
    }
    highest[gl_LocalInvocationIndex] = found;
    barrier();
    for (uint half_size = 32u; half_size > 0u; half_size >>= 1) {
        if (gl_LocalInvocationIndex < half_size) {
            float other = highest[gl_LocalInvocationIndex + half_size];
            highest[gl_LocalInvocationIndex] = max(highest[gl_LocalInvocationIndex], other);
        }
        barrier();
    }
    if (gl_LocalInvocationIndex == 0u) tile_depths[tile.y * grid.x + tile.x] = highest[0];
}

#section plan
layout(local_size_x = 1) in;
layout(std430, binding = 3) writeonly buffer Groups { uvec3 groups; };
layout(std430, binding = 6) readonly buffer CapCommand { uint cap_vertices; };
layout(std430, binding = 7) readonly buffer SideCommand { uint side_vertices; };

// As many threads as there are triangles.
void main() {
    groups = uvec3((cap_vertices / 3u + side_vertices / 3u + 63u) / 64u, 1u, 1u);
}

#section sort
layout(local_size_x = 64) in;
layout(std430, binding = 3) readonly buffer TileDepths { float tile_depths[]; };
layout(std430, binding = 4) buffer Entries { int entries[]; };
layout(std430, binding = 5) buffer Commands { uint commands[]; };
layout(std430, binding = 6) readonly buffer CapCommand { uint cap_vertices; };
layout(std430, binding = 7) readonly buffer SideCommand { uint side_vertices; };
uniform bool placing;       // whether the tiles' lists have their places, and are to be filled

// Pixels by which rasterisers, and another rounding of the corners, may move a triangle.
const float PIXELS = 1.0;
// Share of its terms by which float32 may change a product of two corners: five roundings.
const float ROUNDING = 3e-7;
// Share of a depth that may be unknown before nothing is.
const float UNKNOWN = 0.05;
// Pictures to either side beyond which a corner is as good as behind the eye.
const float FARTHEST = 16.0;
// What one more triangle costs, in fragments: 100 to 250 on llvmpipe.
const int TRIANGLE_COST = 200;

// A triangle on the screen, before any division, so that the near plane may cut it (Olano and Greer 1997,
// "Triangle scan conversion using 2D homogeneous coordinates"). Lines are positive inside.
struct Footprint {
    vec3 lines[3];
    vec3 line_errors;
    vec3 plane;         // depth as a function of the place on the screen
    vec2 plane_errors;  // absolute, relative; relative above UNKNOWN where the plane is not known
    float lowest_depth;
    ivec4 tiles;
    bool small;         // too small to be cut up
    float area;         // pixels; 0 where the near plane is in the way
};

bool touches(Footprint f, vec2 middle, vec2 half_sides) {
    for (int i = 0; i < 3; ++i) {
        vec3 line = f.lines[i];
        if (dot(line, vec3(middle, 1.0)) + dot(abs(line.xy), half_sides) < -f.line_errors[i]) return false;
    }
    return true;
}

bool counts(Footprint f, vec2 middle, vec2 half_sides, float nearest) {
    float depth = f.lowest_depth;
    if (f.plane_errors.y < UNKNOWN) {
        float there = dot(f.plane, vec3(middle, 1.0)), spread = dot(abs(f.plane.xy), half_sides);
        float error = f.plane_errors.x + f.plane_errors.y * (abs(there) + spread);
        depth = max(depth, there - spread - error);
    }
    return nearest > 0.0 && depth <= nearest;
}

bool holds(Footprint f, vec2 place) {
    vec3 there = vec3(place, 1.0);
    return min(dot(f.lines[0], there), min(dot(f.lines[1], there), dot(f.lines[2], there))) >= 0.0;
}

// How many tiles the triangle touches, in how many of them it counts, and how many of the others have their middle
// in it, which is a measure of what it covers there; with `add`, it joins the lists of those where it counts.
ivec3 walk(Footprint f, int number, bool add) {
    ivec3 found = ivec3(0);
    vec2 pixel = 2.0 / viewport, half_sides = pixel * (0.5 * float(grid.z) + PIXELS);
    for (int y = f.tiles.y; y <= f.tiles.w; ++y) {
        for (int x = f.tiles.x; x <= f.tiles.z; ++x) {
            vec2 middle = pixel * (vec2(x, y) + 0.5) * float(grid.z) - 1.0;
            if (!touches(f, middle, half_sides)) continue;
            int tile = y * grid.x + x;
            bool counting = counts(f, middle, half_sides, tile_depths[tile]);
            found += ivec3(1, counting, !counting && holds(f, middle));
            if (!add || !counting) continue;
            int command = WORDS * (LISTS + tile);
            uint vertices = atomicAdd(commands[command], 3u);
            if (placing) entries[(commands[command + 2] + vertices) / 3u] = number;
        }
    }
    return found;
}

// The same question for a small triangle, which is drawn whole or not at all.
bool counts_somewhere(Footprint f) {
    float nearest = 0.0;
    for (int y = f.tiles.y; y <= f.tiles.w; ++y) {
        for (int x = f.tiles.x; x <= f.tiles.z; ++x) nearest = max(nearest, tile_depths[y * grid.x + x]);
    }
    return nearest > 0.0 && f.lowest_depth <= nearest;
}

bool beyond_near(vec4 clip) {
    return clip.z > clip.w || clip.w <= 0.0;
}

void project(Triangle drawn, out vec4 clip[3]) {
    for (int i = 0; i < 3; ++i) {
        vec3 position = vertex(drawn.corners[i]);
        bool end = (drawn.ends >> i & 1) != 0;
        clip[i] = clip_from_scene * (end ? extruded(position) : vec4(position, 1.0));
    }
}

Footprint bound(vec4 clip[3]) {
    Footprint f;
    vec2 low = vec2(2.0), high = vec2(-2.0), corners[3];
    bool whole = false;
    float highest_depth = 0.0;
    f.lowest_depth = 1.0;
    for (int i = 0; i < 3; ++i) {
        bool behind = beyond_near(clip[i]);
        whole = whole || behind || any(greaterThan(abs(clip[i].xy), vec2(FARTHEST * clip[i].w)));
        float depth = behind ? 1.0 : clip[i].z / clip[i].w;
        f.lowest_depth = min(f.lowest_depth, depth);
        highest_depth = max(highest_depth, depth);
        corners[i] = clip[i].xy / clip[i].w;
        low = min(low, corners[i]);
        high = max(high, corners[i]);
    }
    // Rasterisers interpolate between the two.
    f.plane_errors.x = 4.0 * ROUNDING * highest_depth;
    f.lowest_depth -= f.plane_errors.x;
    vec4 pixels = (0.5 * vec4(low, high) + 0.5) * viewport.xyxy + PIXELS * vec4(-1, -1, 1, 1);
    vec2 size = pixels.zw - pixels.xy;
    ivec4 tiles = whole ? ivec4(0, 0, grid.xy) : ivec4(floor(pixels / float(grid.z)));
    f.tiles = ivec4(max(tiles.xy, 0), min(tiles.zw, grid.xy - 1));
    vec2 across = corners[1] - corners[0], along = corners[2] - corners[0];
    f.area = whole ? 0.0 : 0.125 * abs(across.x * along.y - across.y * along.x) * viewport.x * viewport.y;
    f.small = !whole && size.x * size.y < float(4 * TRIANGLE_COST);
    return f;
}

void find_lines(inout Footprint f, vec4 clip[3]) {
    vec3 corners[3], lengths;
    for (int i = 0; i < 3; ++i) {
        corners[i] = clip[i].xyw;
        lengths[i] = length(corners[i]);
    }
    for (int i = 0; i < 3; ++i) f.lines[i] = cross(corners[(i + 1) % 3], corners[(i + 2) % 3]);
    float determinant = dot(corners[0], f.lines[0]), turn = determinant < 0.0 ? -1.0 : 1.0;
    vec3 products = lengths.yzx * lengths.zxy, depths = abs(vec3(clip[0].z, clip[1].z, clip[2].z));
    f.line_errors = ROUNDING * products;
    f.plane_errors.x += 2.0 * ROUNDING * dot(depths, products) / abs(determinant);
    f.plane_errors.y = ROUNDING * lengths.x * products.x / abs(determinant);
    if (determinant == 0.0) f.plane_errors = vec2(1.0);
    f.plane = (clip[0].z * f.lines[0] + clip[1].z * f.lines[1] + clip[2].z * f.lines[2]) / determinant;
    bool flat_on = f.plane_errors.y < UNKNOWN;
    for (int i = 0; i < 3; ++i) {
        f.lines[i] *= turn;
        // Where rounding decides which way the corners run, nothing is outside.
        if (!flat_on) f.line_errors[i] = 1e30;
    }
}

void append(int list, int number) {
    entries[list * grid.w + int(atomicAdd(commands[WORDS * list], 3u) / 3u)] = number;
}

void place_cut(int number) {
    if (commands[OVERFLOW] != 0u) {
        append(WHOLE, number);
        return;
    }
    vec4 clip[3];
    project(triangle(number), clip);
    Footprint f = bound(clip);
    find_lines(f, clip);
    walk(f, number, true);
}

void choose(int number) {
    vec4 clip[3];
    project(triangle(number), clip);
    if (beyond_near(clip[0]) && beyond_near(clip[1]) && beyond_near(clip[2])) return;
    Footprint f = bound(clip);
    if (f.small) {
        if (counts_somewhere(f)) append(WHOLE, number);
        return;
    }
    find_lines(f, clip);
    ivec3 tiles = walk(f, number, false);
    if (tiles.y == 0) return;
    float saved = f.area > 0.0 ? f.area * float(tiles.x - tiles.y) / float(tiles.x) : float(tiles.z * grid.z * grid.z);
    if (tiles.y == tiles.x || saved < float(TRIANGLE_COST * (tiles.y - 1))) append(WHOLE, number);
    else {
        append(CUT, number);
        walk(f, number, true);
    }
}

void main() {
    int index = int(gl_GlobalInvocationID.x);
    if (placing) {
        if (index < int(commands[WORDS * CUT] / 3u)) place_cut(entries[grid.w + index]);
        return;
    }
    int of_caps = int(cap_vertices / 3u), of_sides = int(side_vertices / 3u);
    if (index < of_caps + of_sides) choose(index < of_caps ? index : index - of_caps + 2 * sizes.x);
}

#section place
layout(local_size_x = 1) in;
layout(std430, binding = 3) writeonly buffer Groups { uvec3 groups; };
layout(std430, binding = 5) buffer Commands { uint commands[]; };
uniform int room;       // triangles for which there is room in all lists of tiles

// Gives each tile's list its place behind the others; where they do not fit, all triangles are drawn whole.
void main() {
    uint first = uint(LISTS * grid.w);
    for (int tile = 0; tile < grid.x * grid.y; ++tile) {
        int command = WORDS * (LISTS + tile);
        uint vertices = commands[command];
        commands[command] = 0u;
        commands[command + 2] = 3u * first;
        first += vertices / 3u;
    }
    commands[OVERFLOW] = uint(first > uint(LISTS * grid.w + room));
    groups = uvec3((commands[WORDS * CUT] / 3u + 63u) / 64u, 1u, 1u);
}
