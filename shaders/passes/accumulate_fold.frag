#version 330 core

// A block of passes is added to the total; what rounding loses goes to the carry.

#include "lib/compensated.glsl"

uniform sampler2D block;
uniform sampler2D totalMap;
uniform sampler2D carryMap;

layout(location = 0) out vec4 total;
layout(location = 1) out vec4 carry;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 before = texelFetch(totalMap, pixel, 0);
    vec4 added = texelFetch(block, pixel, 0);
    total = before + added;
    carry = texelFetch(carryMap, pixel, 0) + lostInSum(before, added, total);
}
