#include "image/texture_hard_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "image/mipmaps.h"
#include "image/texture_unit.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/ulp.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr std::array sides = {1, 2, 3, 7, 64, 100, 331, 4096, 16384};

int drawSide(StressInputs& draw) {
    return sides[draw.random().below(sides.size())];
}

/// Just beside 0, at borders of texels, far away, and beyond where float has fractions.
float drawCoordinate(StressInputs& draw, int side) {
    switch (draw.random().below(4)) {
        case 0:
            return static_cast<float>(draw.sign() * draw.magnitude(-148, -1));
        case 1: {
            const double k = std::floor(draw.random().uniform(-3.0, 3.0) * side);
            return static_cast<float>(k / side);
        }
        case 2:
            return static_cast<float>(draw.sign() * draw.magnitude(0, 24));
        default:
            return static_cast<float>(draw.sign() * draw.magnitude(24, 120));
    }
}

struct ExactPlace {
    std::int64_t texel = 0;  ///< ⌊s · side + shift / 2⌋ mod side
    double share = 0;        ///< of what is left
};

/// By integers: s = m 2^e.
ExactPlace exactPlace(float coordinate, int side, int shiftHalves) {
    int exponent = 0;
    const auto mantissa =
        static_cast<std::int64_t>(std::scalbn(std::frexp(static_cast<double>(coordinate), &exponent), 24));
    exponent -= 24;
    if (mantissa == 0)
        exponent = -1;
    if (exponent >= 0)
        return {shiftHalves == 0 ? 0 : (side - 1) % side, shiftHalves == 0 ? 0 : 0.5};
    // Twice the position, times 2^-e: m side 2 + shift 2^-e.
    const Quad position = Quad(static_cast<double>(coordinate)) * side + Quad(0.5) * shiftHalves;
    const int down = -exponent;
    std::int64_t floor = 0;
    if (down < 62 - 1) {
        __extension__ using Wide = __int128;
        const Wide numerator = Wide(2) * mantissa * side + Wide(shiftHalves) * (Wide(1) << down);
        floor = static_cast<std::int64_t>(numerator >> (down + 1));
    } else {
        // |s side| < 2^24 · 2^14 · 2^-61: nothing but its sign counts.
        floor = shiftHalves < 0 || mantissa < 0 ? -1 : 0;
    }
    const std::int64_t texel = ((floor % side) + side) % side;
    return {texel, static_cast<double>(position - Quad(static_cast<double>(floor)))};
}

HardCaseFigures runNearest(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const int side = drawSide(draw);
        const float coordinate = drawCoordinate(draw, side);
        const auto exact = static_cast<double>(exactPlace(coordinate, side, 0).texel);
        const auto error = [&](int texel) {
            return texel < 0 || texel >= side ? infinity : std::abs(texel - exact);
        };
        tally.add(error(nearestTexelNaive(coordinate, side)),
                  error(nearestTexel(coordinate, side, TextureWrap::repeat)),
                  [&] { return fmt::format("s={:a} side={}", coordinate, side); });
    }
    return tally.figures();
}

HardCaseFigures runLinear(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const int side = drawSide(draw);
        const float coordinate = drawCoordinate(draw, side);
        const ExactPlace exact = exactPlace(coordinate, side, -1);
        // Distance of places on the circle of texels.
        const auto error = [&](double texel, double share) {
            if (!(texel >= 0 && texel < side && share >= 0 && share <= 1))
                return infinity;
            const double apart =
                std::remainder(texel + share - static_cast<double>(exact.texel) - exact.share, side);
            return texel == static_cast<double>(exact.texel) ? std::abs(share - exact.share)
                                                             : std::abs(apart);
        };
        const float position = coordinate * static_cast<float>(side) - 0.5f;
        const float first = std::floor(position);
        const double texel = std::fmod(static_cast<double>(first), side);
        const LinearTexels stable = linearTexels(coordinate, side, TextureWrap::repeat);
        const bool neighbours = stable.second == (stable.first + 1) % side;
        tally.add(error(texel < 0 ? texel + side : texel, static_cast<double>(position - first)),
                  neighbours ? error(stable.first, stable.share) : infinity,
                  [&] { return fmt::format("s={:a} side={}", coordinate, side); });
    }
    return tally.figures();
}

