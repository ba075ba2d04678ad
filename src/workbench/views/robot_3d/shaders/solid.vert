uniform mat4 clip_from_base;
in vec3 position;
in vec3 normal;
in vec4 colour;
out vec3 at;
out vec3 across;
out vec4 tint;

void main() {
    at = position;
    across = normal;
    tint = colour;
    gl_Position = clip_from_base * vec4(position, 1.0);
}
