#version 330 core

// A few pictures, each weighted, added one after the other to what was there before; so that the sum is the same
// however many are taken at a time.

uniform sampler2D before;
uniform sampler2D picture0;
uniform sampler2D picture1;
uniform sampler2D picture2;
uniform sampler2D picture3;
uniform int hasBefore;
uniform int count;     // 1 … 4
uniform float weight;

out vec4 color;

vec4 share(sampler2D picture) {
    // task: Give each pass its share, so that all of them together make one picture.
    return texelFetch(picture, ivec2(gl_FragCoord.xy), 0) * weight;
    // instead: return texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
    // end of task
}

void main() {
    vec4 sum = share(picture0);
    if (hasBefore != 0)
        sum = texelFetch(before, ivec2(gl_FragCoord.xy), 0) + sum;
    if (count > 1)
        sum += share(picture1);
    if (count > 2)
        sum += share(picture2);
    if (count > 3)
        sum += share(picture3);
    color = sum;
}
