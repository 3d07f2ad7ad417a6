// Depth of the casters as the light sees them.
#section caster_vertex
in vec3 position;
uniform mat4 map_from_scene;

void main() {
    gl_Position = map_from_scene * vec4(position, 1.0);
}

#section nothing
void main() {}

#section linear
#include "map_linear_depth.glsl"
uniform mat4 map_from_scene;
uniform vec2 offset;

const float DEPTH_STEP = 1.0 / 16777216.0;

void main() {
    float depth = linear_depth(map_from_scene, 1.0 / gl_FragCoord.w);
    float slope = max(abs(dFdx(depth)), abs(dFdy(depth)));
    gl_FragDepth = clamp(depth - offset.x * slope - offset.y * DEPTH_STEP, 0.0, 1.0);
}
