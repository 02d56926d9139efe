// The reflection models of Phong (1975) and Blinn (1977): functions of numbers only, no state of GL.
// The same text compiles as C++ with GLM (common/trace/phong_glsl.h), where it is tested.
//
// Conventions: n is the unit normal, wi the unit vector towards the light, wo the one towards the eye; all in
// one frame. Vectors called unit may be off by a few roundings. "eps" is 2^-24. Bounds of exp and log hold
// where these are good to 4 ulp.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// v / |v| for every finite v: scaled by a power of two first, so that no square overflows or vanishes (Blue,
// ACM TOMS 1978). At most 2.5 ulp a component. (0,0,0) for v = (0,0,0) and for components that are infinite or
// no number. Hardware that takes denormals for zero does so here as well.
QUINCUNX_INLINE vec3 safeNormalize(vec3 v) {
    uint largest = max(max(floatBitsToUint(v.x) & 0x7fffffffu, floatBitsToUint(v.y) & 0x7fffffffu),
                       floatBitsToUint(v.z) & 0x7fffffffu);
    if (largest == 0u || largest >= 0x7f800000u)
        return vec3(0.0f);
    // 2^(127 - e) brings the largest component, of exponent e, to 1 … 2 (denormals to 2^-22 at least).
    uint exponent = min(largest >> 23u, 253u);
    vec3 scaled = v * uintBitsToFloat((254u - exponent) << 23u);
    return scaled / sqrt(dot(scaled, scaled));
}

// The mirror image of a direction that travels towards the surface: d - 2 (n·d) n.
QUINCUNX_INLINE vec3 reflectDirection(vec3 towardsSurface, vec3 n) {
    return towardsSurface - (2.0f * dot(n, towardsSurface)) * n;
}

// The unit vector halfway between two unit vectors; (0,0,0), "there is none", where wi = -wo.
QUINCUNX_INLINE vec3 halfVector(vec3 wi, vec3 wo) {
    return safeNormalize(wi + wo);
}

// max(0, n·wi).
QUINCUNX_INLINE float lambert(vec3 n, vec3 wi) {
    return max(0.0f, dot(n, wi));
}

// max(0, a·b)^exponent of unit vectors, for exponents 0 … 1e5; 1 for exponent 0.
//
// a·b in float cannot tell cosines near 1 apart: pow would be off by exponent · eps, 0.6 % at 1e5. The versed
// cosine x = 1 - a·b = |a-b|²/2 can: differences of close floats are exact, and lengths off by k eps change x
// by 2 k eps of itself. A relative error e of x or of the logarithm is e exponent x e^(-exponent x) ≤ e / 2.7
// of the power.
//   x < 1/4:  log(1-x) = -2 (z + z³/3 + z⁵/5 + z⁷/7), z = x / (2-x) ≤ 1/7: what is left out is z⁸/9 ≤ 2e-8
//             of it. With k = 2 and twelve roundings: 16 eps/2.7 + 2e-8 = 4e-7.
//   else:     1-x is 3/4 at most, and exponent 2^-21 (3/4)^exponent never exceeds 7e-7, which covers a log
//             good to 2^-21 only.
// Vectors that are turned by k eps move the power by k eps √(exponent / 2.7) more; exponents below 1 are steep
// near a right angle, where they make (k eps)^exponent of it.
QUINCUNX_INLINE float cosinePower(vec3 a, vec3 b, float exponent) {
    if (exponent <= 0.0f)
        return 1.0f;
    vec3 difference = a - b;
    float x = 0.5f * dot(difference, difference);
    if (x >= 1.0f)
        return 0.0f;
    float z = x / (2.0f - x);
    float zz = z * z;
    float logarithm = x < 0.25f
                          ? -2.0f * z * (1.0f + zz * (1.0f / 3.0f + zz * (1.0f / 5.0f + zz * (1.0f / 7.0f))))
                          : log(1.0f - x);
    return exp(exponent * logarithm);
}

