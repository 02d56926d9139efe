#version 330 core

// A picture as an open shutter sees it, after the idea of McGuire et al., "A reconstruction filter for plausible motion
// blur", I3D 2012. Two layers: what is seen along this pixel's own motion at its distance and farther, and nearer light
// that moves otherwise and sweeps over this pixel. What neither moves nor is swept over is copied.

#include "lib/film.glsl"
#include "lib/motion.glsl"

uniform sampler2D picture;
uniform sampler2D depthMap;
uniform sampler2D motionMap;
uniform sampler2D tiles;
uniform int tile;  // pixels along a side
uniform int taps;  // of each layer

out vec4 color;

// The largest half: light that overflowed one is infinite, and infinity times nothing is no number.
vec3 lightAt(ivec2 texel) {
    return min(texelFetch(picture, texel, 0).rgb, vec3(65504.0));
}

// The longest motion that may reach this pixel: tiles are as wide as half of it.
vec2 longestAround(ivec2 here) {
    ivec2 last = textureSize(tiles, 0) - 1;
    vec2 longest = vec2(0.0);
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
            vec2 motion = texelFetch(tiles, clamp(here / tile + ivec2(x, y), ivec2(0), last), 0).rg;
            if (dot(motion, motion) > dot(longest, longest))
                longest = motion;
        }
    return longest;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(picture, 0) - 1;
    vec4 seen = texelFetch(picture, here, 0);
    color = seen;
    vec2 longest = longestAround(here);
    float reach = length(longest);
    if (reach <= 1.0)
        return;
    vec2 motion = texelFetch(motionMap, here, 0).rg;
    float depth = texelFetch(depthMap, here, 0).r;
    float jitter = cellNoise(here);

    bool moves = dot(motion, motion) > 1.0;
    vec4 behind = vec4(lightAt(here), 1.0);
    if (moves) {
        behind = vec4(0.0);
        for (int i = 0; i < taps; ++i) {
            vec2 offset = ((float(i) + jitter) / float(taps) - 0.5) * motion;
            ivec2 there = clamp(ivec2(floor(gl_FragCoord.xy + offset)), ivec2(0), last);
            bool nearer = texelFetch(depthMap, there, 0).r < depth;
            float before = nearer ? differs(texelFetch(motionMap, there, 0).rg, motion) : 0.0;
            behind += (1.0 - before) * vec4(lightAt(there), 1.0);
        }
        behind = behind.a > 0.0 ? behind / behind.a : vec4(lightAt(here), 1.0);
    }

    vec4 before = vec4(0.0);
    float spacing = (reach + 1.0) / float(taps);
    for (int i = 0; i < taps; ++i) {
        vec2 offset = ((float(i) + jitter) / float(taps) - 0.5) * (longest + longest / reach);
        ivec2 there = clamp(ivec2(floor(gl_FragCoord.xy + offset)), ivec2(0), last);
        vec2 motionThere = texelFetch(motionMap, there, 0).rg;
        if (texelFetch(depthMap, there, 0).r >= depth)
            continue;
        float weight =
            differs(motionThere, motion) * wayCover(motionThere, offset) * spacing / max(length(motionThere), 1.0);
        if (weight > 0.0)
            before += weight * vec4(lightAt(there), 1.0);
    }
    before /= max(before.a, 1.0);
    if (moves || before.a > 0.0)
        color.rgb = before.rgb + (1.0 - before.a) * behind.rgb;
}
