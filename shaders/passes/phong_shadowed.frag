#version 330 core

// Phong shading where one light is asked for its shadow map first.

#include "lib/phong.glsl"
#include "lib/shadow.glsl"
#include "lib/triangle_normal.glsl"

// task: The share of a light that reaches a point: for the light that has a shadow map what the map says, for
// others all of it.
#define LIT_SHARE(light, position, n) \
    ((light) == shadowMode.z ? litShare(position, triangleNormal(position, n)) : 1.0)
// instead: #define LIT_SHARE(light, position, n) 1.0
// end of task

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
