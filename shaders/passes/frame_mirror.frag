#version 330 core

// The same, where the material mirrors its surroundings.

#include "lib/frame_shadows.glsl"
#include "lib/environment.glsl"

#define ENVIRONMENT_IRRADIANCE(position, n) environmentIrradiance(n)
#define ENVIRONMENT_RADIANCE(position, r, roughness) environmentRadiance(r, roughness)
#define ENVIRONMENT_BRDF(cosEye, roughness) environmentBrdf(cosEye, roughness)

#include "lib/material.glsl"

invariant out vec4 color;

void main() {
    color = materialColor();
}
