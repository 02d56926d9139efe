#include "math/rigid_motion_hard_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "math/exact.h"
#include "math/projection.h"
#include "math/quad_oracle.h"
#include "math/rigid_motion.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/ulp.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string hexColumns(const glm::mat3& m) {
    return hexVector(m[0]) + hexVector(m[1]) + hexVector(m[2]);
}

double absolute(Quad x) {
    return std::abs(static_cast<double>(x));
}

/// The largest entry of |RᵀR − I|; a frame that is mirrored has an infinite one.
double departure(const glm::mat3& r) {
    double error = determinant(r) > 0 ? 0 : infinity;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            error = worse(error, std::abs(dotInDouble(r[i], r[j]) - (i == j ? 1 : 0)));
    return error;
}

struct QuadDirection {
    Quad cosine = 1;
    Quad sine = 0;
};

/// |x| ≤ 2^60, within 2^-95.
QuadDirection quadDirection(Quad x) {
    // π/2 in three doubles, 159 bits; each product with a count of 60 bits is exact.
    static constexpr std::array halfPi = {0x1.921fb54442d18p+0, 0x1.1a62633145c07p-54,
                                          -0x1.f1976b7ed8fbcp-110};
    const auto count = static_cast<std::int64_t>(x / Quad(halfPi[0]) + (x < 0 ? Quad(-0.5) : Quad(0.5)));
    Quad rest = x;
    for (const double part : halfPi)
        rest -= Quad(count) * part;
    // Less than a quarter turn and a bit either way.
    const Quad t = rest < 0 ? -tangent(-rest / 2) : tangent(rest / 2);
    const Quad cosine = (1 - t * t) / (1 + t * t);
    const Quad sine = 2 * t / (1 + t * t);
    switch (count & 3) {
        case 0:
            return {cosine, sine};
        case 1:
            return {-sine, cosine};
        case 2:
            return {-cosine, -sine};
        default:
            return {sine, -cosine};
    }
}

struct QuadMatrix {
    std::array<QuadVector, 3> column;
};

double entryError(const glm::mat3& got, const QuadMatrix& exact) {
    double error = 0;
    for (int c = 0; c < 3; ++c) {
        const QuadVector& column = exact.column[static_cast<std::size_t>(c)];
        error = worse(error,
                      worse(absolute(Quad(got[c].x) - column.x),
                            worse(absolute(Quad(got[c].y) - column.y), absolute(Quad(got[c].z) - column.z))));
    }
    return error;
}

/// A unit quaternion.
struct QuadTurn {
    Quad w = 1;
    QuadVector v;
};

QuadTurn quadTurn(const QuadVector& axis, Quad radians) {
    const QuadDirection half = quadDirection(radians / 2);
    return {half.cosine, half.sine * normalizeQuad(axis)};
}

QuadTurn operator*(const QuadTurn& a, const QuadTurn& b) {
    return {a.w * b.w - dotQuad(a.v, b.v), a.w * b.v + b.w * a.v + crossQuad(a.v, b.v)};
}

QuadMatrix matrixOf(const QuadTurn& q) {
    const Quad w = q.w;
    const auto [x, y, z] = q.v;
    return {{QuadVector(1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)),
             QuadVector(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)),
             QuadVector(2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y))}};
}

struct Turn {
    glm::vec3 axis{0, 1, 0};
    float radians = 0;
};

Turn drawTurn(StressInputs& draw) {
    return {draw.unitVector(), static_cast<float>(draw.sign() * draw.magnitude(-30, 20))};
}

std::string describe(const Turn& turn) {
    return fmt::format("axis={} radians={:a}", hexVector(turn.axis), turn.radians);
}

/// The rotation nearest to m, det m > 0: Newton's iteration X ← (γX + X⁻ᵀ/γ)/2 in Quad.
QuadMatrix quadPolar(const glm::mat3& m) {
    std::array<QuadVector, 3> x = {QuadVector(m[0]), QuadVector(m[1]), QuadVector(m[2])};
    const auto squared = [](const std::array<QuadVector, 3>& a) {
        return dotQuad(a[0], a[0]) + dotQuad(a[1], a[1]) + dotQuad(a[2], a[2]);
    };
    for (int step = 0; step < 40; ++step) {
        std::array<QuadVector, 3> inverse = {crossQuad(x[1], x[2]), crossQuad(x[2], x[0]),
                                             crossQuad(x[0], x[1])};
        const Quad det = dotQuad(x[0], inverse[0]);
        for (QuadVector& column : inverse)
            column = Quad(1) / det * column;
        // Near the end γ is 1 but for its own rounding.
        const Quad gamma = squareRoot(squareRoot(squared(inverse) / squared(x)));
        Quad change = 0;
        for (std::size_t c = 0; c < 3; ++c) {
            const QuadVector next = gamma / 2 * x[c] + 1 / (2 * gamma) * inverse[c];
            const QuadVector difference = next - x[c];
            change += dotQuad(difference, difference);
            x[c] = next;
        }
        if (change < Quad(0x1p-160))
            break;
    }
    return {x};
}

}  // namespace

