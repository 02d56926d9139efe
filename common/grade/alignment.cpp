#include "grade/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include <fmt/format.h>

#include "base/check.h"

namespace quincunx::grade {
namespace {

constexpr std::array<std::string_view, handlingCount> handlingNames = {
    "blank", "bordered", "cropped", "shifted", "scaled", "mirrored", "swapped-channels", "gamma"};

/// Sides of pictures that are searched whole.
constexpr int thumbnailSide = 96;
/// Rows or columns that a crop may take, and pixels that a shift may be.
constexpr int mostCropped = 8;
constexpr int mostShifted = 6;

/// Samples of a search at full size: every `step`th pixel of rows and columns, some 30 000 of them.
int sampleStep(int width, int height) {
    constexpr double samples = 30000;
    return std::max(1, static_cast<int>(std::sqrt(static_cast<double>(width) * height / samples)));
}

int lumaOf(const std::uint8_t* p) {
    return (77 * p[0] + 150 * p[1] + 29 * p[2]) >> 8;
}

/// Mean squared difference of codes over where the pictures overlap when the second's pixel (x, y) lies on
/// the first's (x + dx, y + dy).
double differenceAt(const Image8& a, const Image8& b, int dx, int dy, int step) {
    const int x0 = std::max(0, dx);
    const int y0 = std::max(0, dy);
    const int x1 = std::min(a.width, b.width + dx);
    const int y1 = std::min(a.height, b.height + dy);
    std::uint64_t sum = 0;
    std::uint64_t count = 0;
    for (int y = y0; y < y1; y += step)
        for (int x = x0; x < x1; x += step) {
            const std::uint8_t* const p = a.pixel(x, y);
            const std::uint8_t* const q = b.pixel(x - dx, y - dy);
            for (int c = 0; c < 3; ++c) {
                const int d = p[c] - q[c];
                sum += static_cast<std::uint64_t>(d * d);
            }
            count += 3;
        }
    return count == 0 ? 255.0 * 255.0 : static_cast<double>(sum) / static_cast<double>(count);
}

struct Offset {
    int dx = 0;
    int dy = 0;
    double difference = 255.0 * 255.0;
};

/// The offset within a rectangle of them where the pictures agree best; the one nearest to none of the same.
Offset bestOffset(const Image8& a, const Image8& b, int lowX, int highX, int lowY, int highY, int step) {
    Offset best;
    bool first = true;
    for (int dy = lowY; dy <= highY; ++dy)
        for (int dx = lowX; dx <= highX; ++dx) {
            const double difference = differenceAt(a, b, dx, dy, step);
            const bool nearer = std::abs(dx) + std::abs(dy) < std::abs(best.dx) + std::abs(best.dy);
            if (first || difference < best.difference || (difference == best.difference && nearer))
                best = {dx, dy, difference};
            first = false;
        }
    return best;
}

Image8 thumbnailOf(const Image8& image, int factor) {
    return resized(image, std::max(1, image.width / factor), std::max(1, image.height / factor));
}

/// Where the reference lies inside a larger picture, at its own scale: by thumbnails first.
Offset placeInside(const Image8& larger, const Image8& reference) {
    const int factor = std::max(1, std::max(larger.width, larger.height) / thumbnailSide);
    const Image8 smallLarger = thumbnailOf(larger, factor);
    const Image8 smallReference = thumbnailOf(reference, factor);
    const Offset coarse =
        bestOffset(smallLarger, smallReference, 0, std::max(0, smallLarger.width - smallReference.width), 0,
                   std::max(0, smallLarger.height - smallReference.height), 1);
    const auto around = [factor](int middle, int most) {
        return std::pair(std::clamp(factor * (middle - 1), 0, most),
                         std::clamp(factor * (middle + 1), 0, most));
    };
    const auto [lowX, highX] = around(coarse.dx, larger.width - reference.width);
    const auto [lowY, highY] = around(coarse.dy, larger.height - reference.height);
    const int step = sampleStep(reference.width, reference.height);
    return bestOffset(larger, reference, lowX, highX, lowY, highY, step);
}

Image8 mirrored(const Image8& image, bool sideways, bool upsideDown) {
    Image8 result = image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            std::copy_n(
                image.pixel(sideways ? image.width - 1 - x : x, upsideDown ? image.height - 1 - y : y), 3,
                result.pixel(x, y));
    return result;
}

using Order = std::array<int, 3>;

Image8 reordered(const Image8& image, const Order& order) {
    Image8 result = image;
    for (std::size_t i = 0; i < image.data.size(); i += 3)
        for (std::size_t c = 0; c < 3; ++c)
            result.data[i + c] = image.data[i + static_cast<std::size_t>(order[c])];
    return result;
}

/// Standard deviation of the luma, in codes.
double contrastOf(const Image8& image) {
    double sum = 0;
    double squares = 0;
    for (std::size_t i = 0; i < image.data.size(); i += 3) {
        const double luma = lumaOf(image.data.data() + i);
        sum += luma;
        squares += luma * luma;
    }
    const auto count = static_cast<double>(image.pixelCount());
    return std::sqrt(std::max(0.0, squares / count - sum / count * (sum / count)));
}

std::array<std::uint8_t, 256> powerCurve(double exponent) {
    std::array<std::uint8_t, 256> curve{};
    for (std::size_t code = 0; code < 256; ++code)
        curve[code] =
            static_cast<std::uint8_t>(std::lround(255 * std::pow(static_cast<double>(code) / 255, exponent)));
    return curve;
}

/// How the submitted codes lie above each code of the reference.
struct CodeStatistics {
    std::array<double, 256> count{};
    std::array<double, 256> sum{};
    std::array<double, 256> squares{};

