#version 330 core

// Phong shading where one light is asked for its shadow map first.

#include "lib/phong.glsl"
#include "lib/shadow.glsl"

// The normal of the triangle itself, from how the position changes over the screen; `otherwise` where the steps
// drown in the rounding of the position, 2^-24 of its size: at 256 times that they are good to 1 %.
vec3 triangleNormal(vec3 positionWorld, vec3 otherwise) {
    vec3 right = dFdx(positionWorld);
    vec3 up = dFdy(positionWorld);
    float rounding = 256.0 * 5.96e-8 * length(positionWorld);
    vec3 n = safeNormalize(cross(right, up));
    return min(length(right), length(up)) > rounding && n != vec3(0.0) ? n : otherwise;
}

#define LIT_SHARE(light, position, n) \
    ((light) == shadowMode.z ? litShare(position, triangleNormal(position, n)) : 1.0)

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
#ifdef LIT_MASK
    LightSample incoming = sampleLight(phongLight(lights[max(shadowMode.z, 0)]), positionWorld);
    bool faces = incoming.strength > 0.0 && dot(normal, incoming.wi) > 0.0;
    float lit = litShare(positionWorld, triangleNormal(positionWorld, normal));
    color = vec4(vec3(faces ? lit : 0.0), 1.0);
#else
    color = textureShade(shade(positionWorld, normal), texcoord);
#endif
}
