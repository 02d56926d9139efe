#version 330 core

// Only the depth is kept; what the material cuts out casts no shadow.

#include "lib/object.glsl"

in vec2 texcoord;

void main() {
#ifdef CUT_OUT
    if (texture(baseColorTexture, texcoord).a * emission.a < diffuse.a)
        discard;
#endif
}
