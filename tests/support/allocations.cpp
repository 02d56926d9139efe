#include "tests/support/allocations.h"

#include <atomic>
#include <cstdlib>
#include <new>

#include <malloc.h>

namespace {

std::atomic<std::uint64_t> count{0};
std::atomic<std::size_t> bytesNow{0};
std::atomic<std::size_t> bytesMost{0};

// Not inlined: the compiler would take what is given back by `free` for memory of another kind.
[[gnu::noinline]] void* take(std::size_t size) {
    void* const memory = std::malloc(size > 0 ? size : 1);
    if (memory == nullptr)
        throw std::bad_alloc();
    ++count;
    const std::size_t now = bytesNow += malloc_usable_size(memory);
    std::size_t most = bytesMost;
    while (now > most && !bytesMost.compare_exchange_weak(most, now)) {
    }
    return memory;
}

[[gnu::noinline]] void giveBack(void* memory) {
    if (memory != nullptr)
        bytesNow -= malloc_usable_size(memory);
    std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
    return take(size);
}
void* operator new[](std::size_t size) {
    return take(size);
}
void operator delete(void* memory) noexcept {
    giveBack(memory);
}
void operator delete[](void* memory) noexcept {
    giveBack(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
    giveBack(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
    giveBack(memory);
}

namespace quincunx::test {

std::uint64_t allocationCount() {
    return count;
}
std::size_t allocatedBytes() {
    return bytesNow;
}
std::size_t mostAllocatedBytes() {
    return bytesMost;
}
void restartMostAllocatedBytes() {
    bytesMost = bytesNow.load();
}

}  // namespace quincunx::test
