#version 330 core

// Metallic-roughness materials of a planned frame, with the shadow maps that there are.

#include "lib/frame_shadows.glsl"
#include "lib/material.glsl"

invariant out vec4 color;

void main() {
    // task: Light the material: its own colour alone is what it would be under white light from everywhere.
    color = materialColor();
    // instead: color = surfaceColor();
    // end of task
}
