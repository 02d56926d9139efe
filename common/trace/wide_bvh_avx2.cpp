#if defined(__x86_64__)

#define QX_KERNEL_TARGET __attribute__((target("avx2,bmi,lzcnt,popcnt")))
#define QX_KERNEL_AVX2
#include "trace/wide_bvh_kernels.h"
#include "trace/wide_bvh_units.h"

namespace quincunx::detail {

const WideKernels wideKernelsAvx2 = kernels;

}  // namespace quincunx::detail

#endif
