#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Who has met which triangle; no part of the interface.
namespace quincunx::detail {

/// Forgets a triangle when another one takes its place.
class RayMailbox {
  public:
    RayMailbox() { last_.fill(~std::uint32_t{0}); }
    /// Whether the triangle is new to the ray.
    bool enter(std::uint32_t triangle) {
        std::uint32_t& place = last_[triangle % last_.size()];
        if (place == triangle)
            return false;
        place = triangle;
        return true;
    }

  private:
    std::array<std::uint32_t, 64> last_;
};

/// The mailboxes of a thread, shared by all structures that it asks: a ray has its number from the thread.
class ThreadMailboxes {
  public:
    static ThreadMailboxes& ofThisThread() {
        thread_local ThreadMailboxes mailboxes;
        return mailboxes;
    }
    void startRay(std::size_t triangles) {
        if (lastRay_.size() < triangles)
            lastRay_.resize(triangles, 0);
        if (++ray_ == 0) {
            lastRay_.assign(lastRay_.size(), 0);
            ray_ = 1;
        }
    }
    bool enter(std::uint32_t triangle) {
        if (lastRay_[triangle] == ray_)
            return false;
        lastRay_[triangle] = ray_;
        return true;
    }

  private:
    std::vector<std::uint32_t> lastRay_;
    std::uint32_t ray_ = 0;
};

}  // namespace quincunx::detail
