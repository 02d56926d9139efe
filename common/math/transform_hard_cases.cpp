#include "math/transform_hard_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>

#include "math/projection.h"
#include "math/quad_oracle.h"
#include "math/spaces.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/trs.h"
#include "math/ulp.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double halfUlp = 0.5 + 0x1p-26;

std::string hexMatrix(const glm::mat4& m) {
    std::string text;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            text += fmt::format("{}{:a}", text.empty() ? "" : ",", m[column][row]);
    return "columns(" + text + ")";
}

QuadVector quad(glm::vec3 v) {
    return QuadVector(v);
}

double toDouble(Quad x) {
    return static_cast<double>(x);
}

/// The largest ulp error of an inverse's entries.
double inverseUlps(const glm::mat4& got, const QuadAdjugate& exact) {
    double worst = 0;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            worst = worse(worst, ulpError(got[column][row], exact.inverseEntry(column, row)));
    return worst;
}

/// Whether all entries of the exact inverse are in the range of float.
bool inverseFits(const QuadAdjugate& exact) {
    if (exact.determinant == 0)
        return false;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (std::abs(toDouble(exact.inverseEntry(column, row))) >= 0x1.ffffffp127)
                return false;
    return true;
}

template <typename Draw>
HardCaseFigures runInverses(std::uint64_t inputs, const Draw& draw) {
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::mat4 m = draw();
        const QuadAdjugate exact = adjugateQuad(m);
        const bool fits = inverseFits(exact);
        const std::optional<glm::mat4> stable = inverse(m);
        double stableError = infinity;
        if (stable.has_value() == fits)
            stableError = fits ? inverseUlps(*stable, exact) : 0;
        tally.add(fits ? inverseUlps(inverseNaive(m), exact) : infinity, stableError,
                  [&] { return "M=" + hexMatrix(m); });
    }
    return tally.figures();
}

glm::mat4 affine(const glm::dmat3& linear, glm::vec3 translation) {
    glm::mat4 m{glm::mat3(linear)};
    m[3] = glm::vec4(translation, 1);
    return m;
}

Quad absolute(Quad x) {
    return x < 0 ? -x : x;
}

/// m⁻¹ · v in quad, up to the determinant.
std::array<Quad, 4> adjugateTimes(const QuadAdjugate& adjugate, const std::array<Quad, 4>& v) {
    std::array<Quad, 4> result{};
    for (std::size_t row = 0; row < 4; ++row)
        for (std::size_t column = 0; column < 4; ++column)
            result[row] += adjugate.entries[column][row] * v[column];
    return result;
}

}  // namespace

HardCaseFigures runInverseUniform(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runInverses(inputs, [&] {
        return affine(draw.magnitude(-62, 62) * draw.rotation(), draw.vectorOfMagnitude(-10, 20));
    });
}

HardCaseFigures runInversePerAxis(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runInverses(inputs, [&] {
        glm::dmat3 linear = draw.rotation();
        for (int axis = 0; axis < 3; ++axis)
            linear[axis] *= draw.sign() * draw.magnitude(-20, 20);
        return affine(linear, draw.vectorOfMagnitude(-10, 20));
    });
}

HardCaseFigures runInverseProjection(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    return runInverses(inputs, [&] {
        const auto near = static_cast<float>(draw.magnitude(-40, 20));
        const float far = std::max(static_cast<float>(near * (1 + draw.magnitude(-20, 40))),
                                   std::nextafter(near, std::numeric_limits<float>::infinity()));
        const glm::mat4 eyeFromWorld =
            inverseRigid(affine(draw.rotation(), static_cast<float>(near) * draw.vectorOfMagnitude(0, 10)));
        return perspective(static_cast<float>(draw.random().uniform(0.1, 3)), 1.5f, near, far) * eyeFromWorld;
    });
}

HardCaseFigures runInverseRigid(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dmat3 rotation = draw.rotation();
        // Nearly at right angles to one of the axes, so that one component cancels.
        const auto axis = static_cast<int>(draw.random().below(3));
        const glm::dvec3 away = draw.turned(draw.perpendicular(rotation[axis]), -30, 0);
        const glm::mat4 m = affine(rotation, glm::vec3(draw.magnitude(-10, 40) * away));
        const auto error = [&](const glm::mat4& got) {
            double worst = 0;
            for (int row = 0; row < 3; ++row)
                worst = worse(
                    worst,
                    ulpError(got[3][row], Quad(-dotQuad(quad(glm::vec3(m[row])), quad(glm::vec3(m[3]))))));
            return worst;
        };
        tally.add(error(inverseRigidNaive(m)), error(inverseRigid(m)), [&] { return "M=" + hexMatrix(m); });
    }
    return tally.figures();
}

