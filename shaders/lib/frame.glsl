// What the passes of a frame share: camera and lights. Laid out as struct FrameBlock in
// common/passes/scene_buffers.h. Positions are in world space, colours in linear RGB.

const int maxLights = 8;

struct Light {
    vec4 position;   // xyz: world space; w = 0 for a directional light, whose xyz points towards the light
    vec4 direction;  // xyz: the way a spot light points; w: cosine of its outer cone, −1 for other lights
    vec4 radiance;   // rgb: irradiance (directional) or intensity (point, spot), over pi; w: cosine of the inner cone
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
