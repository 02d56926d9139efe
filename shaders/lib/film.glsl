// Colour turned into light and dark as an old film shows it. Functions of numbers only: the effect can run in the
// shader that draws the scene, or in a pass over the finished picture.

// Relative luminance of linear RGB with the primaries of Rec. 709.
float luminance(vec3 linearColor) {
    return dot(linearColor, vec3(0.2126, 0.7152, 0.0722));
}

// A number in [0, 1) that looks random, from a cell of a grid: an integer hash, so the same on every device.
float cellNoise(ivec2 cell) {
    uint h = uint(cell.x) * 0x9e3779b9u ^ (uint(cell.y) * 0x85ebca6bu + 0xc2b2ae35u);
    h = (h ^ (h >> 15)) * 0x2c1b3c6du;
    h = (h ^ (h >> 12)) * 0x297a2d39u;
    h ^= h >> 15;
    return float(h >> 8) * (1.0 / 16777216.0);
}

// Grain of several sizes, mean 0: an octave adds the noise of cells half as wide at 0.8 of the strength.
float grain(vec2 pixel, int octaves) {
    float sum = 0.0;
    float strength = 1.0;
    float total = 0.0;
    float size = 6.0;
    for (int i = 0; i < octaves; ++i) {
        vec2 place = pixel / size + float(i) * 17.0;
        ivec2 cell = ivec2(floor(place));
        vec2 within = fract(place);
        vec2 s = within * within * (3.0 - 2.0 * within);
        float low = mix(cellNoise(cell), cellNoise(cell + ivec2(1, 0)), s.x);
        float high = mix(cellNoise(cell + ivec2(0, 1)), cellNoise(cell + ivec2(1, 1)), s.x);
        sum += strength * (mix(low, high, s.y) - 0.5);
        total += strength;
        strength *= 0.8;
        size = max(0.5 * size, 1.0);
    }
    return total > 0.0 ? sum / total : 0.0;
}

// The colour of a pixel as grey, `greyscale` of the way, with grain; for none of either the same bits.
vec3 asFilm(vec3 linearColor, vec2 pixel, float greyscale, int octaves) {
    float grey = luminance(linearColor);
    vec3 faded = greyscale == 0.0 ? linearColor : mix(linearColor, vec3(grey), greyscale);
    return octaves > 0 ? max(faded * (1.0 + 0.9 * grain(pixel, octaves)), 0.0) : faded;
}
