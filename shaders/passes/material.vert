#version 330 core

// Places one instance of a mesh; passes on what the material's features read (lib/material.glsl).

#include "lib/frame.glsl"
#include "lib/instances.glsl"
#include "lib/phong.glsl"

layout(location = 0) in vec3 positionModel;
layout(location = 1) in vec3 normalModel;
layout(location = 2) in vec2 texcoordIn;
layout(location = 4) in vec2 texcoord1In;
layout(location = 5) in vec4 tangentModel;
layout(location = 6) in vec4 colorIn;

out vec3 positionWorld;
out vec3 normalWorld;
#ifdef TEXTURED
out vec2 texcoord;
#endif
#ifdef SECOND_TEXCOORDS
out vec2 texcoord1;
#endif
#ifdef NORMAL_MAP
out vec4 tangentWorld;
#endif
#ifdef VERTEX_COLORS
out vec4 vertexColor;
#endif

invariant gl_Position;

void main() {
    Instance instance = instances[gl_InstanceID];
    vec4 position = instance.worldFromModel * vec4(positionModel, 1.0);
    positionWorld = position.xyz;
    normalWorld = safeNormalize(instance.worldNormalFromModel * normalModel);
#ifdef TEXTURED
    texcoord = texcoordIn;
#endif
#ifdef SECOND_TEXCOORDS
    texcoord1 = texcoord1In;
#endif
#ifdef NORMAL_MAP
    // Tangents lie in the surface and move with it. A mirrored placement turns the bitangent, which the normal's
    // cofactor matrix does not know of.
    mat3 linear = mat3(instance.worldFromModel);
    float mirrored = determinant(linear) < 0.0 ? -1.0 : 1.0;
    tangentWorld = vec4(safeNormalize(linear * tangentModel.xyz), tangentModel.w * mirrored);
#endif
#ifdef VERTEX_COLORS
    vertexColor = colorIn;
#endif
    gl_Position = clipFromWorld * position;
}
