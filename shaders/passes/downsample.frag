#version 330 core

// The mean of the factor × factor texels that a pixel covers: a box filter in linear light.

uniform sampler2D fine;
uniform int factor;

out vec4 color;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * factor;
    vec4 sum = vec4(0.0);
    for (int y = 0; y < factor; ++y)
        for (int x = 0; x < factor; ++x)
            sum += texelFetch(fine, corner + ivec2(x, y), 0);
    color = sum / float(factor * factor);
}
