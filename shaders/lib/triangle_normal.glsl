#include "lib/phong.glsl"

// The normal of the triangle itself, from how the position changes over the screen; `otherwise` where the steps
// drown in the rounding of the position, 2^-24 of its size: at 256 times that they are good to 1 %.
vec3 triangleNormal(vec3 positionWorld, vec3 otherwise) {
    vec3 right = dFdx(positionWorld);
    vec3 up = dFdy(positionWorld);
    float rounding = 256.0 * 5.96e-8 * length(positionWorld);
    vec3 n = safeNormalize(cross(right, up));
    return min(length(right), length(up)) > rounding && n != vec3(0.0) ? n : otherwise;
}