HardCaseFigures runTurnLeft(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    constexpr float epsilon = 0.01f;
    Tally tally;
    Orientation stable;
    const Turn start = drawTurn(draw);
    stable.turnAboutBody(glm::dvec3(start.axis), static_cast<double>(start.radians));
    glm::mat3 naive = stable.worldFromBodyFloat();
    for (std::uint64_t i = 0; i < inputs; ++i) {
        naive = turnLeftMirroredNaive(naive, epsilon);
        stable.turnAboutBody({0, 1, 0}, std::atan(static_cast<double>(epsilon)));
        tally.add(departure(naive), departure(stable.worldFromBodyFloat()),
                  [&] { return fmt::format("turn {} after {}", i + 1, describe(start)); });
    }
    return tally.figures();
}

HardCaseFigures runTurnedOrthonormal(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    glm::mat3 naive(1);
    glm::mat3 stable(1);
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const Turn turn = drawTurn(draw);
        naive = turnedNaive(naive, turn.axis, turn.radians);
        const std::optional<glm::mat3> next = turned(stable, turn.axis, turn.radians);
        tally.add(departure(naive), next ? departure(*next) : infinity,
                  [&] { return fmt::format("R={} {}", hexColumns(stable), describe(turn)); });
        stable = next.value_or(stable);
    }
    return tally.figures();
}

HardCaseFigures runOrientation(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    glm::mat3 naive(1);
    Orientation stable;
    QuadTurn exact;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const Turn turn = drawTurn(draw);
        naive = turnedNaive(naive, turn.axis, turn.radians);
        stable.turnAboutBody(glm::dvec3(turn.axis), static_cast<double>(turn.radians));
        exact = exact * quadTurn(QuadVector(turn.axis), turn.radians);
        const QuadMatrix matrix = matrixOf(exact);
        tally.add(entryError(naive, matrix), entryError(stable.worldFromBodyFloat(), matrix),
                  [&] { return fmt::format("turn {}: {}", i + 1, describe(turn)); });
    }
    return tally.figures();
}

HardCaseFigures runAngleSum(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    float naive = 0;
    AngleSum stable;
    Quad exact = 0;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto radians = static_cast<float>((i % 4 == 0 ? -1 : 1) * draw.magnitude(-30, 10));
        naive += radians;
        stable.add(static_cast<double>(radians));
        exact += radians;
        const QuadDirection direction = quadDirection(exact);
        const auto error = [&](const auto& got) {
            return worse(absolute(Quad(got.x) - direction.cosine), absolute(Quad(got.y) - direction.sine));
        };
        tally.add(error(angleSumDirectionNaive(naive)), error(stable.direction()),
                  [&] { return fmt::format("term {}: {:a}", i + 1, radians); });
    }
    return tally.figures();
}

HardCaseFigures runTurnMatrix(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const Turn turn{draw.vectorOfMagnitude(-100, 100),
                        static_cast<float>(draw.sign() * draw.magnitude(-60, 60))};
        const QuadMatrix exact = matrixOf(quadTurn(QuadVector(turn.axis), turn.radians));
        tally.add(entryError(turnMatrixNaive(turn.axis, turn.radians), exact),
                  entryError(turnMatrix(turn.axis, turn.radians), exact), [&] { return describe(turn); });
    }
    return tally.figures();
}

