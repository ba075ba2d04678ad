in vec2 at;
in vec4 tint;
flat in float radius;
flat in float ring;
out vec4 pixel;

void main() {
    float distance = length(at);
    float cover = clamp(radius - distance + 0.5, 0.0, 1.0);
    if (ring > 0.0) {
        cover = min(cover, clamp(distance - (radius - ring) + 0.5, 0.0, 1.0));
    }
    if (cover < 0.02) {
        discard;
    }
    pixel = vec4(tint.rgb, tint.a * cover);
}
