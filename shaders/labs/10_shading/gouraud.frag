#version 330 core

// Gouraud shading: the interpolated colour is all there is.

#include "lib/textured_shade.glsl"

in vec3 frontTextured;
in vec3 frontPlain;
in vec3 backTextured;
in vec3 backPlain;
in vec2 texcoord;

out vec4 color;

void main() {
    Shade shaded = gl_FrontFacing ? Shade(frontTextured, frontPlain) : Shade(backTextured, backPlain);
    color = textureShade(shaded, texcoord);
}
