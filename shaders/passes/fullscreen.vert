#version 330 core

// One triangle that covers the picture, from the vertex number alone. `texcoord` runs from (0,0) at the bottom
// left of the picture to (1,1) at its top right.

out vec2 texcoord;

void main() {
    texcoord = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
    gl_Position = vec4(2.0 * texcoord - 1.0, 0.0, 1.0);
}
