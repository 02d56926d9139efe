#version 330 core

// One of the two passes that enlarge a picture by a separable filter: along its rows, then along its columns. The
// same formulas as lineTaps.

uniform sampler2D source;
uniform int across;    // 1: along rows; the target has the source's rows. 0: along columns, top row first
uniform int kernel;    // 2 Mitchell, 3 Lanczos, 4 the whole sinc
uniform int lobes;     // of Lanczos
uniform int wrap;      // 0 repeat, 1 mirrored, 2 edge, 3 border
uniform float low;     // texels from the line's beginning, at the target's edge
uniform float scale;   // texels a pixel
uniform vec2 origin;   // of the target's panel: left, top in pixels, y down from `targetHeight`
uniform float targetHeight;

out vec4 color;

const float pi = 3.14159265358979;

float sincOf(float x) {
    return abs(x) < 1e-4 ? 1.0 : sin(pi * x) / (pi * x);
}

float mitchell(float x) {
    if (x < 1.0)
        return ((7.0 * x - 12.0) * x * x + 16.0 / 3.0) / 6.0;
    return x < 2.0 ? (((-7.0 / 3.0 * x + 12.0) * x - 20.0) * x + 32.0 / 3.0) / 6.0 : 0.0;
}

// −1: the border
int wrapped(int texel, int side) {
    if (wrap == 0)
        return (texel % side + side) % side;
    if (wrap == 1) {
        int rest = (texel % (2 * side) + 2 * side) % (2 * side);
        return rest < side ? rest : 2 * side - 1 - rest;
    }
    if (wrap == 2)
        return clamp(texel, 0, side - 1);
    return texel < 0 || texel >= side ? -1 : texel;
}

vec4 texelAt(int texel, int other) {
    if (texel < 0)
        return vec4(0.0);
    return texelFetch(source, across == 1 ? ivec2(texel, other) : ivec2(other, texel), 0);
}

// Dirichlet's kernel of an even or an odd period. `sine` is sin(π x), taken from the fraction of x alone.
float periodic(float x, float sine, int period) {
    float turns = round(x / float(period));
    float near = x - float(period) * turns;
    if (abs(near) < 1e-4)
        return 1.0;
    float part = pi * near / float(period);
    float turned = (int(turns) & 1) == 0 ? 1.0 : -1.0;
    return sine / (float(period) * (period % 2 == 0 ? tan(part) : turned * sin(part)));
}

void main() {
    vec2 at = vec2(gl_FragCoord.x - origin.x,
                   across == 1 ? gl_FragCoord.y : targetHeight - gl_FragCoord.y - origin.y);
    float position = low + scale * (across == 1 ? at.x : at.y) - 0.5;
    int other = int(across == 1 ? at.y : at.x);
    int side = across == 1 ? textureSize(source, 0).x : textureSize(source, 0).y;
    int nearest = int(floor(position));
    float share = position - float(nearest);
    vec4 sum = vec4(0.0);
    if (kernel == 4) {
        // sin(π (position − i)) is that of the fraction, with the sign of i's distance.
        float sine = sin(pi * share);
        for (int i = 0; i < side; ++i) {
            float here = ((nearest - i) & 1) == 0 ? sine : -sine;
            float mirrored = -here;
            float x = position - float(i);
            float weight = wrap == 0 ? periodic(x, here, side)
                                     : periodic(x, here, 2 * side) +
                                           periodic(position + 1.0 + float(i), mirrored, 2 * side);
            sum += weight * texelAt(i, other);
        }
        color = vec4(sum.rgb, across == 1 ? sum.a : 1.0);
        return;
    }
    int reach = kernel == 2 ? 2 : lobes;
    float total = 0.0;
    for (int k = 1 - reach; k <= reach; ++k) {
        float x = abs(share - float(k));
        float weight = kernel == 2 ? mitchell(x) : x < float(lobes) ? sincOf(x) * sincOf(x / float(lobes)) : 0.0;
        sum += weight * texelAt(wrapped(nearest + k, side), other);
        total += weight;
    }
    sum /= total;
    color = vec4(sum.rgb, across == 1 ? sum.a : 1.0);
}
