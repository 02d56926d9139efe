#define QX_KERNEL_TARGET
#include "trace/wide_bvh_kernels.h"
#include "trace/wide_bvh_units.h"

namespace quincunx::detail {

const WideKernels wideKernelsAny = kernels;

}  // namespace quincunx::detail
