#version 330 core

// What is brighter than a threshold, averaged over factor × factor texels: the light that bloom spreads.

#include "lib/film.glsl"

uniform sampler2D picture;
uniform int factor;
uniform float threshold;

out vec4 color;

void main() {
    ivec2 size = textureSize(picture, 0);
    ivec2 corner = ivec2(gl_FragCoord.xy) * factor;
    vec3 sum = vec3(0.0);
    for (int y = 0; y < factor; ++y)
        for (int x = 0; x < factor; ++x) {
            // The largest half: light that overflowed one is infinite, and infinity over itself is nothing.
            vec3 c = min(texelFetch(picture, min(corner + ivec2(x, y), size - 1), 0).rgb, vec3(65504.0));
            float light = luminance(c);
            sum += light > threshold ? c * ((light - threshold) / light) : vec3(0.0);
        }
    color = vec4(sum / float(factor * factor), 1.0);
}
