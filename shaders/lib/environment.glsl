// The lookup of an environment map. Laid out as struct EnvironmentBlock in common/passes/environment_map.cpp; units and
// bindings are those of EnvironmentMap.

#include "lib/environment_math.glsl"

layout(std140) uniform EnvironmentBlock {
    vec4 environmentBoxMin;    // xyz: the room that the map is of, world space; w: 1 if it is a box
    vec4 environmentBoxMax;    // xyz; w: levels of the map
    vec4 environmentPosition;  // xyz: where the map was taken, world space; w: what its light is multiplied with
};

uniform samplerCube environmentMap;            // prefiltered: a level for each roughness
uniform samplerCube environmentIrradianceMap;  // cosine-prefiltered
uniform sampler2D environmentBrdfTable;

// The light that a surface of that roughness (0 … 1) reflects along, about a mirror direction: the radiance of the map
// averaged over GGX's lobe as seen from straight ahead (Karis, "Real shading in Unreal Engine 4", SIGGRAPH 2013).
vec3 environmentRadiance(vec3 direction, float roughness) {
    vec3 d = scaledDirection(direction);
    if (d == vec3(0.0))
        return vec3(0.0);
    return environmentPosition.w *
           textureLod(environmentMap, d, environmentLevel(roughness, environmentBoxMax.w)).rgb;
}

// Irradiance over pi: what a white matt surface of that normal sends back.
vec3 environmentIrradiance(vec3 n) {
    vec3 d = scaledDirection(n);
    if (d == vec3(0.0))
        return vec3(0.0);
    return environmentPosition.w * textureLod(environmentIrradianceMap, d, 0.0).rgb;
}

// Scale and offset of the reflectance at normal incidence in the integral of GGX over all directions, for the cosine
// of the view's angle (0 … 1): reflected = environmentRadiance * (f0 * x + y).
vec2 environmentBrdf(float nDotV, float roughness) {
    // The table's outer texels are for 0 and 1.
    vec2 size = vec2(textureSize(environmentBrdfTable, 0));
    vec2 place = (clamp(vec2(nDotV, roughness), 0.0, 1.0) * (size - 1.0) + 0.5) / size;
    return textureLod(environmentBrdfTable, place, 0.0).rg;
}

// The direction to look up for what a ray from a point sees: itself, as if all lay infinitely far away, or, in a room
// that is a box, the one corrected for the point's distance from where the map was taken.
vec3 environmentDirection(vec3 positionWorld, vec3 direction) {
    if (environmentBoxMin.w == 0.0)
        return direction;
    return boxProjected(positionWorld, direction, environmentBoxMin.xyz, environmentBoxMax.xyz,
                        environmentPosition.xyz);
}
