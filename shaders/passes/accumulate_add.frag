#version 330 core

// One pass of the accumulation, weighted.

uniform sampler2D picture;
uniform float weight;

out vec4 color;

void main() {
    color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0) * weight;
}
