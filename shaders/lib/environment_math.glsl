// The arithmetic of environment maps: functions of numbers only, no state of GL. The same text compiles as C++ with
// GLM (common/trace/environment_glsl.h), where it is tested.
//
// A direction is a vector of any length. Cube maps are laid out as OpenGL has them (version 3.3, section 3.8.10):
// faces +x −x +y −y +z −z, and on each (s, t) in [0, 1], t growing downwards for a viewer at the centre whose up is +y.
// "eps" is 2^-24.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// d times the power of two that brings its largest component to 1 … 2 (denormals to 2^-22 at least), so that no
// product of two components overflows or vanishes; exact unless a component becomes a denormal. (0,0,0) for (0,0,0)
// and for components that are infinite or no number. Hardware that takes denormals for zero does so here as well.
QUINCUNX_INLINE vec3 scaledDirection(vec3 d) {
    uint largest = max(max(floatBitsToUint(d.x) & 0x7fffffffu, floatBitsToUint(d.y) & 0x7fffffffu),
                       floatBitsToUint(d.z) & 0x7fffffffu);
    if (largest == 0u || largest >= 0x7f800000u)
        return vec3(0.0f);
    uint exponent = min(largest >> 23u, 253u);
    return d * uintBitsToFloat((254u - exponent) << 23u);
}

// The axes of a face: of s, of t, and outwards. Each is the cross product of the next two.
QUINCUNX_INLINE mat3 cubeFaceAxes(int face) {
    if (face == 0)
        return mat3(0.0f, 0.0f, -1.0f, 0.0f, -1.0f, 0.0f, 1.0f, 0.0f, 0.0f);
    if (face == 1)
        return mat3(0.0f, 0.0f, 1.0f, 0.0f, -1.0f, 0.0f, -1.0f, 0.0f, 0.0f);
    if (face == 2)
        return mat3(1.0f, 0.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 1.0f, 0.0f);
    if (face == 3)
        return mat3(1.0f, 0.0f, 0.0f, 0.0f, 0.0f, -1.0f, 0.0f, -1.0f, 0.0f);
    if (face == 4)
        return mat3(1.0f, 0.0f, 0.0f, 0.0f, -1.0f, 0.0f, 0.0f, 0.0f, 1.0f);
    return mat3(-1.0f, 0.0f, 0.0f, 0.0f, -1.0f, 0.0f, 0.0f, 0.0f, -1.0f);
}

// The direction of a point of a face; its largest component is 1.
QUINCUNX_INLINE vec3 cubeDirection(int face, vec2 st) {
    mat3 axes = cubeFaceAxes(face);
    return axes[2] + (2.0f * st.x - 1.0f) * axes[0] + (2.0f * st.y - 1.0f) * axes[1];
}

// Where a direction meets the cube: (s, t, face); the earlier axis where two components are as long. Each of s and t
// lies in [0, 1] and is off by at most 0.75 eps: half a rounding of a quotient up to 1, and one of a sum up to 1. Where
// there is no direction (scaledDirection), the middle of the first face. Held by the stress of lab 18.
QUINCUNX_INLINE vec3 cubePlace(vec3 direction) {
    vec3 d = scaledDirection(direction);
    vec3 a = abs(d);
    if (max(max(a.x, a.y), a.z) == 0.0f)
        return vec3(0.5f, 0.5f, 0.0f);
    int face = a.x >= a.y && a.x >= a.z ? (d.x > 0.0f ? 0 : 1)
               : a.y >= a.z             ? (d.y > 0.0f ? 2 : 3)
                                        : (d.z > 0.0f ? 4 : 5);
    mat3 axes = cubeFaceAxes(face);
    float depth = dot(axes[2], d);
    return vec3(0.5f + 0.5f * (dot(axes[0], d) / depth), 0.5f + 0.5f * (dot(axes[1], d) / depth), float(face));
}

// Where a direction lies in a panorama (equirectangular image): u in [0, 1] from −x over −z, +x and +z to −x again, v from
// 0 at +y to 1 at −y. Both to 3 eps where atan is good to 1 ulp; acos of a normalized y would lose half of all digits
// about the poles. At the poles u is ½; no direction: the middle of the image. Held by the stress of lab 18.
QUINCUNX_INLINE vec2 panoramaPlace(vec3 direction) {
    vec3 d = scaledDirection(direction);
    float level = sqrt(d.x * d.x + d.z * d.z);
    // Squares that vanish: the larger component stands for the root.
    level = max(level, max(abs(d.x), abs(d.z)));
    float u = level > 0.0f ? 0.5f + 0.15915494309189535f * atan(d.z, d.x) : 0.5f;
    float v = level > 0.0f || d.y != 0.0f ? 0.3183098861837907f * atan(level, d.y) : 0.5f;
    return vec2(u, v);
}

// The direction of a place in a panorama, of length 1 to a few eps.
QUINCUNX_INLINE vec3 panoramaDirection(vec2 uv) {
    float around = 6.283185307179586f * (uv.x - 0.5f);
    float down = 3.141592653589793f * uv.y;
    return vec3(sin(down) * cos(around), cos(down), sin(down) * sin(around));
}

