#version 330 core

// A face of an environment map from a panorama: the mean of samples evenly spread over each texel.

#include "lib/environment_math.glsl"

uniform int face;
uniform int size;     // texels along an edge of the face
uniform int samples;  // along an edge of a texel
uniform sampler2D panorama;

out vec4 color;

void main() {
    vec3 sum = vec3(0.0);
    for (int y = 0; y < samples; ++y)
        for (int x = 0; x < samples; ++x) {
            vec2 within = (vec2(x, y) + 0.5) / float(samples);
            vec2 st = (floor(gl_FragCoord.xy) + within) / float(size);
            sum += textureLod(panorama, panoramaPlace(cubeDirection(face, st)), 0.0).rgb;
        }
    color = vec4(sum / float(samples * samples), 1.0);
}
