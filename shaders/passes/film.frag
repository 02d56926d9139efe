#version 330 core

// Greyscale and grain over a finished picture: once a pixel.

#include "lib/film.glsl"

uniform sampler2D picture;
uniform float greyscale;
uniform int octaves;

out vec4 color;

void main() {
    vec4 seen = texelFetch(picture, ivec2(gl_FragCoord.xy), 0);
    color = vec4(asFilm(seen.rgb, gl_FragCoord.xy, greyscale, octaves), seen.a);
}
