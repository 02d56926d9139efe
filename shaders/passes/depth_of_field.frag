#version 330 core

// The two layers of depth_of_field_gather.frag, averaged over cells of pixels at the same distance and laid over each
// other. What is sharp and lies behind nothing blurred is copied.

#include "lib/lens.glsl"

uniform sampler2D picture;
uniform sampler2D depthMap;
uniform sampler2D behindMap;
uniform sampler2D beforeMap;
uniform float atNear;  // circle of confusion, pixels
uniform float atFar;
uniform float most;

out vec4 color;

float cocAt(ivec2 texel) {
    return circleOfConfusion(texelFetch(depthMap, texel, 0).r, atNear, atFar, most);
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(picture, 0) - 1;
    color = texelFetch(picture, here, 0);
    float coc = cocAt(here);
    vec4 ownBehind = texelFetch(behindMap, here, 0);
    vec4 ownBefore = texelFetch(beforeMap, here, 0);
    vec4 behind = vec4(0.0);
    vec4 before = vec4(0.0);
    float radius = 0.0;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            ivec2 there = clamp(here + ivec2(x, y), ivec2(0), last);
            float sameSurface = discCover(1.0, abs(cocAt(there) - coc));
            vec4 layer = texelFetch(behindMap, there, 0);
            vec4 above = texelFetch(beforeMap, there, 0);
            behind += sameSurface * vec4(layer.rgb, 1.0);
            before += sameSurface * above;
            radius += sameSurface * above.a * layer.a;
        }
    radius = before.a > 0.0 ? radius / before.a : 0.0;
    before = mix(ownBefore, before / behind.a, cellShare(radius));
    if (abs(coc) <= 0.5 && before.a == 0.0)
        return;
    vec3 light = mix(ownBehind.rgb, behind.rgb / behind.a, cellShare(abs(coc)));
    color.rgb = before.rgb + (1.0 - before.a) * light;
}
