#version 330 core

// GrayScaleShader of the eight steps.

#include "lib/film.glsl"

uniform sampler2D picture;

in vec2 texcoord;
out vec4 color;

void main() {
    color = vec4(vec3(luminance(texture(picture, texcoord).rgb)), 1.0);
}
