#version 330 core

// A face of an environment map from two colours: light that grows evenly with the direction's height.

#include "lib/environment_math.glsl"

uniform int face;
uniform vec3 zenith;
uniform vec3 nadir;

in vec2 texcoord;
out vec4 color;

void main() {
    float height = normalize(cubeDirection(face, texcoord)).y;
    color = vec4(mix(nadir, zenith, 0.5 + 0.5 * height), 1.0);
}
