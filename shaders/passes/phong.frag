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
    // task: Light this fragment: by its own normal, made unit length above, at its own place.
    color = textureShade(shade(positionWorld, normal), texcoord);
    // instead: color = vec4(diffuse.rgb, 1.0);
    // end of task
}