HardCaseFigures runLerp(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        float a = static_cast<float>(draw.sign() * draw.magnitude(-30, 30));
        float b = static_cast<float>(draw.sign() * draw.magnitude(-30, 30));
        if (i % 4 == 1)
            b = a;
        if (i % 4 == 2)
            b = std::nextafter(a, b);
        if (i % 16 == 3) {
            a = 3e38f;
            b = -3e38f;
        }
        const float t = i % 5 == 0 ? 0.0f : i % 5 == 1 ? 1.0f : draw.random().uniform();
        const Quad exact = (Quad(1) - Quad(t)) * Quad(a) + Quad(t) * Quad(b);
        const float largest = std::max(std::abs(a), std::abs(b));
        const double ulp = static_cast<double>(largest) - std::nextafter(largest, 0.0f);
        const auto error = [&](float got, bool keepsContract) {
            const bool exactEnds = (t != 0 || got == a) && (t != 1 || got == b) && (a != b || got == a);
            const bool within = got >= std::min(a, b) && got <= std::max(a, b);
            if (!std::isfinite(got) || (keepsContract && !(exactEnds && within)))
                return infinity;
            return std::abs(static_cast<double>(Quad(got) - exact)) / ulp;
        };
        float stable = lerp(a, b, t);
        const float next = std::nextafter(t, 1.0f);
        if ((a < b) != (lerp(a, b, next) >= stable) && a != b && lerp(a, b, next) != stable)
            stable = std::numeric_limits<float>::quiet_NaN();  // not monotone
        tally.add(error(lerpNaive(a, b, t), false), error(stable, true),
                  [&] { return fmt::format("a={:a} b={:a} t={:a}", a, b, t); });
    }
    return tally.figures();
}

float drawDerivative(StressInputs& draw) {
    switch (draw.random().below(12)) {
        case 0:
        case 1:
            return 0;
        case 2:
            return std::numeric_limits<float>::infinity();
        case 3:
            return std::numeric_limits<float>::quiet_NaN();
        case 4:
        case 5:
        case 6:
            return static_cast<float>(draw.sign() * draw.magnitude(-140, 120));
        default:
            return static_cast<float>(draw.sign() * draw.magnitude(-14, 1));
    }
}

TexturePoint drawPoint(StressInputs& draw, int side) {
    TexturePoint point;
    point.st = {drawCoordinate(draw, side), static_cast<float>(draw.random().uniform(-1e7, 1e7))};
    point.alongX = {drawDerivative(draw), drawDerivative(draw)};
    point.alongY = {drawDerivative(draw), drawDerivative(draw)};
    return point;
}

std::string describe(const TexturePoint& point, int width, int height) {
    return fmt::format("st=({:a},{:a}) x=({:a},{:a}) y=({:a},{:a}) {}x{}", point.st.x, point.st.y,
                       point.alongX.x, point.alongX.y, point.alongY.x, point.alongY.y, width, height);
}

/// λ within the levels; a derivative with a NaN counts as 0.
Quad exactLevel(const TexturePoint& point, int width, int height) {
    const Quad last = mipLevelCount(width, height) - 1;
    Quad largest = 0;
    for (const glm::vec2 along : {point.alongX, point.alongY}) {
        if (std::isnan(along.x) || std::isnan(along.y))
            continue;
        if (std::isinf(along.x) || std::isinf(along.y))
            return last;
        const Quad s = Quad(along.x) * width;
        const Quad t = Quad(along.y) * height;
        largest = std::max(largest, s * s + t * t);
    }
    if (largest <= 1)
        return 0;
    return std::min(last, Quad(0.5) * logarithm(largest) / logarithm(Quad(2)));
}

