#version 330 core

// A picture made on the CPU, its rows from the top down; or how far a drawn one is from it, in colours.

uniform sampler2D made;
uniform sampler2D drawn;
uniform int difference;   // 1: the difference
uniform float maximum;    // what is shown as the brightest colour
uniform vec3 ramp[5];     // linear colours of 0, ¼ … 1 of the maximum

out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec3 value = texelFetch(made, ivec2(at.x, textureSize(made, 0).y - 1 - at.y), 0).rgb;
    color = vec4(value, 1.0);
    if (difference == 0)
        return;
    vec3 apart = abs(texelFetch(drawn, at, 0).rgb - value);
    float place = 4.0 * min(max(apart.r, max(apart.g, apart.b)) / maximum, 1.0);
    int step1 = min(int(place), 3);
    color = vec4(mix(ramp[step1], ramp[step1 + 1], place - float(step1)), 1.0);
}