HardCaseFigures runDecompose(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        glm::dmat3 shape(1);
        for (int axis = 0; axis < 3; ++axis)
            shape[axis][axis] = draw.sign() * draw.magnitude(-6, 6);
        shape[1][0] = draw.sign() * draw.magnitude(-6, 6);
        shape[2][1] = draw.sign() * draw.magnitude(-6, 6);
        if (i % 8 == 0)
            shape[static_cast<int>(draw.random().below(3))] = glm::dvec3(0);
        const glm::mat4 m =
            affine(draw.magnitude(-60, 60) * (draw.rotation() * shape), draw.vectorOfMagnitude(-10, 10));
        const QuadVector x = quad(glm::vec3(m[0]));
        const QuadVector y = quad(glm::vec3(m[1]));
        const QuadVector z = quad(glm::vec3(m[2]));
        const QuadVector xy = crossQuad(x, y);
        const Quad volume = dotQuad(xy, z);
        const auto lengthOf = [](const QuadVector& v) {
            return dotQuad(v, v) == 0 ? Quad(0) : lengthQuad(v);
        };
        const Quad lengthX = lengthOf(x);
        const Quad area = lengthOf(xy);
        const QuadVector exact(volume < 0 ? Quad(-lengthX) : lengthX,
                               lengthX != 0 ? Quad(area / lengthX) : lengthOf(y),
                               area != 0      ? Quad(absolute(volume) / area)
                               : lengthX != 0 ? Quad(lengthOf(crossQuad(x, z)) / lengthX)
                                              : Quad(lengthOf(crossQuad(y, z)) / lengthOf(y)));
        const auto error = [&](const Trs& got) {
            double worst = worse(worse(ulpError(got.scale.x, exact.x), ulpError(got.scale.y, exact.y)),
                                 ulpError(got.scale.z, exact.z));
            for (int axis = 0; axis < 3; ++axis)
                worst = isFinite(got.rotation[axis]) ? worst : infinity;
            return worst;
        };
        const std::optional<Trs> stable = decompose(m);
        tally.add(error(decomposeNaive(m)), stable ? error(*stable) : infinity,
                  [&] { return "M=" + hexMatrix(m); });
    }
    return tally.figures();
}

HardCaseFigures runHomogenize(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // Components within 2^±40 of w, else nearly every quotient is zero or too large.
        glm::vec4 p(0, 0, 0, draw.finiteFloat());
        if (i % 16 == 0)
            p.w = 0;
        for (int axis = 0; axis < 3; ++axis)
            p[axis] = i % 4 == 0
                          ? draw.finiteFloat()
                          : std::clamp(static_cast<float>(draw.sign() * draw.magnitude(-40, 40) * p.w),
                                       -std::numeric_limits<float>::max(), std::numeric_limits<float>::max());
        bool fits = p.w != 0;
        QuadVector exact;
        if (fits) {
            exact = QuadVector(Quad(p.x) / p.w, Quad(p.y) / p.w, Quad(p.z) / p.w);
            // Half an ulp above the largest float, from where rounding goes to infinity.
            for (const Quad component : {exact.x, exact.y, exact.z})
                fits = fits && absolute(component) < Quad(0x1.ffffffp127);
        }
        const Homogenized stable = homogenize(p);
        const auto ulps = [&](glm::vec3 got) {
            return worse(worse(ulpError(got.x, exact.x), ulpError(got.y, exact.y)), ulpError(got.z, exact.z));
        };
        double naiveError = infinity;
        double stableError = infinity;
        if (fits) {
            naiveError = ulps(homogenizeNaive(p));
            if (stable.kind == (p.w > 0 ? HomogeneousKind::point : HomogeneousKind::behind))
                stableError = ulps(stable.value);
        } else if ((stable.kind == HomogeneousKind::direction && isFinite(stable.value)) ||
                   (stable.kind == HomogeneousKind::nothing && glm::vec3(p) == glm::vec3(0))) {
            stableError = 0;
        }
        tally.add(naiveError, stableError, [&] { return "p=" + hexVector(p) + fmt::format(" w={:a}", p.w); });
    }
    return tally.figures();
}

