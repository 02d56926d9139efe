#include "image/compare.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <tbb/parallel_for.h>

#include "image/color.h"
#include "image/same_shape.h"

namespace quincunx {
namespace {

struct MetricEntry {
    Metric metric;
    std::string_view name;
    bool higherIsBetter;
};

constexpr std::array<MetricEntry, 4> metricTable = {{{Metric::rmse, "rmse", false},
                                                     {Metric::psnr, "psnr", true},
                                                     {Metric::ssim, "ssim", true},
                                                     {Metric::flip, "flip", false}}};

const MetricEntry& entry(Metric metric) {
    return *std::find_if(metricTable.begin(), metricTable.end(),
                         [&](const MetricEntry& candidate) { return candidate.metric == metric; });
}

/// Which channels of a pixel are compared: those that either picture has.
struct Channels {
    int colours = 0;
    bool alpha = false;

    template <typename Channel>
    Channels(const BasicImage<Channel>& a, const BasicImage<Channel>& b)
        : colours(std::max(a.channels, b.channels) >= 3 ? 3 : 1),
          alpha(a.channels % 2 == 0 || b.channels % 2 == 0) {}

    int count() const { return colours + (alpha ? 1 : 0); }
};

template <typename Channel>
Channel opaque() {
    return std::is_integral_v<Channel> ? std::numeric_limits<Channel>::max() : Channel{1};
}

/// Channel `c` of those that `Channels` counts.
template <typename Channel>
Channel channelOf(const Channel* pixel, int channels, int c, const Channels& compared) {
    if (c == compared.colours)
        return channels % 2 == 0 ? pixel[channels - 1] : opaque<Channel>();
    return pixel[channels >= 3 ? c : 0];
}

/// Σ of squared differences over a pixel's channels: an integer for codes.
template <typename Sum, typename Channel>
Sum squaredDifference(const BasicImage<Channel>& reference, const BasicImage<Channel>& test, int x, int y,
                      const Channels& compared) {
    Sum sum = 0;
    const Channel* const a = reference.pixel(x, y);
    const Channel* const b = test.pixel(x, y);
    for (int c = 0; c < compared.count(); ++c) {
        const Sum difference = static_cast<Sum>(channelOf(a, reference.channels, c, compared)) -
                               static_cast<Sum>(channelOf(b, test.channels, c, compared));
        sum += difference * difference;
    }
    return sum;
}

/// Mean of squared differences, in units of 1.
double meanSquare(const Image8& reference, const Image8& test) {
    requireSameShape(reference, test);
    const Channels compared(reference, test);
    std::int64_t sum = 0;
    for (int y = 0; y < reference.height; ++y)
        for (int x = 0; x < reference.width; ++x)
            sum += squaredDifference<std::int64_t>(reference, test, x, y, compared);
    return static_cast<double>(sum) /
           (255.0 * 255.0 * compared.count() * static_cast<double>(reference.pixelCount()));
}

Image rmseMap(const Image8& reference, const Image8& test) {
    const Channels compared(reference, test);
    Image map(reference.width, reference.height, 1, Encoding::linear);
    for (int y = 0; y < map.height; ++y)
        for (int x = 0; x < map.width; ++x)
            *map.pixel(x, y) = static_cast<float>(std::sqrt(
                squaredDifference<double>(reference, test, x, y, compared) / compared.count() / (255 * 255)));
    return map;
}

constexpr int ssimRadius = 5;

std::array<double, 2 * ssimRadius + 1> ssimWindow() {
    std::array<double, 2 * ssimRadius + 1> weights{};
    double sum = 0;
    for (int i = 0; i < 2 * ssimRadius + 1; ++i) {
        const double x = (i - ssimRadius) / 1.5;
        sum += weights[i] = std::exp(-x * x / 2);
    }
    for (double& weight : weights)
        weight /= sum;
    return weights;
}

double lumaOf(const std::uint8_t* pixel, int channels) {
    if (channels < 3)
        return pixel[0];
    return lumaWeights[0] * pixel[0] + lumaWeights[1] * pixel[1] + lumaWeights[2] * pixel[2];
}

/// SSIM at each pixel; windows at the borders see the border pixels continued.
std::vector<double> ssimMap(const Image8& reference, const Image8& test) {
    requireSameShape(reference, test);
    if (reference.width < 2 * ssimRadius + 1 || reference.height < 2 * ssimRadius + 1)
        throw InputError(fmt::format("{} × {} pixels: SSIM needs 11 × 11", reference.width, reference.height),
                         {}, "use another metric");
    const std::array<double, 2 * ssimRadius + 1> window = ssimWindow();
    const int width = reference.width;
    const int height = reference.height;
    std::vector<double> map(reference.pixelCount());
    constexpr int bandHeight = 32;
    tbb::parallel_for(0, (height + bandHeight - 1) / bandHeight, [&](int band) {
        // Moments of the two lumas a and b, filtered along x: a, b, a², b², ab.
        constexpr int moments = 5;
        const int y0 = band * bandHeight;
        const int y1 = std::min(y0 + bandHeight, height);
        const int rowCount = y1 - y0 + 2 * ssimRadius;
        const auto rowSize = static_cast<std::size_t>(width) * moments;
        std::vector<double> filtered(static_cast<std::size_t>(rowCount) * rowSize);
        std::vector<double> row(static_cast<std::size_t>(width + 2 * ssimRadius) * moments);
        for (int i = 0; i < rowCount; ++i) {
            const int y = std::clamp(y0 - ssimRadius + i, 0, height - 1);
            for (int j = 0; j < width + 2 * ssimRadius; ++j) {
                const int x = std::clamp(j - ssimRadius, 0, width - 1);
                const double a = lumaOf(reference.pixel(x, y), reference.channels);
                const double b = lumaOf(test.pixel(x, y), test.channels);
                double* const at = row.data() + static_cast<std::size_t>(j) * moments;
                at[0] = a;
                at[1] = b;
                at[2] = a * a;
                at[3] = b * b;
                at[4] = a * b;
            }
            double* const out = filtered.data() + static_cast<std::size_t>(i) * rowSize;
            for (std::size_t x = 0; x < rowSize; ++x) {
                double sum = 0;
                for (std::size_t k = 0; k < window.size(); ++k)
                    sum += window[k] * row[x + k * moments];
                out[x] = sum;
            }
        }
        for (int y = y0; y < y1; ++y) {
            for (int x = 0; x < width; ++x) {
                double m[moments] = {};
                for (int k = 0; k < 2 * ssimRadius + 1; ++k) {
                    const double* const at = filtered.data() +
                                             static_cast<std::size_t>(y - y0 + k) * rowSize +
                                             static_cast<std::size_t>(x) * moments;
                    for (int i = 0; i < moments; ++i)
                        m[i] += window[k] * at[i];
                }
                constexpr double c1 = 0.01 * 255 * 0.01 * 255;
                constexpr double c2 = 0.03 * 255 * 0.03 * 255;
                const double varianceA = m[2] - m[0] * m[0];
                const double varianceB = m[3] - m[1] * m[1];
                const double covariance = m[4] - m[0] * m[1];
                map[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                    static_cast<std::size_t>(x)] =
                    (2 * m[0] * m[1] + c1) * (2 * covariance + c2) /
                    ((m[0] * m[0] + m[1] * m[1] + c1) * (varianceA + varianceB + c2));
            }
        }
    });
    return map;
}

double meanOfWholeWindows(const std::vector<double>& map, int width, int height) {
    double sum = 0;
    for (int y = ssimRadius; y < height - ssimRadius; ++y)
        for (int x = ssimRadius; x < width - ssimRadius; ++x)
            sum += map[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(x)];
    return sum / (static_cast<double>(width - 2 * ssimRadius) * (height - 2 * ssimRadius));
}

double decibels(double meanSquare) {
    return meanSquare > 0 ? -10 * std::log10(meanSquare) : std::numeric_limits<double>::infinity();
}

double meanOf(const Image& map) {
    double sum = 0;
    for (const float value : map.data)
        sum += static_cast<double>(value);
    return sum / static_cast<double>(map.data.size());
}

/// sRGB code of a colour in CIELAB under D65, moved into the cube by clamping.
std::array<std::uint8_t, 3> codeOfLab(double lightness, double a, double b) {
    const auto inverseCurve = [](double f) { return f > 6.0 / 29 ? f * f * f : (116 * f - 16) * 27 / 24389; };
    const double fy = (lightness + 16) / 116;
    const double x = 0.95047 * inverseCurve(fy + a / 500);
    const double y = inverseCurve(fy);
    const double z = 1.08883 * inverseCurve(fy - b / 200);
    // IEC 61966-2-1, the inverse matrix.
    const double linear[3] = {3.2406 * x - 1.5372 * y - 0.4986 * z, -0.9689 * x + 1.8758 * y + 0.0415 * z,
                              0.0557 * x - 0.2040 * y + 1.0570 * z};
    std::array<std::uint8_t, 3> code{};
    for (std::size_t i = 0; i < 3; ++i)
        code[i] = srgbCode(static_cast<float>(linear[i]));
    return code;
}

/// Lightness from 0 to 97 in even steps; hue from violet (310°) through red to yellow (105°); the chroma is
/// what the sRGB cube holds at both ends and most between.
std::array<std::array<std::uint8_t, 3>, 256> errorColours() {
    std::array<std::array<std::uint8_t, 3>, 256> colours{};
    for (int i = 0; i < 256; ++i) {
        const double t = i / 255.0;
        const double hue = (310 + 155 * t) * 3.14159265358979323846 / 180;
        const double chroma = 230 * t * (1 - t) * (1 - 0.25 * t) + 40 * t * t * t;
        colours[static_cast<std::size_t>(i)] =
            codeOfLab(97 * t, chroma * std::cos(hue), chroma * std::sin(hue));
    }
    return colours;
}

}  // namespace

std::string_view metricName(Metric metric) {
    return entry(metric).name;
}

std::optional<Metric> parseMetric(std::string_view name) {
    for (const MetricEntry& candidate : metricTable)
        if (candidate.name == name)
            return candidate.metric;
    return {};
}

bool higherIsBetter(Metric metric) {
    return entry(metric).higherIsBetter;
}

double rmse(const Image8& reference, const Image8& test) {
    return std::sqrt(meanSquare(reference, test));
}

double rmse(const Image& reference, const Image& test) {
    requireSameShape(reference, test);
    const auto isFinite = [](float value) { return std::isfinite(value); };
    for (const Image* image : {&reference, &test})
        if (!std::all_of(image->data.begin(), image->data.end(), isFinite))
            return std::numeric_limits<double>::infinity();
    const Channels compared(reference, test);
    double sum = 0;
    for (int y = 0; y < reference.height; ++y) {
        double row = 0;
        for (int x = 0; x < reference.width; ++x)
            row += squaredDifference<double>(reference, test, x, y, compared);
        sum += row;
    }
    return std::sqrt(sum / compared.count() / static_cast<double>(reference.pixelCount()));
}

Image differenceMap(const Image& reference, const Image& test) {
    requireSameShape(reference, test);
    const Channels compared(reference, test);
    Image map(reference.width, reference.height, 1, Encoding::linear);
    for (int y = 0; y < reference.height; ++y)
        for (int x = 0; x < reference.width; ++x) {
            const double mean = squaredDifference<double>(reference, test, x, y, compared) /
                                static_cast<double>(compared.count());
            *map.pixel(x, y) = std::isfinite(mean) ? static_cast<float>(std::sqrt(mean))
                                                   : std::numeric_limits<float>::infinity();
        }
    return map;
}

double psnr(const Image8& reference, const Image8& test) {
    return decibels(meanSquare(reference, test));
}

double ssim(const Image8& reference, const Image8& test) {
    return meanOfWholeWindows(ssimMap(reference, test), reference.width, reference.height);
}

Comparison compareImages(const Image8& reference, const Image8& test, Metric metric) {
    Comparison result;
    switch (metric) {
        case Metric::rmse:
            result.value = rmse(reference, test);
            result.perPixel = rmseMap(reference, test);
            break;
        case Metric::psnr:
            result.value = psnr(reference, test);
            result.perPixel = rmseMap(reference, test);
            break;
        case Metric::ssim: {
            const std::vector<double> map = ssimMap(reference, test);
            result.value = meanOfWholeWindows(map, reference.width, reference.height);
            result.perPixel = Image(reference.width, reference.height, 1, Encoding::linear);
            std::transform(map.begin(), map.end(), result.perPixel.data.begin(), [](double value) {
                return std::clamp(static_cast<float>((1 - value) / 2), 0.0F, 1.0F);
            });
            break;
        }
        case Metric::flip:
            result.perPixel = flipMap(reference, test);
            result.value = meanOf(result.perPixel);
            break;
    }
    return result;
}

Image8 errorMap(const Image& perPixel, float maximum) {
    QX_CHECK_EQ(perPixel.channels, 1);
    QX_CHECK_GT(maximum, 0.0F);
    static const std::array<std::array<std::uint8_t, 3>, 256> colours = errorColours();
    constexpr std::array<std::uint8_t, 3> notANumber = {0, 255, 255};
    Image8 image(perPixel.width, perPixel.height, 3, Encoding::srgb);
    for (std::size_t i = 0; i < perPixel.data.size(); ++i) {
        const float value = perPixel.data[i] / maximum;
        const std::array<std::uint8_t, 3>& colour =
            std::isnan(value)
                ? notANumber
                : colours[static_cast<std::size_t>(std::lround(255 * std::clamp(value, 0.0F, 1.0F)))];
        std::copy(colour.begin(), colour.end(), image.data.begin() + static_cast<std::ptrdiff_t>(3 * i));
    }
    return image;
}

}  // namespace quincunx
