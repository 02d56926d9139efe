#version 330 core

// The triangles of the eight steps, from the vertex number alone: a spaceship of three triangles (0 to 8), and one
// triangle that covers the target (9 to 11).

out vec3 paint;
out vec2 texcoord;

const vec2 corners[12] = vec2[](vec2(-0.7, -0.2), vec2(0.8, 0.0), vec2(-0.7, 0.3),     // hull
                                vec2(-0.6, -0.1), vec2(0.0, -0.1), vec2(-0.9, -0.8),   // fin
                                vec2(-0.6, 0.1), vec2(0.0, 0.1), vec2(-0.9, 0.8),      // fin
                                vec2(-1.0, -1.0), vec2(3.0, -1.0), vec2(-1.0, 3.0));

void main() {
    vec2 corner = corners[gl_VertexID];
    paint = gl_VertexID < 3 ? vec3(0.8, 0.5, 0.2) : gl_VertexID < 9 ? vec3(0.2, 0.3, 0.9) : vec3(0.6, 0.1, 0.1);
    texcoord = 0.5 * corner + 0.5;
    gl_Position = vec4(corner, 0.0, 1.0);
}
