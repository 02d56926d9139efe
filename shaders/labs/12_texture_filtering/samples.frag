#version 330 core

// The driver's samples at given places: a texel of `places` is (s, t, level), or, with derivatives, (s, t) and in
// `derivatives` how they move along x and y.

uniform sampler2D image;
uniform sampler2D places;
uniform sampler2D derivatives;
uniform int byLevel;

out vec4 color;

void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 place = texelFetch(places, at, 0);
    vec4 along = texelFetch(derivatives, at, 0);
    color = byLevel == 1 ? textureLod(image, place.xy, place.z) : textureGrad(image, place.xy, along.xy, along.zw);
}
