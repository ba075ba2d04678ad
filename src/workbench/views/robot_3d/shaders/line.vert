uniform mat4 clip_from_base;
uniform vec3 eye;
uniform vec2 size;
uniform float scale;
uniform float lift;
in vec3 begin;
in vec3 end;
in vec4 colour;
in float width;
out vec4 tint;

// Slightly towards the eye, so that a line on a face is seen; its place in the picture does not change.
vec4 lifted(vec3 p) {
    return clip_from_base * vec4(p + normalize(eye - p) * lift, 1.0);
}

void main() {
    const int CORNERS[6] = int[6](0, 1, 2, 2, 1, 3);
    int corner = CORNERS[gl_VertexID];
    vec4 a = lifted(begin);
    vec4 b = lifted(end);
    // What is nearer than the near plane has no place in the picture.
    float da = a.z + a.w;
    float db = b.z + b.w;
    if (da < 0.0 && db > 0.0) {
        a = mix(a, b, da / (da - db));
    } else if (db < 0.0 && da > 0.0) {
        b = mix(b, a, db / (db - da));
    }
    vec2 d = (b.xy / b.w - a.xy / a.w) * size;
    vec2 along = dot(d, d) > 1e-8 ? normalize(d) : vec2(1.0, 0.0);
    vec2 side = vec2(-along.y, along.x);
    float half_width = 0.5 * max(width * scale, 1.0);
    bool last = corner >= 2;
    bool left = corner == 1 || corner == 3;
    // Half a width longer: bends are closed.
    vec2 offset = (left ? side : -side) + (last ? along : -along);
    vec4 p = last ? b : a;
    p.xy += offset * half_width * 2.0 / size * p.w;
    gl_Position = p;
    tint = colour;
}
