uniform vec3 eye;
uniform vec3 lamp;
in vec3 pos;
in vec3 nor;
in vec4 col;
layout (location = 0) out vec4 pixel;

void main() {
    vec3 n = normalize(nor);
    // Both sides are lit: what is open is seen from inside, too.
    if (dot(n, eye - pos) < 0.0) {
        n = -n;
    }
    float shade = 0.58 + 0.42 * max(dot(n, lamp), 0.0);
    pixel = vec4(col.rgb * shade, col.a);
}
