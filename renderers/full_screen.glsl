// One triangle that covers the viewport, with what a pixel needs to find its surface again.
#include "frame.glsl"

#section full_screen
out vec2 uv;
out vec3 view_ray;      // scene space, one unit of view depth long

void main() {
    vec2 ndc = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    gl_Position = vec4(ndc, 0.0, 1.0);
    uv = 0.5 * ndc + 0.5;
    view_ray = ray_forward.xyz + ndc.x * ray_right.xyz + ndc.y * ray_up.xyz;
}

#section layer
// A thin layer of everything, for filling time.
layout(location = 0) out vec4 color;

void main() {
    color = vec4(1.0 / 256.0);
}