// How far along a direction the walls lie, seen from inside a box: t of position + t · direction, for a direction of
// scaledDirection. Never negative; 0 on the wall that the direction leads out of. A component of zero, of either
// sign, meets no wall. `position` lies in the box.
QUINCUNX_INLINE float distanceToWalls(vec3 position, vec3 d, vec3 boxMin, vec3 boxMax) {
    float t = 3.4028234663852886e38f;
    if (d.x != 0.0f)
        t = min(t, ((d.x > 0.0f ? boxMax.x : boxMin.x) - position.x) / d.x);
    if (d.y != 0.0f)
        t = min(t, ((d.y > 0.0f ? boxMax.y : boxMin.y) - position.y) / d.y);
    if (d.z != 0.0f)
        t = min(t, ((d.z > 0.0f ? boxMax.z : boxMin.z) - position.z) / d.z);
    return t;
}

// Box projection (Lagarde and Zanuttini, "Local image-based lighting with parallax-corrected cubemaps", SIGGRAPH
// Talks 2012): the direction, from where the map was taken, of the wall point that a ray meets in a room that is a
// box. Exact where the walls are all that is seen.
//
// A position outside is first moved to the nearest point of the box. The point met is put on its wall, and kept
// inside the box, after rounding; so the result is off by at most 8 eps of the box's size (its diagonal and its
// distance from the origin). No direction gives (0,0,0). Held by the stress of lab 18.
QUINCUNX_INLINE vec3 boxProjected(vec3 positionWorld, vec3 direction, vec3 boxMin, vec3 boxMax, vec3 mapWorld) {
    vec3 d = scaledDirection(direction);
    if (d == vec3(0.0f))
        return d;
    vec3 p = clamp(positionWorld, boxMin, boxMax);
    float t = distanceToWalls(p, d, boxMin, boxMax);
    return clamp(p + t * d, boxMin, boxMax) - mapWorld;
}

// Which level of a prefiltered map holds a roughness of 0 … 1: level k of `levels` is for roughness k / (levels − 1).
QUINCUNX_INLINE float environmentLevel(float roughness, float levels) {
    return clamp(roughness, 0.0f, 1.0f) * (levels - 1.0f);
}

// Point i of n of a set that fills the unit square evenly: (i + ½)/n and the binary digits of i mirrored at the point
// (Hammersley; van der Corput 1935), each cell's middle.
QUINCUNX_INLINE vec2 hammersley(uint i, uint n) {
    uint bits = (i << 16u) | (i >> 16u);
    bits = ((bits & 0x00ff00ffu) << 8u) | ((bits & 0xff00ff00u) >> 8u);
    bits = ((bits & 0x0f0f0f0fu) << 4u) | ((bits & 0xf0f0f0f0u) >> 4u);
    bits = ((bits & 0x33333333u) << 2u) | ((bits & 0xccccccccu) >> 2u);
    bits = ((bits & 0x55555555u) << 1u) | ((bits & 0xaaaaaaaau) >> 1u);
    return vec2((float(i) + 0.5f) / float(n), float(bits >> 8u) * 5.960464477539063e-8f);
}

// The normals of a rough surface, GGX with alpha = roughness²: their density D over solid angle times the cosine
// integrates to 1 (Walter et al., "Microfacet models for refraction through rough surfaces", EGSR 2007, eq. 33). Alpha
// below 1e-6 counts as that. Relative error at most 16 eps: 1 − cosine² is a product, which keeps its digits near 1.
// Held by the stress of lab 18.
QUINCUNX_INLINE float ggxDensity(float cosine, float alpha) {
    float a2 = max(alpha * alpha, 1e-12f);
    float root = (1.0f - cosine) * (1.0f + cosine) + a2 * (cosine * cosine);
    return 0.3183098861837907f * (a2 / root) / root;
}

// A normal drawn from D times the cosine by two numbers, u.x in [0, 1), about +z (eq. 35, 36). Sine and cosine are each
// within 4 eps of themselves, where one taken from the other would lose its digits. Held by the stress of lab 18.
QUINCUNX_INLINE vec3 ggxNormal(vec2 u, float alpha) {
    float around = 6.283185307179586f * u.y;
    float opposite = alpha * alpha * u.x;
    float adjacent = 1.0f - u.x;
    float both = adjacent + opposite;
    float sine = sqrt(opposite / both);
    return vec3(sine * cos(around), sine * sin(around), sqrt(adjacent / both));
}

// The angle of a cube texel as seen from the centre, in steradians, for a texel whose middle is (x, y) of the face's
// [−1, 1]² and whose edge is `width`: as for a small one, width² / (1 + x² + y²)^(3/2).
QUINCUNX_INLINE float cubeTexelAngle(vec2 xy, float width) {
    float squared = 1.0f + dot(xy, xy);
    return width * width / (squared * sqrt(squared));
}

// A frame about the direction of a point of a face (columns; the third is the unit direction) that turns with the
// cube: its first axis points towards the face's middle, which all rotations of the cube onto itself carry along. In
// the middle itself it is the face's own; a pattern that four quarter turns leave as it is cannot tell.
QUINCUNX_INLINE mat3 cubeTexelFrame(int face, vec2 st) {
    mat3 axes = cubeFaceAxes(face);
    vec3 n = cubeDirection(face, st);
    n = n / sqrt(dot(n, n));
    vec2 offset = 2.0f * st - 1.0f;
    vec3 towards = -offset.x * axes[0] - offset.y * axes[1];
    vec3 tangent = offset == vec2(0.0f) ? axes[0] : towards - dot(towards, n) * n;
    tangent = tangent / sqrt(dot(tangent, tangent));
    return mat3(tangent, cross(n, tangent), n);
}
