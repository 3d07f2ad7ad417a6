// Depth of the casters as the light sees them.
#section caster_vertex
in vec3 position;
uniform mat4 map_from_scene;

void main() {
    gl_Position = map_from_scene * vec4(position, 1.0);
}

#section nothing
void main() {}
