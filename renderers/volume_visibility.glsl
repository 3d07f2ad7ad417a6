// Shadow where some triangle lies between the surface and the light.
#include "receiver.glsl"

#section visibility
layout(binding = 2) uniform sampler2D volume_counts;
layout(location = 0) out float lit;

void main() {
    bool reached = texture(volume_counts, uv).r < 0.5;
    lit = float(reached && answers(visible_receiver()));
}
