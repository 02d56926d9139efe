#pragma once

#include "trace/wide_bvh.h"

/// WideBvh's traversals, compiled for each kind of vector units; no part of the interface.
namespace quincunx::detail {

extern const WideKernels wideKernelsAny;   ///< what every machine has
extern const WideKernels wideKernelsAvx2;  ///< on x86-64

/// The best for this machine. All give the same hits and counts.
const WideKernels& wideKernels();

}  // namespace quincunx::detail
