uniform vec3 eye;
uniform vec3 light;
in vec3 at;
in vec3 across;
in vec4 tint;
out vec4 pixel;

void main() {
    vec3 n = normalize(across);
    // Both sides are lit: what is open is seen from inside, too.
    if (dot(n, eye - at) < 0.0) {
        n = -n;
    }
    float shade = 0.58 + 0.42 * max(dot(n, light), 0.0);
    pixel = vec4(tint.rgb * shade, tint.a);
}
