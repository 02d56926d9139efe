#version 330 core

// The two layers of depth_of_field_gather.frag, averaged over cells of pixels at the same distance and laid over each
// other. What is sharp and lies behind nothing blurred is copied.

#include "lib/lens.glsl"

uniform sampler2D picture;
uniform sampler2D behindMap;
uniform sampler2D beforeMap;

out vec4 color;

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(picture, 0) - 1;
    vec4 seen = texelFetch(picture, here, 0);
    vec4 own = texelFetch(behindMap, here, 0);
    vec4 behind = vec4(0.0);
    vec4 before = vec4(0.0);
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            ivec2 there = clamp(here + ivec2(x, y), ivec2(0), last);
            vec4 layer = texelFetch(behindMap, there, 0);
            float sameSurface = discCover(1.0, abs(layer.a - own.a));
            behind += sameSurface * vec4(layer.rgb, 1.0);
            before += sameSurface * texelFetch(beforeMap, there, 0);
        }
    before /= behind.a;
    color = seen;
    if (abs(own.a) <= 0.5 && before.a == 0.0)
        return;
    vec3 light = mix(own.rgb, behind.rgb / behind.a, cellShare(abs(own.a)));
    color.rgb = before.rgb + (1.0 - before.a) * light;
}
