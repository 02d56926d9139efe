#include "image/texture_unit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <tbb/parallel_for.h>

#include "base/check.h"
#include "image/color.h"

namespace quincunx {
namespace {

constexpr double lodLimit = 1000;

double finiteOrZero(double x) {
    return std::isfinite(x) ? x : 0;
}

int nearestAt(double coordinate, int side, TextureWrap wrap) {
    return wrapTexel(std::floor(finiteOrZero(coordinate) * side), side, wrap);
}

LinearTexels linearAt(double coordinate, int side, TextureWrap wrap) {
    double within = finiteOrZero(coordinate);
    // Two repeats, or a repeat and its mirror, are all there is; the rest is exact, and leaves room for the
    // ½.
    if ((wrap == TextureWrap::repeat || wrap == TextureWrap::mirroredRepeat) && std::abs(within) >= 2)
        within = std::abs(within) < 0x1p60
                     ? within - 2 * static_cast<double>(static_cast<std::int64_t>(0.5 * within))
                     : 0;  // a multiple of 2
    const double position = within * side - 0.5;
    const double first = std::floor(position);
    return {wrapTexel(first, side, wrap), wrapTexel(first + 1, side, wrap), position - first};
}

template <typename Visit>
void visitNearest(const MipTexture& texture, const SamplerSettings& settings, glm::dvec2 st, int level,
                  double weight, Visit&& visit) {
    visit(level, nearestAt(st.x, texture.width(level), settings.wrapS),
          nearestAt(st.y, texture.height(level), settings.wrapT), weight);
}

template <typename Visit>
void visitLinear(const MipTexture& texture, const SamplerSettings& settings, glm::dvec2 st, int level,
                 double weight, Visit&& visit) {
    const LinearTexels x = linearAt(st.x, texture.width(level), settings.wrapS);
    const LinearTexels y = linearAt(st.y, texture.height(level), settings.wrapT);
    visit(level, x.first, y.first, weight * (1 - x.share) * (1 - y.share));
    visit(level, x.second, y.first, weight * x.share * (1 - y.share));
    visit(level, x.first, y.second, weight * (1 - x.share) * y.share);
    visit(level, x.second, y.second, weight * x.share * y.share);
}

template <typename Visit>
void visitMagnified(const MipTexture& texture, const SamplerSettings& settings, glm::dvec2 st, double weight,
                    Visit&& visit) {
    switch (settings.magnification) {
        case Magnification::nearest:
            return visitNearest(texture, settings, st, 0, weight, visit);
        case Magnification::bilinear:
            return visitLinear(texture, settings, st, 0, weight, visit);
        default: {
            thread_local std::vector<LineTap> across;
            thread_local std::vector<LineTap> down;
            lineTaps(settings.magnification, settings.lobes, finiteOrZero(st.x) * texture.width(),
                     texture.width(), settings.wrapS, across);
            lineTaps(settings.magnification, settings.lobes, finiteOrZero(st.y) * texture.height(),
                     texture.height(), settings.wrapT, down);
            for (const LineTap& y : down)
                for (const LineTap& x : across)
                    visit(0, x.texel, y.texel, weight * x.weight * y.weight);
        }
    }
}

/// Two levels that λ lies between, or one.
template <typename VisitLevel>
void visitBlended(double lambda, int levels, VisitLevel&& visitLevel) {
    const double place = clampedLevel(lambda, levels);
    const double finer = std::floor(place);
    const int level = static_cast<int>(finer);
    if (level == levels - 1)
        return visitLevel(level, 1.0);
    visitLevel(level, 1 - (place - finer));
    visitLevel(level + 1, place - finer);
}

/// ⌈λ + ½⌉ − 1 within the levels.
int nearestLevel(double lambda, int levels) {
    return static_cast<int>(std::ceil(clampedLevel(lambda, levels) + 0.5)) - 1;
}

template <typename Visit>
void visitLod(const MipTexture& texture, const SamplerSettings& settings, glm::dvec2 st, double lambda,
              double weight, Visit&& visit) {
    const double clamped = std::clamp(lambda, settings.minLod, settings.maxLod);
    const Minification filter = settings.minification;
    const bool nearestWithin =
        filter == Minification::nearestMipmap || filter == Minification::nearestBlended;
    const double magnifiedUpTo = nearestWithin && settings.magnification != Magnification::nearest ? 0.5 : 0;
    if (clamped <= magnifiedUpTo)
        return visitMagnified(texture, settings, st, weight, visit);
    const int levels = texture.levels();
    switch (filter) {
        case Minification::nearest:
            return visitNearest(texture, settings, st, 0, weight, visit);
        case Minification::bilinear:
            return visitLinear(texture, settings, st, 0, weight, visit);
        case Minification::nearestMipmap:
            return visitNearest(texture, settings, st, nearestLevel(clamped, levels), weight, visit);
        case Minification::bilinearMipmap:
            return visitLinear(texture, settings, st, nearestLevel(clamped, levels), weight, visit);
        case Minification::nearestBlended:
            return visitBlended(clamped, levels, [&](int level, double share) {
                visitNearest(texture, settings, st, level, weight * share, visit);
            });
        case Minification::trilinear:
        case Minification::anisotropic:
            return visitBlended(clamped, levels, [&](int level, double share) {
                visitLinear(texture, settings, st, level, weight * share, visit);
            });
    }
}

template <typename Visit>
void visitPoint(const MipTexture& texture, const SamplerSettings& settings, const TexturePoint& point,
                Visit&& visit) {
    const glm::dvec2 st(point.st);
    if (settings.minification != Minification::anisotropic)
        return visitLod(texture, settings, st,
                        levelOfDetail(point, texture.width(), texture.height(), settings.lodBias), 1, visit);
    const Footprint footprint =
        footprintOf(point, texture.width(), texture.height(), settings.maxAnisotropy, settings.lodBias);
    for (int i = 0; i < footprint.probes; ++i)
        visitLod(texture, settings, footprint.probe(i, st), footprint.lambda, 1.0 / footprint.probes, visit);
}

/// Adds up texels.
class Sum {
  public:
    Sum(const MipTexture& texture, const SamplerSettings& settings)
        : texture_(texture), border_(settings.border) {}

