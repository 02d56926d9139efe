#version 330 core

// What a light sees: positions for the depth, texture coordinates for what is cut out.

#include "lib/object.glsl"

uniform mat4 shadowClipFromWorld;

layout(location = 0) in vec3 positionModel;
layout(location = 2) in vec2 texcoordIn;

out vec2 texcoord;

void main() {
    texcoord = texcoordIn;
    gl_Position = shadowClipFromWorld * (worldFromModel * vec4(positionModel, 1.0));
}
