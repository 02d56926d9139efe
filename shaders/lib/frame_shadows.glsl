// The shadow maps of a planned frame: one for each kind of light that casts, a tile for each of its lights' views.
// Laid out as struct FrameShadowBlock in common/passes/frame_shadows.cpp. SHADOWS_DIRECTIONAL, SHADOWS_SPOT and
// SHADOWS_POINT say which maps there are.

#include "lib/frame.glsl"
// The maps' sampler blends four comparisons.
#define SHADOW_BILINEAR
#include "lib/shadow_taps.glsl"
#include "lib/triangle_normal.glsl"

#if defined(SHADOWS_DIRECTIONAL) || defined(SHADOWS_SPOT) || defined(SHADOWS_POINT)

const int maxFrameShadowViews = 48;

layout(std140) uniform FrameShadowBlock {
    mat4 frameShadowFromWorld[maxFrameShadowViews];
    mat4 frameWorldFromShadow[maxFrameShadowViews];
    vec4 frameShadowTiles[maxFrameShadowViews];
    ivec4 frameShadowLights[maxLights];  // x: first view; y: views, 0 for a light that casts nothing
    vec4 frameShadowTexels[maxLights];   // x: width of a texel in the light's views
    vec4 frameShadowDistances[maxLights];  // directional: how far along the eye's view each of its views serves
    vec4 frameShadowEyeForward;            // dot with (position, 1): how far along the eye's view a point is
    ivec4 frameShadowMode;               // x: radius of taps
};

#ifdef SHADOWS_DIRECTIONAL
uniform sampler2DShadow directionalShadowMap;
#endif
#ifdef SHADOWS_SPOT
uniform sampler2DShadow spotShadowMap;
#endif
#ifdef SHADOWS_POINT
uniform sampler2DShadow pointShadowMap;
#endif

// What of a light arrives: exactly 1 where nothing is in its way.
float frameLitShare(int light, vec3 positionWorld, vec3 normal) {
    ivec4 views = frameShadowLights[light];
    if (views.y == 0)
        return 1.0;
    vec3 planeNormal = triangleNormal(positionWorld, normal);
    int view = views.x;
    if (views.y == 6) {
        view += cubeFace(positionWorld - lights[light].position.xyz);
    } else if (views.y > 1) {
        float distance = dot(frameShadowEyeForward, vec4(positionWorld, 1.0));
        for (int i = 0; i < views.y - 1 && distance > frameShadowDistances[light][i]; ++i)
            ++view;
    }
    ShadowTile tile =
        ShadowTile(frameShadowFromWorld[view], frameWorldFromShadow[view], frameShadowTiles[view]);
    vec3 bias = vec3(0.0, 1.0, frameShadowTexels[light].x);
    int radius = frameShadowMode.x;
    int kind = int(lights[light].position.w);
#ifdef SHADOWS_DIRECTIONAL
    if (kind == 0)
        return shareOfTaps(directionalShadowMap, tile, bias, radius, positionWorld, planeNormal);
#endif
#ifdef SHADOWS_SPOT
    if (kind == 2)
        return shareOfTaps(spotShadowMap, tile, bias, radius, positionWorld, planeNormal);
#endif
#ifdef SHADOWS_POINT
    if (kind == 1)
        return shareOfTaps(pointShadowMap, tile, bias, radius, positionWorld, planeNormal);
#endif
    return 1.0;
}

#define LIT_SHARE(light, position, n) frameLitShare(light, position, n)

#endif
