#include "image/mipmaps.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "base/check.h"
#include "base/vector_units.h"
#include "image/color.h"

namespace quincunx {
namespace {

/// Which texels of a longer line make up each texel of the half as long one.
struct LineFilter {
    int taps = 0;
    int before = 0;              ///< texels that are read before the line's first
    int after = 0;               ///< … and after its last
    std::vector<int> first;      ///< by texel of the short line, ≥ −before
    std::vector<float> weights;  ///< taps for each texel of the short line; they sum to 1
};

double sinc(double x) {
    const double a = std::numbers::pi * x;
    return std::abs(a) < 1e-8 ? 1 : std::sin(a) / a;  // 1 − a²/6 rounds to 1 there
}

double kernel(MipFilter filter, double x) {
    constexpr double lobes = 3;
    const double t = std::abs(x) / lobes;
    if (t >= 1)
        return 0;
    if (filter == MipFilter::lanczos)
        return sinc(x) * sinc(t);
    constexpr double alpha = 4;
    return sinc(x) * std::cyl_bessel_i(0.0, alpha * std::sqrt(1 - t * t)) / std::cyl_bessel_i(0.0, alpha);
}

LineFilter boxFilter(int side) {
    const int half = mipSide(side, 1);
    LineFilter line;
    line.taps = side == 1 ? 1 : side % 2 == 0 ? 2 : 3;
    for (int i = 0; i < half; ++i) {
        line.first.push_back(2 * i);
        if (line.taps == 1)
            line.weights.push_back(1);
        else if (line.taps == 2)
            line.weights.insert(line.weights.end(), {0.5f, 0.5f});
        else
            for (const int share : {half - i, half, i + 1})
                line.weights.push_back(static_cast<float>(static_cast<double>(share) / side));
    }
    return line;
}

LineFilter lineFilter(MipFilter filter, int side) {
    if (filter == MipFilter::box || side == 1)
        return boxFilter(side);
    const int half = mipSide(side, 1);
    const double step = static_cast<double>(side) / half;
    const double reach = 3 * step;
    LineFilter line;
    line.taps = static_cast<int>(std::ceil(2 * reach));
    std::vector<double> exact(static_cast<std::size_t>(line.taps));
    for (int i = 0; i < half; ++i) {
        const double centre = (i + 0.5) * step;
        const int first = static_cast<int>(std::ceil(centre - reach - 0.5));
        double sum = 0;
        for (int k = 0; k < line.taps; ++k)
            sum += exact[static_cast<std::size_t>(k)] = kernel(filter, (first + k + 0.5 - centre) / step);
        line.first.push_back(first);
        for (const double weight : exact)
            line.weights.push_back(static_cast<float>(weight / sum));
        line.before = std::max(line.before, -first);
        line.after = std::max(line.after, first + line.taps - side);
    }
    return line;
}

/// Where a place outside of a line is found on it.
int onLine(int i, int side, bool repeats) {
    return repeats ? ((i % side) + side) % side : std::clamp(i, 0, side - 1);
}

/// A level as floats, decoded if light is averaged.
struct Level {
    int width = 0;
    int height = 0;
    std::vector<float> texels;
};

using DecodeTables = std::array<std::array<float, 256>, 4>;  ///< by channel

DecodeTables decodeTables(const Image8& base, bool linearLight) {
    DecodeTables tables;
    for (int channel = 0; channel < base.channels; ++channel) {
        const bool alpha = base.channels % 2 == 0 && channel == base.channels - 1;
        auto& table = tables[static_cast<std::size_t>(channel)];
        for (std::size_t code = 0; code < 256; ++code)
            table[code] = base.encoding == Encoding::srgb && linearLight && !alpha
                              ? linearOfCode()[code]
                              : static_cast<float>(code) / 255;
    }
    return tables;
}

template <int channels>
void decodeRow(const std::uint8_t* from, int width, const DecodeTables& tables, float* to) {
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(width) * channels; i += channels)
        for (int c = 0; c < channels; ++c)
            to[i + c] = tables[static_cast<std::size_t>(c)][from[i + c]];
}

/// to[i] = Σ weights[k] rows[k][i]
QUINCUNX_FOR_EACH_VECTOR_UNIT
void combineRows(const float* const* rows, const float* weights, int taps, int count, float* to) {
    if (taps == 2) {
        const float* const a = rows[0];
        const float* const b = rows[1];
        for (int i = 0; i < count; ++i)
            to[i] = weights[0] * a[i] + weights[1] * b[i];
        return;
    }
    for (int i = 0; i < count; ++i)
        to[i] = weights[0] * rows[0][i];
    for (int k = 1; k < taps; ++k) {
        const float weight = weights[k];
        const float* const row = rows[k];
        for (int i = 0; i < count; ++i)
            to[i] += weight * row[i];
    }
}

/// `row` has line.before and line.after texels around it.
template <int channels>
void combineTexels(const float* row, const LineFilter& line, float* to) {
    const auto half = static_cast<int>(line.first.size());
    const float* weight = line.weights.data();
    for (int i = 0; i < half; ++i, weight += line.taps) {
        const float* from =
            row + static_cast<std::ptrdiff_t>(line.first[static_cast<std::size_t>(i)]) * channels;
        if constexpr (channels == 4) {
            using Texel = float __attribute__((vector_size(16), aligned(4), may_alias));
            Texel sum = weight[0] * *reinterpret_cast<const Texel*>(from);
            for (int k = 1; k < line.taps; ++k)
                sum += weight[k] * *reinterpret_cast<const Texel*>(from + 4 * k);
            *reinterpret_cast<Texel*>(to + 4 * i) = sum;
        } else {
            for (int c = 0; c < channels; ++c) {
                float sum = weight[0] * from[c];
                for (int k = 1; k < line.taps; ++k)
                    sum += weight[k] * from[k * channels + c];
                to[i * channels + c] = sum;
            }
        }
    }
}

/// The next level of `source`, whose rows `rowOf(y, buffer)` gives, in `buffer` or elsewhere. `finishRow`
/// gets each row as soon as it is made.
template <int channels, typename RowOf, typename FinishRow>
Level halve(int width, int height, const MipmapParams& params, const RowOf& rowOf,
            const FinishRow& finishRow) {
    const LineFilter across = lineFilter(params.filter, width);
    const LineFilter down = lineFilter(params.filter, height);
    Level level{mipSide(width, 1), mipSide(height, 1), {}};
    const auto outRow = static_cast<std::size_t>(level.width) * channels;
    level.texels.resize(outRow * static_cast<std::size_t>(level.height));
    const auto inRow = static_cast<std::size_t>(width) * channels;
    constexpr int unheld = std::numeric_limits<int>::min();
    // Bands of rows: the rows that two bands share are decoded twice, so bands are not too narrow.
    tbb::parallel_for(tbb::blocked_range<int>(0, level.height, 16), [&](const tbb::blocked_range<int>& band) {
        const auto taps = static_cast<std::size_t>(down.taps);
        std::vector<float> ring(taps * inRow);
        // Place k of the ring holds the row whose number, not yet brought onto the image, leaves the rest k.
        std::vector<int> held(taps, unheld);
        std::vector<const float*> ringRows(taps, nullptr);
        std::vector<const float*> rows(taps, nullptr);
        std::vector<float> line((static_cast<std::size_t>(width + across.before + across.after)) * channels);
        float* const inner = line.data() + static_cast<std::ptrdiff_t>(across.before) * channels;
        for (int y = band.begin(); y < band.end(); ++y) {
            for (int k = 0; k < down.taps; ++k) {
                const int row = down.first[static_cast<std::size_t>(y)] + k;
                const auto place = static_cast<std::size_t>(row + down.before) % taps;
                if (held[place] != row) {
                    ringRows[place] = rowOf(onLine(row, height, params.repeats), ring.data() + place * inRow);
                    held[place] = row;
                }
                rows[static_cast<std::size_t>(k)] = ringRows[place];
            }
            combineRows(rows.data(), &down.weights[static_cast<std::size_t>(y) * taps], down.taps,
                        static_cast<int>(inRow), inner);
            for (int i = -across.before; i < width + across.after; ++i)
                if (i < 0 || i >= width)
                    std::copy_n(
                        inner + static_cast<std::ptrdiff_t>(onLine(i, width, params.repeats)) * channels,
                        channels, inner + static_cast<std::ptrdiff_t>(i) * channels);
            float* const made = &level.texels[static_cast<std::size_t>(y) * outRow];
            combineTexels<channels>(inner, across, made);
            finishRow(y, made);
        }
    });
    return level;
}

std::uint8_t code(float value) {
    const float clamped = value > 0 ? std::min(value, 1.0f) : 0.0f;
    // Not negative, so that cutting off rounds. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return static_cast<std::uint8_t>(255 * static_cast<double>(clamped) + 0.5);
}

template <int channels>
void encodeRow(const float* from, int width, bool curved, float alphaScale, std::uint8_t* to) {
    constexpr bool hasAlpha = channels % 2 == 0;
    for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(width) * channels; i += channels)
        for (int c = 0; c < channels; ++c) {
            const bool alpha = hasAlpha && c == channels - 1;
            to[i + c] = alpha    ? code(alphaScale * from[i + c])
                        : curved ? srgbCode(from[i + c])
                                 : code(from[i + c]);
        }
}

