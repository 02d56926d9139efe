#version 330 core

// The shader that draws the spaceship. FILM_INSIDE: it makes its colours grey and grainy itself, for every fragment,
// seen in the end or not; otherwise a pass over the finished picture does, for every pixel once.

#include "lib/film.glsl"
#include "lib/textured_shade.glsl"

uniform float greyscale;
uniform int octaves;
uniform float samplesPerPixel;  // along a side

in vec3 positionWorld;
in vec3 normalWorld;
in vec2 texcoord;

out vec4 color;

void main() {
    vec3 normal = safeNormalize(normalWorld);
#ifdef DOUBLE_SIDED
    if (!gl_FrontFacing)
        normal = -normal;
#endif
    color = textureShade(shade(positionWorld, normal), texcoord);
#ifdef FILM_INSIDE
    vec2 pixel = floor(gl_FragCoord.xy / samplesPerPixel) + 0.5;
    color.rgb = asFilm(color.rgb, pixel, greyscale, octaves);
#endif
}
