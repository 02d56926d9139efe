#version 330 core

// Places one instance of a mesh; passes on what the material's features read (lib/material.glsl).

#include "lib/frame.glsl"
#include "lib/instances.glsl"
#include "lib/material_vertex.glsl"
#include "lib/phong.glsl"

layout(location = 1) in vec3 normalModel;
layout(location = 5) in vec4 tangentModel;

#ifdef NORMAL_MAP
out vec4 tangentWorld;
#endif

invariant gl_Position;

void main() {
    Instance instance = instances[gl_InstanceID];
    vec4 position = instance.worldFromModel * vec4(positionModel, 1.0);
    positionWorld = position.xyz;
    normalWorld = safeNormalize(instance.worldNormalFromModel * normalModel);
    passAttributesOn();
#ifdef NORMAL_MAP
    // Tangents lie in the surface and move with it. A mirrored placement turns the bitangent, which the normal's
    // cofactor matrix does not know of.
    mat3 linear = mat3(instance.worldFromModel);
    float mirrored = determinant(linear) < 0.0 ? -1.0 : 1.0;
    tangentWorld = vec4(safeNormalize(linear * tangentModel.xyz), tangentModel.w * mirrored);
#endif
    gl_Position = clipFromWorld * position;
}
