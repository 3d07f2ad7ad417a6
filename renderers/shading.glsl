// The one place where light becomes colour, for every technique.
#include "receiver.glsl"

#section domain
layout(location = 0) out float domain;

void main() {
    domain = float(answers(visible_receiver()));
}

#section shade
layout(binding = 2) uniform sampler2D scene_albedo;
layout(binding = 3) uniform sampler2D lit_mask;
layout(location = 0) out vec4 shaded;

const float AMBIENT = 0.18;

// sRGB's curve fitted by three square roots: within 0.0007 of it above 0.003, and much cheaper than a power.
vec3 encode_srgb(vec3 linear) {
    vec3 half_root = sqrt(linear), quarter_root = sqrt(half_root), eighth_root = sqrt(quarter_root);
    return 0.58965 * half_root + 0.77280 * quarter_root - 0.36182 * eighth_root;
}

// Lagarde and de Rousiers 2014, "Moving Frostbite to PBR", section 4: windowed to end at the range. The inverse
// square is left out on purpose: these pictures are there to judge shadows at every distance from the light.
float fall_off(vec3 to_light) {
    float squared = dot(to_light, to_light);
    float range = inner_range.y;
    float ratio = light.w == 0.0 || range == 0.0 ? 0.0 : squared / (range * range);
    float window = max(1.0 - ratio * ratio, 0.0);
    float cosine = -dot(to_light, axis_outer.xyz) * inversesqrt(squared);
    float cone = smoothstep(axis_outer.w, max(inner_range.x, axis_outer.w + 1e-4), cosine);
    return window * window * (axis_outer.w < -1.0 ? 1.0 : cone);
}

void main() {
    Receiver receiver = visible_receiver();
    vec3 albedo = texture(scene_albedo, uv).rgb;
    float lit = texture(lit_mask, uv).r;
    vec3 normal = normalize(receiver.normal);
    vec3 to_light = towards_light(receiver.position);
    float cosine = max(dot(normal, to_light) * inversesqrt(dot(to_light, to_light)), 0.0);
    // A little light from above tells surfaces in shadow apart.
    float ambient = AMBIENT * (0.75 + 0.25 * normal.y);
    vec3 radiance = albedo * (ambient + (1.0 - AMBIENT) * lit * cosine * fall_off(to_light) * color.rgb);
    shaded = vec4(encode_srgb(min(radiance, 1.0)), 1.0);
}
