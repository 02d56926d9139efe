#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <vector>

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#ifdef __SSE2__
#include <immintrin.h>
#endif

#include "image/color.h"
#include "image/compare.h"
#include "image/same_shape.h"

// Vectors wider than the machine's are split by the compiler; none crosses a call, so that the changed ABI
// that the warning is about does not matter.
#pragma GCC diagnostic ignored "-Wpsabi"

namespace quincunx {
namespace {

#define QX_INLINE [[gnu::always_inline]] inline

constexpr int lanes = 8;
using Floats = float __attribute__((vector_size(lanes * sizeof(float))));
using Ints = std::int32_t __attribute__((vector_size(lanes * sizeof(float))));

QX_INLINE Floats load(const float* from) {
    Floats value;
    std::memcpy(&value, from, sizeof value);
    return value;
}

QX_INLINE void store(float* to, const Floats& value) {
    std::memcpy(to, &value, sizeof value);
}

QX_INLINE Floats broadcast(float value) {
    return value - Floats{};
}

QX_INLINE Floats smaller(const Floats& a, const Floats& b) {
    return a < b ? a : b;
}

QX_INLINE Floats larger(const Floats& a, const Floats& b) {
    return a > b ? a : b;
}

QX_INLINE Floats magnitude(const Floats& a) {
    return larger(a, -a);
}

QX_INLINE Floats squareRoot(const Floats& a) {
    Floats root;
#ifdef __SSE2__
    for (int half = 0; half < 2; ++half) {
        __m128 four;
        std::memcpy(&four, reinterpret_cast<const char*>(&a) + 16 * half, 16);
        four = _mm_sqrt_ps(four);
        std::memcpy(reinterpret_cast<char*>(&root) + 16 * half, &four, 16);
    }
#else
    for (int lane = 0; lane < lanes; ++lane)
        root[lane] = std::sqrt(a[lane]);
#endif
    return root;
}

/// t^(1/3) for t in [2^-8, 1]. The guess divides the bits by 3, as a logarithm, and is within 6 %; Halley's
/// step takes a relative error e to 2/3 e³: 1.5e-4, then 3e-12, below the rounding of float (6e-8).
QX_INLINE Floats cubeRoot(const Floats& t) {
    Ints bits;
    std::memcpy(&bits, &t, sizeof bits);
    constexpr float guessAtZero = 709921077.0F;  // 2/3 of the bits of 1, less what evens out the error
    const Ints guess =
        __builtin_convertvector(__builtin_convertvector(bits, Floats) * (1.0F / 3) + guessAtZero, Ints);
    Floats root;
    std::memcpy(&root, &guess, sizeof root);
    for (int step = 0; step < 2; ++step) {
        const Floats cube = root * root * root;
        root = root * ((cube + 2 * t) / (2 * cube + t));
    }
    return root;
}

/// log2 of normal positive numbers. With v = 2^e m, m in [√½, √2) and s = (m − 1) / (m + 1), |s| ≤ 0.1716:
/// log2 m = 2/ln 2 · (s + s³/3 + … + s⁹/9), the rest below 2/ln 2 · s¹¹/11 / (1 − s²) = 1e-9.
QX_INLINE Floats log2Of(const Floats& v) {
    constexpr float scale = 2 / std::numbers::ln2_v<float>;
    constexpr std::int32_t bitsOfRootHalf = std::bit_cast<std::int32_t>(std::numbers::sqrt2_v<float> / 2);
    Ints bits;
    std::memcpy(&bits, &v, sizeof bits);
    const Ints exponent = (bits - bitsOfRootHalf) >> 23;
    const Ints mantissaBits = bits - (exponent << 23);
    Floats m;
    std::memcpy(&m, &mantissaBits, sizeof m);
    const Floats s = (m - 1.0F) / (m + 1.0F);
    const Floats s2 = s * s;
    const Floats series =
        s * (scale + s2 * (scale / 3 + s2 * (scale / 5 + s2 * (scale / 7 + s2 * (scale / 9)))));
    return __builtin_convertvector(exponent, Floats) + series;
}

/// 2^x for x in [−126, 126]: the series of exp to x⁷ on [−½, ½] leaves (½ ln 2)⁸/8! = 5e-9.
QX_INLINE Floats exp2Of(const Floats& x) {
    constexpr float ln2 = std::numbers::ln2_v<float>;
    constexpr float toInteger = 12582912;  // 1.5 · 2^23: what is added to it is rounded to an integer
    const Floats n = (x + toInteger) - toInteger;
    const Floats f = (x - n) * ln2;
    const Floats power =
        1.0F +
        f * (1.0F +
             f * (1.0F / 2 + f * (1.0F / 6 + f * (1.0F / 24 +
                                                  f * (1.0F / 120 + f * (1.0F / 720 + f * (1.0F / 5040)))))));
    const Ints scaleBits = (__builtin_convertvector(n, Ints) + 127) << 23;
    Floats scale;
    std::memcpy(&scale, &scaleBits, sizeof scale);
    return power * scale;
}

/// base^exponent for base ≥ 0, exponent in (0, 1]; 0 for bases below the normal numbers.
QX_INLINE Floats power(const Floats& base, const Floats& exponent) {
    constexpr float smallest = std::numeric_limits<float>::min();
    const Floats result = exp2Of(exponent * log2Of(larger(base, broadcast(smallest))));
    return base < smallest ? Floats{} : result;
}

using Matrix = std::array<std::array<double, 3>, 3>;

constexpr double determinant(const Matrix& m) {
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
           m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
           m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
}

constexpr Matrix inverse(const Matrix& m) {
    Matrix result{};
    for (std::size_t row = 0; row < 3; ++row) {
        for (std::size_t column = 0; column < 3; ++column) {
            const std::size_t r1 = (column + 1) % 3;
            const std::size_t r2 = (column + 2) % 3;
            const std::size_t c1 = (row + 1) % 3;
            const std::size_t c2 = (row + 2) % 3;
            result[row][column] = (m[r1][c1] * m[r2][c2] - m[r1][c2] * m[r2][c1]) / determinant(m);
        }
    }
    return result;
}

/// CIE XYZ over the white's XYZ from linear RGB, so that white is (1, 1, 1): from the chromaticities of the
/// sRGB primaries (IEC 61966-2-1) and of D65 in five digits (CIE 15), as the authors have it.
constexpr Matrix whiteXyzFromRgb() {
    constexpr double primaries[3][2] = {{0.64, 0.33}, {0.30, 0.60}, {0.15, 0.06}};
    constexpr double whiteChromaticity[2] = {0.31271, 0.32902};
    const auto xyz = [](const double* chromaticity) {
        return std::array<double, 3>{chromaticity[0] / chromaticity[1], 1,
                                     (1 - chromaticity[0] - chromaticity[1]) / chromaticity[1]};
    };
    const std::array<double, 3> white = xyz(whiteChromaticity);
    Matrix m{};
    for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t row = 0; row < 3; ++row)
            m[row][column] = xyz(primaries[column])[row];
    const Matrix solve = inverse(m);
    for (std::size_t column = 0; column < 3; ++column) {
        double brightness = 0;
        for (std::size_t i = 0; i < 3; ++i)
            brightness += solve[column][i] * white[i];
        for (std::size_t row = 0; row < 3; ++row)
            m[row][column] *= brightness / white[row];
    }
    return m;
}

struct FloatMatrix {
    float m[3][3];
};

constexpr FloatMatrix toFloat(const Matrix& matrix) {
    FloatMatrix result{};
    for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 3; ++column)
            result.m[row][column] = static_cast<float>(matrix[row][column]);
    return result;
}

