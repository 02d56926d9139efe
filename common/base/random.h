#pragma once

#include <cstdint>

namespace quincunx {

/// SplitMix64 (Steele, Lea, Flood: "Fast splittable pseudorandom number generators", OOPSLA 2014).
/// Every seed gives an independent stream; the same seed gives the same numbers on every machine.
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }

    /// Uniform in [0, 1): a multiple of 2^-24, so that it is never rounded up to 1.
    float uniform() { return static_cast<float>(bits() >> 40) * 0x1p-24f; }

    /// Uniform in [0, 1): a multiple of 2^-53.
    double uniformDouble() { return static_cast<double>(bits() >> 11) * 0x1p-53; }

    /// Uniform in [low, high), up to rounding.
    double uniform(double low, double high) { return low + (high - low) * uniformDouble(); }

    /// Uniform in 0 … count-1 (count > 0), without bias: multiply-shift with rejection (Lemire 2019).
    std::uint64_t below(std::uint64_t count) {
        __extension__ using Wide = unsigned __int128;
        const std::uint64_t unfair = (0 - count) % count;
        for (;;) {
            const auto product = static_cast<Wide>(bits()) * count;
            if (static_cast<std::uint64_t>(product) >= unfair)
                return static_cast<std::uint64_t>(product >> 64);
        }
    }

  private:
    std::uint64_t state_;
};

}  // namespace quincunx
