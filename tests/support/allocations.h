#pragma once

#include <cstddef>
#include <cstdint>

/// What the program allocates with `new`, on all threads. A program that calls any of these counts from its
/// start; others are as they are without.
namespace quincunx::test {

/// How often memory was taken so far.
std::uint64_t allocationCount();

/// Bytes that are taken and not given back.
std::size_t allocatedBytes();
/// The most that those were since the last restart.
std::size_t mostAllocatedBytes();
void restartMostAllocatedBytes();

}  // namespace quincunx::test