HardCaseFigures runLevel(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const int width = drawSide(draw);
        const int height = drawSide(draw);
        const TexturePoint point = drawPoint(draw, width);
        const int levels = mipLevelCount(width, height);
        const Quad exact = exactLevel(point, width, height);
        const float naive =
            std::clamp(levelOfDetailNaive(point, width, height), 0.0f, static_cast<float>(levels - 1));
        const double stable = clampedLevel(levelOfDetail(point, width, height), levels);
        tally.add(std::abs(static_cast<double>(Quad(naive) - exact)),
                  std::abs(static_cast<double>(Quad(stable) - exact)),
                  [&] { return describe(point, width, height); });
    }
    return tally.figures();
}

HardCaseFigures runLevelCount(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto power = static_cast<std::int64_t>(1) << draw.random().below(30);
        const auto near = power + static_cast<std::int64_t>(draw.random().below(5)) - 2;
        const int side = static_cast<int>(std::max<std::int64_t>(
            i % 4 == 0 ? static_cast<std::int64_t>(draw.random().below(1 << 26)) : near, 1));
        int exact = 1;
        while (side >> exact > 0)
            ++exact;
        tally.add(std::abs(mipLevelCountNaive(side, 1) - exact), std::abs(mipLevelCount(1, side) - exact),
                  [&] { return fmt::format("side={}", side); });
    }
    return tally.figures();
}

/// The last level against the mean of the base, in codes.
HardCaseFigures runChain(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        Image8 base(1 + static_cast<int>(draw.random().below(19)),
                    1 + static_cast<int>(draw.random().below(9)), 1, Encoding::linear);
        const bool ramp = draw.random().below(2) == 0;
        std::int64_t sum = 0;
        for (std::size_t k = 0; k < base.data.size(); ++k) {
            base.data[k] =
                static_cast<std::uint8_t>(ramp ? k * 255 / base.data.size() : draw.random().below(256));
            sum += base.data[k];
        }
        const double mean = static_cast<double>(sum) / static_cast<double>(base.data.size());
        const auto last = [&](const std::vector<Image8>& levels) {
            return std::abs((levels.empty() ? base : levels.back()).data[0] - mean);
        };
        tally.add(last(makeMipmapsNaive(base)), last(makeMipmaps(base)),
                  [&] { return fmt::format("{}x{} {}", base.width, base.height, ramp ? "ramp" : "noise"); });
    }
    return tally.figures();
}

Quad exactSine(Quad x) {
    // π to 113 bits is what sineCosine's reduction has; the fraction of x is exact.
    static const Quad pi = Quad(4) * arcTangent(Quad(1), Quad(1));
    const double whole = std::nearbyint(static_cast<double>(x));
    const Quad sine = sineCosine(pi * (x - Quad(whole))).sine;
    return std::fmod(whole, 2) != 0 ? -sine : sine;
}

double drawDistance(StressInputs& draw, int most) {
    const auto whole = static_cast<double>(draw.random().below(static_cast<std::uint64_t>(most)));
    const double beside = draw.random().below(4) == 0 ? 0 : draw.sign() * draw.magnitude(-40, -1);
    return static_cast<double>(static_cast<float>(draw.sign() * (whole + beside)));
}

HardCaseFigures runSinc(std::uint64_t inputs, std::uint64_t seed) {
    static const Quad pi = Quad(4) * arcTangent(Quad(1), Quad(1));
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const double x = drawDistance(draw, 4096);
        const Quad exact = x == 0 ? Quad(1) : exactSine(Quad(x)) / (pi * Quad(x));
        tally.add(std::abs(static_cast<double>(Quad(sincNaive(static_cast<float>(x))) - exact)),
                  std::abs(static_cast<double>(Quad(sinc(x)) - exact)),
                  [&] { return fmt::format("x={:a}", x); });
    }
    return tally.figures();
}

