// Vertices of the scene, and where shadow volumes end.
#include "light.glsl"
#include "frame.glsl"

layout(std140, binding = 2) uniform VolumeBlock {
    vec4 end_plane;         // normal, distance; without a normal the length of volumes, 0 if they never end
    vec4 reach_planes[5];   // inward planes of a spot's pyramid; zeros for other lights
    ivec4 sizes;            // faces, edges, least sign that counts (2: of each face), whether a side weighs one
};

layout(std430, binding = 0) readonly buffer Vertices { float coordinates[]; };

vec3 vertex(int index) {
    return vec3(coordinates[3 * index], coordinates[3 * index + 1], coordinates[3 * index + 2]);
}

// Where the ray from the light through `near` ends.
vec4 extruded(vec3 near) {
    vec3 along = light.w * near - light.xyz;
    if (end_plane.xyz == vec3(0.0)) {
        return end_plane.w > 0.0 ? vec4(near + end_plane.w * normalize(along), 1.0) : vec4(along, 0.0);
    }
    float steps = (end_plane.w - dot(end_plane.xyz, near)) / dot(end_plane.xyz, along);
    return vec4(near + steps * along, 1.0);
}