/// What alpha is multiplied with so that `share` of its values reach the cutoff.
template <int channels>
float coverageScale(const Level& level, float cutoff, double share) {
    std::vector<float> alphas;
    for (std::size_t i = channels - 1; i < level.texels.size(); i += channels)
        alphas.push_back(level.texels[i]);
    const auto wanted = static_cast<std::size_t>(std::lround(share * static_cast<double>(alphas.size())));
    if (wanted == 0 || wanted == alphas.size()) {
        // All or none: no more than needed, and opaque stays opaque.
        const auto [least, most] = std::minmax_element(alphas.begin(), alphas.end());
        if (wanted == 0)
            return *most < cutoff ? 1 : std::max(0.0f, cutoff - 1.0f / 255) / *most;
        return *least >= cutoff || *least <= 0 ? 1 : cutoff / *least;
    }
    std::nth_element(alphas.begin(), alphas.begin() + static_cast<std::ptrdiff_t>(wanted) - 1, alphas.end(),
                     std::greater<>());
    const float last = alphas[wanted - 1];
    const float next = *std::max_element(alphas.begin() + static_cast<std::ptrdiff_t>(wanted), alphas.end());
    // The cutoff comes to lie halfway between the last one in and the first one out.
    const float between = 0.5f * (last + next);
    return between > 0 ? cutoff / between : 1;
}

