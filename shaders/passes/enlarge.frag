#version 330 core

// A smaller picture drawn over the whole target, bilinear between its texels, added to another one if there is one.

uniform sampler2D small;
uniform float strength;
uniform int factor;  // how many pixels wide a texel of the small picture is
#ifdef ADD_TO_BASE
uniform sampler2D base;
#endif

out vec4 color;

void main() {
    // By pixels, not by shares of the picture: its sides need not be multiples of the factor.
    vec2 place = gl_FragCoord.xy / (float(factor) * vec2(textureSize(small, 0)));
    vec4 seen = strength * texture(small, place);
#ifdef ADD_TO_BASE
    vec4 below = texelFetch(base, ivec2(gl_FragCoord.xy), 0);
    color = strength == 0.0 ? below : vec4(below.rgb + seen.rgb, below.a);
#else
    color = seen;
#endif
}
