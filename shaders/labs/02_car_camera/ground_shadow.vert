#version 330 core

// Shadows on level ground: every point goes along the light's way down to the plane y = shadowHeight.

#include "lib/frame.glsl"
#include "lib/object.glsl"

layout(location = 0) in vec3 positionModel;

uniform float shadowHeight;

void main() {
    vec3 p = (worldFromModel * vec4(positionModel, 1.0)).xyz;
    vec3 way = lights[0].direction.xyz;
    p += way * ((shadowHeight - p.y) / way.y);
    gl_Position = clipFromWorld * vec4(p, 1.0);
}
