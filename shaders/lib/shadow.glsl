// The lookup of a shadow map. Laid out as struct ShadowBlock in common/passes/shadow_map.cpp.

#include "lib/shadow_taps.glsl"

const int maxShadowViews = 6;

layout(std140) uniform ShadowBlock {
    mat4 shadowFromWorld[maxShadowViews];  // to (s, t, depth) in [0, 1] of a view, after the division by w
    mat4 worldFromShadow[maxShadowViews];
    vec4 shadowTiles[maxShadowViews];  // of the map: offset and scale of each view's (s, t)
    vec4 shadowDistances;   // cascades: the distance along the view that each of them reaches
    vec4 shadowEyeForward;  // distance along the view = dot(xyz, position) + w
    vec4 shadowLightPosition;
    vec4 shadowBias;  // x: constant depth; y: multiple of the receiver plane's; z: width of a texel in a view
    ivec4 shadowMode;  // x: 0 cascades, 1 single, 2 cube; y: views; z: the light's index; w: radius of taps
};

uniform sampler2DShadow shadowMap;

int shadowView(vec3 positionWorld) {
    if (shadowMode.x == 2)
        return cubeFace(positionWorld - shadowLightPosition.xyz);
    if (shadowMode.x == 1)
        return 0;
    float distanceAlongView = dot(shadowEyeForward.xyz, positionWorld) + shadowEyeForward.w;
    int view = 0;
    while (view + 1 < shadowMode.y && distanceAlongView > shadowDistances[view])
        ++view;
    return view;
}

// The share of the taps that the light reaches: 1 lit, 0 in shadow. What lies outside the map is lit.
float litShare(vec3 positionWorld, vec3 planeNormal) {
    if (shadowMode.y == 0)
        return 1.0;
    int view = shadowView(positionWorld);
    return shareOfTaps(shadowMap, ShadowTile(shadowFromWorld[view], worldFromShadow[view], shadowTiles[view]),
                       shadowBias.xyz, shadowMode.w, positionWorld, planeNormal);
}
