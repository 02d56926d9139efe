#version 330 core

// FancyShader of the eight steps: the paint, shaded along the hull.

in vec3 paint;
in vec2 texcoord;
out vec4 color;

void main() {
    color = vec4(paint * (0.4 + 0.6 * texcoord.x), 1.0);
}
