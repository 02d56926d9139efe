#version 330 core

// For each tile of the picture the longest motion of its pixels.

uniform sampler2D motionMap;
uniform int tile;  // pixels along a side

out vec4 longest;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * tile;
    ivec2 end = min(corner + tile, textureSize(motionMap, 0));
    vec2 found = vec2(0.0);
    for (int y = corner.y; y < end.y; ++y)
        for (int x = corner.x; x < end.x; ++x) {
            vec2 motion = texelFetch(motionMap, ivec2(x, y), 0).rg;
            if (dot(motion, motion) > dot(found, found))
                found = motion;
        }
    longest = vec4(found, 0.0, 0.0);
}
