#version 330 core

// The typeface holds the coverage of each texel.

uniform sampler2D typeface;

in vec2 texcoord;
in vec4 textColor;

out vec4 color;  // multiplied with its opacity

void main() {
    color = vec4(textColor.rgb, 1.0) * (textColor.a * texture(typeface, texcoord).r);
}
