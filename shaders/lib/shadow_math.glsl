// The arithmetic of a shadow map's lookup: functions of numbers only, no state of GL. The same text compiles as
// C++ with GLM (common/trace/shadow_glsl.h), where it is tested.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// Where a point of the world lies in a light's view: (s, t, depth), each in [0, 1] inside the view, and w = 1. All
// zeros for what is behind the light or in its plane: there x/w would fall into the map mirrored.
QUINCUNX_INLINE vec4 shadowPlace(mat4 shadowFromWorld_, vec3 positionWorld) {
    vec4 projected = shadowFromWorld_ * vec4(positionWorld, 1.0f);
    if (!(projected.w > 0.0f))
        return vec4(0.0f);
    return vec4(vec3(projected.x, projected.y, projected.z) / projected.w, 1.0f);
}

// How much the depth grows with s and t along a plane of the world: the plane is carried into the view, which is
// projective, and read off there. Planes that the light grazes are taken as no steeper than 1e4.
QUINCUNX_INLINE vec2 receiverSlopes(mat4 worldFromShadow_, vec3 positionWorld, vec3 planeNormal) {
    vec4 plane = vec4(planeNormal, -dot(planeNormal, positionWorld)) * worldFromShadow_;
    if (plane.z == 0.0f)
        return vec2(1e4f);
    return clamp(vec2(-plane.x / plane.z, -plane.y / plane.z), vec2(-1e4f), vec2(1e4f));
}

// How far a plane of those slopes can lie before its own image in the map: the map's depth was taken at a texel's
// centre, up to `reach` from here along s and along t (half a texel's width for the nearest, a whole one where four
// are blended). Isidoro, "Shadow mapping: GPU-based tips and techniques", GDC 2006.
QUINCUNX_INLINE float receiverPlaneBias(vec2 slopes, float reach) {
    return reach * (abs(slopes.x) + abs(slopes.y));
}

// How far rounding moves a depth, for the comparison with the map: 2^-24 of the terms that it is summed from, four times
// in each of the two products (the map's vertices and this point) and in how each position came about: 2^-20.
QUINCUNX_INLINE float shadowRounding(mat4 shadowFromWorld_, vec3 positionWorld) {
    vec4 position = vec4(positionWorld, 1.0f);
    vec4 depths = vec4(shadowFromWorld_[0].z, shadowFromWorld_[1].z, shadowFromWorld_[2].z, shadowFromWorld_[3].z);
    vec4 ws = vec4(shadowFromWorld_[0].w, shadowFromWorld_[1].w, shadowFromWorld_[2].w, shadowFromWorld_[3].w);
    float terms = dot(abs(depths), abs(position)) + dot(abs(ws), abs(position));
    return 9.5367431640625e-7f * terms / dot(ws, position);
}

// Which of a cube's faces a direction falls on: +x −x +y −y +z −z; the earlier axis where two are as long.
QUINCUNX_INLINE int cubeFace(vec3 d) {
    vec3 a = abs(d);
    if (a.x >= a.y && a.x >= a.z)
        return d.x >= 0.0f ? 0 : 1;
    if (a.y >= a.z)
        return d.y >= 0.0f ? 2 : 3;
    return d.z >= 0.0f ? 4 : 5;
}
