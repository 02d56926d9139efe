#version 330 core

// Whatever shader was in use before the eight steps.

out vec4 color;

void main() {
    color = vec4(1.0, 0.0, 1.0, 1.0);
}