// Phong's highlight, max(0, r·wo)^shininess with r the mirror image of the light's direction; 0 unless the
// light is above the horizon (n·wi > 0), and there 1 for shininess 0.
QUINCUNX_INLINE float phongSpecular(vec3 n, vec3 wi, vec3 wo, float shininess) {
    if (dot(n, wi) <= 0.0f)
        return 0.0f;
    return cosinePower(reflectDirection(-wi, n), wo, shininess);
}

// Blinn's highlight, max(0, n·h)^shininess; 0 unless the light is above the horizon, and 0 where there is no
// half vector.
QUINCUNX_INLINE float blinnPhongSpecular(vec3 n, vec3 wi, vec3 wo, float shininess) {
    vec3 h = halfVector(wi, wo);
    if (dot(n, wi) <= 0.0f || dot(h, h) == 0.0f)
        return 0.0f;
    return cosinePower(n, h, shininess);
}

// A light. kind 0 is directional, 1 a point, 2 a spot. `direction` is the way the light travels, unit length.
struct PhongLight {
    int kind;
    vec3 position;
    vec3 direction;
    vec3 radiance;  // color · intensity
    float innerConeRadians;
    float outerConeRadians;
};

// What a light does at a point: the unit vector towards it, and how much of color · intensity arrives.
struct LightSample {
    vec3 wi;
    float strength;
};

// A spot's share: 1 inside the inner cone, 0 outside the outer one, a smooth cubic of the cosine between. The
// inner cone is taken as no wider than the outer one. A cone of no width lights nothing but its axis.
QUINCUNX_INLINE float spotShare(vec3 wi, vec3 lightDirection, float innerConeRadians, float outerConeRadians) {
    float cosine = dot(-wi, lightDirection);
    float cosInner = cos(min(innerConeRadians, outerConeRadians));
    float cosOuter = cos(outerConeRadians);
    if (cosine >= cosInner)
        return 1.0f;
    if (cosine <= cosOuter)
        return 0.0f;
    float share = (cosine - cosOuter) / (cosInner - cosOuter);
    return share * share * (3.0f - 2.0f * share);
}

// Points and spots fall off with the square of the distance, taken as 2^-32 at least, which keeps the product
// with intensities up to 2^63 finite. A point at the light itself is unlit: its direction is (0,0,0).
QUINCUNX_INLINE LightSample sampleLight(PhongLight light, vec3 position) {
    LightSample lightSample;
    if (light.kind == 0) {
        lightSample.wi = -light.direction;
        lightSample.strength = 1.0f;
        return lightSample;
    }
    vec3 towards = light.position - position;
    lightSample.wi = safeNormalize(towards);
    // Dividing twice by the distance instead of once by its square keeps far lights from overflowing it.
    float distance_ = max(dot(towards, lightSample.wi), 2.3283064365386963e-10f);
    lightSample.strength = (1.0f / distance_) / distance_;
    if (light.kind == 2)
        lightSample.strength *=
            spotShare(lightSample.wi, light.direction, light.innerConeRadians, light.outerConeRadians);
    return lightSample;
}

// The share of a light's strength that a range leaves, KHR_lights_punctual's smooth end: 1 - (distance/range)^4, at
// least 0; 1 for range 0, which has no end.
QUINCUNX_INLINE float rangeShare(float distance_, float range) {
    if (!(range > 0.0f))
        return 1.0f;
    float share = min(distance_ / range, 1.0f);
    share *= share;
    return (1.0f - share) * (1.0f + share);
}

// A material's numbers at a point, textures already multiplied in.
struct PhongMaterial {
    vec3 ambient;
    vec3 diffuse;
    vec3 specular;
    vec3 emission;
    float shininess;
};

// What one light adds to the light sent towards wo: radiance · strength ⊙ (diffuse max(0, n·wi) + specular s).
QUINCUNX_INLINE vec3 reflectLight(PhongMaterial material, PhongLight light, vec3 position, vec3 n, vec3 wo,
                                  bool blinn) {
    LightSample lightSample = sampleLight(light, position);
    float highlight = blinn ? blinnPhongSpecular(n, lightSample.wi, wo, material.shininess)
                            : phongSpecular(n, lightSample.wi, wo, material.shininess);
    return (light.radiance * lightSample.strength) *
           (material.diffuse * lambert(n, lightSample.wi) + material.specular * highlight);
}
