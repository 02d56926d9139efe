// Sums whose rounding errors are kept. The same text compiles as C++ with GLM, where it is tested.

#ifndef QUINCUNX_INLINE
#define QUINCUNX_INLINE
#endif

// What a + b lost when it was rounded to `sum`, exactly: sum + lost = a + b (Knuth, TAOCP 2, 4.2.2, theorem B). A
// compiler that takes sums of floats for sums of numbers would make 0 of it; the detour over bits keeps it from that.
QUINCUNX_INLINE vec4 lostInSum(vec4 a, vec4 b, vec4 sum) {
    vec4 bRounded = uintBitsToFloat(floatBitsToUint(sum) + uvec4(0u)) - a;
    vec4 aRounded = sum - uintBitsToFloat(floatBitsToUint(bRounded) + uvec4(0u));
    return (a - aRounded) + (b - bRounded);
}
