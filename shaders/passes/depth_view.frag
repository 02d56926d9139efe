#version 330 core

// A depth map as a picture: near is white, far is dark, and where nothing was drawn a flat colour. The texture
// keeps its shape inside the target.

uniform sampler2D depthMap;
uniform vec2 targetPixels;
uniform float contrast;  // 1 for depth that grows evenly; less for perspective views, whose depths crowd near 1

out vec4 color;

void main() {
    vec2 mapTexels = vec2(textureSize(depthMap, 0));
    float scale = min(targetPixels.x / mapTexels.x, targetPixels.y / mapTexels.y);
    vec2 place = (gl_FragCoord.xy - 0.5 * (targetPixels - scale * mapTexels)) / scale;
    if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, mapTexels))) {
        color = vec4(0.02, 0.02, 0.025, 1.0);
        return;
    }
    float depth = texelFetch(depthMap, ivec2(place), 0).r;
    color = depth < 1.0 ? vec4(pow(1.0 - depth, contrast) * vec3(1.0, 0.97, 0.9), 1.0) : vec4(0.01, 0.03, 0.07, 1.0);
}
