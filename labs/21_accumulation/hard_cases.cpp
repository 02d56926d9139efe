#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <glm/gtc/packing.hpp>

#include "labs/21_accumulation/lab.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"

namespace quincunx {
namespace {

/// shaders/lib/compensated.glsl as C++: what the shaders compute, on the CPU, in float.
#define QUINCUNX_INLINE inline
namespace glsl {

using namespace glm;

#include "shaders/lib/compensated.glsl"

}  // namespace glsl
#undef QUINCUNX_INLINE

constexpr double infinity = std::numeric_limits<double>::infinity();

/// How long sequences are: many short ones, some of thousands, and one in a thousand of 65 536 frames.
std::size_t frameCount(std::uint64_t input, Random& random) {
    if (input % 1000 == 7)
        return 65536;
    return input % 50 == 3 ? 4096 : 2 + static_cast<std::size_t>(random.below(30));
}

/// The frames' values: all the same, or anything within a factor of two, at any brightness.
struct Frames {
    float base;
    bool same;
    Random random;

    float next() { return same ? base : base * (1 + random.uniform()); }
};

double exactMean(Frames frames, std::size_t count) {
    // Exact: 2^16 floats of 24 bits within a factor of two add up to 42 bits.
    double sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        sum += static_cast<double>(frames.next());
    return sum / static_cast<double>(count);
}

float compensatedMean(Frames frames, std::size_t count, std::size_t block) {
    glm::vec4 total(0);
    glm::vec4 carry(0);
    glm::vec4 inBlock(0);
    for (std::size_t i = 0; i < count; ++i) {
        const glm::vec4 frame(frames.next());
        inBlock = i % block == 0 ? frame : inBlock + frame;
        if (i % block == block - 1) {
            const glm::vec4 added = inBlock + carry;
            const glm::vec4 sum = total + added;
            carry = glsl::lostInSum(total, added, sum, 0u);
            total = sum;
        }
    }
    const float rest = count % block == 0 ? 0.0f : inBlock.x;
    return (total.x + carry.x + rest) / static_cast<float>(count);
}

float runningMeanNaive(Frames frames, std::size_t count) {
    float mean = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const float share = 1.0f / static_cast<float>(i + 1);
        mean = frames.next() * share + mean * (1 - share);
    }
    return mean;
}

float weightedHalfNaive(Frames frames, std::size_t count) {
    float sum = 0;
    const float weight = 1.0f / static_cast<float>(count);
    for (std::size_t i = 0; i < count; ++i)
        sum = glm::unpackHalf1x16(
            glm::packHalf1x16(sum + glm::unpackHalf1x16(glm::packHalf1x16(frames.next() * weight))));
    return sum;
}

/// 8 bits: values in 0 … 255, each frame's share rounded.
float weightedByteNaive(Frames frames, std::size_t count) {
    float sum = 0;
    const float weight = 1.0f / static_cast<float>(count);
    for (std::size_t i = 0; i < count; ++i)
        sum = std::min(255.0f, sum + std::round(frames.next() * weight * 255));
    return sum / 255;
}

double relative(float got, double exact) {
    return std::isfinite(got) ? std::abs(static_cast<double>(got) - exact) / std::abs(exact) : infinity;
}

template <typename Naive>
HardCaseFigures runMeans(std::uint64_t inputs, std::uint64_t seed, double lowExponent, double highExponent,
                         std::size_t block, const Naive& naive) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const std::size_t count = frameCount(i, draw.random());
        const Frames frames{static_cast<float>(draw.magnitude(lowExponent, highExponent)),
                            draw.random().below(2) == 0, Random(draw.random().bits())};
        const double exact = exactMean(frames, count);
        tally.add(relative(naive(frames, count), exact),
                  relative(compensatedMean(frames, count, block), exact), [&] {
                      return fmt::format("{} frames of {:a}{}", count, frames.base,
                                         frames.same ? "" : " to twice that");
                  });
    }
    return tally.figures();
}

HardCaseFigures runRunningMean(std::uint64_t inputs, std::uint64_t seed) {
    return runMeans(inputs, seed, -60, 60, 1, &runningMeanNaive);
}
HardCaseFigures runHalf(std::uint64_t inputs, std::uint64_t seed) {
    return runMeans(inputs, seed, -6, 4, 16, &weightedHalfNaive);
}
HardCaseFigures runByte(std::uint64_t inputs, std::uint64_t seed) {
    return runMeans(inputs, seed, -6, -1, 16, &weightedByteNaive);
}

