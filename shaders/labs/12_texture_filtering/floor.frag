#version 330 core

// A plane under a texture that recedes to the horizon: where a pixel lies on the texture, how that place moves
// from pixel to pixel, and the filters that make one colour of the texels in between. The same formulas as
// FloorView and footprintOf.

uniform sampler2D image;
uniform mat3 rayFromPixel;
uniform vec3 eye;
uniform float repeats;
uniform float left;          // of the panel, pixels
uniform float hazeDistance;
uniform vec3 horizonColor;
uniform vec3 zenithColor;
uniform float lodScale;      // 2 to the power of the bias
uniform int maxProbes;       // 0: the sampler's own filter
uniform float mostRepeats;   // that one footprint may cover

out vec4 color;

// Probes in a row along the long axis of the pixel's ellipse, at the level of its short axis.
vec4 probed(vec2 st, vec2 alongX, vec2 alongY) {
    vec2 side = vec2(textureSize(image, 0));
    vec2 x = alongX * side;
    vec2 y = alongY * side;
    float ss = x.x * x.x + y.x * y.x;
    float tt = x.y * x.y + y.y * y.y;
    float cross2 = x.x * x.y + y.x * y.y;
    float longTexels = sqrt(0.5 * (ss + tt) + length(vec2(0.5 * (ss - tt), cross2)));
    float shortTexels = abs(x.x * y.y - x.y * y.x) / longTexels;
    float narrow = max(shortTexels, 1.0);
    int probes = int(clamp(ceil(longTexels / narrow), 1.0, float(maxProbes)));
    if (probes == 1)
        return textureGrad(image, st, alongX * lodScale, alongY * lodScale);
    float angle = 0.5 * atan(2.0 * cross2, ss - tt);
    vec2 longAxis = longTexels * vec2(cos(angle), sin(angle)) / side;
    float lambda = log2(max(narrow, longTexels / float(probes)) * lodScale);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < probes; ++i)
        sum += textureLod(image, st + ((float(i) + 0.5) / float(probes) - 0.5) * longAxis, lambda);
    return sum / float(probes);
}

void main() {
    vec3 ray = rayFromPixel * vec3(gl_FragCoord.x - left, gl_FragCoord.y, 1.0);
    if (ray.y * eye.y >= 0.0) {
        color = vec4(mix(horizonColor, zenithColor, sqrt(abs(ray.y) / length(ray))), 1.0);
        return;
    }
    float reach = -eye.y / ray.y;
    vec2 st = repeats * (eye.xz + reach * ray.xz);
    // The quotient rule, for ray.xz / ray.y.
    float scale = repeats * reach / ray.y;
    // task: How far the place on the texture moves from this pixel to the next along x, and along y: the filter
    // chooses its level by that.
    vec2 alongX = scale * (rayFromPixel[0].xz * ray.y - ray.xz * rayFromPixel[0].y);
    vec2 alongY = scale * (rayFromPixel[1].xz * ray.y - ray.xz * rayFromPixel[1].y);
    // instead: vec2 alongX = vec2(0.0);
    // instead: vec2 alongY = vec2(0.0);
    // end of task
    // Beyond a few repeats the mean stays the same, and a filter that walks over all texels of a footprint ends.
    float covered = max(length(alongX), length(alongY));
    if (covered > mostRepeats) {
        alongX *= mostRepeats / covered;
        alongY *= mostRepeats / covered;
    }
    vec4 texel = maxProbes > 0 ? probed(st, alongX, alongY)
                               : textureGrad(image, st, alongX * lodScale, alongY * lodScale);
    color = vec4(mix(horizonColor, texel.rgb, exp(-reach * length(ray) / hazeDistance)), 1.0);
}