constexpr FloatMatrix xyzFromRgb = toFloat(whiteXyzFromRgb());
constexpr FloatMatrix rgbFromXyz = toFloat(inverse(whiteXyzFromRgb()));

/// Constants of the paper, sections 4.1.2, 4.1.3 and 4.2.
constexpr double colourExponent = 0.7;         // q_c
constexpr double colourKnee = 0.4;             // p_c: of the largest distance
constexpr double valueAtKnee = 0.95;           // p_t
constexpr double featureWidthDegrees = 0.082;  // w
// q_f = 0.5 is written as a square root.

/// The largest Hunt-adjusted distance between colours of the sRGB cube to the power q_c: green against blue.
double largestColourDistance() {
    constexpr Matrix m = whiteXyzFromRgb();
    std::array<double, 3> lab[2];
    for (std::size_t primary = 1; primary <= 2; ++primary) {
        std::array<double, 3> f{};
        for (std::size_t row = 0; row < 3; ++row) {
            const double t = m[row][primary];
            f[row] = t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116;
        }
        const double lightness = 116 * f[1] - 16;
        lab[primary - 1] = {lightness, 5 * lightness * (f[0] - f[1]), 2 * lightness * (f[1] - f[2])};
    }
    const double distance =
        std::abs(lab[0][0] - lab[1][0]) + std::hypot(lab[0][1] - lab[1][1], lab[0][2] - lab[1][2]);
    return std::pow(distance, colourExponent);
}

