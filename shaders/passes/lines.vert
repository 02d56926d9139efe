#version 330 core

// A line segment as a quad of constant width on the screen. Each instance is a segment, each vertex a corner.

uniform mat4 clipFromWorld;
uniform vec2 viewportPixels;
uniform float depthBias;  // of normalized depth, towards the viewer

layout(location = 0) in vec3 fromWorld;
layout(location = 1) in vec3 toWorld;
layout(location = 2) in vec4 segmentColor;
layout(location = 3) in vec2 widthAndDash;  // pixels

flat out vec4 lineColor;
flat out vec3 lengthWidthDash;      // pixels
noperspective out vec2 alongAcross;  // pixels from the segment's start, and from its axis

const float fringe = 1.0;  // pixels around the line that its antialiased edge needs

void main() {
    vec4 a = clipFromWorld * vec4(fromWorld, 1.0);
    vec4 b = clipFromWorld * vec4(toWorld, 1.0);
    lineColor = segmentColor;
    lengthWidthDash = vec3(0.0);
    alongAcross = vec2(0.0);

    // What lies before the near plane is cut off here: behind the eye there is no place on the screen.
    float aInside = a.z + a.w;
    float bInside = b.z + b.w;
    if (aInside < 0.0 && bInside < 0.0) {
        gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
        return;
    }
    vec4 start = aInside < 0.0 ? mix(a, b, aInside / (aInside - bInside)) : a;
    vec4 end = bInside < 0.0 ? mix(b, a, bInside / (bInside - aInside)) : b;

    vec2 startPixels = 0.5 * viewportPixels * start.xy / start.w;
    vec2 endPixels = 0.5 * viewportPixels * end.xy / end.w;
    vec2 run = endPixels - startPixels;
    float lengthPixels = length(run);
    vec2 along = lengthPixels > 0.0 ? run / lengthPixels : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);

    bool atEnd = gl_VertexID >= 2;
    float side = gl_VertexID % 2 == 0 ? -1.0 : 1.0;
    float reach = 0.5 * widthAndDash.x + fringe;
    vec2 corner = (atEnd ? endPixels + reach * along : startPixels - reach * along) + side * reach * across;
    vec4 near = atEnd ? end : start;
    gl_Position = vec4(2.0 * corner / viewportPixels * near.w, near.z - depthBias * near.w, near.w);
    lengthWidthDash = vec3(lengthPixels, widthAndDash);
    alongAcross = vec2(atEnd ? lengthPixels + reach : -reach, side * reach);
}
