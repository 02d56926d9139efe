#version 330 core

// Phong shading of the ground; where the mask says so, without the sun.

#include "lib/textured_shade.glsl"

in vec3 positionWorld;
in vec3 normalWorld;
in vec2 texcoord;

uniform sampler2D groundShadow;
uniform float highestGround;  // above it the plane of the shadows is not the ground

out vec4 color;

void main() {
    vec3 normal = safeNormalize(normalWorld);
    Shade lit = shade(positionWorld, normal);
    bool isLevel = abs(positionWorld.y) < highestGround;
    // task: Ask the mask whether this pixel of level ground lies in shadow: 1 where it does.
    float shadowed = isLevel ? texelFetch(groundShadow, ivec2(gl_FragCoord.xy), 0).r : 0.0;
    // instead: float shadowed = 0.0;
    // end of task
    vec3 sky = ambient.rgb * ambientLight.rgb;
    Shade shaded = Shade(mix(lit.textured, sky, shadowed), mix(lit.plain, emission.rgb, shadowed));
    color = textureShade(shaded, texcoord);
}