/// Weights of a symmetric or antisymmetric filter at 0, 1, 2 … pixels from its middle.
using HalfFilter = std::vector<float>;

/// Σ over the whole filter of its magnitudes.
double wholeSum(const std::vector<double>& half) {
    double sum = std::abs(half[0]);
    for (std::size_t i = 1; i < half.size(); ++i)
        sum += 2 * std::abs(half[i]);
    return sum;
}

HalfFilter scaled(const std::vector<double>& half, double factor) {
    HalfFilter result;
    for (const double weight : half)
        result.push_back(static_cast<float>(weight * factor));
    return result;
}

/// All filters of FLIP, separated into rows and columns. The filter of Cz is a sum of two Gaussians in two
/// dimensions: two pairs of row and column, each Gaussian its own row and column.
struct Filters {
    HalfFilter y;            ///< contrast sensitivity, achromatic
    HalfFilter cx;           ///< red–green
    HalfFilter cz1, cz2;     ///< blue–yellow
    HalfFilter gauss, edge;  ///< features: smoothing across, first derivative along
    HalfFilter point;        ///< second derivative along, applied to differences from the middle pixel: its
                             ///< weights sum to 0, and so do its products on an even area, exactly
    int radius = 0;          ///< of the longest, pixels
};

/// e^(−π² x² / b), the paper's form of a Gaussian of frequency width b, at `radius` + 1 pixels.
std::vector<double> gaussian(double b, int radius, double pixelsPerDegree) {
    std::vector<double> weights;
    for (int i = 0; i <= radius; ++i) {
        const double degrees = i / pixelsPerDegree;
        weights.push_back(std::exp(-std::numbers::pi * std::numbers::pi * degrees * degrees / b));
    }
    return weights;
}

/// Cut where all further weights together stay below the rounding of float.
HalfFilter normalized(std::vector<double> half) {
    const double sum = wholeSum(half);
    double tail = 0;
    while (half.size() > 1 && tail + 2 * half.back() / sum < 0x1p-26) {
        tail += 2 * half.back() / sum;
        half.pop_back();
    }
    return scaled(half, 1 / wholeSum(half));
}