/// Where a point in the plane of focus lands when it is seen through a point of the lens, against where the
/// pinhole shows it. Focus from the eye itself to infinity, lenses from pinholes to as wide as the focus is
/// far.
HardCaseFigures runLens(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        Camera camera;
        camera.fovYRadians = static_cast<float>(draw.random().uniform(0.05, 2.5));
        camera.nearDistance = static_cast<float>(draw.magnitude(-12, -1));
        camera.farDistance = i % 3 == 0 ? std::numeric_limits<float>::infinity() : 1000;
        const float aspect = static_cast<float>(draw.random().uniform(0.5, 2.5));
        camera.focusDistance = i % 7 == 0   ? 0
                               : i % 7 == 1 ? std::numeric_limits<float>::infinity()
                                            : static_cast<float>(draw.magnitude(-3, 12));
        const bool regular = i % 7 > 1;
        const double radius = regular ? static_cast<double>(camera.focusDistance) * draw.magnitude(-10, 0)
                                      : draw.magnitude(-10, 0);
        // At the eye only the middle of the lens looks at anything.
        const bool middle = i % 7 == 0 || i % 11 == 0;
        const glm::vec2 lens = middle ? glm::vec2(0)
                                      : glm::vec2(static_cast<float>(radius * draw.random().uniform(-1, 1)),
                                                  static_cast<float>(radius * draw.random().uniform(-1, 1)));
        // Points at the focus; for a focus of infinity directions; for one at the eye any distance.
        const double z = regular ? static_cast<double>(camera.focusDistance) : draw.magnitude(-1, 8);
        const double tangent = std::tan(static_cast<double>(camera.fovYRadians) / 2);
        const double ndc = draw.random().uniform(-1, 1);
        const bool direction = i % 7 == 1;
        const glm::dvec4 point(ndc * z * tangent * static_cast<double>(aspect), 0, -z, direction ? 0 : 1);
        const auto error = [&](const glm::mat4& clipFromCamera) {
            const glm::dvec4 clip = glm::dmat4(clipFromCamera) * point;
            const double got = clip.x / clip.w;
            return std::isfinite(got) ? std::abs(got - ndc) : infinity;
        };
        const double stable =
            error(glm::mat4(lensClipFromCamera(camera, aspect, glm::dvec2(lens), glm::dvec2(0))));
        // The textbook's matrix has no far plane at infinity: it is given one.
        tally.add(error(lensClipFromCameraNaive(camera, aspect, lens)), stable, [&] {
            return fmt::format("focus={:a} lens=({:a},{:a}) fov={:a} aspect={:a} ndc={:a} z={:a}",
                               camera.focusDistance, lens.x, lens.y, camera.fovYRadians, aspect, ndc, z);
        });
    }
    return tally.figures();
}

/// A moment of an exposure of 2^-13 … 1 s, up to 2^22 s (seven weeks) after the start: its place in the
/// shutter's time.
HardCaseFigures runMoment(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto seconds = static_cast<float>(draw.magnitude(-4, 22));
        const auto shutter = static_cast<float>(draw.magnitude(-13, 0));
        const float at = draw.random().uniform();
        PassSample sample;
        sample.time = static_cast<double>(at);
        const auto error = [&](double got) {
            return std::abs((got - static_cast<double>(seconds)) / static_cast<double>(shutter) -
                            (static_cast<double>(at) - 0.5));
        };
        tally.add(error(static_cast<double>(passSecondsNaive(seconds, shutter, at))),
                  error(passSeconds(static_cast<double>(seconds), static_cast<double>(shutter), sample)),
                  [&] { return fmt::format("seconds={:a} shutter={:a} at={:a}", seconds, shutter, at); });
    }
    return tally.figures();
}

/// Any index of 32 bits in bases 2 … 19. A number that is 1 is a failure: it lies outside of [0, 1).
HardCaseFigures runRadicalInverse(std::uint64_t inputs, std::uint64_t seed) {
    static constexpr std::array<std::uint32_t, 8> bases = {2, 3, 5, 7, 11, 13, 17, 19};
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const std::uint32_t base = bases[i % bases.size()];
        // The hardest have their digits all at their largest.
        const auto any = static_cast<std::uint32_t>(draw.random().bits());
        const std::uint32_t index = i % 5 == 0 ? 0xffffffffu - any % 16 : any >> draw.random().below(24);
        Quad exact(0.0);
        Quad place(1.0);
        for (std::uint32_t rest = index; rest > 0; rest /= base) {
            place = place / Quad(static_cast<double>(base));
            exact = exact + Quad(static_cast<double>(rest % base)) * place;
        }
        const auto error = [&](double got) {
            return got < 1 ? std::abs(static_cast<double>(Quad(got) - exact)) : infinity;
        };
        tally.add(error(static_cast<double>(radicalInverseNaive(base, index))),
                  error(radicalInverse(base, index)),
                  [&] { return fmt::format("base={} index={}", base, index); });
    }
    return tally.figures();
}

}  // namespace

std::vector<HardCase> AccumulationLab::hardCases() {
    return {
        // A block is rounded once less than it has passes, and once with the carry; sum, rest and quotient,
        // too.
        {"Accumulator, running mean", "up to 65 536 frames of 2^-60 … 2^60", "relative error", 4 * 0x1p-24,
         "Kahan's sum with Knuth's TwoSum", &runRunningMean},
        {"Accumulator, 16-bit float", "up to 65 536 frames, each divided by their number", "relative error",
         19 * 0x1p-24, "blocks of 16, compensated, in 32-bit float", &runHalf},
        {"Accumulator, 8 bits", "up to 65 536 frames, each divided by their number", "relative error",
         19 * 0x1p-24, "blocks of 16, compensated, in 32-bit float", &runByte},
        // x, the slope times z, and the lens, each rounded by 2^-25 of 1, 1 and 1 half-picture, with a lens
        // as
        // wide as the focus is far and a view whose half-height is 1/40 of its distance or more.
        {"lensClipFromCamera", "focus at the eye, at infinity and between; lenses up to the focus' distance",
         "half-pictures", 40 * 0x1p-23, "shear by lens/focus in double, rounded once", &runLens},
        // The moment is rounded to 2^-53 · 2^22 s, and the shutter is 2^-13 s at least; the measuring adds
        // half.
        {"passSeconds", "exposures of 2^-13 … 1 s up to 2^22 s after the start", "of the exposure", 0x1p-17,
         "in double", &runMoment},
        {"radicalInverse", "indices up to 2^32 in bases 2 … 19", "absolute error", 0x1p-53,
         "one integer quotient, rounded once", &runRadicalInverse},
    };
}

}  // namespace quincunx
