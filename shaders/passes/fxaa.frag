#version 330 core

// Antialiasing from the finished picture alone, after the idea of FXAA (Lottes 2009): where neighbours differ, find
// which way the edge runs and how far this pixel is from its ends, and fetch from across the edge accordingly.

#include "lib/film.glsl"

uniform sampler2D picture;  // bilinear, in [0, 1]
uniform float strength;     // 0 … 1: how far of the way

in vec2 texcoord;
out vec4 color;

const float contrastAtLeast = 0.05;  // of the perceived range: less is not seen as a step
const int stepsAtMost = 12;          // texels along the edge

// The square root is near enough to how light is perceived.
float perceived(vec2 place) {
    return sqrt(luminance(textureLod(picture, place, 0.0).rgb));
}

void main() {
    vec2 texel = 1.0 / vec2(textureSize(picture, 0));
    vec4 centre = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
    color = centre;
    if (strength == 0.0)
        return;
    float m = sqrt(luminance(centre.rgb));
    float n = perceived(texcoord + texel * vec2(0, 1));
    float s = perceived(texcoord - texel * vec2(0, 1));
    float e = perceived(texcoord + texel * vec2(1, 0));
    float w = perceived(texcoord - texel * vec2(1, 0));
    float contrast = max(max(n, s), max(max(e, w), m)) - min(min(n, s), min(min(e, w), m));
    if (contrast < contrastAtLeast)
        return;

    // An edge runs level where the picture changes upwards more than sideways.
    bool level = abs(n + s - 2.0 * m) >= abs(e + w - 2.0 * m);
    float before = level ? s : w;
    float after = level ? n : e;
    bool towardsAfter = abs(after - m) >= abs(before - m);
    vec2 across = (level ? vec2(0, texel.y) : vec2(texel.x, 0)) * (towardsAfter ? 1.0 : -1.0);
    vec2 along = level ? vec2(texel.x, 0) : vec2(0, texel.y);
    float step_ = towardsAfter ? after - m : before - m;
    float onEdge = m + 0.5 * step_;

    // Between the two rows the fetch gives their mean; the edge ends where that mean leaves the one here.
    vec2 between = texcoord + 0.5 * across;
    float lengths[2];
    bool leavesUp[2];
    for (int side = 0; side < 2; ++side) {
        float sign_ = side == 0 ? 1.0 : -1.0;
        float length_ = float(stepsAtMost);
        bool up = false;
        for (int i = 1; i <= stepsAtMost; ++i) {
            float mean = perceived(between + sign_ * float(i) * along);
            if (abs(mean - onEdge) >= 0.25 * abs(step_)) {
                length_ = float(i);
                up = mean > onEdge;
                break;
            }
        }
        lengths[side] = length_;
        leavesUp[side] = up;
    }
    int nearer = lengths[0] <= lengths[1] ? 0 : 1;
    // The edge crosses this pixel only if beyond its nearer end the other side's colour goes on.
    bool crosses = leavesUp[nearer] == (step_ > 0.0);
    float share = crosses ? max(0.5 - lengths[nearer] / (lengths[0] + lengths[1]), 0.0) : 0.0;
    share *= strength;
    if (share > 0.0)
        color = vec4(textureLod(picture, texcoord + share * across, 0.0).rgb, centre.a);
}
