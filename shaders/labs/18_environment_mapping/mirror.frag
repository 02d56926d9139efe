#version 330 core

// A mirror that asks the environment map what it reflects.

#include "lib/frame.glsl"
#include "lib/object.glsl"
#include "lib/phong.glsl"
#include "lib/environment.glsl"

uniform float roughness;

in vec3 positionWorld;
in vec3 normalWorld;
in vec2 texcoord;

out vec4 color;

void main() {
    vec3 n = safeNormalize(normalWorld);
    // task: The direction in which a mirror with the normal n sends on what comes from the eye.
    vec3 reflected = reflectDirection(safeNormalize(positionWorld - eyeWorld.xyz), n);
    // instead: vec3 reflected = n;
    // end of task
#ifdef SHOW_VECTORS
    color = vec4(0.5 + 0.5 * reflected, 1.0);
#else
    // All that is known of the point itself: nothing, but for box projection.
    vec3 direction = environmentDirection(positionWorld, reflected);
    color = vec4(specular.rgb * environmentRadiance(direction, roughness), 1.0);
#endif
}
