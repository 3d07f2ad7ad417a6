// Casters on a map, each grown by half a texel, so that it covers the middle of every texel that it touches
// (Hasselgren, Akenine-Moeller and Ohlsson 2005, "Conservative rasterization", GPU Gems 2, chapter 42).
#section grow
layout(triangles) in;
layout(triangle_strip, max_vertices = 21) out;
uniform vec2 half_texel;    // in normalised device coordinates

vec3 corners[3];
vec2 gradient;
vec2 depths;

void emit(int i, vec2 offset) {
    float depth = clamp(corners[i].z + dot(gradient, offset), depths.x, depths.y);
    gl_Position = vec4(corners[i].xy + offset, depth, 1.0);
    EmitVertex();
}

// What a texel sweeps whose middle runs along an edge.
void sweep(int from, int to) {
    vec2 along = corners[to].xy - corners[from].xy;
    vec2 ahead = half_texel * vec2(along.x < 0.0 ? -1.0 : 1.0, along.y < 0.0 ? -1.0 : 1.0);
    vec2 across = vec2(-ahead.x, ahead.y);
    emit(from, -ahead);
    emit(from, across);
    emit(from, -across);
    emit(to, across);
    emit(to, -across);
    emit(to, ahead);
    EndPrimitive();
}

void main() {
    bool ahead = true;
    for (int i = 0; i < 3; ++i) {
        ahead = ahead && gl_in[i].gl_Position.w > 0.0;
        corners[i] = gl_in[i].gl_Position.xyz / gl_in[i].gl_Position.w;
        gl_Position = gl_in[i].gl_Position;
        EmitVertex();
    }
    EndPrimitive();
    if (!ahead) return;
    vec3 first = corners[1] - corners[0], second = corners[2] - corners[0];
    float doubled = first.x * second.y - first.y * second.x;
    vec2 turned = vec2(first.z * second.y - second.z * first.y, second.z * first.x - first.z * second.x);
    gradient = doubled == 0.0 ? vec2(0.0) : turned / doubled;
    depths.x = min(corners[0].z, min(corners[1].z, corners[2].z));
    depths.y = max(corners[0].z, max(corners[1].z, corners[2].z));
    sweep(0, 1);
    sweep(1, 2);
    sweep(2, 0);
}
