#version 330 core

// How far each pixel of a world at rest moves over the picture while the camera moves: from its depth to where the
// camera sees that point when the shutter opens and closes.

#include "lib/motion.glsl"

uniform sampler2D depthMap;
uniform mat4 openFromView;   // from (x, y, 1 − depth, depth), x and y in −1 … 1
uniform mat4 closeFromView;
uniform vec2 sizePixels;
uniform float most;          // pixels

in vec2 texcoord;
out vec4 motion;

void main() {
    float depth = texelFetch(depthMap, ivec2(gl_FragCoord.xy), 0).r;
    vec4 place = vec4(2.0 * texcoord - 1.0, 1.0 - depth, depth);
    motion = vec4(screenMotion(openFromView * place, closeFromView * place, sizePixels, most), 0.0, 0.0);
}
