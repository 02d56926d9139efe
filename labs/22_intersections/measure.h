#pragma once

#include "base/timing.h"

namespace quincunx {

/// Keeps a computed value from being left out as unused.
template <typename T>
void keep(const T& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

}  // namespace quincunx
