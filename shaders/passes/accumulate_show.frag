#version 330 core

// The mean of the passes so far.

uniform sampler2D block;
uniform sampler2D totalMap;
uniform sampler2D carryMap;
uniform int hasBlock;
uniform int hasTotal;
uniform float divisor;

out vec4 color;

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    if (hasTotal != 0)
        sum = texelFetch(totalMap, pixel, 0) + texelFetch(carryMap, pixel, 0);
    if (hasBlock != 0)
        sum += texelFetch(block, pixel, 0);
    color = sum / divisor;
}
