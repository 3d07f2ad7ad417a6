// Copies between the frame's depth, a depth and stencil texture, and the count that is read.
in vec2 uv;

// A blit between depth formats with and without stencil is an error; written by a shader the bits are the same.
#section copy_depth
layout(binding = 2) uniform sampler2D scene_depth;

void main() {
    gl_FragDepth = texture(scene_depth, uv).r;
}

#section copy_count
layout(binding = 2) uniform usampler2D layers;
layout(location = 0) out float counted;

void main() {
    counted = float(texture(layers, uv).r);
}
