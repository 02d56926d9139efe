// Percentage-closer filtering in one view of a shadow map (Reeves et al., SIGGRAPH 1987).

#include "lib/shadow_math.glsl"

struct ShadowTile {
    mat4 shadowFromWorld;  // to (s, t, depth) in [0, 1] of the view, after the division by w
    mat4 worldFromShadow;
    vec4 place;  // of the map: offset and scale of the view's (s, t)
};

// The share of (2 radius + 1)² taps that the light reaches: 1 lit, 0 in shadow. What lies outside the view is lit.
// `bias`: x: constant depth; y: multiple of the receiver plane's; z: width of a texel in the view.
float shareOfTaps(sampler2DShadow map, ShadowTile tile, vec3 bias, int radius, vec3 positionWorld, vec3 planeNormal) {
    vec4 place = shadowPlace(tile.shadowFromWorld, positionWorld);
    if (place.w == 0.0 || any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, vec2(1.0))))
        return 1.0;
    float texel = bias.z;
#ifdef SHADOW_BILINEAR
    float reach = texel;
#else
    float reach = 0.5 * texel;
#endif
    vec2 slopes = bias.y > 0.0 ? receiverSlopes(tile.worldFromShadow, positionWorld, planeNormal) : vec2(0.0);
    float depth = place.z - bias.x - bias.y * receiverPlaneBias(slopes, reach);
    if (bias.y > 0.0)
        depth -= shadowRounding(tile.shadowFromWorld, positionWorld);
    float lit = 0.0;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            // Taps stay in their own tile; each is compared with the depth that the receiver has there.
            vec2 offset = texel * vec2(x, y);
            vec2 st = clamp(place.xy + offset, vec2(reach), vec2(1.0 - reach));
            float tapDepth = clamp(depth + dot(slopes, st - place.xy), 0.0, 1.0);
            lit += textureLod(map, vec3(tile.place.xy + tile.place.zw * st, tapDepth), 0.0);
        }
    float side = float(2 * radius + 1);
    return lit / (side * side);
}
