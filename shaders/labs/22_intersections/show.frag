#version 330 core

// What was cast on the CPU, texel by pixel: its rows run from the top down. Alpha is the window depth of what
// was hit, so that lines drawn later are hidden behind it.

uniform sampler2D rays;

out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 texel = texelFetch(rays, ivec2(at.x, textureSize(rays, 0).y - 1 - at.y), 0);
    color = vec4(texel.rgb, 1.0);
    gl_FragDepth = texel.a;
}