template <int channels>
double coverageOf(const Image8& image, float cutoff) {
    std::size_t count = 0;
    for (std::size_t i = channels - 1; i < image.data.size(); i += channels)
        count += static_cast<float>(image.data[i]) >= 255 * cutoff ? 1 : 0;
    return static_cast<double>(count) / static_cast<double>(image.pixelCount());
}

template <int channels>
std::vector<Image8> makeMipmaps8(const Image8& base, const MipmapParams& params) {
    const DecodeTables tables = decodeTables(base, params.linearLight);
    const bool curved = base.encoding == Encoding::srgb && params.linearLight;
    const bool covers = params.coverageCutoff.has_value() && channels % 2 == 0;
    const double coverage = covers ? coverageOf<channels>(base, *params.coverageCutoff) : 0;
    std::vector<Image8> levels;
    Level above{base.width, base.height, {}};
    while (above.width > 1 || above.height > 1) {
        const bool fromBase = levels.empty();
        Image8& coded =
            levels.emplace_back(mipSide(above.width, 1), mipSide(above.height, 1), channels, base.encoding);
        const auto rowOf = [&](int y, float* buffer) -> const float* {
            if (!fromBase)
                return &above.texels[static_cast<std::size_t>(y) * static_cast<std::size_t>(above.width) *
                                     channels];
            decodeRow<channels>(base.pixel(0, y), base.width, tables, buffer);
            return buffer;
        };
        const auto finishRow = [&](int y, const float* row) {
            if (!covers)
                encodeRow<channels>(row, coded.width, curved, 1, coded.pixel(0, y));
        };
        Level level = halve<channels>(above.width, above.height, params, rowOf, finishRow);
        if (covers) {
            const float scale = coverageScale<channels>(level, *params.coverageCutoff, coverage);
            for (int y = 0; y < coded.height; ++y)
                encodeRow<channels>(&level.texels[static_cast<std::size_t>(y) *
                                                  static_cast<std::size_t>(level.width) * channels],
                                    coded.width, curved, scale, coded.pixel(0, y));
        }
        above = std::move(level);
    }
    return levels;
}

