#version 330 core

// A vertical gradient behind everything, in linear light.

#include "lib/frame.glsl"

in vec2 texcoord;
out vec4 color;

void main() {
    color = vec4(mix(backgroundBottom.rgb, backgroundTop.rgb, texcoord.y), 1.0);
}
