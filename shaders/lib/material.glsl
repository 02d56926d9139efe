// For fragment shaders: the light that a metallic-roughness surface sends to the eye. The program's defines say which
// features the material uses; nothing is here for those that it does not.
//
// A fragment shader defines, before it includes this, what it has:
//   LIT_SHARE(light, position, n)                 shadows: the share of that light that arrives
//   ENVIRONMENT_IRRADIANCE(position, n)           vec3: light from all around on a matt surface, over pi
//   ENVIRONMENT_RADIANCE(position, r, roughness)  vec3: mean light about direction r, as wide as the roughness
//   ENVIRONMENT_BRDF(cosEye, roughness)           vec2: what of white surroundings is mirrored: x times f0, plus y
// The last three come together; the split is Karis', "Real shading in Unreal Engine 4", SIGGRAPH 2013.

#include "lib/frame.glsl"
#include "lib/phong.glsl"
#include "lib/brdf.glsl"

#ifndef LIT_SHARE
#define LIT_SHARE(light, position, n) 1.0
#endif

// Bits of enum class MaterialFeature in common/passes/material.h.
const int baseColorTextureBit = 1;
const int metallicRoughnessTextureBit = 2;
const int normalMapBit = 4;
const int occlusionTextureBit = 8;
const int emissionTextureBit = 16;
const int vertexColorsBit = 32;
const int alphaMaskBit = 256;
const int alphaBlendBit = 512;
const int environmentBit = 2048;

// Laid out as struct MaterialBlock in common/passes/material.cpp.
layout(std140) uniform MaterialBlock {
    vec4 baseColor;
    vec4 emission;     // rgb: radiance; a: alpha below which a fragment is cut out
    vec4 factors;      // x: metallic, y: roughness, z: scale of the normal map's x and y, w: strength of occlusion
    ivec4 usedBits;    // x: features; y: textures that read the second coordinates, by slot
    vec4 textureRows[10];  // by slot: two rows that make s and t of (s, t, 1)
};

// Whether the material has a feature that its program has. Programs may be forced to have more.
#ifdef FORCED_FEATURES
#define USES(bit) ((usedBits.x & (bit)) != 0)
#else
#define USES(bit) true
#endif

in vec3 positionWorld;
in vec3 normalWorld;

#ifdef TEXTURED
in vec2 texcoord;
#ifdef SECOND_TEXCOORDS
in vec2 texcoord1;
#endif

vec2 texcoordOf(int slot) {
    vec2 st = texcoord;
#ifdef SECOND_TEXCOORDS
    if ((usedBits.y & (1 << slot)) != 0)
        st = texcoord1;
#endif
#ifdef TEXTURE_TRANSFORMS
    vec3 s = textureRows[2 * slot].xyz;
    vec3 t = textureRows[2 * slot + 1].xyz;
    st = vec2(s.x * st.x + s.y * st.y + s.z, t.x * st.x + t.y * st.y + t.z);
#endif
    return st;
}
#endif

#ifdef BASE_COLOR_TEXTURE
uniform sampler2D baseColorTexture;
#endif
#ifdef METALLIC_ROUGHNESS_TEXTURE
uniform sampler2D metallicRoughnessTexture;
#endif
#ifdef NORMAL_MAP
uniform sampler2D normalTexture;
in vec4 tangentWorld;  // w: the sign of the bitangent
#endif
#ifdef OCCLUSION_TEXTURE
uniform sampler2D occlusionTexture;
#endif
#ifdef EMISSION_TEXTURE
uniform sampler2D emissionTexture;
#endif
#ifdef VERTEX_COLORS
in vec4 vertexColor;
#endif

vec4 surfaceColor() {
    vec4 color = baseColor;
#ifdef BASE_COLOR_TEXTURE
    if (USES(baseColorTextureBit))
        color *= texture(baseColorTexture, texcoordOf(0));
#endif
#ifdef VERTEX_COLORS
    if (USES(vertexColorsBit))
        color *= vertexColor;
#endif
    return color;
}