Filters makeFilters(double pixelsPerDegree) {
    // Table 1 of the paper: a and b of each Gaussian. An amplitude a of frequency becomes a √(π/b) of angle.
    constexpr double bY = 0.0047;
    constexpr double bCx = 0.0053;
    constexpr double aCz1 = 34.1;
    constexpr double bCz1 = 0.04;
    constexpr double aCz2 = 13.5;
    constexpr double bCz2 = 0.025;
    const double widestDeviation = std::sqrt(bCz1 / (2 * std::numbers::pi * std::numbers::pi));
    const int spatialRadius = static_cast<int>(std::ceil(3 * widestDeviation * pixelsPerDegree));
    Filters filters;
    filters.y = normalized(gaussian(bY, spatialRadius, pixelsPerDegree));
    filters.cx = normalized(gaussian(bCx, spatialRadius, pixelsPerDegree));
    const std::vector<double> cz1 = gaussian(bCz1, spatialRadius, pixelsPerDegree);
    const std::vector<double> cz2 = gaussian(bCz2, spatialRadius, pixelsPerDegree);
    const double amplitude1 = aCz1 * std::sqrt(std::numbers::pi / bCz1);
    const double amplitude2 = aCz2 * std::sqrt(std::numbers::pi / bCz2);
    const double sum1 = wholeSum(cz1);
    const double sum2 = wholeSum(cz2);
    const double volume = amplitude1 * sum1 * sum1 + amplitude2 * sum2 * sum2;
    filters.cz1 = scaled(cz1, std::sqrt(amplitude1 / volume));
    filters.cz2 = scaled(cz2, std::sqrt(amplitude2 / volume));

    const double deviation = 0.5 * featureWidthDegrees * pixelsPerDegree;
    const int featureRadius = static_cast<int>(std::ceil(3 * deviation));
    std::vector<double> gauss;
    std::vector<double> edge;
    std::vector<double> point;
    for (int i = 0; i <= featureRadius; ++i) {
        const double x2 = i * i / (deviation * deviation);
        gauss.push_back(std::exp(-x2 / 2));
        edge.push_back(i * gauss.back());
        point.push_back((x2 - 1) * gauss.back());
    }
    filters.gauss = scaled(gauss, 1 / wholeSum(gauss));
    filters.edge = scaled(edge, 2 / wholeSum(edge));
    // The weights of each sign sum to 1 and −1.
    double positive = 0;
    double negative = 0;
    for (std::size_t i = 0; i < point.size(); ++i)
        (point[i] > 0 ? positive : negative) += (i == 0 ? 1 : 2) * std::abs(point[i]);
    for (double& weight : point)
        weight /= weight > 0 ? positive : negative;
    filters.point = scaled(point, 1);
    filters.radius = std::max(spatialRadius, featureRadius);
    return filters;
}

/// How an image's row becomes linear RGB in three planes.
struct Source8 {
    explicit Source8(const Image8& picture)
        : image(picture), colours(picture.channels >= 3), step(static_cast<std::size_t>(picture.channels)) {
        for (int code = 0; code < 256; ++code)
            linear[static_cast<std::size_t>(code)] = picture.encoding == Encoding::srgb
                                                         ? linearOfCode()[static_cast<std::size_t>(code)]
                                                         : static_cast<float>(code) / 255;
    }

    void readRow(int y, int x0, int count, float* r, float* g, float* b) const {
        const std::uint8_t* pixel = image.pixel(x0, y);
        for (int i = 0; i < count; ++i, pixel += step) {
            r[i] = linear[pixel[0]];
            g[i] = linear[pixel[colours ? 1 : 0]];
            b[i] = linear[pixel[colours ? 2 : 0]];
        }
    }

    static bool hasNan(int, int) { return false; }

    const Image8& image;
    bool colours;
    std::size_t step;
    std::array<float, 256> linear{};
};

struct SourceFloat {
    explicit SourceFloat(const Image& picture) : image(picture) {}

    void readRow(int y, int x0, int count, float* r, float* g, float* b) const {
        const bool colours = image.channels >= 3;
        const auto value = [&](const float* channel) {
            if (image.encoding == Encoding::srgb)
                return linearFromSrgb(*channel);
            return *channel > 0 ? std::min(*channel, 1.0F) : 0.0F;
        };
        for (int i = 0; i < count; ++i) {
            const float* const pixel = image.pixel(x0 + i, y);
            r[i] = value(pixel);
            g[i] = value(pixel + (colours ? 1 : 0));
            b[i] = value(pixel + (colours ? 2 : 0));
        }
    }

