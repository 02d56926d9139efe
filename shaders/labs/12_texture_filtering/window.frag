#version 330 core

// A rectangle of the picture filled by a rectangle of a texture's level, through the texture unit. The texture's
// row 0 is on top.

uniform sampler2D image;
uniform vec4 rectangle;  // left, bottom, width, height in pixels
uniform vec4 window;     // s and t at the top left, s and t at the bottom right
uniform float level;
uniform float dim;       // what the colour is multiplied with

out vec4 color;

void main() {
    vec2 at = (gl_FragCoord.xy - rectangle.xy) / rectangle.zw;
    vec2 st = mix(window.xy, window.zw, vec2(at.x, 1.0 - at.y));
    color = vec4(dim * textureLod(image, st, level).rgb, 1.0);
}
