#version 330 core

// The traced picture, texel by pixel, or how far the drawn one is from it.

uniform sampler2D traced;  // its first row is the top one
uniform sampler2D drawn;
uniform int showError;

out vec4 color;

// Black, violet, red, orange, light yellow, from 0 to 1.
vec3 heat(float x) {
    x = clamp(x, 0.0, 1.0);
    vec3 low = mix(vec3(0.0), vec3(0.11, 0.01, 0.22), clamp(4.0 * x, 0.0, 1.0));
    vec3 middle = mix(low, vec3(0.58, 0.03, 0.05), clamp(4.0 * x - 1.0, 0.0, 1.0));
    vec3 high = mix(middle, vec3(0.95, 0.35, 0.02), clamp(4.0 * x - 2.0, 0.0, 1.0));
    return mix(high, vec3(1.0, 0.93, 0.55), clamp(4.0 * x - 3.0, 0.0, 1.0));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec3 exact = texelFetch(traced, ivec2(pixel.x, textureSize(traced, 0).y - 1 - pixel.y), 0).rgb;
    if (showError == 0) {
        color = vec4(exact, 1.0);
        return;
    }
    vec3 off = texelFetch(drawn, pixel, 0).rgb - exact;
    color = vec4(heat(2.0 * sqrt(dot(off, off) / 3.0)), 1.0);
}