HardCaseFigures runScaleThroughW(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const double scale = draw.magnitude(-140, 120);
        const auto d = static_cast<float>(scale);
        // Results from the smallest to the largest floats.
        const auto x = static_cast<float>(std::clamp(
            draw.magnitude(-140, 126) / scale, static_cast<double>(std::numeric_limits<float>::denorm_min()),
            static_cast<double>(std::numeric_limits<float>::max())));
        const Quad exact = Quad(x) * d;
        const glm::vec4 naive = scaleThroughWNaive(d) * glm::vec4(x, 0, 0, 1);
        const glm::vec4 stable = scaleThroughW(d) * glm::vec4(x, 0, 0, 1);
        tally.add(ulpError(naive.x / naive.w, exact), ulpError(homogenize(stable).value.x, exact),
                  [&] { return fmt::format("x={:a} d={:a}", x, d); });
    }
    return tally.figures();
}

HardCaseFigures runLargeWorld(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    constexpr double width = 1920;
    constexpr double height = 1080;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 offset = draw.magnitude(10, 26.5754) * draw.direction();  // … 1e8
        glm::dmat4 worldFromEye(draw.rotation());
        worldFromEye[3] = glm::dvec4(offset, 1);
        // In view, 2 … 64 units away, a model of ten units.
        const double away = draw.magnitude(1, 6);
        const glm::dvec3 inEye(away * draw.random().uniform(-0.5, 0.5),
                               away * draw.random().uniform(-0.3, 0.3), -away);
        glm::dmat4 worldFromModel(draw.rotation());
        const glm::vec3 vertex = static_cast<float>(draw.random().uniform(0, 5)) * draw.unitVector();
        worldFromModel[3] = glm::dvec4(
            offset + glm::dmat3(worldFromEye) * inEye - glm::dmat3(worldFromModel) * glm::dvec3(vertex), 1);
        const glm::mat4 clipFromEye = perspective(1.0f, static_cast<float>(width / height), 0.1f, 1000.0f);

        // The pixel exactly: the doubles as they are, and the float projection.
        QuadVector world(Quad(worldFromModel[3].x), Quad(worldFromModel[3].y), Quad(worldFromModel[3].z));
        for (int axis = 0; axis < 3; ++axis)
            world = world + Quad(vertex[axis]) * QuadVector(glm::dvec3(worldFromModel[axis]));
        const QuadVector apart = world - QuadVector(glm::dvec3(worldFromEye[3]));
        const Quad eyeX = dotQuad(QuadVector(glm::dvec3(worldFromEye[0])), apart);
        const Quad eyeY = dotQuad(QuadVector(glm::dvec3(worldFromEye[1])), apart);
        const Quad eyeZ = dotQuad(QuadVector(glm::dvec3(worldFromEye[2])), apart);
        const double exactX = toDouble((clipFromEye[0][0] * eyeX / -eyeZ + 1) * Quad(width / 2));
        const double exactY = toDouble((clipFromEye[1][1] * eyeY / -eyeZ + 1) * Quad(height / 2));
        const auto error = [&](const glm::vec4& clip) {
            // As a shader and the fixed divide and viewport compute, the last step in double.
            const double x = (static_cast<double>(clip.x / clip.w) + 1) * (width / 2);
            const double y = (static_cast<double>(clip.y / clip.w) + 1) * (height / 2);
            return worse(std::abs(x - exactX), std::abs(y - exactY));
        };
        const glm::vec4 model(vertex, 1);
        const glm::mat4 naive = clipFromEye * eyeFromModelNaive(worldFromModel, worldFromEye);
        tally.add(error(naive * model),
                  error(clipFromEye * (eyeFromModel(worldFromModel, worldFromEye) * model)), [&] {
                      return fmt::format("offset=({:a},{:a},{:a}) vertex=", offset.x, offset.y, offset.z) +
                             hexVector(vertex);
                  });
    }
    return tally.figures();
}