HardCaseFigures runPeriodicSinc(std::uint64_t inputs, std::uint64_t seed) {
    static const Quad pi = Quad(4) * arcTangent(Quad(1), Quad(1));
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const int period = 1 + static_cast<int>(draw.random().below(24));
        const double x = drawDistance(draw, 4 * period);
        // Dirichlet's kernel as the sum of its cosines, the highest of an even period by half.
        Quad sum = 1;
        for (int k = 1; 2 * k <= period; ++k)
            sum += (2 * k == period ? Quad(1) : Quad(2)) * sineCosine(2 * pi * k * Quad(x) / period).cosine;
        const Quad exact = sum / period;
        tally.add(
            std::abs(static_cast<double>(Quad(periodicSincNaive(static_cast<float>(x), period)) - exact)),
            std::abs(static_cast<double>(Quad(periodicSinc(x, period)) - exact)),
            [&] { return fmt::format("x={:a} period={}", x, period); });
    }
    return tally.figures();
}

/// The short axis of footprints that are nearly lines.
HardCaseFigures runFootprint(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const int width = drawSide(draw);
        const int height = drawSide(draw);
        TexturePoint point;
        const double angle = draw.random().uniform(0, 6.28);
        const double apart = draw.magnitude(-20, -1);
        const double size = draw.magnitude(-40, 20);
        point.alongX = glm::vec2(size * glm::dvec2(std::cos(angle), std::sin(angle)));
        point.alongY = glm::vec2(size * draw.magnitude(-3, 3) *
                                 glm::dvec2(std::cos(angle + apart), std::sin(angle + apart)));
        const Quad xs = Quad(point.alongX.x) * width;
        const Quad xt = Quad(point.alongX.y) * height;
        const Quad ys = Quad(point.alongY.x) * width;
        const Quad yt = Quad(point.alongY.y) * height;
        const Quad half = Quad(0.5) * (xs * xs + xt * xt + ys * ys + yt * yt);
        Quad determinant = xs * yt - xt * ys;
        determinant = determinant < 0 ? -determinant : determinant;
        const Quad root = squareRoot((half - determinant) * (half + determinant));
        const Quad longAxis = squareRoot(half + root);
        const Quad shortAxis = determinant / longAxis;
        const auto error = [&](double longTexels, double shortTexels) {
            const auto relative = [](double got, Quad exact) {
                return exact == 0 ? (got == 0 ? 0 : infinity)
                                  : std::abs(static_cast<double>((Quad(got) - exact) / exact));
            };
            if (!std::isfinite(longTexels) || !std::isfinite(shortTexels))
                return infinity;
            return std::max(relative(longTexels, longAxis), relative(shortTexels, shortAxis));
        };
        const glm::vec2 naive = footprintAxesNaive(point, width, height);
        const Footprint stable = footprintOf(point, width, height, 16);
        const bool inRange = stable.probes >= 1 && stable.probes <= 16 && !std::isnan(stable.lambda);
        tally.add(error(naive.x, naive.y), inRange ? error(stable.longTexels, stable.shortTexels) : infinity,
                  [&] { return describe(point, width, height); });
    }
    return tally.figures();
}

