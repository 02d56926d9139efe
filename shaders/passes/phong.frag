#version 330 core

// Phong shading: the interpolated normal, made unit length again, lights each fragment.

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
}
