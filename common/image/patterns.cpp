#include "image/patterns.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/glm.hpp>
#include <tbb/parallel_for.h>

#include "base/check.h"
#include "base/random.h"
#include "image/color.h"

namespace quincunx {
namespace {

constexpr double pi = std::numbers::pi;

/// `colorAt(s, t)`, linear RGB, averaged over each texel by 3 × 3 points.
template <typename ColorAt>
Image8 paint(int width, int height, const ColorAt& colorAt) {
    constexpr int points = 3;
    QX_CHECK_GE(width, 1);
    QX_CHECK_GE(height, 1);
    Image8 image(width, height, 3, Encoding::srgb);
    tbb::parallel_for(0, height, [&](int y) {
        for (int x = 0; x < width; ++x) {
            glm::dvec3 sum(0);
            for (int j = 0; j < points; ++j)
                for (int i = 0; i < points; ++i)
                    sum += colorAt((x + (i + 0.5) / points) / width, (y + (j + 0.5) / points) / height);
            for (int c = 0; c < 3; ++c)
                image.pixel(x, y)[c] = srgbCode(static_cast<float>(sum[c] / (points * points)));
        }
    });
    return image;
}

/// A number in [0, 1) for a cell.
double cellValue(std::uint64_t seed, int x, int y) {
    Random random(seed + (static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32) +
                  static_cast<std::uint32_t>(y));
    return random.uniformDouble();
}

double smooth(double t) {
    return t * t * t * (t * (6 * t - 15) + 10);
}

double rise(double low, double high, double x) {
    return smooth(std::clamp((x - low) / (high - low), 0.0, 1.0));
}

/// Gradient noise, about −0.7 … 0.7, over cells that repeat after `across` and `down`.
class Noise {
  public:
    Noise(std::uint64_t seed, int across, int down) : across_(across), down_(down) {
        for (int y = 0; y < down; ++y)
            for (int x = 0; x < across; ++x) {
                const double angle = 2 * pi * cellValue(seed, x, y);
                gradients_.emplace_back(std::cos(angle), std::sin(angle));
            }
    }
    /// s and t: any; 0…1 is a period.
    double at(double s, double t) const {
        const double x = s * across_;
        const double y = t * down_;
        const double left = std::floor(x);
        const double top = std::floor(y);
        const auto corner = [&](int i, int j) {
            const int column = (static_cast<int>(left) + i) % across_;
            const int row = (static_cast<int>(top) + j) % down_;
            const glm::dvec2& gradient = gradients_[static_cast<std::size_t>(
                (row + (row < 0 ? down_ : 0)) * across_ + column + (column < 0 ? across_ : 0))];
            return glm::dot(gradient, glm::dvec2(x - left - i, y - top - j));
        };
        return glm::mix(glm::mix(corner(0, 0), corner(1, 0), smooth(x - left)),
                        glm::mix(corner(0, 1), corner(1, 1), smooth(x - left)), smooth(y - top));
    }

