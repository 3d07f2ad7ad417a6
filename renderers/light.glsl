// One light in scene space.
layout(std140, binding = 1) uniform LightBlock {
    vec4 light;         // (position, 1), or (unit vector towards the light, 0)
    vec4 axis_outer;    // unit direction of a spot, cosine of its outer half angle; -2 for other kinds
    vec4 inner_range;   // cosine of the inner half angle, range (0 for none), 0, 0
    vec4 color;
};

// Not normalised: its length is the distance of a point or spot light.
vec3 towards_light(vec3 position) {
    return light.xyz - light.w * position;
}

bool in_reach(vec3 to_light) {
    float squared = dot(to_light, to_light);
    float range = inner_range.y;
    bool in_range = light.w == 0.0 || range == 0.0 || squared <= range * range;
    // A spot's half angle is at most 90 degrees, so squares compare like the cosines themselves.
    float along = max(-dot(to_light, axis_outer.xyz), 0.0);
    bool in_cone = axis_outer.w < -1.0 || along * along >= axis_outer.w * axis_outer.w * squared;
    return in_range && in_cone;
}
