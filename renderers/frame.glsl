// The view in scene space, one block for every pass.
layout(std140, binding = 0) uniform FrameBlock {
    mat4 clip_from_scene;
    vec4 eye_rounding;  // eye position; how far float32 may leave a surface's position off it
    vec4 ray_right;     // scene-space step for one unit of NDC x at view depth 1
    vec4 ray_up;        // the same for NDC y
    vec4 ray_forward;   // unit view direction
};