    bool hasNan(int x, int y) const {
        const float* const pixel = image.pixel(x, y);
        return std::any_of(pixel, pixel + (image.channels >= 3 ? 3 : 1),
                           [](float value) { return std::isnan(value); });
    }

    const Image& image;
};

/// Pixels of one task: wide enough to spare the borders that neighbours share, narrow enough for the rows
/// that the vertical filters need to stay in a second-level cache (21 rows of 2 × 7 planes: 300 kB).
constexpr int tileWidth = 256;
constexpr int tileHeight = 256;

enum Plane { planeY, planeCx, planeCz1, planeCz2, planeEdge, planePoint, planeGauss, planeCount };

/// What a thread works in.
struct Scratch {
    std::vector<float> red, green, blue;  ///< one row with borders; then Y, Cx and Cz
    std::vector<float> rings[2];          ///< rows filtered along x: [row mod ring][plane][x]
};

struct Tile {
    int x0, y0, x1, y1;
};

struct Frame {
    const Filters& filters;
    int width, height;
    int ringRows;
    float largest;  ///< largest colour distance

    float* ringRow(std::vector<float>& ring, int y) const {
        return ring.data() + static_cast<std::size_t>(y % ringRows) * planeCount * tileWidth;
    }
};

/// `source`'s row y about the tile, as Y, Cx, Cz in units in which white is (1, 0, 0), into the three planes.
template <typename Source>
QX_INLINE void readOpponent(const Source& source, const Frame& frame, const Tile& tile, int y,
                            Scratch& scratch) {
    const int radius = frame.filters.radius;
    const int first = std::max(tile.x0 - radius, 0);
    const int last = std::min(tile.x1 + radius, frame.width);
    const int before = first - (tile.x0 - radius);
    const int total = tileWidth + 2 * radius;
    float* const planes[3] = {scratch.red.data(), scratch.green.data(), scratch.blue.data()};
    source.readRow(y, first, last - first, planes[0] + before, planes[1] + before, planes[2] + before);
    const int end = before + last - first;
    for (float* const plane : planes) {
        std::fill(plane, plane + before, plane[before]);
        std::fill(plane + end, plane + total, plane[end - 1]);
    }
    for (int x = 0; x < total; x += lanes) {
        const Floats r = load(planes[0] + x);
        const Floats g = load(planes[1] + x);
        const Floats b = load(planes[2] + x);
        Floats xyz[3];
        for (int row = 0; row < 3; ++row)
            xyz[row] = xyzFromRgb.m[row][0] * r + xyzFromRgb.m[row][1] * g + xyzFromRgb.m[row][2] * b;
        store(planes[0] + x, xyz[1]);
        store(planes[1] + x, xyz[0] - xyz[1]);
        store(planes[2] + x, xyz[1] - xyz[2]);
    }
}

