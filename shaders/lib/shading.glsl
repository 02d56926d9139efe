// The light that a surface point sends to the eye, by the classic models: ambient + diffuse + specular + emission.
// Included by the shaders of every shading model; only where it is evaluated differs between them.

#include "lib/frame.glsl"
#include "lib/object.glsl"
#include "lib/phong.glsl"

// The share of a light that nothing keeps away: 1 unless a pass with shadows says otherwise.
#ifndef LIT_SHARE
#define LIT_SHARE(light, position, n) 1.0
#endif

struct Shade {
    vec3 textured;  // ambient and diffuse: multiplied by the texture
    vec3 plain;     // specular and emission: not
};

PhongLight phongLight(Light light) {
    return PhongLight(int(light.position.w), light.position.xyz, light.direction.xyz, light.radiance.rgb,
                      light.direction.w, light.radiance.w);
}

// `positionWorld`: the point; `n`: its unit normal on the side of the eye.
Shade shade(vec3 positionWorld, vec3 n) {
    Shade result = Shade(ambient.rgb * ambientLight.rgb, emission.rgb);
    vec3 wo = safeNormalize(eyeWorld.xyz - positionWorld);
    for (int i = 0; i < lightCount.x; ++i) {
        PhongLight light = phongLight(lights[i]);
        LightSample incoming = sampleLight(light, positionWorld);
        vec3 arriving = light.radiance * (incoming.strength * LIT_SHARE(i, positionWorld, n));
#ifdef BLINN_PHONG
        float highlight = blinnPhongSpecular(n, incoming.wi, wo, specular.a);
#else
        float highlight = phongSpecular(n, incoming.wi, wo, specular.a);
#endif
        result.textured += arriving * diffuse.rgb * lambert(n, incoming.wi);
        result.plain += arriving * specular.rgb * highlight;
    }
    return result;
}
