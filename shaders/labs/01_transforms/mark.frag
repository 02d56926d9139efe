#version 330 core

// The pixel that a vertex lights up: its number, and its depth in the window.

flat in float number;

layout(location = 0) out vec4 mark;

void main() {
    mark = vec4(number, gl_FragCoord.z, 0.0, 1.0);
}
