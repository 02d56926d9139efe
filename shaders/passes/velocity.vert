#version 330 core

// A moving instance as the picture shows it, and where its points are when the shutter opens and closes.

layout(location = 0) in vec3 positionModel;

uniform mat4 worldFromModel;
uniform mat4 clipFromWorld;
uniform mat4 openFromModel;   // clip spaces
uniform mat4 closeFromModel;

out vec4 open;
out vec4 close;

void main() {
    vec4 position = vec4(positionModel, 1.0);
    open = openFromModel * position;
    close = closeFromModel * position;
    gl_Position = clipFromWorld * (worldFromModel * position);
}