/// All filters along x.
QX_INLINE void filterRow(const Frame& frame, int width, const Scratch& scratch, float* to) {
    const Filters& filters = frame.filters;
    const int radius = filters.radius;
    for (int x = 0; x < width; x += lanes) {
        const float* const y = scratch.red.data() + radius + x;
        const float* const cx = scratch.green.data() + radius + x;
        const float* const cz = scratch.blue.data() + radius + x;
        const Floats middle = load(y);
        Floats sumY = filters.y[0] * middle;
        for (int k = 1; k < static_cast<int>(filters.y.size()); ++k)
            sumY += filters.y[k] * (load(y - k) + load(y + k));
        Floats sumCx = filters.cx[0] * load(cx);
        for (int k = 1; k < static_cast<int>(filters.cx.size()); ++k)
            sumCx += filters.cx[k] * (load(cx - k) + load(cx + k));
        Floats sumCz1 = filters.cz1[0] * load(cz);
        Floats sumCz2 = filters.cz2[0] * load(cz);
        for (int k = 1; k < static_cast<int>(filters.cz1.size()); ++k) {
            const Floats both = load(cz - k) + load(cz + k);
            sumCz1 += filters.cz1[k] * both;
            sumCz2 += filters.cz2[k] * both;
        }
        Floats edge{};
        Floats point{};
        Floats gauss = filters.gauss[0] * middle;
        for (int k = 1; k < static_cast<int>(filters.gauss.size()); ++k) {
            const Floats left = load(y - k);
            const Floats right = load(y + k);
            const Floats both = left + right;
            edge += filters.edge[k] * (right - left);
            point += filters.point[k] * (both - 2 * middle);
            gauss += filters.gauss[k] * both;
        }
        store(to + planeY * tileWidth + x, sumY);
        store(to + planeCx * tileWidth + x, sumCx);
        store(to + planeCz1 * tileWidth + x, sumCz1);
        store(to + planeCz2 * tileWidth + x, sumCz2);
        store(to + planeEdge * tileWidth + x, edge);
        store(to + planePoint * tileWidth + x, point);
        store(to + planeGauss * tileWidth + x, gauss);
    }
}

struct Perceived {
    Floats lightness, a, b;  ///< CIELAB, a and b times L/100 (Hunt)
    Floats edge, point;      ///< strength of features
};

/// CIELAB's f.
QX_INLINE Floats labCurve(const Floats& t) {
    constexpr float knee = 216.0F / 24389;
    const Floats root = cubeRoot(larger(t, broadcast(knee)));
    return t > knee ? root : (24389.0F / (27 * 116)) * t + 16.0F / 116;
}

/// Eight pixels of the filtered row `k` below the current one.
struct Column {
    const float* const* rows;
    int x;

    QX_INLINE Floats operator()(int k, Plane plane) const { return load(rows[k] + plane * tileWidth + x); }
};

/// All filters along y, and the colour and features that they give. `rows[radius + k]` is the row k below.
QX_INLINE Perceived perceive(const Filters& filters, const float* const* rows, int x) {
    const Column at{rows + filters.radius, x};
    Floats y = filters.y[0] * at(0, planeY);
    for (int k = 1; k < static_cast<int>(filters.y.size()); ++k)
        y += filters.y[k] * (at(-k, planeY) + at(k, planeY));
    Floats cx = filters.cx[0] * at(0, planeCx);
    for (int k = 1; k < static_cast<int>(filters.cx.size()); ++k)
        cx += filters.cx[k] * (at(-k, planeCx) + at(k, planeCx));
    Floats cz1 = filters.cz1[0] * at(0, planeCz1);
    Floats cz2 = filters.cz2[0] * at(0, planeCz2);
    for (int k = 1; k < static_cast<int>(filters.cz1.size()); ++k) {
        cz1 += filters.cz1[k] * (at(-k, planeCz1) + at(k, planeCz1));
        cz2 += filters.cz2[k] * (at(-k, planeCz2) + at(k, planeCz2));
    }
    Floats edgeX = filters.gauss[0] * at(0, planeEdge);
    Floats pointX = filters.gauss[0] * at(0, planePoint);
    Floats edgeY{};
    Floats pointY{};
    const Floats middle = at(0, planeGauss);
    for (int k = 1; k < static_cast<int>(filters.gauss.size()); ++k) {
        edgeX += filters.gauss[k] * (at(-k, planeEdge) + at(k, planeEdge));
        pointX += filters.gauss[k] * (at(-k, planePoint) + at(k, planePoint));
        const Floats above = at(-k, planeGauss);
        const Floats below = at(k, planeGauss);
        edgeY += filters.edge[k] * (below - above);
        pointY += filters.point[k] * ((above + below) - 2 * middle);
    }

    const Floats xyz[3] = {y + cx, y, y - (cz1 + cz2)};
    Floats rgb[3];
    for (int row = 0; row < 3; ++row) {
        const Floats value =
            rgbFromXyz.m[row][0] * xyz[0] + rgbFromXyz.m[row][1] * xyz[1] + rgbFromXyz.m[row][2] * xyz[2];
        rgb[row] = smaller(larger(value, Floats{}), broadcast(1));
    }
    Floats f[3];
    for (int row = 0; row < 3; ++row)
        f[row] = labCurve(xyzFromRgb.m[row][0] * rgb[0] + xyzFromRgb.m[row][1] * rgb[1] +
                          xyzFromRgb.m[row][2] * rgb[2]);
    const Floats lightness = 116.0F * f[1] - 16.0F;
    return {lightness, 5.0F * lightness * (f[0] - f[1]), 2.0F * lightness * (f[1] - f[2]),
            squareRoot(edgeX * edgeX + edgeY * edgeY), squareRoot(pointX * pointX + pointY * pointY)};
}

