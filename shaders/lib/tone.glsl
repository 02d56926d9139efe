// Tone curves: light of any strength into [0, 1]. Functions of numbers only; the same text compiles as C++ with GLM
// (common/trace/tone_glsl.h), where it is tested.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// What Reinhard et al., "Photographic tone reproduction for digital images", SIGGRAPH 2002, equation 4, multiplies a
// colour of luminance l >= 0 with: (1 + l/w²) / (1 + l), so that luminance w becomes 1. Above 1 both are divided by l
// first: l itself may be as large as a float can be.
QUINCUNX_INLINE float reinhardFactor(float l, float white) {
    float inverseWhite2 = 1.0f / (white * white);
    if (l <= 1.0f)
        return (1.0f + l * inverseWhite2) / (1.0f + l);
    return (1.0f / l + inverseWhite2) / (1.0f / l + 1.0f);
}

// A fit of the ACES reference curve by a quotient of quadratics (Narkowicz 2015), for x >= 0. Above 1 both are divided
// by x² first, which would overflow from 2^64 on. Within 8 units of 2^-24 of the exact quotient, relative.
QUINCUNX_INLINE float filmicCurve(float x) {
    if (x <= 1.0f)
        return (x * (2.51f * x + 0.03f)) / (x * (2.43f * x + 0.59f) + 0.14f);
    float r = 1.0f / x;
    return (2.51f + 0.03f * r) / (2.43f + r * (0.59f + 0.14f * r));
}
