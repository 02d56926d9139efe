#version 330 core

// What a light sees of instances: positions for the depth, texture coordinates for what is cut out.

#include "lib/instances.glsl"
#include "lib/material_vertex.glsl"

uniform mat4 depthClipFromAnchored;

void main() {
    passAttributesOn();
    positionWorld = vec3(0.0);
    normalWorld = vec3(0.0);
    gl_Position = depthClipFromAnchored * (instances[gl_InstanceID].worldFromModel * vec4(positionModel, 1.0));
}
