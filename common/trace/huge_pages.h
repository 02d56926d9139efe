#pragma once

#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <vector>

#if defined(__linux__)
#include <sys/mman.h>
#endif

/// Memory that is read all over; no part of the interface.
namespace quincunx::detail {

/// An allocator that asks the system for pages of 2 MiB where a block is larger than that: a ray that jumps
/// about in a tree then does not wait for the tables of pages as well.
template <typename T>
class HugePages {
  public:
    using value_type = T;

    HugePages() = default;
    template <typename Other>
    explicit(false) HugePages(const HugePages<Other>&) {}

    T* allocate(std::size_t count) {
        if (count > std::numeric_limits<std::size_t>::max() / 2 / sizeof(T))
            throw std::bad_alloc();
        const std::size_t wanted = count * sizeof(T);
        const std::size_t alignment = wanted >= hugePage ? hugePage : cacheLine;
        const std::size_t unit = wanted >= hugePage ? page : cacheLine;
        const std::size_t bytes = (wanted + unit - 1) / unit * unit;
        void* memory = nullptr;
        if (posix_memalign(&memory, alignment, bytes == 0 ? unit : bytes) != 0)
            throw std::bad_alloc();
#if defined(__linux__)
        if (wanted >= hugePage)
            madvise(memory, bytes, MADV_HUGEPAGE);  // only advice: where it is not taken, nothing is lost
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t) {
        std::free(memory);
    }

    friend bool operator==(const HugePages&, const HugePages&) {
        return true;
    }

  private:
    static constexpr std::size_t cacheLine = 64;
    static constexpr std::size_t page = 4096;
    static constexpr std::size_t hugePage = std::size_t{2} << 20;
    static_assert(alignof(T) <= cacheLine);
};

template <typename T>
using HugeVector = std::vector<T, HugePages<T>>;

}  // namespace quincunx::detail
