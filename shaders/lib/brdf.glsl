// The metallic-roughness reflection of glTF 2.0 (appendix B): functions of numbers only, no state of GL. The same
// text compiles as C++ with GLM (common/trace/brdf_glsl.h), where it is tested. Needs lib/phong.glsl.
//
// The microfacet model: Walter et al., "Microfacet models for refraction through rough surfaces", EGSR 2007, for
// the distribution (there GGX; Trowbridge and Reitz 1975); Heitz, "Understanding the masking-shadowing function in
// microfacet-based BRDFs", JCGT 2014, equation 99, for shadowing and masking correlated by height; Schlick 1994 for
// Fresnel; roughness squared as Karis, "Real shading in Unreal Engine 4", SIGGRAPH 2013.
//
// Conventions: n is the unit normal, wi the unit vector towards the light, wo the one towards the eye, h the half
// vector; all in one frame. Lights come divided by pi (Light::intensity), so that all here is pi times the BRDF.
// "eps" is 2^-24. Every function is finite and no less than 0 for all inputs that are finite.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// The least width of a highlight, the tangent of its half angle: a roughness of 0.01. A mirror's image of a point
// has no width at all, and no brightness that a float can hold.
const float leastAlpha = 1e-4f;

// GGX's width of a glTF roughness, which is taken as within [0, 1].
QUINCUNX_INLINE float alphaOfRoughness(float roughness) {
    float r = clamp(roughness, 0.0f, 1.0f);
    return max(r * r, leastAlpha);
}

// (1 - cosine)^5 of a cosine taken as within [0, 1]. Within 8 eps, absolute: the difference is off by eps/2, and
// the power's slope is 5.
QUINCUNX_INLINE float fresnelWeight(float cosine) {
    float x = 1.0f - clamp(cosine, 0.0f, 1.0f);
    float xx = x * x;
    return xx * xx * x;
}

// Schlick's share of mirrored light, f0 at normal incidence and 1 at grazing.
QUINCUNX_INLINE vec3 fresnelSchlick(vec3 f0, float cosine) {
    return f0 + (vec3(1.0f) - f0) * fresnelWeight(cosine);
}

// pi D(h) = (alpha / (|n x h|² + alpha² (n·h)²))²; 0 for h below the horizon or (0,0,0), where there is none.
// The textbook's n·h² (alpha² - 1) + 1 cancels where the highlight is: at alpha 1e-4 nothing is left. Here the
// difference h - n is exact where it is small (Sterbenz), and crossing it with n loses only what lengths of n and
// h that are off by some eps do. Within 24 eps, relative, of the exact value for the directions given.
QUINCUNX_INLINE float ggxDistribution(vec3 n, vec3 h, float alpha) {
    float cosine = dot(n, h);
    if (cosine <= 0.0f)
        return 0.0f;
    vec3 sine = cross(n, h - n);
    float width = alpha * cosine;
    float root = alpha / (dot(sine, sine) + width * width);
    return root * root;
}

// n·wi times G / (4 n·wi n·wo), Heitz's quotient: with the cosine of the lit side taken in, nothing is left that
// is 0 / 0 at grazing angles. Cosines below 0 are taken as 0; 0 where the light is not above the horizon.
// Within 8 eps, relative.
QUINCUNX_INLINE float smithVisibility(float cosLight, float cosEye, float alpha) {
    float l = min(cosLight, 1.0f);
    float v = clamp(cosEye, 0.0f, 1.0f);
    if (!(l > 0.0f))
        return 0.0f;
    float a2 = alpha * alpha;
    float rest = (1.0f - alpha) * (1.0f + alpha);
    float masking = sqrt(a2 + rest * v * v);
    float shadowing = sqrt(a2 + rest * l * l);
    return 0.5f / (masking + v * shadowing / l);
}

// A surface at a point, textures already multiplied in.
struct MicrofacetSurface {
    vec3 diffuse;  // Lambertian albedo
    vec3 f0;       // mirrored at normal incidence
    float alpha;   // width of the highlight
};

// glTF's numbers: what is not metal mirrors 4 %, and metals have no diffuse colour but mirror theirs.
QUINCUNX_INLINE MicrofacetSurface metallicRoughness(vec3 baseColor, float metallic, float roughness) {
    float m = clamp(metallic, 0.0f, 1.0f);
    MicrofacetSurface surface;
    surface.diffuse = baseColor * (1.0f - m);
    surface.f0 = vec3(0.04f * (1.0f - m)) + baseColor * m;
    surface.alpha = alphaOfRoughness(roughness);
    return surface;
}

// pi f max(0, n·wi), mixed as glTF's appendix B has it: how much of a light's color · intensity is sent towards wo. Eyes below the horizon, as
// interpolated normals have them at silhouettes, are taken as in it. Metals never send back more than arrives; with
// the appendix' mix white dielectrics do at grazing angles, as the diffuse part there gives up less than the mirrored
// one takes: 1.03 times at 60° from the normal, up to 1.7 at 87° where they are smooth.
QUINCUNX_INLINE vec3 microfacetShare(MicrofacetSurface surface, vec3 n, vec3 wi, vec3 wo) {
    float cosLight = dot(n, wi);
    if (!(cosLight > 0.0f))
        return vec3(0.0f);
    vec3 between = wi + wo;
    // wo·h is half the length of wi + wo: the same bits when the two are exchanged.
    vec3 fresnel = fresnelSchlick(surface.f0, 0.5f * length(between));
    float highlight = ggxDistribution(n, safeNormalize(between), surface.alpha) *
                      smithVisibility(cosLight, dot(n, wo), surface.alpha);
    return (vec3(1.0f) - fresnel) * surface.diffuse * cosLight + fresnel * highlight;
}
