#version 330 core

// Marks a pixel of the ground as shadowed, however many shadows lie on it.

out vec4 color;

void main() {
    color = vec4(1.0);
}