HardCaseFigures runUnproject(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto near = static_cast<float>(draw.magnitude(-10, 2));
        const auto far = static_cast<float>(near * draw.magnitude(1, 20));
        SpaceChain chain;
        chain.viewport = {.x = 0, .y = 0, .width = 1920, .height = 1080};
        const glm::vec3 eye = draw.vectorOfMagnitude(-2, 12);
        const glm::mat4 worldFromEye = affine(draw.rotation(), eye);
        chain.eyeFromWorld = inverseRigid(worldFromEye);
        chain.worldFromModel =
            affine(draw.rotation(), eye + static_cast<float>(near) * draw.vectorOfMagnitude(1, 3));
        chain.clipFromEye =
            perspective(static_cast<float>(draw.random().uniform(0.3, 2)), 16 / 9.0f, near, far);
        const glm::vec3 window(static_cast<float>(draw.random().uniform(0, 1920)),
                               static_cast<float>(draw.random().uniform(0, 1080)),
                               static_cast<float>(draw.random().uniform(0, 1)));
        // The same steps undone in quad.
        std::array<Quad, 4> v = {Quad(window.x) * 2 / 1920 - 1, Quad(window.y) * 2 / 1080 - 1,
                                 Quad(window.z) * 2 - 1, 1};
        v = adjugateTimes(adjugateQuad(chain.clipFromEye), v);
        const std::array<Quad, 4> inEye = v;
        v = adjugateTimes(adjugateQuad(chain.eyeFromWorld), v);
        v = adjugateTimes(adjugateQuad(chain.worldFromModel), v);
        const QuadVector exact(v[0] / v[3], v[1] / v[3], v[2] / v[3]);
        const QuadVector exactEye(inEye[0] / inEye[3], inEye[1] / inEye[3], inEye[2] / inEye[3]);
        const double reach =
            toDouble(lengthQuad(exactEye)) + length(eye) + length(glm::vec3(chain.worldFromModel[3]));
        const double allowed =
            0x1p-23 * toDouble(lengthQuad(exact)) + 0x1p-48 * static_cast<double>(far) / near * reach;
        const auto error = [&](glm::vec3 got) {
            const QuadVector d = quad(got) - exact;
            return isFinite(got) ? std::sqrt(toDouble(dotQuad(d, d))) / allowed : infinity;
        };
        const std::optional<glm::vec3> stable = modelFromWindow(chain, window);
        tally.add(error(modelFromWindowNaive(chain, window)), stable ? error(*stable) : infinity, [&] {
            return "window=" + hexVector(window) + fmt::format(" near={:a} far={:a}", near, far);
        });
    }
    return tally.figures();
}

HardCaseFigures runDistanceFromDepth(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto near = static_cast<float>(draw.magnitude(-10, 10));
        const auto far = static_cast<float>(near * draw.magnitude(1, 40));
        const auto depth = static_cast<float>(1 - draw.magnitude(-24, 0));
        const Quad exact = Quad(near) * far / (Quad(far) - Quad(depth) * (Quad(far) - near));
        tally.add(ulpError(distanceFromDepthNaive(depth, near, far), exact),
                  ulpError(distanceFromDepth(depth, near, far), exact),
                  [&] { return fmt::format("depth={:a} near={:a} far={:a}", depth, near, far); });
    }
    return tally.figures();
}

HardCaseFigures runOrthographic(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        std::array<float, 6> planes{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double size = draw.magnitude(-60, 126);
            const double centre = draw.sign() * std::min(size * draw.magnitude(-10, 20), 0x1p126);
            planes[2 * axis] = static_cast<float>(centre - size);
            planes[2 * axis + 1] = static_cast<float>(centre + size);
            if (planes[2 * axis] == planes[2 * axis + 1])
                planes[2 * axis + 1] =
                    std::nextafter(planes[2 * axis], std::numeric_limits<float>::infinity());
        }
        const auto [left, right, bottom, top, near, far] = planes;
        const auto error = [&](const glm::mat4& got) {
            double worst = 0;
            for (int axis = 0; axis < 3; ++axis) {
                const auto first = static_cast<std::size_t>(2 * axis);
                const Quad low = axis == 2 ? -Quad(planes[first]) : Quad(planes[first]);
                const Quad high = axis == 2 ? -Quad(planes[first + 1]) : Quad(planes[first + 1]);
                worst = worse(worst, ulpError(got[axis][axis], Quad(2 / (high - low))));
                worst = worse(worst, ulpError(got[3][axis], Quad(-(high + low) / (high - low))));
            }
            return worst;
        };
        tally.add(error(orthographicNaive(left, right, bottom, top, near, far)),
                  error(orthographic(left, right, bottom, top, near, far)), [&planes] {
                      return fmt::format("x=({:a},{:a}) y=({:a},{:a}) z=({:a},{:a})", planes[0], planes[1],
                                         planes[2], planes[3], planes[4], planes[5]);
                  });
    }
    return tally.figures();
}

