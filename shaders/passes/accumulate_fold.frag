#version 330 core

// A block of passes is added to the total, together with what was lost before; what rounding loses now goes to the
// carry, which so stays as small as a rounding.

#include "lib/compensated.glsl"

uniform sampler2D block;
uniform sampler2D totalMap;
uniform sampler2D carryMap;
uniform uint zero;

layout(location = 0) out vec4 total;
layout(location = 1) out vec4 carry;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 before = texelFetch(totalMap, pixel, 0);
    vec4 added = texelFetch(block, pixel, 0) + texelFetch(carryMap, pixel, 0);
    total = before + added;
    carry = lostInSum(before, added, total, zero);
}
