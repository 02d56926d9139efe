#pragma once

#include <cmath>
#include <optional>

#include <glm/glm.hpp>

/// The way of a vertex: model → world → eye → clip → normalized device coordinates (NDC) → window, and back.
/// Column vectors, `a_from_b * b`. The eye looks along −z of its frame; NDC is the cube [−1, 1]³ with z = −1
/// at the near plane; window coordinates are pixels from the lower left corner (centres at halves) and a
/// depth.
namespace quincunx {

/// What a homogeneous point (x, y, z, w) stands for.
enum class HomogeneousKind {
    point = 0,   ///< w > 0: the point p / w
    behind = 1,  ///< w < 0: p / w too, but behind the eye; what is drawn there is upside down, so clip first
    direction,   ///< w = 0, or p / w beyond the range: a point at infinity, given as its unit direction
    nothing,     ///< (0, 0, 0, 0), or not finite: no point at all, given as zero
};

/// The result of the division by w. `value` is finite whatever came in.
template <typename Float>
struct BasicHomogenized {
    HomogeneousKind kind = HomogeneousKind::nothing;
    glm::vec<3, Float> value{0};

    bool isPoint() const { return kind == HomogeneousKind::point || kind == HomogeneousKind::behind; }
};
using Homogenized = BasicHomogenized<float>;
using HomogenizedInDouble = BasicHomogenized<double>;

namespace detail {
Homogenized homogenizeFarAway(glm::vec4 p);
}

/// p / w by true division, each component to 0.5 ulp (IEEE), with subnormal w too. It takes the time of the
/// three divisions and as much again to say what came out (bench_vector). Held by Homogenize.*.
inline Homogenized homogenize(glm::vec4 p) {
    Homogenized result;
    const float x = p.x / p.w;
    const float y = p.y / p.w;
    const float z = p.z / p.w;
    result.kind = static_cast<HomogeneousKind>(std::signbit(p.w));
    result.value.x = x;
    result.value.y = y;
    result.value.z = z;
    // Zero unless a quotient is not finite (w = 0, beyond the range, not finite input) or w is infinite.
    const float probe = (x - x) + (y - y) + (z - z) + (p.w - p.w);
    if (probe != 0) [[unlikely]]
        result = detail::homogenizeFarAway(p);
    return result;
}
HomogenizedInDouble homogenize(glm::dvec4 p);

/// p times the reciprocal of w, in float.
glm::vec3 homogenizeNaive(glm::vec4 p);

/// The matrix that scales points uniformly by d > 0 (finite; a bug otherwise) through the division by w:
/// diag(s, s, s, s / d) with s the largest power of two ≤ d, so that s / d is in (½, 1] and neither overflows
/// nor vanishes. After `homogenize` a scaled point is within 1.5 ulp of x d (the rounding of s / d is worth
/// less than 1), and where the result is below 2^-125 within 2.5, since x s may be subnormal already.
/// Directions (w = 0) keep their w, so they are scaled by s alone and stay the same directions. Held by
/// ScaleThroughW.*.
glm::mat4 scaleThroughW(float d);

/// diag(1, 1, 1, 1 / d).
glm::mat4 scaleThroughWNaive(float d);

/// The pixels that NDC's square is stretched over, and the depths of its ends.
struct Viewport {
    double x = 0;       ///< left edge, pixels
    double y = 0;       ///< lower edge, pixels
    double width = 1;   ///< pixels, > 0
    double height = 1;  ///< pixels, > 0
    double nearDepth = 0;
    double farDepth = 1;  ///< ≠ nearDepth
};

/// The viewport as a matrix, windowFromNdc. Each entry to 0.5 ulp. Held by Spaces.*.
glm::mat4 viewportMatrix(const Viewport& viewport);

/// All that stands between a model and the pixels.
struct SpaceChain {
    glm::mat4 worldFromModel{1};
    glm::mat4 eyeFromWorld{1};
    glm::mat4 clipFromEye{1};
    Viewport viewport;
};

/// One vertex in all six spaces.
struct VertexInSpaces {
    glm::dvec4 model{0};
    glm::dvec4 world{0};
    glm::dvec4 eye{0};
    glm::dvec4 clip{0};
    HomogenizedInDouble ndc;
    std::optional<glm::dvec3> window;  ///< none unless w > 0
    bool inView = false;               ///< −w ≤ x, y, z ≤ w and w > 0: not clipped
};

/// The vertex in double from the matrices as they are; nothing is rounded to float in between. Each step is
/// within 2^-51 of Σ|product| of its entry. Held by Spaces.*.
VertexInSpaces throughSpaces(const SpaceChain& chain, glm::dvec3 model);

/// Where in the window a model's point is drawn: the last step of `throughSpaces`, rounded once. None if the
/// point is behind the eye or in its plane, or not in the range of float. Held by Spaces.*.
std::optional<glm::vec3> windowFromModel(const SpaceChain& chain, glm::vec3 model);

/// The model's point that is drawn at a window position with a depth: the steps undone one by one in double,
/// each by elimination with complete pivoting after scaling by powers of two. With P the perspective of
/// near n and far f, and rigid or uniformly scaled placements, the point is within 2^-23 |p| + 2^-48 (f/n) D
/// of exact in model units, D the distance to the eye plus those of eye and model from the world's origin.
/// None if a matrix is singular, if the point lies at infinity, or if something is not finite. Held by
/// Unproject.*.
std::optional<glm::vec3> modelFromWindow(const SpaceChain& chain, glm::dvec3 window);

/// By the inverse of the product of the three matrices, all in float.
glm::vec3 modelFromWindowNaive(const SpaceChain& chain, glm::vec3 window);

/// The placement of a model as seen from an eye in a large world: both placed in double, subtracted in
/// double, and rounded once, so that float arithmetic sees small numbers only. `worldFromEye` is rigid. With
/// u = 2^-53 and d the largest coordinate of both origins, the translation is within half an ulp plus 8 u d.
/// A vertex then lands within 0.001 of a 1920-pixel picture's pixels for worlds of 1e8 units and models some
/// ten units across. Held by LargeWorld.*.
glm::mat4 eyeFromModel(const glm::dmat4& worldFromModel, const glm::dmat4& worldFromEye);

/// The same with both placements rounded to float first.
glm::mat4 eyeFromModelNaive(const glm::dmat4& worldFromModel, const glm::dmat4& worldFromEye);

}  // namespace quincunx