/// The FLIP error of eight pixels.
QX_INLINE Floats difference(const Perceived& reference, const Perceived& test, float largest) {
    const Floats da = reference.a - test.a;
    const Floats db = reference.b - test.b;
    const Floats distance = magnitude(reference.lightness - test.lightness) + squareRoot(da * da + db * db);
    const Floats raised = power(distance, broadcast(static_cast<float>(colourExponent)));
    const float knee = static_cast<float>(colourKnee) * largest;
    constexpr float atKnee = static_cast<float>(valueAtKnee);
    const Floats below = raised * (atKnee / knee);
    const Floats above = atKnee + (raised - knee) * ((1 - atKnee) / (largest - knee));
    const Floats colour = smaller(raised < knee ? below : above, broadcast(1));
    const Floats feature =
        larger(magnitude(reference.edge - test.edge), magnitude(reference.point - test.point));
    const Floats featureError =
        smaller(squareRoot(feature * (std::numbers::sqrt2_v<float> / 2)), broadcast(1));
    return power(colour, 1.0F - featureError);
}

/// Sum of the errors in a tile; the errors themselves too if `map` is not null.
template <typename Source>
QX_INLINE double compareTileInline(const Source& reference, const Source& test, const Frame& frame,
                                   const Tile& tile, Scratch& scratch, float* map) {
    const int radius = frame.filters.radius;
    const int width = tile.x1 - tile.x0;
    std::vector<const float*> rows[2];
    for (std::vector<const float*>& pointers : rows)
        pointers.resize(static_cast<std::size_t>(frame.ringRows));
    int filtered = std::max(tile.y0 - radius, 0);  // next row to filter along x
    double sum = 0;
    for (int y = tile.y0; y < tile.y1; ++y) {
        for (; filtered <= std::min(y + radius, frame.height - 1); ++filtered) {
            readOpponent(reference, frame, tile, filtered, scratch);
            filterRow(frame, width, scratch, frame.ringRow(scratch.rings[0], filtered));
            readOpponent(test, frame, tile, filtered, scratch);
            filterRow(frame, width, scratch, frame.ringRow(scratch.rings[1], filtered));
        }
        for (int image = 0; image < 2; ++image)
            for (int k = -radius; k <= radius; ++k)
                rows[image][static_cast<std::size_t>(radius + k)] =
                    frame.ringRow(scratch.rings[image], std::clamp(y + k, 0, frame.height - 1));
        for (int x = 0; x < width; x += lanes) {
            const Floats error = difference(perceive(frame.filters, rows[0].data(), x),
                                            perceive(frame.filters, rows[1].data(), x), frame.largest);
            float errors[lanes];
            store(errors, error);
            for (int lane = 0; lane < std::min(lanes, width - x); ++lane) {
                const int column = tile.x0 + x + lane;
                if (reference.hasNan(column, y) || test.hasNan(column, y))
                    errors[lane] = 1;
                sum += static_cast<double>(errors[lane]);
                if (map != nullptr)
                    map[static_cast<std::size_t>(y) * static_cast<std::size_t>(frame.width) +
                        static_cast<std::size_t>(column)] = errors[lane];
            }
        }
    }
    return sum;
}

