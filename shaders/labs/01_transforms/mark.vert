#version 330 core

// One vertex on its way through the spaces, a matrix at a time. What comes out is in clip space; OpenGL divides
// by w and stretches the result over the viewport.

uniform mat4 worldFromModel;
uniform mat4 eyeFromWorld;
uniform mat4 clipFromEye;

layout(location = 0) in vec3 positionModel;

flat out float number;  // of the vertex, from 1

void main() {
    vec4 world = worldFromModel * vec4(positionModel, 1.0);
    vec4 eye = eyeFromWorld * world;
    gl_Position = clipFromEye * eye;
    number = float(gl_VertexID + 1);
}
