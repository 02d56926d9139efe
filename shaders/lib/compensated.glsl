// Sums whose rounding errors are kept. The same text compiles as C++ with GLM, where it is tested.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// The same number, for `zero` = 0, in a way that no compiler sees through: those that take floats for real numbers
// make b of (a + b) - a, and GLSL 3.30 has no `precise`.
QUINCUNX_INLINE vec4 asRounded(vec4 x, uint zero) {
    return uintBitsToFloat(floatBitsToUint(x) ^ uvec4(zero));
}

// What a + b lost when it was rounded to `sum`, exactly: sum + lost = a + b (Knuth, TAOCP 2, 4.2.2, theorem B).
// `zero` is 0, from where the compiler cannot know it.
QUINCUNX_INLINE vec4 lostInSum(vec4 a, vec4 b, vec4 sum, uint zero) {
    vec4 rounded = asRounded(sum, zero);
    vec4 bRounded = asRounded(rounded - a, zero);
    vec4 aRounded = rounded - bRounded;
    return (a - aRounded) + (b - bRounded);
}
