#version 330 core

// How far the points of a moving instance move over the picture, where the picture shows that instance: where the
// depth is its own.

#include "lib/motion.glsl"

uniform sampler2D depthMap;
uniform vec2 sizePixels;
uniform float most;  // pixels

in vec4 open;
in vec4 close;
out vec4 motion;

void main() {
    // The picture's vertices may be rounded otherwise than these: depth by 2^-20 (eight times 2^-23, of products of
    // matrices and the division), and places by 1/128 of a pixel (two steps of 1/256), which a slope turns into depth.
    float rounding = 9.5367431640625e-7 + fwidth(gl_FragCoord.z) / 128.0;
    vec2 moved = screenMotion(open, close, sizePixels, most);
    if (abs(gl_FragCoord.z - texelFetch(depthMap, ivec2(gl_FragCoord.xy), 0).r) > rounding)
        discard;
    motion = vec4(moved, 0.0, 0.0);
}
