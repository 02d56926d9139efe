// What the passes of a frame share: camera and lights. Laid out as struct FrameBlock in
// common/passes/scene_buffers.h. Positions are in world space, colours in linear RGB.

const int maxLights = 8;

struct Light {
    vec4 position;   // xyz: world space; w: 0 directional, 1 point, 2 spot
    vec4 direction;  // xyz: the way the light travels, world space, unit length; w: inner cone, radians
    vec4 radiance;   // rgb: irradiance (directional) or intensity (point, spot), over pi; w: outer cone, radians
    vec4 reach;      // x: distance where a point or spot ends, 0 for no end
};

layout(std140) uniform FrameBlock {
    mat4 clipFromWorld;
    vec4 eyeWorld;
    vec4 ambientLight;
    vec4 backgroundTop;
    vec4 backgroundBottom;
    ivec4 lightCount;  // x
    Light lights[maxLights];
};
