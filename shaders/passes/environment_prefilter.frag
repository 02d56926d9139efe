#version 330 core

// A face of one level of a prefiltered environment map: the light around each direction, averaged over the mirror
// directions of GGX's normals seen from straight ahead, weighted with the cosine (Karis 2013). The sources are read
// from the level whose texels are as large as a sample's share of the sphere (Křivánek and Colbert, "Real-time shading
// with filtered importance sampling", EGSR 2008).

#include "lib/environment_math.glsl"

uniform int face;
uniform samplerCube source;
uniform float sourceSize;  // texels along an edge of its level 0
uniform float lastLevel;   // of the source
uniform float alpha;
uniform int samples;  // a multiple of 4
uniform float levelBias;  // added to the source's level; large and negative reads level 0 alone

in vec2 texcoord;
out vec4 color;

void main() {
    mat3 frame = cubeTexelFrame(face, texcoord);
    uint quarter = uint(samples / 4);
    float texelAngle = 4.18879 / (2.0 * sourceSize * sourceSize);  // 4 pi / (6 size²)
    vec3 sum = vec3(0.0);
    float weight = 0.0;
    for (uint i = 0u; i < quarter; ++i) {
        vec3 h = ggxNormal(hammersley(i, quarter), alpha);
        float cosine = 2.0 * h.z * h.z - 1.0;
        if (cosine <= 0.0)
            continue;
        vec2 across = 2.0 * h.z * h.xy;
        // The mirrored direction's density is D cos / (4 cos), the same cosine twice.
        float sampleAngle = 4.0 / (float(samples) * ggxDensity(h.z, alpha));
        float level = clamp(0.5 * log2(sampleAngle / texelAngle) + levelBias, 0.0, lastLevel);
        // Four quarter turns of each, so that the pattern looks the same along all four.
        for (int turn = 0; turn < 4; ++turn) {
            sum += cosine * textureLod(source, frame * vec3(across, cosine), level).rgb;
            weight += cosine;
            across = vec2(-across.y, across.x);
        }
    }
    color = vec4(sum / weight, 1.0);
}