    void operator()(int level, int x, int y, double weight) {
        ++texels_;
        if (x < 0 || y < 0) {
            color_ += weight * border_;
            return;
        }
        const float* const texel = texture_.level(level).pixel(x, y);
        color_ += weight * glm::dvec4(texel[0], texel[1], texel[2], texel[3]);
    }
    TextureSample sample() const { return {glm::vec4(color_), texels_}; }

  private:
    const MipTexture& texture_;
    glm::dvec4 border_;
    glm::dvec4 color_{0};
    int texels_ = 0;
};

/// (s, t) derivatives in texels, those with a NaN as 0.
glm::dvec2 inTexels(glm::vec2 derivative, int width, int height) {
    const glm::dvec2 texels(static_cast<double>(derivative.x) * width,
                            static_cast<double>(derivative.y) * height);
    return std::isnan(texels.x) || std::isnan(texels.y) ? glm::dvec2(0) : texels;
}

Image withFourChannels(Image linear) {
    if (linear.channels == 4)
        return linear;
    Image image(linear.width, linear.height, 4, linear.encoding);
    const int channels = linear.channels;
    for (std::size_t i = 0; i < linear.pixelCount(); ++i) {
        const float* const from = &linear.data[i * static_cast<std::size_t>(channels)];
        float* const to = &image.data[4 * i];
        for (int c = 0; c < 3; ++c)
            to[c] = channels < 3 ? from[0] : from[c];
        to[3] = channels == 2 ? from[1] : 1;
    }
    return image;
}

}  // namespace

int wrapTexel(double texel, int side, TextureWrap wrap) {
    const double sides = side;
    if (texel >= 0 && texel < sides)
        return static_cast<int>(texel);
    switch (wrap) {
        case TextureWrap::repeat: {
            const double rest = std::fmod(texel, sides);  // exact
            return static_cast<int>(rest < 0 ? rest + sides : rest);
        }
        case TextureWrap::mirroredRepeat: {
            double rest = std::fmod(texel, 2 * sides);
            rest = rest < 0 ? rest + 2 * sides : rest;
            return static_cast<int>(rest < sides ? rest : 2 * sides - 1 - rest);
        }
        case TextureWrap::clampToEdge:
            return static_cast<int>(std::clamp(texel, 0.0, sides - 1));
        case TextureWrap::clampToBorder:
            return texel < 0 || texel >= sides ? -1 : static_cast<int>(texel);
    }
    return 0;
}

int nearestTexel(float coordinate, int side, TextureWrap wrap) {
    return nearestAt(coordinate, side, wrap);
}

int nearestTexelNaive(float coordinate, int side) {
    const float texel = (coordinate - std::floor(coordinate)) * static_cast<float>(side);
    // A conversion of what no int holds is undefined.
    return std::abs(texel) < 2e9f ? static_cast<int>(texel) : std::numeric_limits<int>::min();
}

LinearTexels linearTexels(float coordinate, int side, TextureWrap wrap) {
    return linearAt(coordinate, side, wrap);
}

double levelOfDetail(const TexturePoint& point, int width, int height, double bias) {
    const glm::dvec2 x = inTexels(point.alongX, width, height);
    const glm::dvec2 y = inTexels(point.alongY, width, height);
    // Squares of floats times sides neither overflow nor vanish in double.
    const double squared = std::max(glm::dot(x, x), glm::dot(y, y));
    const double lambda = 0.5 * std::log2(squared) + (std::isnan(bias) ? 0 : bias);
    return std::isnan(lambda) ? -lodLimit : std::clamp(lambda, -lodLimit, lodLimit);
}

float levelOfDetailNaive(const TexturePoint& point, int width, int height) {
    const glm::vec2 sides(width, height);
    return std::log2(std::max(glm::length(point.alongX * sides), glm::length(point.alongY * sides)));
}

double clampedLevel(double lambda, int levels) {
    return lambda > 0 ? std::min(lambda, levels - 1.0) : 0;
}

MipTexture::MipTexture(std::span<const Image8> levels) {
    for (const Image8& level : levels)
        levels_.push_back(withFourChannels(toLinear(level)));
    check();
}

MipTexture::MipTexture(std::vector<Image> levels) {
    for (Image& level : levels)
        levels_.push_back(withFourChannels(toLinear(std::move(level))));
    check();
}

MipTexture::MipTexture(const Image8& base, const MipmapParams& params) {
    levels_.push_back(withFourChannels(toLinear(base)));
    for (const Image8& level : makeMipmaps(base, params))
        levels_.push_back(withFourChannels(toLinear(level)));
    check();
}

void MipTexture::check() {
    complete_ =
        !levels_.empty() && width() >= 1 && height() >= 1 && levels() <= mipLevelCount(width(), height());
    for (int i = 0; complete_ && i < levels(); ++i)
        complete_ = width(i) == mipSide(width(), i) && height(i) == mipSide(height(), i);
}

TextureSample sampleTexture(const MipTexture& texture, const SamplerSettings& settings,
                            const TexturePoint& point) {
    if (!texture.complete())
        return {};
    Sum sum(texture, settings);
    visitPoint(texture, settings, point, sum);
    return sum.sample();
}

TextureSample sampleTextureLod(const MipTexture& texture, const SamplerSettings& settings, glm::vec2 st,
                               double lambda) {
    if (!texture.complete())
        return {};
    Sum sum(texture, settings);
    visitLod(texture, settings, glm::dvec2(st), std::isnan(lambda) ? -lodLimit : lambda + settings.lodBias, 1,
             sum);
    return sum.sample();
}

glm::vec4 sampleTrilinearNaive(const MipTexture& texture, const TexturePoint& point) {
    const float lambda = levelOfDetailNaive(point, texture.width(), texture.height());
    const auto bilinear = [&](int level) {
        const int width = texture.width(level);
        const int height = texture.height(level);
        const float x = (point.st.x - std::floor(point.st.x)) * static_cast<float>(width) - 0.5f;
        const float y = (point.st.y - std::floor(point.st.y)) * static_cast<float>(height) - 0.5f;
        const float left = std::floor(x);
        const float top = std::floor(y);
        // A program would read what lies beside the texture; here that is NaN.
        const auto texel = [&](float i, float j) {
            const int column = static_cast<int>(i) % width;
            const int row = static_cast<int>(j) % height;
            if (!(column >= 0 && row >= 0))
                return glm::vec4(std::numeric_limits<float>::quiet_NaN());
            const float* const t = texture.level(level).pixel(column, row);
            return glm::vec4(t[0], t[1], t[2], t[3]);
        };
        const auto mix = [](glm::vec4 a, glm::vec4 b, float t) { return a + t * (b - a); };
        return mix(mix(texel(left, top), texel(left + 1, top), x - left),
                   mix(texel(left, top + 1), texel(left + 1, top + 1), x - left), y - top);
    };
    const auto isInside = [&](int level) { return level >= 0 && level < texture.levels(); };
    const float place = std::clamp(lambda, 0.0f, static_cast<float>(texture.levels() - 1));
    const float finer = std::floor(place);
    if (!(std::abs(finer) < 1e6f) || !std::isfinite(point.st.x) || !std::isfinite(point.st.y) ||
        !isInside(static_cast<int>(finer)))
        return glm::vec4(std::numeric_limits<float>::quiet_NaN());
    const int level = static_cast<int>(finer);
    const int coarser = std::min(level + 1, texture.levels() - 1);
    return bilinear(level) + (place - finer) * (bilinear(coarser) - bilinear(level));
}

std::vector<TexelTap> texelTaps(const MipTexture& texture, const SamplerSettings& settings,
                                const TexturePoint& point) {
    std::vector<TexelTap> taps;
    if (texture.complete())
        visitPoint(texture, settings, point, [&](int level, int x, int y, double weight) {
            taps.push_back({level, x < 0 || y < 0 ? -1 : x, y, weight});
        });
    return taps;
}

Footprint footprintOf(const TexturePoint& point, int width, int height, int maxAnisotropy, double bias) {
    QX_CHECK_GE(maxAnisotropy, 1);
    const glm::dvec2 x = inTexels(point.alongX, width, height);
    const glm::dvec2 y = inTexels(point.alongY, width, height);
    Footprint footprint;
    footprint.lambda = levelOfDetail(point, width, height, bias);
    // J Jᵀ for the Jacobian J = (x y): its eigenvalues are the squared half axes of the ellipse that the
    // pixel's circle becomes.
    const double ss = x.x * x.x + y.x * y.x;
    const double tt = x.y * x.y + y.y * y.y;
    const double st = x.x * x.y + y.x * y.y;
    const double longSquared = 0.5 * (ss + tt) + std::hypot(0.5 * (ss - tt), st);
    if (!std::isfinite(longSquared) || longSquared <= 0)
        return footprint;
    footprint.longTexels = std::sqrt(longSquared);
    // Products of floats are exact, so that their difference is rounded once, however thin the ellipse is.
    const double area = (static_cast<double>(point.alongX.x) * point.alongY.y -
                         static_cast<double>(point.alongX.y) * point.alongY.x) *
                        width * height;
    footprint.shortTexels = std::isfinite(area) ? std::abs(area) / footprint.longTexels : 0;
    const double angle = 0.5 * std::atan2(2 * st, ss - tt);
    footprint.longAxis = footprint.longTexels * glm::dvec2(std::cos(angle) / width, std::sin(angle) / height);
    const double narrow = std::max(footprint.shortTexels, 1.0);
    const double ratio =
        std::min(std::ceil(footprint.longTexels / narrow), static_cast<double>(maxAnisotropy));
    footprint.probes = std::max(static_cast<int>(ratio), 1);
    if (footprint.probes > 1)
        footprint.lambda = std::log2(std::max(narrow, footprint.longTexels / footprint.probes)) +
                           (std::isnan(bias) ? 0 : bias);
    return footprint;
}

glm::vec2 footprintAxesNaive(const TexturePoint& point, int width, int height) {
    const glm::vec2 sides(width, height);
    const glm::vec2 x = point.alongX * sides;
    const glm::vec2 y = point.alongY * sides;
    const float half = 0.5f * (glm::dot(x, x) + glm::dot(y, y));
    const float determinant = x.x * y.y - x.y * y.x;
    const float root = std::sqrt(half * half - determinant * determinant);
    return {std::sqrt(half + root), std::sqrt(half - root)};
}

float sincNaive(float x) {
    const float a = static_cast<float>(std::numbers::pi) * x;
    return std::sin(a) / a;
}

double sinc(double x) {
    if (!std::isfinite(x))
        return 0;
    if (std::abs(x) < 1e-9)
        return 1;  // 1 − (πx)²/6 rounds to 1
    const double whole = std::nearbyint(x);
    const double sine = std::sin(std::numbers::pi * (x - whole));
    return (std::fmod(whole, 2) != 0 ? -sine : sine) / (std::numbers::pi * x);
}

double periodicSinc(double x, int period) {
    const double near = std::remainder(x, period);  // exact
    if (std::abs(near) < 1e-9)
        return 1;
    const double whole = std::nearbyint(near);
    const double sine = std::sin(std::numbers::pi * (near - whole)) * (std::fmod(whole, 2) != 0 ? -1 : 1);
    const double part = std::numbers::pi * near / period;
    return sine / (period * (period % 2 == 0 ? std::tan(part) : std::sin(part)));
}

float periodicSincNaive(float x, int period) {
    constexpr auto pi = static_cast<float>(std::numbers::pi);
    const float n = static_cast<float>(period);
    return std::sin(pi * x) / (n * (period % 2 == 0 ? std::tan(pi * x / n) : std::sin(pi * x / n)));
}

double filterWeight(Magnification filter, double distance, int lobes) {
    const double x = std::abs(distance);
    switch (filter) {
        case Magnification::nearest:
            return x < 0.5 ? 1 : 0;
        case Magnification::bilinear:
            return std::max(0.0, 1 - x);
        case Magnification::mitchell:
            // Mitchell and Netravali, equation 8, for B = C = 1/3.
            if (x < 1)
                return ((7 * x - 12) * x * x + 16.0 / 3) / 6;
            return x < 2 ? (((-7.0 / 3 * x + 12) * x - 20) * x + 32.0 / 3) / 6 : 0;
        case Magnification::lanczos:
            return x < lobes ? sinc(x) * sinc(x / lobes) : 0;
        case Magnification::sinc:
            return sinc(x);
    }
    return 0;
}

void lineTaps(Magnification filter, int lobes, double position, int side, TextureWrap wrap,
              std::vector<LineTap>& taps) {
    taps.clear();
    if (filter == Magnification::nearest) {
        taps.push_back({wrapTexel(std::floor(position), side, wrap), 1});
        return;
    }
    const double centre = position - 0.5;  // the texel whose centre it is
    if (filter == Magnification::sinc) {
        const bool repeats = wrap == TextureWrap::repeat;
        for (int i = 0; i < side; ++i)
            taps.push_back({i, repeats ? periodicSinc(centre - i, side)
                                       : periodicSinc(centre - i, 2 * side) +
                                             periodicSinc(centre + 1 + i - 2 * side, 2 * side)});
        return;
    }
    const int reach = filter == Magnification::bilinear ? 1 : filter == Magnification::mitchell ? 2 : lobes;
    const double first = std::floor(centre) - reach + 1;
    double sum = 0;
    for (int k = 0; k < 2 * reach; ++k) {
        const double weight = filterWeight(filter, centre - (first + k), lobes);
        taps.push_back({wrapTexel(first + k, side, wrap), weight});
        sum += weight;
    }
    for (LineTap& tap : taps)
        tap.weight /= sum;
}

Image enlarge(const MipTexture& texture, const SamplerSettings& settings, const TextureWindow& window,
              int width, int height) {
    QX_CHECK(texture.complete());
    const Image& texels = texture.level(0);
    const auto tapsOf = [&](double low, double high, int pixels, int side, TextureWrap wrap) {
        std::vector<std::vector<LineTap>> taps(static_cast<std::size_t>(pixels));
        for (int i = 0; i < pixels; ++i)
            lineTaps(settings.magnification, settings.lobes, (low + (high - low) * (i + 0.5) / pixels) * side,
                     side, wrap, taps[static_cast<std::size_t>(i)]);
        return taps;
    };
    const auto across = tapsOf(window.low.x, window.high.x, width, texels.width, settings.wrapS);
    const auto down = tapsOf(window.low.y, window.high.y, height, texels.height, settings.wrapT);
    const auto columns = static_cast<std::size_t>(width);
    const glm::dvec4 border(settings.border);

    std::vector<bool> isRead(static_cast<std::size_t>(texels.height));
    for (const auto& taps : down)
        for (const LineTap& tap : taps)
            if (tap.texel >= 0)
                isRead[static_cast<std::size_t>(tap.texel)] = true;
    std::vector<glm::dvec4> wide(columns * static_cast<std::size_t>(texels.height));
    tbb::parallel_for(0, texels.height, [&](int y) {
        for (std::size_t x = 0; isRead[static_cast<std::size_t>(y)] && x < columns; ++x) {
            glm::dvec4 sum(0);
            for (const LineTap& tap : across[x]) {
                const float* const t = tap.texel < 0 ? nullptr : texels.pixel(tap.texel, y);
                sum += tap.weight * (t == nullptr ? border : glm::dvec4(t[0], t[1], t[2], t[3]));
            }
            wide[static_cast<std::size_t>(y) * columns + x] = sum;
        }
    });
    Image image(width, height, 4, Encoding::linear);
    tbb::parallel_for(0, height, [&](int y) {
        std::vector<glm::dvec4> row(columns, glm::dvec4(0));
        for (const LineTap& tap : down[static_cast<std::size_t>(y)])
            for (std::size_t x = 0; x < columns; ++x)
                row[x] += tap.weight *
                          (tap.texel < 0 ? border : wide[static_cast<std::size_t>(tap.texel) * columns + x]);
        for (std::size_t x = 0; x < columns; ++x)
            for (int c = 0; c < 4; ++c)
                image.pixel(static_cast<int>(x), y)[c] = static_cast<float>(row[x][c]);
    });
    return image;
}

}  // namespace quincunx
