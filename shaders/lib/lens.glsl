// The arithmetic of depth of field: functions of numbers only, no state of GL. The same text compiles as C++ with
// GLM (common/trace/lens_glsl.h), where it is tested.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// The signed radius, in pixels, of the disc that a thin lens makes of a point at a window depth in [0, 1]: negative
// before the plane of focus, positive behind it, within ±most. It is K (1/focus − 1/distance), and 1/distance is affine
// in the depth, so that its values at the near and at the far plane are all it takes; the far plane may be infinitely
// far. Potmesil, Chakravarty, "A lens and aperture camera model for synthetic image generation", SIGGRAPH 1981. Within
// 2^-22 (|1 − depth| |atNear| + depth |atFar|).
QUINCUNX_INLINE float circleOfConfusion(float depth, float atNear, float atFar, float most) {
    return clamp((1.0f - depth) * atNear + depth * atFar, -most, most);
}

// How much of a pixel a disc covers whose centre is `away` pixels off: from 1 to 0 over one pixel at its rim.
QUINCUNX_INLINE float discCover(float radius, float away) {
    return clamp(radius - away + 0.5f, 0.0f, 1.0f);
}

// What `discCover` adds up to over the plane.
QUINCUNX_INLINE float discArea(float radius) {
    float r = max(radius, 0.5f);
    return 3.14159265f * (r * r + 0.0833333333f);
}

// Whether light from there passes before what is seen here: 1 yes, 0 it is as far or farther. Discs that differ by less
// than half a pixel are one surface, however steep it is.
QUINCUNX_INLINE float isBefore(float cocThere, float cocHere) {
    return clamp(cocHere - cocThere - 0.5f, 0.0f, 1.0f);
}

// The taps of the nine pixels of a 3 × 3 cell are one spiral of golden angles (Vogel, "A better way to construct the
// sunflower head", Mathematical Biosciences 44, 1979): pixel k takes every ninth point, from k on. Averaged over the
// cell they are nine times as many taps. The direction of the first one:
QUINCUNX_INLINE vec2 spiralStart(int k) {
    float angle = 2.39996323f * float(k);
    return vec2(cos(angle), sin(angle));
}

// … and of the next: nine golden angles on, 157.570° beyond whole turns.
QUINCUNX_INLINE vec2 spiralNext(vec2 d) {
    const float c = -0.92434556f;
    const float s = 0.38155641f;
    return vec2(c * d.x - s * d.y, s * d.x + c * d.y);
}

// The share of the taps before this one: in (0, 1).
QUINCUNX_INLINE float spiralShare(int tap, int k, int taps) {
    return (float(tap) + (float(k) + 0.5f) / 9.0f) / float(taps);
}

// How many taps a disc is worth: `least`, and for large ones as many in a cell as the disc has texels, so that small
// bright things do not fall between them. Spread evenly along the radius they are half as dense at the rim.
QUINCUNX_INLINE int tapsOfDisc(float radius, int least) {
    return int(clamp(ceil(0.35f * radius * radius), float(least), max(float(least), 1024.0f)));
}

// How much a pixel is averaged with its cell: not at all for discs of up to 2 pixels, which hold fewer texels than there
// are taps, wholly from 4 pixels on.
QUINCUNX_INLINE float cellShare(float radius) {
    return clamp(0.5f * radius - 1.0f, 0.0f, 1.0f);
}

// The radius of the taps of a pixel that is then averaged with its cell. A disc has the variance r²/4 along each axis
// and a square of 3 × 3 pixels 2/3: their sum is that of the disc asked for.
QUINCUNX_INLINE float tapRadius(float radius) {
    return sqrt(max(radius * radius - 2.66666667f * cellShare(radius), 0.0f));
}
