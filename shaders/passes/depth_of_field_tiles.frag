#version 330 core

// For each tile of the picture the circle of confusion of what is nearest: how far light from there may reach.

#include "lib/lens.glsl"

uniform sampler2D depthMap;
uniform int tile;       // pixels along a side
uniform float atNear;   // circle of confusion, pixels
uniform float atFar;
uniform float most;

out float nearest;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * tile;
    ivec2 end = min(corner + tile, textureSize(depthMap, 0));
    nearest = most;
    for (int y = corner.y; y < end.y; ++y)
        for (int x = corner.x; x < end.x; ++x)
            nearest = min(nearest,
                          circleOfConfusion(texelFetch(depthMap, ivec2(x, y), 0).r, atNear, atFar, most));
}
