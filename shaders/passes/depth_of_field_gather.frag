#version 330 core

// Two layers of each pixel. `behind`: what is seen at this pixel's own distance and farther, averaged over its own
// disc; what is nearer is left out, so that it does not bleed into the background. `before`: nearer light whose discs
// reach this pixel, each texel spread over its own disc; what that does not cover shows what is behind.

#include "lib/lens.glsl"

uniform sampler2D picture;
uniform sampler2D depthMap;
uniform sampler2D tiles;
uniform int tile;       // pixels along a side
uniform float atNear;   // circle of confusion, pixels
uniform float atFar;
uniform float most;
uniform int taps;       // of each layer, at least

layout(location = 0) out vec4 behind;  // a: the mean radius of the discs of what is before
layout(location = 1) out vec4 before;  // times how much of the pixel it covers, which is in a

float cocAt(ivec2 texel) {
    return circleOfConfusion(texelFetch(depthMap, texel, 0).r, atNear, atFar, most);
}

// The largest half: light that overflowed one is infinite, and infinity times nothing is no number.
vec3 lightAt(ivec2 texel) {
    return min(texelFetch(picture, texel, 0).rgb, vec3(65504.0));
}

// The circle of confusion of the nearest thing that may reach this pixel: tiles are as wide as discs reach.
float nearestAround(ivec2 here) {
    ivec2 last = textureSize(tiles, 0) - 1;
    float nearest = most;
    for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x)
            nearest = min(nearest, texelFetch(tiles, clamp(here / tile + ivec2(x, y), ivec2(0), last), 0).r);
    return nearest;
}

void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    ivec2 last = textureSize(picture, 0) - 1;
    float coc = cocAt(here);
    int k = here.x % 3 + 3 * (here.y % 3);

    behind = vec4(lightAt(here), 0.0);
    if (abs(coc) > 0.5) {
        float reach = tapRadius(abs(coc));
        int count = tapsOfDisc(reach, taps);
        vec4 sum = vec4(0.0);
        vec2 direction = spiralStart(k);
        for (int i = 0; i < count; ++i) {
            vec2 offset = reach * sqrt(spiralShare(i, k, count)) * direction;
            ivec2 there = clamp(ivec2(floor(gl_FragCoord.xy + offset)), ivec2(0), last);
            sum += (1.0 - isBefore(cocAt(there), coc)) * vec4(lightAt(there), 1.0);
            direction = spiralNext(direction);
        }
        if (sum.a > 0.0)
            behind.rgb = sum.rgb / sum.a;
    }

    before = vec4(0.0);
    float nearest = nearestAround(here);
    float reach = max(-nearest, coc) + 0.5;
    if (isBefore(nearest, coc) > 0.0 && reach > 1.0) {
        int count = tapsOfDisc(reach, taps);
        vec2 direction = spiralStart(k);
        for (int i = 0; i < count; ++i) {
            // Evenly along the radius: nearest by, where small discs are found, taps are dense; each stands for
            // the ring around it.
            float away = reach * spiralShare(i, k, count);
            float ring = 6.28318531 * reach * away / float(count);
            vec2 texel = floor(gl_FragCoord.xy + away * direction) + 0.5;
            ivec2 there = clamp(ivec2(texel), ivec2(0), last);
            float cocThere = cocAt(there);
            float cover = discCover(abs(cocThere), distance(texel, gl_FragCoord.xy));
            float weight = isBefore(cocThere, coc) * cover * ring / discArea(abs(cocThere));
            if (weight > 0.0) {
                before += weight * vec4(lightAt(there), 1.0);
                behind.a += weight * abs(cocThere);
            }
            direction = spiralNext(direction);
        }
        if (before.a > 0.0)
            behind.a /= before.a;
        before /= max(before.a, 1.0);
    }
}
