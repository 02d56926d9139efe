// For fragment shaders: what a shade (lib/shading.glsl) looks like through the material's texture.

#include "lib/shading.glsl"

// The colour of a fragment from its shade and the material's texture.
vec4 textureShade(Shade shaded, vec2 texcoord) {
    vec4 base = texture(baseColorTexture, texcoord);
    if (base.a * emission.a < diffuse.a)
        discard;
    return vec4(shaded.textured * base.rgb + shaded.plain, 1.0);
}
