#version 330 core

// Coverage of a line with round ends, from the distance to its axis.

flat in vec4 lineColor;
flat in vec3 lengthWidthDash;
noperspective in vec2 alongAcross;

out vec4 color;  // multiplied with its opacity

void main() {
    float beyond = max(max(-alongAcross.x, alongAcross.x - lengthWidthDash.x), 0.0);
    float fromAxis = length(vec2(beyond, alongAcross.y));
    float coverage = clamp(0.5 * lengthWidthDash.y + 0.5 - fromAxis, 0.0, 1.0);
    float dash = lengthWidthDash.z;
    if (dash > 0.0) {
        float intoPair = mod(alongAcross.x, 2.0 * dash);
        coverage *= clamp(0.5 * dash - abs(intoPair - 0.5 * dash) + 0.5, 0.0, 1.0);
    }
    if (coverage <= 0.0)
        discard;
    color = vec4(lineColor.rgb, 1.0) * (lineColor.a * coverage);
}
