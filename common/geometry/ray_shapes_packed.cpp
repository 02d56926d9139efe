#include "geometry/ray_shapes_packed.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "base/check.h"
#include "base/vector_units.h"

namespace quincunx {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float epsilon = 0x1p-24f;   // the unit roundoff of float
constexpr float accepted = 0x1p-14f;  // the relative error that t may have

struct Components {
    float x;
    float y;
    float z;
};

QUINCUNX_ALWAYS_INLINE float dotted(Components a, Components b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
QUINCUNX_ALWAYS_INLINE Components minus(Components a, Components b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}
QUINCUNX_ALWAYS_INLINE float sumOfSizes(Components a) {
    return std::abs(a.x) + std::abs(a.y) + std::abs(a.z);
}
/// Of what is not a number, both take `b`, as the instructions do.
template <typename T>
QUINCUNX_ALWAYS_INLINE T larger(T a, T b) {
    return a > b ? a : b;
}
template <typename T>
QUINCUNX_ALWAYS_INLINE T smaller(T a, T b) {
    return a < b ? a : b;
}

/// The bounds of `raySphere` with ε in place of u, as long as nothing overflows or loses bits below the
/// smallest normal number: sizes between 2^-30 and 2^30 keep squares and their products in 2^±120, and a
/// bound of ε r² stands far above what underflows.
QUINCUNX_ALWAYS_INLINE float sphereLane(Components o, Components d, Components c, float r,
                                        std::int32_t& doubt) {
    const Components f = minus(c, o);
    const float a = dotted(d, d);
    const float inverse = 1 / a;
    const float middle = dotted(d, f) * inverse;
    const Components l{f.x - middle * d.x, f.y - middle * d.y, f.z - middle * d.z};
    const float gap = r * r - dotted(l, l);
    const float far = sumOfSizes(f);
    const float gapError = epsilon * ((12 * sumOfSizes(l) + 0x1p-16f * far) * far + 4 * (r * r));
    const float half = std::sqrt(larger(gap, 0.0f) * inverse);
    const float reach = far * sumOfSizes(d) * inverse;
    const float nearer = middle - half;
    const float chosen = nearer > 0 ? nearer : middle + half;
    // Times the gap, to spare a division: half · gapError / gap + 8 ε half + 10 ε (…). Beside the sphere it
    // is negative, and then nothing below asks for more.
    const float error = half * gapError + gap * (epsilon * (8 * half + 10 * (reach + std::abs(middle))));
    const float nearerGap = std::abs(nearer * gap);
    const float chosenGap = chosen * gap;
    // Ahead, t has to be good; behind, its sign.
    const float certainty = larger(chosenGap * accepted, -chosenGap);
    const bool settled = (a > 0x1p-60f) & (a < 0x1p60f) & (r > 0x1p-30f) & (far + r < 0x1p30f) &
                         (std::abs(gap) > gapError) & (std::abs(error) > 0x1p-100f) & (nearerGap > error) &
                         (certainty >= error);
    doubt = settled ? 0 : 1;
    return (gap > 0) & (chosen > 0) ? chosen : infinity;
}

QUINCUNX_ALWAYS_INLINE float sphereLaneNaive(Components o, Components d, Components c, float r) {
    const Components w = minus(o, c);
    const float a = dotted(d, d);
    const float b = 2 * dotted(w, d);
    const float rest = dotted(w, w) - r * r;
    const float discriminant = b * b - 4 * a * rest;
    const float root = std::sqrt(larger(discriminant, 0.0f));
    const float inverse = 1 / (2 * a);
    const float nearer = (-b - root) * inverse;
    const float farther = (-b + root) * inverse;
    const float t = nearer >= 0 ? nearer : farther;
    return (discriminant >= 0) & (t >= 0) ? t : infinity;
}

/// Where a ray crosses the two planes of a slab. Along the slab, the reciprocal is infinite: −∞ … ∞ inside,
/// and beside it an infinity of either sign twice; in one of its planes 0 · ∞, which is no number, says
/// nothing.
struct Slab {
    float low;
    float high;
};

QUINCUNX_ALWAYS_INLINE Slab slab(float o, float inverse, float low, float high) {
    return {(low - o) * inverse, (high - o) * inverse};
}

/// Whether quotients by these numbers are off by 3 ε of themselves (difference, reciprocal, product), or
/// infinite where they should be: all sizes between 2^-60 and 2^60 or 0, and not all of them 0. The bits of
/// sizes are ordered as the sizes are; less 1, those of 0 come last.
QUINCUNX_ALWAYS_INLINE bool usual(Components d) {
    constexpr std::uint32_t smallest = std::bit_cast<std::uint32_t>(0x1p-60f);
    constexpr std::uint32_t largest = std::bit_cast<std::uint32_t>(0x1p60f);
    const auto size = [](float v) { return std::bit_cast<std::uint32_t>(std::abs(v)); };
    const std::uint32_t x = size(d.x);
    const std::uint32_t y = size(d.y);
    const std::uint32_t z = size(d.z);
    const std::uint32_t least = smaller(smaller(x - 1, y - 1), z - 1);
    const std::uint32_t most = larger(larger(x, y), z);
    return (least >= smallest) & (most - 1 < largest);
}

/// What overflows is an infinity of the right sign, and what underflows is far below 2^-60. Enter e and exit
/// x are off by 3 ε of themselves, and the sign of x − e is right where |x − e| > 8 ε min(|e|, |x|): for
/// equal signs the error is at most 3 ε (2 min(|e|, |x|) + |x − e|), and for different ones |x − e| is |e| +
/// |x|.
QUINCUNX_ALWAYS_INLINE float boxLane(Components o, Components inverse, Components low, Components high,
                                     bool usual, std::int32_t& doubt) {
    const Slab x = slab(o.x, inverse.x, low.x, high.x);
    const Slab y = slab(o.y, inverse.y, low.y, high.y);
    const Slab z = slab(o.z, inverse.z, low.z, high.z);
    const float enter =
        larger(larger(smaller(x.low, x.high), smaller(y.low, y.high)), smaller(z.low, z.high));
    const float exit = smaller(smaller(larger(x.high, x.low), larger(y.high, y.low)), larger(z.high, z.low));
    const float length = exit - enter;
    const float margin = 8 * epsilon * smaller(smaller(std::abs(enter), std::abs(exit)), 0x1p120f);
    const bool settled = usual & !std::isunordered(x.low, x.high) & !std::isunordered(y.low, y.high) &
                         !std::isunordered(z.low, z.high) & (exit < 0x1p120f) & (std::abs(exit) > 0x1p-60f) &
                         (std::abs(length) > margin);
    doubt = settled ? 0 : 1;
    return (length > 0) & (exit > 0) ? larger(enter, 0.0f) : infinity;
}

QUINCUNX_ALWAYS_INLINE float boxLaneNaive(Components o, Components inverse, Components low, Components high) {
    const float x0 = (low.x - o.x) * inverse.x;
    const float x1 = (high.x - o.x) * inverse.x;
    const float y0 = (low.y - o.y) * inverse.y;
    const float y1 = (high.y - o.y) * inverse.y;
    const float z0 = (low.z - o.z) * inverse.z;
    const float z1 = (high.z - o.z) * inverse.z;
    const float enter = larger(larger(smaller(x0, x1), smaller(y0, y1)), smaller(z0, z1));
    const float exit = smaller(smaller(larger(x0, x1), larger(y0, y1)), larger(z0, z1));
    return (enter < exit) & (exit >= 0) ? larger(enter, 0.0f) : infinity;
}

struct Pointers {
    const float* __restrict x;
    const float* __restrict y;
    const float* __restrict z;
};

Pointers pointersOf(const std::array<std::vector<float>, 3>& v, std::size_t begin) {
    return {v[0].data() + begin, v[1].data() + begin, v[2].data() + begin};
}

Components componentsOf(glm::vec3 v) {
    return {v.x, v.y, v.z};
}

QUINCUNX_ALWAYS_INLINE Components reciprocal(Components d) {
    return {1 / d.x, 1 / d.y, 1 / d.z};
}

// Each returns whether any lane is left to the scalar routine; those have 1 in `doubts`, the others 0.

QUINCUNX_FOR_EACH_VECTOR_UNIT
std::int32_t raysToBall(Pointers o, Pointers d, Components c, float r, std::size_t count, float* __restrict t,
                        std::int32_t* __restrict doubts) {
    std::int32_t any = 0;
    for (std::size_t i = 0; i < count; ++i) {
        t[i] = sphereLane({o.x[i], o.y[i], o.z[i]}, {d.x[i], d.y[i], d.z[i]}, c, r, doubts[i]);
        any |= doubts[i];
    }
    return any;
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
std::int32_t rayToBalls(Components o, Components d, Pointers c, const float* __restrict r, std::size_t count,
                        float* __restrict t, std::int32_t* __restrict doubts) {
    std::int32_t any = 0;
    for (std::size_t i = 0; i < count; ++i) {
        t[i] = sphereLane(o, d, {c.x[i], c.y[i], c.z[i]}, r[i], doubts[i]);
        any |= doubts[i];
    }
    return any;
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
std::int32_t raysToBox(Pointers o, Pointers d, Components low, Components high, std::size_t count,
                       float* __restrict t, std::int32_t* __restrict doubts) {
    std::int32_t any = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Components direction{d.x[i], d.y[i], d.z[i]};
        t[i] =
            boxLane({o.x[i], o.y[i], o.z[i]}, reciprocal(direction), low, high, usual(direction), doubts[i]);
        any |= doubts[i];
    }
    return any;
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
std::int32_t rayToBoxes(Components o, Components d, Pointers low, Pointers high, std::size_t count,
                        float* __restrict t, std::int32_t* __restrict doubts) {
    const Components inverse = reciprocal(d);
    std::int32_t any = 0;
    for (std::size_t i = 0; i < count; ++i) {
        t[i] = boxLane(o, inverse, {low.x[i], low.y[i], low.z[i]}, {high.x[i], high.y[i], high.z[i]}, true,
                       doubts[i]);
        any |= doubts[i];
    }
    return any;
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void raysToBallNaive(Pointers o, Pointers d, Components c, float r, std::size_t count, float* __restrict t) {
    for (std::size_t i = 0; i < count; ++i)
        t[i] = sphereLaneNaive({o.x[i], o.y[i], o.z[i]}, {d.x[i], d.y[i], d.z[i]}, c, r);
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void rayToBallsNaive(Components o, Components d, Pointers c, const float* __restrict r, std::size_t count,
                     float* __restrict t) {
    for (std::size_t i = 0; i < count; ++i)
        t[i] = sphereLaneNaive(o, d, {c.x[i], c.y[i], c.z[i]}, r[i]);
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void raysToBoxNaive(Pointers o, Pointers d, Components low, Components high, std::size_t count,
                    float* __restrict t) {
    for (std::size_t i = 0; i < count; ++i)
        t[i] = boxLaneNaive({o.x[i], o.y[i], o.z[i]}, reciprocal({d.x[i], d.y[i], d.z[i]}), low, high);
}

QUINCUNX_FOR_EACH_VECTOR_UNIT
void rayToBoxesNaive(Components o, Components d, Pointers low, Pointers high, std::size_t count,
                     float* __restrict t) {
    const Components inverse = reciprocal(d);
    for (std::size_t i = 0; i < count; ++i)
        t[i] = boxLaneNaive(o, inverse, {low.x[i], low.y[i], low.z[i]}, {high.x[i], high.y[i], high.z[i]});
}

/// Calls `fill(begin, count, doubts)` for block after block, and `settle(index)` for what it says it leaves
/// open.
template <typename Fill, typename Settle>
std::size_t inBlocks(std::size_t size, const Fill& fill, const Settle& settle) {
    constexpr std::size_t blockSize = 256;
    std::array<std::int32_t, blockSize> doubts;
    std::size_t settled = 0;
    for (std::size_t begin = 0; begin < size; begin += blockSize) {
        const std::size_t count = std::min(blockSize, size - begin);
        if (fill(begin, count, doubts.data()) == 0)
            continue;
        for (std::size_t i = 0; i < count; ++i)
            if (doubts[i] != 0) {
                settle(begin + i);
                ++settled;
            }
    }
    return settled;
}

float sphereScalar(const Ray& ray, const Ball& ball) {
    const std::optional<double> t = raySphereDistance(ray, ball);
    return t ? static_cast<float>(*t) : infinity;
}

float boxScalar(const Ray& ray, const Bounds& box) {
    const std::optional<RaySpan> span = rayBox(ray, box);
    return span ? static_cast<float>(span->enter) : infinity;
}

}  // namespace

void BallArrays::add(const Ball& ball) {
    for (int axis = 0; axis < 3; ++axis)
        centre[static_cast<std::size_t>(axis)].push_back(ball.centre[axis]);
    radius.push_back(ball.radius);
}

Ball BallArrays::at(std::size_t index) const {
    return {{centre[0][index], centre[1][index], centre[2][index]}, radius[index]};
}

void BoxArrays::add(const Bounds& box) {
    for (int axis = 0; axis < 3; ++axis) {
        min[static_cast<std::size_t>(axis)].push_back(box.min[axis]);
        max[static_cast<std::size_t>(axis)].push_back(box.max[axis]);
    }
}

Bounds BoxArrays::at(std::size_t index) const {
    return {{min[0][index], min[1][index], min[2][index]}, {max[0][index], max[1][index], max[2][index]}};
}

std::size_t intersectPacked(const RayArrays& rays, const Ball& ball, std::span<float> t) {
    QX_CHECK_EQ(t.size(), rays.size());
    return inBlocks(
        t.size(),
        [&](std::size_t begin, std::size_t count, std::int32_t* doubts) {
            return raysToBall(pointersOf(rays.origin, begin), pointersOf(rays.direction, begin),
                              componentsOf(ball.centre), ball.radius, count, t.data() + begin, doubts);
        },
        [&](std::size_t i) { t[i] = sphereScalar(rays.at(i), ball); });
}

std::size_t intersectPacked(const Ray& ray, const BallArrays& balls, std::span<float> t) {
    QX_CHECK_EQ(t.size(), balls.size());
    return inBlocks(
        t.size(),
        [&](std::size_t begin, std::size_t count, std::int32_t* doubts) {
            return rayToBalls(componentsOf(ray.origin), componentsOf(ray.direction),
                              pointersOf(balls.centre, begin), balls.radius.data() + begin, count,
                              t.data() + begin, doubts);
        },
        [&](std::size_t i) { t[i] = sphereScalar(ray, balls.at(i)); });
}

std::size_t intersectPacked(const RayArrays& rays, const Bounds& box, std::span<float> t) {
    QX_CHECK_EQ(t.size(), rays.size());
    if (box.empty()) {
        std::fill(t.begin(), t.end(), infinity);
        return 0;
    }
    return inBlocks(
        t.size(),
        [&](std::size_t begin, std::size_t count, std::int32_t* doubts) {
            return raysToBox(pointersOf(rays.origin, begin), pointersOf(rays.direction, begin),
                             componentsOf(box.min), componentsOf(box.max), count, t.data() + begin, doubts);
        },
        [&](std::size_t i) { t[i] = boxScalar(rays.at(i), box); });
}

std::size_t intersectPacked(const Ray& ray, const BoxArrays& boxes, std::span<float> t) {
    QX_CHECK_EQ(t.size(), boxes.size());
    if (!usual(componentsOf(ray.direction))) {
        for (std::size_t i = 0; i < t.size(); ++i)
            t[i] = boxScalar(ray, boxes.at(i));
        return t.size();
    }
    return inBlocks(
        t.size(),
        [&](std::size_t begin, std::size_t count, std::int32_t* doubts) {
            return rayToBoxes(componentsOf(ray.origin), componentsOf(ray.direction),
                              pointersOf(boxes.min, begin), pointersOf(boxes.max, begin), count,
                              t.data() + begin, doubts);
        },
        [&](std::size_t i) { t[i] = boxScalar(ray, boxes.at(i)); });
}

void intersectPackedNaive(const RayArrays& rays, const Ball& ball, std::span<float> t) {
    QX_CHECK_EQ(t.size(), rays.size());
    raysToBallNaive(pointersOf(rays.origin, 0), pointersOf(rays.direction, 0), componentsOf(ball.centre),
                    ball.radius, t.size(), t.data());
}

void intersectPackedNaive(const Ray& ray, const BallArrays& balls, std::span<float> t) {
    QX_CHECK_EQ(t.size(), balls.size());
    rayToBallsNaive(componentsOf(ray.origin), componentsOf(ray.direction), pointersOf(balls.centre, 0),
                    balls.radius.data(), t.size(), t.data());
}

void intersectPackedNaive(const RayArrays& rays, const Bounds& box, std::span<float> t) {
    QX_CHECK_EQ(t.size(), rays.size());
    raysToBoxNaive(pointersOf(rays.origin, 0), pointersOf(rays.direction, 0), componentsOf(box.min),
                   componentsOf(box.max), t.size(), t.data());
}

void intersectPackedNaive(const Ray& ray, const BoxArrays& boxes, std::span<float> t) {
    QX_CHECK_EQ(t.size(), boxes.size());
    rayToBoxesNaive(componentsOf(ray.origin), componentsOf(ray.direction), pointersOf(boxes.min, 0),
                    pointersOf(boxes.max, 0), t.size(), t.data());
}

}  // namespace quincunx
