#version 330 core

// Light of any strength brought into what a screen shows, in linear light; the target encodes it.

#include "lib/film.glsl"
#include "lib/tone.glsl"

uniform sampler2D picture;
uniform float exposure;  // factor
uniform int curve;       // 0 none, 1 Reinhard, 2 filmic
uniform int cutOff;      // 1: keep to [0, 1]

out vec4 color;

void main() {
    vec4 seen = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
    color = seen;
    if (curve == 0 && exposure == 1.0 && cutOff == 0)
        return;
    vec3 c = exposure * seen.rgb;
    // task: Bring light of any strength into 0 … 1, by the curve that is asked for.
    // Reinhard keeps a colour's hue; the filmic curve is applied a channel at a time, so that highlights lose their
    // colour as on film.
    if (curve == 1)
        c *= reinhardFactor(luminance(c), 4.0);
    else if (curve == 2)
        c = vec3(filmicCurve(0.6 * c.r), filmicCurve(0.6 * c.g), filmicCurve(0.6 * c.b));
    // end of task
    color = vec4(cutOff == 1 ? clamp(c, 0.0, 1.0) : c, seen.a);
}
