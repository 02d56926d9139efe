// The light that a surface point sends to the eye, by the classic models: ambient + diffuse + specular + emission.
// Included by the shaders of every shading model; only where it is evaluated differs between them.

#include "lib/frame.glsl"
#include "lib/object.glsl"
#include "lib/phong.glsl"

struct Shade {
    vec3 textured;  // ambient and diffuse: multiplied by the texture
    vec3 plain;     // specular and emission: not
};

// `positionWorld`: the point; `normal`: its unit normal on the side of the eye.
Shade shade(vec3 positionWorld, vec3 normal) {
    Shade result = Shade(ambient.rgb * ambientLight.rgb, emission.rgb);
    vec3 towardsEye = safeNormalize(eyeWorld.xyz - positionWorld);
    for (int i = 0; i < lightCount.x; ++i) {
        LightSample incoming = sampleLight(lights[i], positionWorld);
        float cosine = max(dot(normal, incoming.towardsLight), 0.0);
        result.textured += diffuse.rgb * incoming.radiance * cosine;
#ifdef BLINN_PHONG
        float highlight = blinnPhongSpecular(normal, incoming.towardsLight, towardsEye, specular.a);
#else
        float highlight = phongSpecular(normal, incoming.towardsLight, towardsEye, specular.a);
#endif
        result.plain += specular.rgb * incoming.radiance * highlight;
    }
    return result;
}

// The colour of a fragment from its shade and the material's texture.
vec4 textureShade(Shade shaded, vec2 texcoord) {
    vec4 base = texture(baseColorTexture, texcoord);
    if (base.a * emission.a < diffuse.a)
        discard;
    return vec4(shaded.textured * base.rgb + shaded.plain, 1.0);
}
