#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace quincunx {

/// What stood between a point and a light.
struct Blocker {
    enum class Kind : std::uint8_t { none, triangle, solid };
    Kind kind = Kind::none;
    std::uint32_t index = 0;

    bool operator==(const Blocker&) const = default;
};

/// The last thing that a shadow ray met, for each light and each depth of the recursion (Haines and
/// Greenberg, "The light buffer: a shadow-testing accelerator", CG&A 6(9), 1986): neighbouring points mostly
/// lie in the shadow of the same thing, and where that is met again, no structure need be walked. Since any
/// blocker settles the matter, the picture is the same, bit for bit.
///
/// Not shared: each thread has its own, so that there is nothing to lock. It is emptied where a tile begins,
/// so that hits and misses are the same for any number of threads.
class ShadowCache {
  public:
    ShadowCache(std::size_t lights, std::size_t depths) : lights_(lights), last_(lights * depths) {}

    /// Of one light at one depth; kind `none` where the last ray reached the light.
    Blocker& last(std::size_t light, std::size_t depth) { return last_[depth * lights_ + light]; }
    void clear() { last_.assign(last_.size(), {}); }

  private:
    std::size_t lights_;
    std::vector<Blocker> last_;
};

}  // namespace quincunx