// The unit normal on the side that is seen.
vec3 surfaceNormal() {
    vec3 n = safeNormalize(normalWorld);
#ifdef NORMAL_MAP
    if (USES(normalMapBit)) {
        // Interpolated frames are used as they come, as the bakers of normal maps do (Mikkelsen 2008): only the
        // outcome is made a unit vector.
        vec3 mapped = texture(normalTexture, texcoordOf(2)).xyz * 2.0 - 1.0;
        mapped.xy *= factors.z;
        vec3 bitangent = tangentWorld.w * cross(n, tangentWorld.xyz);
        vec3 bent = safeNormalize(mapped.x * tangentWorld.xyz + mapped.y * bitangent + mapped.z * n);
        if (bent != vec3(0.0))
            n = bent;
    }
#endif
#ifdef DOUBLE_SIDED
    if (!gl_FrontFacing)
        n = -n;
#endif
    return n;
}

#ifdef ENVIRONMENT_RADIANCE
vec3 environmentLight(MicrofacetSurface surface, float roughness, vec3 n, vec3 wo) {
    vec2 share = ENVIRONMENT_BRDF(clamp(dot(n, wo), 0.0, 1.0), roughness);
    vec3 mirrored = surface.f0 * share.x + share.y;
    return (1.0 - mirrored) * surface.diffuse * ENVIRONMENT_IRRADIANCE(positionWorld, n) +
           mirrored * ENVIRONMENT_RADIANCE(positionWorld, reflectDirection(-wo, n), roughness);
}
#endif

// Radiance and opacity of this fragment, which may be discarded.
vec4 materialColor() {
    vec4 color = surfaceColor();
    float metallic = factors.x;
    float roughness = factors.y;
#ifdef METALLIC_ROUGHNESS_TEXTURE
    if (USES(metallicRoughnessTextureBit)) {
        vec2 map = texture(metallicRoughnessTexture, texcoordOf(1)).gb;
        roughness *= map.x;
        metallic *= map.y;
    }
#endif
    MicrofacetSurface surface = metallicRoughness(color.rgb, metallic, roughness);
    vec3 n = surfaceNormal();
    vec3 wo = safeNormalize(eyeWorld.xyz - positionWorld);

    vec3 around = ambientLight.rgb * color.rgb;
#ifdef ENVIRONMENT_RADIANCE
    if (USES(environmentBit))
        around = environmentLight(surface, clamp(roughness, 0.0, 1.0), n, wo);
#endif
#ifdef OCCLUSION_TEXTURE
    if (USES(occlusionTextureBit))
        around *= 1.0 + factors.w * (texture(occlusionTexture, texcoordOf(3)).r - 1.0);
#endif
    vec3 radiance = emission.rgb;
#ifdef EMISSION_TEXTURE
    if (USES(emissionTextureBit))
        radiance *= texture(emissionTexture, texcoordOf(4)).rgb;
#endif
    radiance += around;
#ifdef ALPHA_MASK
    // Not before: textures choose their level by neighbours, which have to reach them.
    if (USES(alphaMaskBit) && color.a < emission.a)
        discard;
#endif
    for (int i = 0; i < lightCount.x; ++i) {
        Light light = lights[i];
        PhongLight source = PhongLight(int(light.position.w), light.position.xyz, light.direction.xyz,
                                       light.radiance.rgb, light.direction.w, light.radiance.w);
        LightSample incoming = sampleLight(source, positionWorld);
        if (light.reach.x > 0.0)
            incoming.strength *= rangeShare(distance(light.position.xyz, positionWorld), light.reach.x);
        vec3 arriving = source.radiance * (incoming.strength * LIT_SHARE(i, positionWorld, n));
        radiance += arriving * microfacetShare(surface, n, incoming.wi, wo);
    }

    float alpha = 1.0;
#ifdef ALPHA_BLEND
    if (USES(alphaBlendBit))
        alpha = clamp(color.a, 0.0, 1.0);
#endif
    // The largest half, so that no target holds an infinity.
    return vec4(min(radiance, vec3(65504.0)), alpha);
}
