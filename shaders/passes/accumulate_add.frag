#version 330 core

// One pass of the accumulation, weighted.

uniform sampler2D picture;
uniform float weight;

out vec4 color;

void main() {
    // task: Give each pass its share, so that all of them together make one picture.
    color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0) * weight;
    // instead: color = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
    // end of task
}
