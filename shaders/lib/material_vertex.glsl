// What vertices hand on to fragments as it is, as far as the material's features read it (lib/material.glsl).

layout(location = 0) in vec3 positionModel;
layout(location = 2) in vec2 texcoordIn;
layout(location = 4) in vec2 texcoord1In;
layout(location = 6) in vec4 colorIn;

out vec3 positionWorld;
out vec3 normalWorld;
#ifdef TEXTURED
out vec2 texcoord;
#endif
#ifdef SECOND_TEXCOORDS
out vec2 texcoord1;
#endif
#ifdef VERTEX_COLORS
out vec4 vertexColor;
#endif

void passAttributesOn() {
#ifdef TEXTURED
    texcoord = texcoordIn;
#endif
#ifdef SECOND_TEXCOORDS
    texcoord1 = texcoord1In;
#endif
#ifdef VERTEX_COLORS
    vertexColor = colorIn;
#endif
}