template <int channels>
std::vector<Image> makeMipmapsFloat(const Image& base, const MipmapParams& params) {
    std::vector<Image> levels;
    levels.reserve(32);
    const Image* above = &base;
    while (above->width > 1 || above->height > 1) {
        const auto rowOf = [above](int y, float*) -> const float* { return above->pixel(0, y); };
        Level level = halve<channels>(above->width, above->height, params, rowOf, [](int, const float*) {});
        Image& made = levels.emplace_back();
        made.width = level.width;
        made.height = level.height;
        made.channels = channels;
        made.encoding = base.encoding;
        made.data = std::move(level.texels);
        above = &made;
    }
    return levels;
}

template <typename Channel>
void checkImage(const BasicImage<Channel>& image) {
    QX_CHECK_GE(image.width, 1);
    QX_CHECK_GE(image.height, 1);
    QX_CHECK_GE(image.channels, 1);
    QX_CHECK_LE(image.channels, 4);
    QX_CHECK_EQ(image.data.size(), image.pixelCount() * static_cast<std::size_t>(image.channels));
}

}  // namespace

int mipLevelCount(int width, int height) {
    QX_CHECK_GE(std::min(width, height), 1);
    return std::bit_width(static_cast<unsigned>(std::max(width, height)));
}

int mipLevelCountNaive(int width, int height) {
    return 1 + static_cast<int>(std::log(static_cast<float>(std::max(width, height))) / std::log(2.0f));
}

std::vector<Image8> makeMipmaps(const Image8& base, const MipmapParams& params) {
    checkImage(base);
    switch (base.channels) {
        case 1:
            return makeMipmaps8<1>(base, params);
        case 2:
            return makeMipmaps8<2>(base, params);
        case 3:
            return makeMipmaps8<3>(base, params);
        default:
            return makeMipmaps8<4>(base, params);
    }
}

std::vector<Image> makeMipmaps(const Image& base, const MipmapParams& params) {
    checkImage(base);
    if (base.encoding == Encoding::srgb && params.linearLight) {
        std::vector<Image> levels = makeMipmaps(toLinear(base), params);
        for (Image& level : levels) {
            for (std::size_t i = 0; i < level.data.size(); ++i)
                if (level.channels % 2 != 0 || i % static_cast<std::size_t>(level.channels) !=
                                                   static_cast<std::size_t>(level.channels) - 1)
                    level.data[i] = srgbFromLinear(level.data[i]);
            level.encoding = Encoding::srgb;
        }
        return levels;
    }
    switch (base.channels) {
        case 1:
            return makeMipmapsFloat<1>(base, params);
        case 2:
            return makeMipmapsFloat<2>(base, params);
        case 3:
            return makeMipmapsFloat<3>(base, params);
        default:
            return makeMipmapsFloat<4>(base, params);
    }
}

std::vector<Image8> makeMipmapsNaive(const Image8& base) {
    checkImage(base);
    std::vector<Image8> levels;
    levels.reserve(32);
    const Image8* above = &base;
    while (above->width > 1 || above->height > 1) {
        Image8 level(mipSide(above->width, 1), mipSide(above->height, 1), base.channels, base.encoding);
        for (int y = 0; y < level.height; ++y)
            for (int x = 0; x < level.width; ++x)
                for (int c = 0; c < base.channels; ++c) {
                    const int right = std::min(2 * x + 1, above->width - 1);
                    const int below = std::min(2 * y + 1, above->height - 1);
                    level.pixel(x, y)[c] = static_cast<std::uint8_t>(
                        (above->pixel(2 * x, 2 * y)[c] + above->pixel(right, 2 * y)[c] +
                         above->pixel(2 * x, below)[c] + above->pixel(right, below)[c]) /
                        4);
                }
        above = &levels.emplace_back(std::move(level));
    }
    return levels;
}

Image8 reducedToSide(const Image8& image, int mostTexels) {
    QX_CHECK_GE(mostTexels, 1);
    checkImage(image);
    if (std::max(image.width, image.height) <= mostTexels)
        return image;
    std::vector<Image8> levels = makeMipmaps(image);
    return std::move(*std::find_if(levels.begin(), levels.end(), [&](const Image8& level) {
        return std::max(level.width, level.height) <= mostTexels;
    }));
}

}  // namespace quincunx