  private:
    int across_;
    int down_;
    std::vector<glm::dvec2> gradients_;
};

}  // namespace

Image8 checkerTexture(int width, int height, int across, int down) {
    QX_CHECK_GE(std::min(across, down), 1);
    return paint(width, height, [&](double s, double t) {
        const bool light =
            (static_cast<int>(std::floor(s * across)) + static_cast<int>(std::floor(t * down))) % 2 == 0;
        return light ? glm::dvec3(0.86, 0.83, 0.76) : glm::dvec3(0.035, 0.04, 0.055);
    });
}

Image8 zonePlateTexture(int side, double frequency) {
    return paint(side, side, [&](double s, double t) {
        const double squared = (s - 0.5) * (s - 0.5) + (t - 0.5) * (t - 0.5);
        return glm::dvec3(0.5 + 0.48 * std::cos(pi * side * frequency * squared));
    });
}

Image8 brickTexture(int side, int rows, std::uint64_t seed) {
    QX_CHECK(rows >= 2 && rows % 2 == 0);
    const Noise rough(seed + 1, 12 * rows, 12 * rows);
    const Noise cloudy(seed + 2, 2 * rows, 2 * rows);
    return paint(side, side, [&](double s, double t) {
        const double y = t * rows;
        const int row = static_cast<int>(std::floor(y));
        const double x = s * (rows / 2) + (row % 2 == 0 ? 0 : 0.5);
        const int column = static_cast<int>(std::floor(x)) % (rows / 2);
        // Distances to the brick's edges, in heights of a row.
        const double toEdge = std::min(2 * std::min(x - std::floor(x), 1 - (x - std::floor(x))),
                                       std::min(y - std::floor(y), 1 - (y - std::floor(y))));
        const double grit = rough.at(s, t);
        const double tone = 0.62 + 0.5 * cellValue(seed, column, row) + 0.22 * cloudy.at(s, t) + 0.3 * grit;
        const double redness = cellValue(seed + 3, column, row);
        const glm::dvec3 clay =
            glm::mix(glm::dvec3(0.36, 0.105, 0.055), glm::dvec3(0.43, 0.17, 0.085), redness);
        const glm::dvec3 mortar = glm::dvec3(0.52, 0.49, 0.44) * (0.9 + 0.35 * grit);
        const double edge = rise(0.045, 0.085, toEdge + 0.02 * grit);
        return glm::max(glm::mix(mortar, clay * tone * (0.75 + 0.25 * rise(0.05, 0.2, toEdge)), edge),
                        glm::dvec3(0.004));
    });
}

Image8 woodTexture(int side, std::uint64_t seed) {
    constexpr int planks = 4;
    const Noise bend(seed + 1, 2 * planks, 2);
    const Noise fibre(seed + 2, 40 * planks, 5);
    return paint(side, side, [&](double s, double t) {
        const int plank = static_cast<int>(std::floor(s * planks));
        const double inPlank = s * planks - plank;
        const double shift = cellValue(seed, plank, 0);
        const double along = t + shift;
        const double rings =
            9 * inPlank * (0.6 + 0.5 * cellValue(seed, plank, 1)) + 2.6 * bend.at(s + 0.3 * shift, along);
        const double ring = 0.5 + 0.5 * std::cos(2 * pi * rings);
        const double grain = fibre.at(s, along);
        const double tone = 0.72 + 0.4 * cellValue(seed, plank, 2) - 0.34 * ring * ring * ring + 0.3 * grain;
        const double gap = rise(0.006, 0.022, std::min(inPlank, 1 - inPlank));
        return glm::max(glm::dvec3(0.47, 0.235, 0.095) * tone * (0.12 + 0.88 * gap), glm::dvec3(0.003));
    });
}

Image8 noiseTexture(int side, std::uint64_t seed) {
    constexpr int octaves = 6;
    std::vector<Noise> noises;
    for (int i = 0; i < octaves; ++i)
        noises.emplace_back(seed + static_cast<std::uint64_t>(i), 4 << i, 4 << i);
    return paint(side, side, [&](double s, double t) {
        double sum = 0;
        for (int i = 0; i < octaves; ++i)
            sum += std::exp2(-i) * noises[static_cast<std::size_t>(i)].at(s, t);
        const double value = std::clamp(0.42 + 0.62 * sum, 0.0, 1.0);
        return glm::mix(glm::dvec3(0.05, 0.055, 0.075), glm::dvec3(0.9, 0.85, 0.74), value);
    });
}

WavePicture::WavePicture(int side, double share, std::uint64_t seed) : side_(side) {
    QX_CHECK_GE(side, 1);
    QX_CHECK(share >= 0 && share < 1);
    constexpr int count = 24;
    const double most = share * 0.5 * side;
    Random random(seed);
    double sum = 0;
    for (int i = 0; i < count; ++i) {
        // Evenly over the frequencies' disk, so that most of them are high, but lower ones are stronger.
        const double radius = most * std::sqrt((i + 0.5) / count);
        const double angle = random.uniform(0, 2 * pi);
        Wave wave;
        wave.across = static_cast<int>(std::trunc(radius * std::cos(angle)));
        wave.down = static_cast<int>(std::trunc(radius * std::sin(angle)));
        wave.phase = random.uniform(0, 2 * pi);
        wave.amplitude = 1 / std::sqrt(1 + 8 * radius / side);
        sum += wave.amplitude;
        waves_.push_back(wave);
    }
    for (Wave& wave : waves_)
        wave.amplitude *= 0.5 / sum;
}

double WavePicture::at(double s, double t) const {
    double value = 0.5;
    for (const Wave& wave : waves_)
        value += wave.amplitude * std::cos(2 * pi * (wave.across * s + wave.down * t) + wave.phase);
    return value;
}

Image WavePicture::texels() const {
    Image image(side_, side_, 1, Encoding::linear);
    for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x)
            *image.pixel(x, y) = static_cast<float>(at((x + 0.5) / side_, (y + 0.5) / side_));
    return image;
}

}  // namespace quincunx
