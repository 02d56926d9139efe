// The lookup of a shadow map. Laid out as struct ShadowBlock in common/passes/shadow_map.cpp.

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

// Which of a cube's faces a direction falls on: +x −x +y −y +z −z.
int cubeFace(vec3 d) {
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z)
        return d.x >= 0.0 ? 0 : 1;
    if (a.y >= a.z)
        return d.y >= 0.0 ? 2 : 3;
    return d.z >= 0.0 ? 4 : 5;
}

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

// How much the depth grows with s and t along a plane of the world: the plane is carried into the view, which is
// projective, and read off there. Planes that the light grazes are as steep as the map is deep.
vec2 depthSlopes(int view, vec3 positionWorld, vec3 planeNormal) {
    vec4 plane = vec4(planeNormal, -dot(planeNormal, positionWorld)) * worldFromShadow[view];
    const float steepest = 1e4;
    vec2 slopes = -plane.xy / plane.z;
    return plane.z == 0.0 ? vec2(steepest) : clamp(slopes, -steepest, steepest);
}

// The share of the taps that the light reaches: 1 lit, 0 in shadow. What lies outside the map is lit, and so is
// what is behind a spot: there w <= 0, and x/w would fall into the map mirrored.
float litShare(vec3 positionWorld, vec3 planeNormal) {
    if (shadowMode.y == 0)
        return 1.0;
    int view = shadowView(positionWorld);
    vec4 projected = shadowFromWorld[view] * vec4(positionWorld, 1.0);
    if (projected.w <= 0.0)
        return 1.0;
    vec3 place = projected.xyz / projected.w;
    if (any(lessThan(place.xy, vec2(0.0))) || any(greaterThan(place.xy, vec2(1.0))))
        return 1.0;
    float texel = shadowBias.z;
    vec2 slopes = shadowBias.y > 0.0 ? depthSlopes(view, positionWorld, planeNormal) : vec2(0.0);
    // A tap compares with the depth at texels' centres: half a texel off to the nearest, a whole one to each of four.
#ifdef SHADOW_BILINEAR
    float reach = texel;
#else
    float reach = 0.5 * texel;
#endif
    float depth = place.z - shadowBias.x - shadowBias.y * reach * (abs(slopes.x) + abs(slopes.y));
    vec4 tile = shadowTiles[view];
    int radius = shadowMode.w;
    float lit = 0.0;
    for (int y = -radius; y <= radius; ++y)
        for (int x = -radius; x <= radius; ++x) {
            vec2 offset = texel * vec2(x, y);
            vec2 st = clamp(place.xy + offset, vec2(reach), vec2(1.0 - reach));
            float tapDepth = clamp(depth + dot(slopes, offset), 0.0, 1.0);
            lit += texture(shadowMap, vec3(tile.xy + tile.zw * st, tapDepth));
        }
    float side = float(2 * radius + 1);
    return lit / (side * side);
}