HardCaseFigures runGramSchmidt(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const glm::dvec3 facing = draw.direction();
        const glm::vec3 z(draw.magnitude(-60, 60) * facing);
        const glm::vec3 y(draw.magnitude(-60, 60) * draw.turned(draw.sign() * facing, -22, 0));
        const glm::mat3 frame(draw.vectorOfMagnitude(-60, 60), y, z);
        const QuadVector across = crossQuad(QuadVector(y), QuadVector(z));
        const bool parallel = dotQuad(across, across) == 0;
        const std::optional<glm::mat3> stable = gramSchmidt(frame);
        double naiveError = infinity;
        double stableError = stable.has_value() == parallel ? infinity : 0;
        if (!parallel) {
            const QuadVector left = normalizeQuad(across);
            const QuadVector ahead = normalizeQuad(QuadVector(z));
            const QuadMatrix exact{{left, crossQuad(ahead, left), ahead}};
            naiveError = entryError(gramSchmidtNaive(frame), exact);
            if (stable)
                stableError = entryError(*stable, exact);
        }
        tally.add(naiveError, stableError, [&] { return hexColumns(frame); });
    }
    return tally.figures();
}

HardCaseFigures runNearestRotation(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        // U diag(σ) Vᵀ, σ1 = 1, σ2 down to 2^-20, σ3 down to 2^-24.
        const glm::dmat3 u = draw.rotation();
        const glm::dmat3 v = draw.rotation();
        const double second = draw.magnitude(-20, 0);
        const double third = draw.magnitude(-24, 0) * (i % 8 == 0 ? -1 : 1);
        const double size = draw.magnitude(-60, 60);
        const glm::mat3 m(size * (glm::dmat3(u[0], second * u[1], third * u[2]) * glm::transpose(v)));
        // Rounding to float may turn the sign of a third value below 2^-24.
        const bool mirrored = determinant(m) <= 0;
        const std::optional<glm::mat3> stable = nearestRotation(m);
        const QuadMatrix exact = mirrored ? QuadMatrix{} : quadPolar(m);
        tally.add(mirrored ? infinity : entryError(gramSchmidtNaive(m), exact),
                  stable.has_value() == mirrored ? infinity : (stable ? entryError(*stable, exact) : 0),
                  [&] { return hexColumns(m); });
    }
    return tally.figures();
}

HardCaseFigures runRigidInverse(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        glm::mat4 pose{glm::mat3(draw.rotation())};
        pose[3] = glm::vec4(draw.vectorOfMagnitude(0, 100), 1);
        const QuadVector origin{glm::vec3(pose[3])};
        const auto error = [&](const glm::mat4& got) {
            double worst = 0;
            for (int row = 0; row < 3; ++row) {
                const QuadVector axis{glm::vec3(pose[row])};
                for (int column = 0; column < 3; ++column)
                    worst = worse(worst, ulpError(got[column][row], Quad(pose[row][column])));
                worst = worse(worst, ulpError(got[3][row], Quad(-dotQuad(axis, origin))));
            }
            return worst;
        };
        tally.add(error(inverseNaive(pose)), error(cameraFromWorld(pose)), [&] {
            return fmt::format("R={} t={}", hexColumns(glm::mat3(pose)), hexVector(glm::vec3(pose[3])));
        });
    }
    return tally.figures();
}

HardCaseFigures runCameraFromModel(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    constexpr float width = 1920;
    constexpr float height = 1080;
    const glm::mat4 clipFromCamera = perspective(1, width / height, 0.0625f, 4096);
    const Quad focalX = clipFromCamera[0][0];
    const Quad focalY = clipFromCamera[1][1];
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const RigidPose camera{draw.rotation(), draw.magnitude(10, 40) * draw.direction()};
        // In view: up to 0.4 of the distance to the side.
        const double distance = draw.magnitude(-3, 8);
        const glm::dvec3 ahead(draw.random().uniform(-0.4, 0.4), draw.random().uniform(-0.4, 0.4), -1);
        const RigidPose model{draw.rotation(), camera.origin + camera.rotation * (distance * ahead)};
        const glm::vec3 vertex(0.25 * distance * draw.direction());

        const auto column = [](const glm::dmat3& m, int c) { return QuadVector(m[c]); };
        const auto times = [&](const glm::dmat3& m, const QuadVector& p) {
            return p.x * column(m, 0) + p.y * column(m, 1) + p.z * column(m, 2);
        };
        const QuadVector fromEye =
            times(model.rotation, QuadVector(vertex)) + QuadVector(model.origin) - QuadVector(camera.origin);
        const QuadVector seen(dotQuad(column(camera.rotation, 0), fromEye),
                              dotQuad(column(camera.rotation, 1), fromEye),
                              dotQuad(column(camera.rotation, 2), fromEye));
        const auto error = [&](const glm::mat4& cameraFromVertex) {
            const glm::vec4 clip = clipFromCamera * (cameraFromVertex * glm::vec4(vertex, 1));
            if (!(clip.w > 0))
                return infinity;
            const Quad x = Quad(clip.x / clip.w) + focalX * seen.x / seen.z;
            const Quad y = Quad(clip.y / clip.w) + focalY * seen.y / seen.z;
            return worse(absolute(x) * width / 2, absolute(y) * height / 2);
        };
        tally.add(error(cameraFromModelNaive(camera.matrix(), model.matrix())),
                  error(cameraFromModel(camera, model)), [&] {
                      return fmt::format("camera at {} model at {} vertex={}", hexVector(camera.origin),
                                         hexVector(model.origin), hexVector(vertex));
                  });
    }
    return tally.figures();
}

