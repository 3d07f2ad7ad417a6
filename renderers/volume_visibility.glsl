// Shadow where some triangle lies between the surface and the light.
#section visibility
layout(binding = 2) uniform sampler2D volume_counts;
in vec2 uv;
layout(location = 0) out float lit;

void main() {
    lit = float(texture(volume_counts, uv).r < 0.5);
}
