#version 330 core

// Only the depth is kept; what the material cuts out casts no shadow.

#include "lib/material.glsl"

void main() {
#ifdef ALPHA_MASK
    if (surfaceColor().a < emission.a)
        discard;
#endif
}
