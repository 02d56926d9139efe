// The arithmetic of motion blur: functions of numbers only, no state of GL. The same text compiles as C++ with GLM
// (common/trace/motion_glsl.h), where it is tested.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// Where the picture shows the first point of the way from a to b whose w is not below `lowest` > 0: −1 … 1 inside it,
// and within ±2^60.
QUINCUNX_INLINE vec2 placeOnWay(vec4 a, vec4 b, float lowest) {
    vec2 place = vec2(a.x, a.y) / a.w;
    if (a.w < lowest) {
        float share = (lowest - a.w) / (b.w - a.w);
        place = vec2(a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)) / lowest;
    }
    return clamp(place, vec2(-1.1529215e18f), vec2(1.1529215e18f));
}

// How far a point moves over the picture, in pixels, between two places in clip space. A point that passes the
// camera's plane (w = 0) is at no place of the picture; of a way that comes near it, what lies at a sixteenth of the
// larger w or deeper is taken: its direction is right, and its length is more than is ever used. Zero if both ends are
// behind the camera; exactly zero if they are the same. At most `most` pixels long.
QUINCUNX_INLINE vec2 screenMotion(vec4 open, vec4 close, vec2 sizePixels, float most) {
    float deepest = max(open.w, close.w);
    if (!(deepest > 0.0f))
        return vec2(0.0f);
    float lowest = 0.0625f * deepest;
    vec2 motion = 0.5f * sizePixels * (placeOnWay(close, open, lowest) - placeOnWay(open, close, lowest));
    // The larger side first: squares of long ways would overflow.
    float larger = max(abs(motion.x), abs(motion.y));
    if (!(larger > 0.0f))
        return vec2(0.0f);
    vec2 direction = motion / larger;
    float length_ = larger * sqrt(dot(direction, direction));
    return length_ > most ? motion * (most / length_) : motion;
}

// How much of a pixel's exposure light from a texel takes that is `there` pixels off and moves by `motion`, centred on
// where it is seen: 1 on its way, to 0 over one pixel at its ends and beside it.
QUINCUNX_INLINE float wayCover(vec2 motion, vec2 there) {
    float length_ = sqrt(dot(motion, motion));
    if (length_ <= 1.0f)
        return 0.0f;
    vec2 direction = motion / length_;
    float along = abs(dot(direction, there));
    float beside = abs(direction.x * there.y - direction.y * there.x);
    return clamp(0.5f * length_ - along + 0.5f, 0.0f, 1.0f) * clamp(1.5f - beside, 0.0f, 1.0f);
}

// Whether two motions differ so much that the nearer thing uncovers the farther one: 0 up to half a pixel.
QUINCUNX_INLINE float differs(vec2 a, vec2 b) {
    vec2 difference = a - b;
    return clamp(sqrt(dot(difference, difference)) - 0.5f, 0.0f, 1.0f);
}
