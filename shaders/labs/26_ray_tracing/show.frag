#version 330 core

// What was traced on the CPU: its rows run from the top down, and it may be coarser than the picture.

uniform sampler2D traced;
uniform vec2 viewport;  // pixels of the picture

out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    ivec2 size = ivec2(viewport);
    ivec2 texels = textureSize(traced, 0);
    ivec2 texel = ivec2(at.x, size.y - 1 - at.y) * texels / size;
    color = vec4(texelFetch(traced, texel, 0).rgb, 1.0);
}
