#pragma once

#include <span>

#include "lab/lab.h"

namespace quincunx {

/// Every lab there is, by number; the build system makes the table from the folders.
std::span<const LabEntry> allLabs();

}  // namespace quincunx