HardCaseFigures runNearPlane(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto near = static_cast<float>(draw.magnitude(-10, 4));
        const auto far = i % 8 == 0 ? std::numeric_limits<float>::infinity()
                                    : static_cast<float>(near * draw.magnitude(1, 30));
        const glm::mat4 clipFromEye =
            perspective(static_cast<float>(draw.random().uniform(0.3, 2)), 1.5f, near, far);
        // A plane across the view between near and far, seen from behind by the eye.
        glm::dvec3 normal = draw.direction();
        normal.z = -std::abs(normal.z) - 0.1;
        const double away = near * draw.magnitude(0.1, std::isinf(far) ? 20 : std::log2(far / near));
        const double size = draw.magnitude(-60, 60);
        const glm::vec4 plane(size * glm::dvec4(normal, normal.z * away));

        // Lengyel's corner in quad, from the floats as they are.
        const QuadAdjugate eyeFromClip = adjugateQuad(clipFromEye);
        const Quad det = eyeFromClip.determinant;
        std::array<Quad, 4> planeClip{};
        for (std::size_t column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                planeClip[column] +=
                    Quad(plane[row]) * eyeFromClip.entries[column][static_cast<std::size_t>(row)] / det;
        const std::array<Quad, 4> corner = adjugateTimes(
            eyeFromClip,
            {planeClip[0] < 0 ? Quad(-1) : Quad(1), planeClip[1] < 0 ? Quad(-1) : Quad(1), 1, 1});
        Quad front = 0;
        for (std::size_t row = 0; row < 4; ++row)
            front += Quad(plane[static_cast<int>(row)]) * corner[row] / det;
        const Quad scale = 2 * (-corner[2] / det) / front;
        std::array<Quad, 4> exact{};
        double largest = 0;
        for (std::size_t column = 0; column < 4; ++column) {
            exact[column] = scale * Quad(plane[static_cast<int>(column)]) + (column == 2 ? Quad(1) : Quad(0));
            largest = std::max(largest, std::abs(toDouble(exact[column])));
        }
        const auto error = [&](const glm::mat4& got) {
            double worst = 0;
            for (std::size_t column = 0; column < 4; ++column)
                worst =
                    worse(worst, std::abs(toDouble(Quad(got[static_cast<int>(column)][2]) - exact[column])));
            return worst / largest;
        };
        const bool exists = front > 0;
        const std::optional<glm::mat4> stable = withNearPlane(clipFromEye, plane);
        double stableError = infinity;
        if (stable.has_value() == exists)
            stableError = exists ? error(*stable) : 0;
        tally.add(exists ? error(withNearPlaneNaive(clipFromEye, plane)) : infinity, stableError, [&] {
            return "plane=" + hexVector(plane) +
                   fmt::format(" d={:a} near={:a} far={:a}", plane.w, near, far);
        });
    }
    return tally.figures();
}

std::span<const HardCase> transformHardCases() {
    constexpr double inverseBound = 0.53;
    static constexpr HardCase cases[] = {
        {"inverse", "placements scaled by 2^-62 … 2^62", "ulp", inverseBound,
         "adjugate over determinant in double", &runInverseUniform},
        {"inverse", "each axis scaled by ±2^-20 … 2^20", "ulp", inverseBound,
         "adjugate over determinant, exact sums where they cancel", &runInversePerAxis},
        {"inverse", "projection times view, far/near up to 2^40", "ulp", inverseBound,
         "adjugate over determinant, exact sums where they cancel", &runInverseProjection},
        {"inverseRigid", "far away, nearly at right angles to an axis", "ulp", halfUlp,
         "compensated sum of exact products; Ogita, Rump, Oishi 2005", &runInverseRigid},
        {"decompose", "mirrored, sheared, flattened, scaled by 2^-60 … 2^60", "ulp", halfUlp,
         "QR by cross products of exact products", &runDecompose},
        {"homogenize", "any finite p and w, also w = 0", "ulp", 0.5, "true division; IEEE 754",
         &runHomogenize},
        {"scaleThroughW", "scales of 2^-140 … 2^120", "ulp", 2.5, "diag(s, s, s, s/d) with a power of two s",
         &runScaleThroughW},
        {"eyeFromModel", "worlds of 1e3 … 1e8 units", "pixels of 1920×1080", 0.001,
         "the eye subtracted in double; float from there", &runLargeWorld},
        {"modelFromWindow", "near 2^-10, far/near up to 2^20", "of the bound", 1,
         "three matrices undone one by one, complete pivoting; Higham 2002, ch. 9", &runUnproject},
        {"distanceFromDepth", "2^-24 … 1 short of the far plane", "ulp", halfUlp,
         "n / ((1 − depth) + depth n/f)", &runDistanceFromDepth},
        {"orthographic", "boxes of 2^-60 … 2^127 off the axis", "ulp", halfUlp, "in double, rounded once",
         &runOrthographic},
        {"withNearPlane", "far/near up to 2^30 and ∞, planes of any length", "of the row", 6.1e-8,
         "Lengyel 2005, in double", &runNearPlane},
    };
    return cases;
}

}  // namespace quincunx
