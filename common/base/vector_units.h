#pragma once

/// Before a function with loops over arrays: it is compiled once for each width of vectors that a machine may
/// have, and the widest that is there is called. No product is fused with a sum (-ffp-contract=off), so all
/// of them give the same numbers. What it calls in a loop must be QUINCUNX_ALWAYS_INLINE.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define QUINCUNX_FOR_EACH_VECTOR_UNIT __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define QUINCUNX_FOR_EACH_VECTOR_UNIT
#endif
#define QUINCUNX_ALWAYS_INLINE inline __attribute__((always_inline))
