#version 330 core

// A Gaussian blur. BLUR_DIRECT: every texel of the square around. Else along one axis; two such passes are the same,
// since the weights of a Gaussian are products. BLUR_PAIRS: two texels by one bilinear fetch between them.
// Beyond the picture its edge goes on.

uniform sampler2D picture;
uniform vec2 axis;  // (1,0) or (0,1)
uniform int radius;
uniform float weights[129];  // of the distance in texels; those of both sides sum to 1

out vec4 color;

void main() {
    ivec2 size = textureSize(picture, 0);
    ivec2 here = ivec2(gl_FragCoord.xy);
    if (radius == 0) {
        color = texelFetch(picture, here, 0);
        return;
    }
#if defined(BLUR_DIRECT)
    vec4 sum = vec4(0.0);
    for (int y = -radius; y <= radius; ++y) {
        vec4 row = vec4(0.0);
        for (int x = -radius; x <= radius; ++x)
            row += weights[abs(x)] * texelFetch(picture, clamp(here + ivec2(x, y), ivec2(0), size - 1), 0);
        sum += weights[abs(y)] * row;
    }
    color = sum;
#elif defined(BLUR_PAIRS)
    vec2 texel = axis / vec2(size);
    vec2 centre = (vec2(here) + 0.5) / vec2(size);
    vec4 sum = weights[0] * texelFetch(picture, here, 0);
    for (int i = 1; i <= radius; i += 2) {
        float near = weights[i];
        float far = i < radius ? weights[i + 1] : 0.0;
        // Far from the middle of a narrow Gaussian both are zero.
        float place = float(i) + (near + far > 0.0 ? far / (near + far) : 0.0);
        sum += (near + far) * (texture(picture, centre + place * texel) + texture(picture, centre - place * texel));
    }
    color = sum;
#else
    vec4 sum = weights[0] * texelFetch(picture, here, 0);
    for (int i = 1; i <= radius; ++i)
        sum += weights[i] * (texelFetch(picture, clamp(here + i * ivec2(axis), ivec2(0), size - 1), 0) +
                             texelFetch(picture, clamp(here - i * ivec2(axis), ivec2(0), size - 1), 0));
    color = sum;
#endif
}
