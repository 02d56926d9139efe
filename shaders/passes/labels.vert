#version 330 core

// Glyphs of a text, placed in pixels from the top left of the viewport.

uniform vec2 viewportPixels;

layout(location = 0) in vec2 cornerPixels;
layout(location = 1) in vec2 texcoordIn;
layout(location = 2) in vec4 colorIn;

out vec2 texcoord;
out vec4 textColor;

void main() {
    texcoord = texcoordIn;
    textColor = colorIn;
    vec2 ndc = 2.0 * cornerPixels / viewportPixels - 1.0;
    gl_Position = vec4(ndc.x, -ndc.y, 0.0, 1.0);
}
