#version 330 core

// Flat shading: one colour a triangle. The light is evaluated at the triangle's centroid with the normal of its
// own plane, so it does not matter which corner the rasterizer takes the colour from.

#include "lib/shading.glsl"

layout(location = 0) in vec3 positionModel;
layout(location = 1) in vec3 planeNormalModel;
layout(location = 2) in vec2 texcoordIn;
layout(location = 3) in vec3 centroidModel;

flat out vec3 frontTextured;
flat out vec3 frontPlain;
flat out vec3 backTextured;
flat out vec3 backPlain;
out vec2 texcoord;

void main() {
    vec3 normal = safeNormalize(worldNormalFromModel * planeNormalModel);
    vec3 centroidWorld = (worldFromModel * vec4(centroidModel, 1.0)).xyz;
    Shade front = shade(centroidWorld, normal);
    frontTextured = front.textured;
    frontPlain = front.plain;
#ifdef DOUBLE_SIDED
    Shade back = shade(centroidWorld, -normal);
    backTextured = back.textured;
    backPlain = back.plain;
#else
    backTextured = front.textured;
    backPlain = front.plain;
#endif
    texcoord = texcoordIn;
    gl_Position = clipFromWorld * (worldFromModel * vec4(positionModel, 1.0));
}
