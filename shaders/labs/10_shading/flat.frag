#version 330 core

// Flat shading: every fragment of a triangle has the triangle's colour.

#include "lib/textured_shade.glsl"

flat in vec3 frontTextured;
flat in vec3 frontPlain;
flat in vec3 backTextured;
flat in vec3 backPlain;
in vec2 texcoord;

out vec4 color;

void main() {
    Shade shaded = gl_FrontFacing ? Shade(frontTextured, frontPlain) : Shade(backTextured, backPlain);
    color = textureShade(shaded, texcoord);
}
