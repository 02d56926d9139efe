#version 330 core

// Phong shading: position and normal go to the fragments.

#include "lib/shading.glsl"

layout(location = 0) in vec3 positionModel;
layout(location = 1) in vec3 normalModel;
layout(location = 2) in vec2 texcoordIn;

out vec3 positionWorld;
out vec3 normalWorld;
out vec2 texcoord;

void main() {
    // task: Carry the vertex from its model's own space into the world.
    vec4 position = worldFromModel * vec4(positionModel, 1.0);
    // instead: vec4 position = vec4(positionModel, 1.0);
    // end of task
    positionWorld = position.xyz;
    normalWorld = safeNormalize(worldNormalFromModel * normalModel);
    texcoord = texcoordIn;
    gl_Position = clipFromWorld * position;
}
