#version 330 core

// What was traced on the CPU, texel by pixel: its rows run from the top down.

uniform sampler2D light;
uniform float exposure;

out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 texel = texelFetch(light, ivec2(at.x, textureSize(light, 0).y - 1 - at.y), 0).rgb;
    color = vec4(exposure * texel, 1.0);
}