HardCaseFigures runArcOffset(std::uint64_t inputs, std::uint64_t seed) {
    StressInputs draw(seed);
    Tally tally;
    for (std::uint64_t i = 0; i < inputs; ++i) {
        const auto distance = static_cast<float>(draw.sign() * draw.magnitude(-10, 20));
        const auto curvature =
            i % 8 == 0 ? 0.0f : static_cast<float>(draw.sign() * draw.magnitude(i % 2 == 0 ? -100 : -12, 6));
        QuadVector exact(distance, 0, 0);
        if (curvature != 0) {
            const Quad phi = Quad(curvature) * distance / 2;
            const QuadDirection middle = quadDirection(phi);
            const Quad chord = distance * (middle.sine / phi);
            exact = {chord * middle.cosine, chord * middle.sine, 0};
        }
        const double size =
            std::min(std::abs(static_cast<double>(distance)), 2 / std::abs(static_cast<double>(curvature)));
        const auto error = [&](const auto& got) {
            return worse(absolute(Quad(got.x) - exact.x), absolute(Quad(got.y) - exact.y)) / size;
        };
        tally.add(error(arcOffsetNaive(distance, curvature)),
                  error(arcOffset(static_cast<double>(distance), static_cast<double>(curvature))),
                  [&] { return fmt::format("distance={:a} curvature={:a}", distance, curvature); });
    }
    return tally.figures();
}

std::span<const HardCase> rigidMotionHardCases() {
    // Roundings as derived in math/rigid_motion.h; u = 2^-53.
    constexpr double u = 0x1p-53;
    constexpr double halfUlp = 0.5 + 0x1p-26;
    static constexpr HardCase cases[] = {
        {"turnLeft (card)", "one frame, turn upon turn by 0.01", "|RᵀR − I|", 1.1e-7,
         "unit quaternion in double; left is y × z", &runTurnLeft},
        {"turned", "one frame, turn upon turn by 2^-30 … 2^20 rad", "|RᵀR − I|", 1.1e-7,
         "product in double, Newton–Schulz, rounded once", &runTurnedOrthonormal},
        {"Orientation", "one body, turn upon turn by 2^-30 … 2^20 rad", "entry", 0x1p-25 + 16e6 * u,
         "unit quaternion in double, kept at length 1 to first order", &runOrientation},
        {"AngleSum", "angles of 2^-30 … 2^10 rad added up", "cosine, sine", 4 * u,
         "sum and rounding error apart; Knuth's two-sum", &runAngleSum},
        {"turnMatrix", "2^-60 … 2^60 rad, axes of length 2^-100 … 2^100", "entry", 0x1p-25 + 16 * u,
         "from the half angle, in double", &runTurnMatrix},
        {"gramSchmidt", "columns 2^-60 … 2^60, y 2^-22 … 1 rad from ±z", "entry", 0x1p-25 + 16 * u,
         "exact cross product instead of a difference", &runGramSchmidt},
        {"nearestRotation", "stretched by up to 2^24, of any size, or mirrored", "entry",
         0x1p-25 + 64 * 0x1p20 * u, "scaled Newton iteration in double; Higham 1986", &runNearestRotation},
        {"cameraFromWorld", "the eye 2^0 … 2^100 from the origin", "ulp", halfUlp,
         "Rᵀ and −Rᵀt, compensated sums of exact products", &runRigidInverse},
        {"cameraFromModel", "camera and model 2^10 … 2^40 from the origin", "pixels", 1e-3,
         "origins subtracted in double", &runCameraFromModel},
        {"arcOffset", "arcs bent by 0 and 2^-100 … 2^6, 2^-10 … 2^20 long", "of arc or circle", 16 * u,
         "sin(φ)/φ with the rounding of φ carried along", &runArcOffset},
    };
    return cases;
}

}  // namespace quincunx