    /// Σ (submitted − curve(reference))² if the submitted picture were the reference through x^exponent.
    double residual(double exponent) const {
        double total = 0;
        for (std::size_t code = 0; code < 256; ++code) {
            const double expected = 255 * std::pow(static_cast<double>(code) / 255, exponent);
            total += squares[code] - 2 * expected * sum[code] + expected * expected * count[code];
        }
        return total;
    }
};

CodeStatistics statisticsOf(const Image8& reference, const Image8& submitted) {
    CodeStatistics statistics;
    const auto step = static_cast<std::size_t>(sampleStep(reference.width, reference.height));
    for (std::size_t i = 0; i < reference.data.size(); i += 3 * step)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t code = reference.data[i + c];
            const double value = submitted.data[i + c];
            statistics.count[code] += 1;
            statistics.sum[code] += value;
            statistics.squares[code] += value * value;
        }
    return statistics;
}

/// The exponent that fits best, between 1/4 and 4, to a hundredth.
double fittedExponent(const CodeStatistics& statistics) {
    double best = 1;
    double least = statistics.residual(1);
    for (int i = -140; i <= 140; ++i) {
        const double exponent = std::exp(i * 0.01);
        if (const double residual = statistics.residual(exponent); residual < least) {
            least = residual;
            best = exponent;
        }
    }
    return best;
}

std::string pixels(int count, const char* what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

class Aligner {
  public:
    Aligner(const Image8& reference, const Image8& submitted)
        : reference_(rgbOf(reference)), submitted_(rgbOf(submitted)) {}

    Alignment run() {
        if (isBlank()) {
            note(Handling::blank, "blank: all of the picture is nearly one colour");
            submitted_ = resized(submitted_, reference_.width, reference_.height);
        } else {
            matchSizes();
            if (meanSquare() > alike) {
                undoMirroring();
                undoChannels();
                undoShift();
                undoGamma();
            }
        }
        result_.reference = std::move(reference_);
        result_.submitted = std::move(submitted_);
        return std::move(result_);
    }

  private:
    /// Differences that need no explanation: two codes, as another driver's rounding makes.
    static constexpr double alike = 4;

    void note(Handling handling, std::string text) {
        result_.findings.push_back({handling, std::move(text)});
    }

    double meanSquare() const {
        return differenceAt(reference_, submitted_, 0, 0, sampleStep(reference_.width, reference_.height));
    }

    bool isBlank() const {
        // Noise of one code, and JPEG's, has less; any drawing far more.
        constexpr double contrastOfNothing = 1.5;
        return contrastOf(submitted_) < contrastOfNothing && contrastOf(reference_) > 3 * contrastOfNothing;
    }

    void matchSizes() {
        const int wider = submitted_.width - reference_.width;
        const int taller = submitted_.height - reference_.height;
        if (wider == 0 && taller == 0)
            return;
        const std::string sizes = fmt::format("{}×{} instead of {}×{} pixels", submitted_.width,
                                              submitted_.height, reference_.width, reference_.height);
        const Image8 scaled = resized(submitted_, reference_.width, reference_.height);
        const int step = sampleStep(reference_.width, reference_.height);
        const double scaledDifference = differenceAt(reference_, scaled, 0, 0, step);
        if (wider >= 0 && taller >= 0) {
            const Offset place = placeInside(submitted_, reference_);
            if (place.difference < 0.5 * scaledDifference) {
                note(Handling::bordered,
                     fmt::format("bordered: {}; the picture begins {} from the left and {} from the top",
                                 sizes, pixels(place.dx, "pixel"), pixels(place.dy, "pixel")));
                submitted_ = cropped(submitted_, place.dx, place.dy, reference_.width, reference_.height);
                return;
            }
        }
        if (std::abs(wider) <= mostCropped && std::abs(taller) <= mostCropped) {
            const Offset place = bestOffset(reference_, submitted_, std::min(0, -wider), std::max(0, -wider),
                                            std::min(0, -taller), std::max(0, -taller), step);
            if (place.difference <= scaledDifference) {
                note(Handling::cropped, fmt::format("cropped: {}", sizes));
                overlap(place.dx, place.dy);
                return;
            }
        }
        note(Handling::scaled, fmt::format("scaled: {}", sizes));
        submitted_ = scaled;
    }

    /// Keeps what both have when the submitted pixel (0, 0) lies on the reference's (dx, dy).
    void overlap(int dx, int dy) {
        const int x0 = std::max(0, dx);
        const int y0 = std::max(0, dy);
        const int width = std::min(reference_.width, submitted_.width + dx) - x0;
        const int height = std::min(reference_.height, submitted_.height + dy) - y0;
        reference_ = cropped(reference_, x0, y0, width, height);
        submitted_ = cropped(submitted_, x0 - dx, y0 - dy, width, height);
        result_.left += x0;
        result_.top += y0;
    }

    /// A change is believed if it takes most of the difference away. What is left is no more than the mean
    /// squared difference of pictures with defects in a part of them; a wrong explanation leaves about as
    /// much as there was.
    static bool explains(double before, double after) { return after < 0.4 * before; }

    void undoMirroring() {
        const int factor = std::max(1, std::max(reference_.width, reference_.height) / thumbnailSide);
        const Image8 small = thumbnailOf(reference_, factor);
        const double before = differenceAt(small, thumbnailOf(submitted_, factor), 0, 0, 1);
        double least = before;
        int chosen = 0;
        for (int way = 1; way < 4; ++way)
            if (const double after = differenceAt(
                    small, thumbnailOf(mirrored(submitted_, way % 2 == 1, way / 2 == 1), factor), 0, 0, 1);
                after < least) {
                least = after;
                chosen = way;
            }
        if (chosen == 0 || !explains(before, least))
            return;
        constexpr std::array<const char*, 4> ways = {"", "left is right", "top is bottom",
                                                     "turned by 180 degrees"};
        note(Handling::mirrored, fmt::format("mirrored: {}", ways[static_cast<std::size_t>(chosen)]));
        submitted_ = mirrored(submitted_, chosen % 2 == 1, chosen / 2 == 1);
    }

    void undoChannels() {
        const int step = sampleStep(reference_.width, reference_.height);
        const double before = meanSquare();
        double least = before;
        Order chosen = {0, 1, 2};
        Order order = {0, 1, 2};
        while (std::next_permutation(order.begin(), order.end()))
            if (const double after = differenceAt(reference_, reordered(submitted_, order), 0, 0, step);
                after < least) {
                least = after;
                chosen = order;
            }
        if (!explains(before, least))
            return;
        const auto letter = [&](std::size_t c) { return "RGB"[chosen[c]]; };
        note(Handling::swappedChannels,
             fmt::format("swapped-channels: red, green and blue are right when read as {}{}{}", letter(0),
                         letter(1), letter(2)));
        submitted_ = reordered(submitted_, chosen);
    }

    void undoShift() {
        if (reference_.width <= 4 * mostShifted || reference_.height <= 4 * mostShifted)
            return;
        const int step = sampleStep(reference_.width, reference_.height);
        const double before = differenceAt(reference_, submitted_, 0, 0, step);
        const Offset place =
            bestOffset(reference_, submitted_, -mostShifted, mostShifted, -mostShifted, mostShifted, step);
        if (!explains(before, place.difference))
            return;
        note(Handling::shifted, fmt::format("shifted: by {} across and {} down", pixels(-place.dx, "pixel"),
                                            pixels(-place.dy, "pixel")));
        overlap(place.dx, place.dy);
    }

    void undoGamma() {
        const CodeStatistics statistics = statisticsOf(reference_, submitted_);
        const double exponent = fittedExponent(statistics);
        constexpr double leastChange =
            0.05;  // of the exponent's logarithm: 2 codes in the middle of the range
        if (std::abs(std::log(exponent)) < leastChange ||
            !explains(statistics.residual(1), statistics.residual(exponent)))
            return;
        note(Handling::gamma,
             fmt::format("gamma: the codes are the reference's to the power of {:.2f}{}", exponent,
                         std::abs(exponent - 1 / 2.2) < 0.06 ? ", encoded once more than they should be"
                         : std::abs(exponent - 2.2) < 0.3    ? ", linear light that was never encoded"
                                                             : ""));
        const std::array<std::uint8_t, 256> inverse = powerCurve(1 / exponent);
        for (std::uint8_t& code : submitted_.data)
            code = inverse[code];
    }

    Image8 reference_;
    Image8 submitted_;
    Alignment result_;
};

}  // namespace

std::string_view handlingName(Handling handling) {
    return handlingNames[static_cast<std::size_t>(handling)];
}

std::optional<Handling> parseHandling(std::string_view name) {
    const auto found = std::find(handlingNames.begin(), handlingNames.end(), name);
    if (found == handlingNames.end())
        return {};
    return static_cast<Handling>(found - handlingNames.begin());
}

bool Alignment::has(Handling handling) const {
    return std::any_of(findings.begin(), findings.end(),
                       [&](const Finding& finding) { return finding.handling == handling; });
}

Alignment align(const Image8& reference, const Image8& submitted) {
    return Aligner(reference, submitted).run();
}

Image8 rgbOf(const Image8& image) {
    Image8 result(image.width, image.height, 3, image.encoding);
    const std::size_t channels = static_cast<std::size_t>(image.channels);
    for (std::size_t i = 0; i < image.pixelCount(); ++i)
        for (std::size_t c = 0; c < 3; ++c)
            result.data[3 * i + c] = image.data[channels * i + (channels >= 3 ? c : 0)];
    return result;
}

Image8 cropped(const Image8& image, int left, int top, int width, int height) {
    QX_CHECK(left >= 0 && top >= 0 && width >= 1 && height >= 1);
    QX_CHECK(left + width <= image.width && top + height <= image.height);
    Image8 result(width, height, image.channels, image.encoding);
    for (int y = 0; y < height; ++y)
        std::copy_n(image.pixel(left, top + y), width * image.channels, result.pixel(0, y));
    return result;
}

Image8 resized(const Image8& image, int width, int height) {
    if (image.width == width && image.height == height)
        return image;
    /// For each target pixel: the first source pixel, and the weights of it and those after it.
    struct Taps {
        int first = 0;
        std::vector<float> weights;
    };
    const auto tapsOf = [](int from, int to) {
        std::vector<Taps> taps(static_cast<std::size_t>(to));
        const double scale = static_cast<double>(from) / to;
        const double radius = std::max(1.0, scale);  // of a tent, which is a mean where the picture shrinks
        for (int i = 0; i < to; ++i) {
            Taps& tap = taps[static_cast<std::size_t>(i)];
            const double centre = (i + 0.5) * scale - 0.5;
            tap.first = std::max(0, static_cast<int>(std::ceil(centre - radius)));
            const int last = std::min(from - 1, static_cast<int>(std::floor(centre + radius)));
            double sum = 0;
            for (int k = tap.first; k <= last; ++k) {
                const double weight = std::max(0.0, 1 - std::abs(k - centre) / radius);
                tap.weights.push_back(static_cast<float>(weight));
                sum += weight;
            }
            for (float& weight : tap.weights)
                weight = static_cast<float>(static_cast<double>(weight) / sum);
        }
        return taps;
    };
    const std::vector<Taps> across = tapsOf(image.width, width);
    const std::vector<Taps> down = tapsOf(image.height, height);
    const int channels = image.channels;
    std::vector<float> rows(static_cast<std::size_t>(width) * static_cast<std::size_t>(image.height) *
                            static_cast<std::size_t>(channels));
    float* out = rows.data();
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c) {
                const Taps& tap = across[static_cast<std::size_t>(x)];
                const std::uint8_t* from = image.pixel(tap.first, y) + c;
                float sum = 0;
                for (const float weight : tap.weights) {
                    sum += weight * static_cast<float>(*from);
                    from += channels;
                }
                *out++ = sum;
            }
    Image8 result(width, height, channels, image.encoding);
    const std::size_t rowSize = static_cast<std::size_t>(width) * static_cast<std::size_t>(channels);
    std::vector<float> sums(rowSize);
    for (int y = 0; y < height; ++y) {
        const Taps& tap = down[static_cast<std::size_t>(y)];
        std::fill(sums.begin(), sums.end(), 0.0F);
        for (std::size_t k = 0; k < tap.weights.size(); ++k) {
            const float* const row = rows.data() + (static_cast<std::size_t>(tap.first) + k) * rowSize;
            for (std::size_t i = 0; i < rowSize; ++i)
                sums[i] += tap.weights[k] * row[i];
        }
        for (std::size_t i = 0; i < rowSize; ++i)
            result.data[static_cast<std::size_t>(y) * rowSize + i] =
                static_cast<std::uint8_t>(std::clamp(sums[i] + 0.5F, 0.0F, 255.0F));
    }
    return result;
}

}  // namespace quincunx::grade
