#version 330 core

// What is behind the spaceship: a gradient, with the film effect if that is not a pass of its own.

#include "lib/film.glsl"
#include "lib/frame.glsl"

uniform float greyscale;
uniform int octaves;
uniform float samplesPerPixel;

in vec2 texcoord;
out vec4 color;

void main() {
    color = vec4(mix(backgroundBottom.rgb, backgroundTop.rgb, texcoord.y), 1.0);
#ifdef FILM_INSIDE
    vec2 pixel = floor(gl_FragCoord.xy / samplesPerPixel) + 0.5;
    color.rgb = asFilm(color.rgb, pixel, greyscale, octaves);
#endif
}
