#version 330 core

// A face of the irradiance map: each normal's cosine-weighted sum over all texels of one level of the map, over pi.
// The weights are made to sum to one exactly, so that a constant map gives itself.

#include "lib/environment_math.glsl"

uniform int face;
uniform samplerCube source;
uniform float sourceLevel;
uniform int sourceSize;  // texels along an edge of that level

in vec2 texcoord;
out vec4 color;

void main() {
    vec3 n = normalize(cubeDirection(face, texcoord));
    float width = 2.0 / float(sourceSize);
    vec3 sum = vec3(0.0);
    float weight = 0.0;
    for (int other = 0; other < 6; ++other) {
        mat3 axes = cubeFaceAxes(other);
        for (int y = 0; y < sourceSize; ++y)
            for (int x = 0; x < sourceSize; ++x) {
                vec2 xy = (vec2(x, y) + 0.5) * width - 1.0;
                vec3 d = axes[2] + xy.x * axes[0] + xy.y * axes[1];
                float share = max(0.0, dot(n, d)) * inversesqrt(dot(d, d)) * cubeTexelAngle(xy, width);
                if (share > 0.0) {
                    sum += share * textureLod(source, d, sourceLevel).rgb;
                    weight += share;
                }
            }
    }
    color = vec4(sum / weight, 1.0);
}