template <typename Source>
double compareTileAnywhere(const Source& reference, const Source& test, const Frame& frame, const Tile& tile,
                           Scratch& scratch, float* map) {
    return compareTileInline(reference, test, frame, tile, scratch, map);
}

#ifdef __x86_64__
/// The same operations in the same order, so the same bits, in wider registers.
template <typename Source>
[[gnu::target("avx2")]] double compareTileAvx2(const Source& reference, const Source& test,
                                               const Frame& frame, const Tile& tile, Scratch& scratch,
                                               float* map) {
    return compareTileInline(reference, test, frame, tile, scratch, map);
}
#endif

template <typename Source>
auto chooseCompareTile() {
#ifdef __x86_64__
    if (__builtin_cpu_supports("avx2"))
        return &compareTileAvx2<Source>;
#endif
    return &compareTileAnywhere<Source>;
}

/// Mean error; the errors too if `map` is not null.
template <typename Source, typename Picture>
double compare(const Picture& referencePicture, const Picture& testPicture, const FlipSettings& settings,
               Image* map) {
    requireSameShape(referencePicture, testPicture);
    // 10^4 pixels a degree make filters of a thousand taps; below 1 the eye sees less than a pixel.
    if (!(settings.pixelsPerDegree >= 1 && settings.pixelsPerDegree <= 10000))
        throw InputError(fmt::format("{} pixels per degree", settings.pixelsPerDegree), {},
                         "choose 1 to 10000");
    if (map != nullptr)
        *map = Image(referencePicture.width, referencePicture.height, 1, Encoding::linear);
    const Filters filters = makeFilters(settings.pixelsPerDegree);
    const Frame frame{filters, referencePicture.width, referencePicture.height, 2 * filters.radius + 1,
                      static_cast<float>(largestColourDistance())};
    const Source reference(referencePicture);
    const Source test(testPicture);
    const int columns = (frame.width + tileWidth - 1) / tileWidth;
    const int rows = (frame.height + tileHeight - 1) / tileHeight;
    std::vector<double> sums(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    const auto compareTile = chooseCompareTile<Source>();
    tbb::enumerable_thread_specific<Scratch> scratches([&] {
        Scratch scratch;
        const std::size_t row = static_cast<std::size_t>(tileWidth + 2 * filters.radius + lanes);
        for (std::vector<float>* plane : {&scratch.red, &scratch.green, &scratch.blue})
            plane->resize(row);
        for (std::vector<float>& ring : scratch.rings)
            ring.resize(static_cast<std::size_t>(frame.ringRows) * planeCount * tileWidth);
        return scratch;
    });
    tbb::parallel_for(0, columns * rows, [&](int i) {
        const int x0 = i % columns * tileWidth;
        const int y0 = i / columns * tileHeight;
        const Tile tile{x0, y0, std::min(x0 + tileWidth, frame.width),
                        std::min(y0 + tileHeight, frame.height)};
        sums[static_cast<std::size_t>(i)] = compareTile(reference, test, frame, tile, scratches.local(),
                                                        map != nullptr ? map->data.data() : nullptr);
    });
    double sum = 0;
    for (const double part : sums)
        sum += part;
    return sum / static_cast<double>(referencePicture.pixelCount());
}

}  // namespace

double flip(const Image8& reference, const Image8& test, const FlipSettings& settings) {
    return compare<Source8>(reference, test, settings, nullptr);
}

double flip(const Image& reference, const Image& test, const FlipSettings& settings) {
    return compare<SourceFloat>(reference, test, settings, nullptr);
}

Image flipMap(const Image8& reference, const Image8& test, const FlipSettings& settings) {
    Image map;
    compare<Source8>(reference, test, settings, &map);
    return map;
}

Image flipMap(const Image& reference, const Image& test, const FlipSettings& settings) {
    Image map;
    compare<SourceFloat>(reference, test, settings, &map);
    return map;
}

}  // namespace quincunx