/// Trilinear and anisotropic samples: values of a texture whose texels lie in 1…2.
HardCaseFigures runSample(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    static constexpr std::array shapes = {glm::ivec2(1, 1), glm::ivec2(1, 13), glm::ivec2(16, 16),
                                          glm::ivec2(7, 5)};
    std::vector<MipTexture> textures;
    for (const glm::ivec2 shape : shapes) {
        Image base(shape.x, shape.y, 4, Encoding::linear);
        for (float& value : base.data)
            value = 1 + draw.random().uniform();
        std::vector<Image> levels = makeMipmaps(base);
        levels.insert(levels.begin(), base);
        textures.emplace_back(std::move(levels));
    }
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const MipTexture& texture = textures[draw.random().below(textures.size())];
        const TexturePoint point = drawPoint(draw, texture.width());
        // The texels that count, in quad: an independent walk over levels, rows and columns.
        const Quad lambda = exactLevel(point, texture.width(), texture.height());
        const int finer = std::min(static_cast<int>(static_cast<double>(lambda)), texture.levels() - 1);
        const Quad blend = lambda - finer;
        std::array<Quad, 4> exact{};
        for (int l = finer; l <= std::min(finer + 1, texture.levels() - 1); ++l) {
            const Quad levelWeight =
                l == finer ? (finer + 1 < texture.levels() ? 1 - blend : Quad(1)) : blend;
            const ExactPlace x = exactPlace(point.st.x, texture.width(l), -1);
            const ExactPlace y = exactPlace(point.st.y, texture.height(l), -1);
            for (int j = 0; j < 2; ++j)
                for (int k = 0; k < 2; ++k) {
                    const Quad weight = levelWeight * (k == 0 ? 1 - Quad(x.share) : Quad(x.share)) *
                                        (j == 0 ? 1 - Quad(y.share) : Quad(y.share));
                    const float* const texel =
                        texture.level(l).pixel(static_cast<int>((x.texel + k) % texture.width(l)),
                                               static_cast<int>((y.texel + j) % texture.height(l)));
                    for (std::size_t c = 0; c < 4; ++c)
                        exact[c] += weight * Quad(texel[c]);
                }
        }
        const auto error = [&](glm::vec4 got) {
            double worst = 0;
            for (int c = 0; c < 4; ++c)
                worst = worse(
                    worst, std::abs(static_cast<double>(Quad(got[c]) - exact[static_cast<std::size_t>(c)])));
            return std::isfinite(worst) ? worst : infinity;
        };
        SamplerSettings settings;
        const TextureSample trilinear = sampleTexture(texture, settings, point);
        settings.minification = Minification::anisotropic;
        const glm::vec4 probed = sampleTexture(texture, settings, point).color;
        bool sane = true;
        for (int c = 0; c < 4; ++c)
            sane = sane && probed[c] >= 1 && probed[c] <= 2;
        tally.add(error(sampleTrilinearNaive(texture, point)), sane ? error(trilinear.color) : infinity,
                  [&] { return describe(point, texture.width(), texture.height()); });
    }
    return tally.figures();
}

}  // namespace

std::span<const HardCase> textureHardCases() {
    static constexpr HardCase cases[] = {
        {"nearestTexel", "beside 0, at texels' borders, 2^24 … 2^120", "texels", 0,
         "⌊s · side⌋ in double, fmod; OpenGL 3.3, 3.8.11", &runNearest},
        {"linearTexels", "the same", "texels", 0x1p-52, "s · side − ½ in double", &runLinear},
        {"lerp", "t = 0 and 1, equal and neighbouring ends, ±3e38", "ulp of the larger end", 0.5 + 0x1p-26,
         "(1 − t) a + t b in double, rounded once", &runLerp},
        {"levelOfDetail", "derivatives 0, infinite, NaN, 2^-140 … 2^120", "levels", 1e-13,
         "squares in double; OpenGL 3.3, 3.8.11", &runLevel},
        {"mipLevelCount", "powers of two and their neighbours", "levels", 0, "bits of the longer side",
         &runLevelCount},
        {"makeMipmaps", "odd sides, ramps, noise: the last level", "codes", 0.5001,
         "floats to the end, shares of three texels; Guthe, Heckbert 2005", &runChain},
        {"sinc", "at and beside whole numbers up to 4096", "absolute", 4e-16,
         "x less its nearest whole number", &runSinc},
        {"periodicSinc", "at and beside whole numbers and periods", "absolute", 1e-15,
         "x less its nearest period", &runPeriodicSinc},
        {"footprintOf", "derivatives 2^-20 … 2^-1 rad apart", "relative error", 1e-15,
         "short axis by the determinant of exact products", &runFootprint},
        {"sampleTexture", "1×1 to 16×16, all of the above at once", "of texels in 1…2", 1.3e-7,
         "OpenGL 3.3, 3.8.11, in double", &runSample},
    };
    return cases;
}

}  // namespace quincunx
