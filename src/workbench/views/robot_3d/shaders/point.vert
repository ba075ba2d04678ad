uniform mat4 clip_from_base;
uniform vec3 eye;
uniform vec2 size;
uniform float scale;
uniform float lift;
uniform float opening;
in vec3 centre;
in vec4 colour;
in vec3 look;
out vec2 at;
out vec4 tint;
flat out float radius;
flat out float ring;

void main() {
    // A triangle around the disc: half as many corners as two triangles that make a square.
    const vec2 CORNERS[3] = vec2[3](vec2(0.0, 2.0), vec2(-1.7320508, -1.0), vec2(1.7320508, -1.0));
    vec4 p = clip_from_base * vec4(centre + normalize(eye - centre) * lift, 1.0);
    radius = 0.5 * look.x * scale;
    ring = look.y * scale;
    // The part that the point stands for is large enough itself.
    float seen = look.z * size.y / (opening * p.w);
    if (seen > radius) {
        radius = 0.0;
    }
    float reach = radius > 0.0 ? radius + 1.0 : 0.0;
    at = CORNERS[gl_VertexID] * reach;
    p.xy += at * 2.0 / size * p.w;
    gl_Position = p;
    tint = colour;
}
