#version 330 core

// Metallic-roughness materials lit by lights without shadows and by ambient light.

#include "lib/material.glsl"

invariant out vec4 color;

void main() {
    color = materialColor();
}
