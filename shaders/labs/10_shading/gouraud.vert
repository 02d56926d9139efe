#version 330 core

// Gouraud shading: the light is evaluated at each vertex, and colours are interpolated.

#include "lib/shading.glsl"

layout(location = 0) in vec3 positionModel;
layout(location = 1) in vec3 normalModel;
layout(location = 2) in vec2 texcoordIn;

out vec3 frontTextured;
out vec3 frontPlain;
out vec3 backTextured;
out vec3 backPlain;
out vec2 texcoord;

void main() {
    vec3 normal = safeNormalize(worldNormalFromModel * normalModel);
    vec4 positionWorld = worldFromModel * vec4(positionModel, 1.0);
    Shade front = shade(positionWorld.xyz, normal);
    frontTextured = front.textured;
    frontPlain = front.plain;
#ifdef DOUBLE_SIDED
    Shade back = shade(positionWorld.xyz, -normal);
    backTextured = back.textured;
    backPlain = back.plain;
#else
    backTextured = front.textured;
    backPlain = front.plain;
#endif
    texcoord = texcoordIn;
    gl_Position = clipFromWorld * positionWorld;
}
