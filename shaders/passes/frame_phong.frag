#version 330 core

// Phong shading of a planned frame: with the shadow maps that there are, opaque or BLENDED.

#include "lib/frame_shadows.glsl"
#include "lib/textured_shade.glsl"

in vec3 positionWorld;
in vec3 normalWorld;
in vec2 texcoord;

out vec4 color;

void main() {
    vec3 normal = safeNormalize(normalWorld);
#ifdef DOUBLE_SIDED
    if (!gl_FrontFacing)
        normal = -normal;
#endif
    color = textureShade(shade(positionWorld, normal), texcoord);
#ifdef BLENDED
    color.a = texture(baseColorTexture, texcoord).a * emission.a;
#endif
}
