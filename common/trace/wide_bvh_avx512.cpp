#if defined(__x86_64__)

// The same eight lanes as with AVX2, in twice as many registers and with masks of their own.
#define QX_KERNEL_TARGET __attribute__((target("avx512f,avx512vl,avx512dq,avx512bw,avx2,bmi,lzcnt,popcnt")))
#define QX_KERNEL_AVX2
#define QX_KERNEL_AVX512
#include "trace/wide_bvh_kernels.h"
#include "trace/wide_bvh_units.h"

namespace quincunx::detail {

const WideKernels wideKernelsAvx512 = kernels;

}  // namespace quincunx::detail

#endif
