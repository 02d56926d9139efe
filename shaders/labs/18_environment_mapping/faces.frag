#version 330 core

// The six faces of the map, unfolded: −x +z +x −z in a row, +y above +z and −y below. The cross keeps its shape inside
// the target.

#include "lib/environment.glsl"

uniform vec2 targetPixels;
uniform float roughness;

out vec4 color;

void main() {
    const vec2 cross_ = vec2(4.0, 3.0);
    float scale = 0.96 * min(targetPixels.x / cross_.x, targetPixels.y / cross_.y);
    vec2 place = (gl_FragCoord.xy - 0.5 * targetPixels) / scale + 0.5 * cross_;
    int column = int(floor(place.x));
    int row = 2 - int(floor(place.y));
    int face = -1;
    if (row == 1 && column >= 0 && column < 4)
        face = column == 0 ? 1 : column == 1 ? 4 : column == 2 ? 0 : 5;
    else if (column == 1 && row == 0)
        face = 2;
    else if (column == 1 && row == 2)
        face = 3;
    color = vec4(0.012, 0.013, 0.016, 1.0);
    if (face < 0)
        return;
    vec2 st = vec2(fract(place.x), 1.0 - fract(place.y));
    color = vec4(environmentRadiance(cubeDirection(face, st), roughness), 1.0);
}
