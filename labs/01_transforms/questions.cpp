#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "image/compare.h"
#include "lab/studio.h"
#include "labs/01_transforms/lab.h"
#include "labs/01_transforms/shader_vertices.h"
#include "math/exact.h"
#include "math/quad_oracle.h"
#include "math/stress_inputs.h"
#include "math/transform.h"
#include "math/trs.h"
#include "math/ulp.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr int width = 640;
constexpr int height = 480;

Frame plainFrame(TransformsLab& lab, Studio& studio) {
    for (Knob* knob : lab.knobs().all())
        knob->reset();
    lab.view.set(static_cast<int>(TransformsLab::View::picture));
    lab.supersample.set(1);
    return studio.frame(lab, width, height);
}

/// The largest |difference| of the entries.
template <typename Matrix>
double largestDifference(const Matrix& a, const Matrix& b) {
    double most = 0;
    for (int column = 0; column < Matrix::length(); ++column)
        for (int row = 0; row < Matrix::length(); ++row)
            most = std::max(most, std::abs(static_cast<double>(a[column][row]) - b[column][row]));
    return most;
}

std::vector<Measurement> measureVertexShader(Studio& studio) {
    TransformsLab lab;
    const Frame frame = plainFrame(lab, studio);
    lab.precision.set(static_cast<int>(TransformsLab::Precision::absolute));
    const ShaderVertices vertices = shaderVertices(studio, lab, frame);
    double error = 0;
    double pixelError = 0;
    double leastW = std::numeric_limits<double>::infinity();
    double mostW = 0;
    std::size_t outside = 0;
    std::size_t visible = 0;
    for (std::size_t i = 0; i < vertices.clip.size(); ++i) {
        const glm::dvec4 got(vertices.clip[i]);
        const glm::dvec4 exact = vertices.exactClip[i];
        for (int entry = 0; entry < 4; ++entry)
            error = std::max(error, std::abs(got[entry] - exact[entry]) / exact.w);
        const glm::dvec2 apart = glm::dvec2(got) / got.w - glm::dvec2(exact) / exact.w;
        pixelError = std::max({pixelError, std::abs(apart.x) * width / 2, std::abs(apart.y) * height / 2});
        leastW = std::min(leastW, got.w);
        mostW = std::max(mostW, got.w);
        if (std::abs(got.x) <= got.w && std::abs(got.y) <= got.w && std::abs(got.z) <= got.w) {
            ++visible;
            outside += std::abs(got.x) > 1 || std::abs(got.y) > 1 || std::abs(got.z) > 1 ? 1 : 0;
        }
    }
    // A chain of three products of four terms: up to 16 roundings of 2^-24 of terms near w in size.
    return {
        {"vertices through the vertex shader", static_cast<double>(vertices.clip.size()), "", atLeast(10000)},
        {"shader against P · V · M in double, worst entry over w", error, "", atMost(16 * 0x1p-24)},
        {"the same in the window", pixelError, "pixels", atMost(1e-3)},
        {"smallest w before the divide", leastW, "", atLeast(1.5)},
        {"largest w before the divide", mostW, "", {}},
        {"of the visible vertices, outside −1 … 1 before the divide",
         100.0 * static_cast<double>(outside) / static_cast<double>(visible), "%", atLeast(50)}};
}

std::vector<Measurement> measureNormals() {
    StressInputs draw(4);
    double byModel = 0;
    double byInverseTranspose = 0;
    double byCofactors = 0;
    double byDoubles = 0;
    std::size_t inward = 0;
    std::size_t naiveInward = 0;
    std::size_t singular = 0;
    std::size_t singularRight = 0;
    std::size_t naiveSingularLost = 0;
    constexpr int count = 50'000;
    for (int i = 0; i < count; ++i) {
        glm::dmat3 shape(1);
        for (int axis = 0; axis < 3; ++axis)
            shape[axis][axis] = draw.magnitude(-2, 2);
        shape[1][0] = draw.random().uniform(-2, 2);
        if (i % 2 == 0)
            shape[2][2] = -shape[2][2];
        const bool flat = i % 10 == 0;
        if (flat)
            shape[2] = glm::dvec3(0);
        const glm::mat4 m{glm::mat3(draw.rotation() * shape)};
        const glm::dvec3 unit = draw.direction();
        const glm::vec3 n = flat ? glm::vec3(0, 0, 1) : glm::vec3(unit);
        const glm::vec3 t = flat ? glm::vec3(1, 0, 0) : glm::vec3(draw.perpendicular(unit));
        const glm::dvec3 tangent = glm::normalize(glm::dmat3(m) * glm::dvec3(t));
        const auto slope = [&](glm::vec3 normal) {
            return std::abs(glm::dot(glm::normalize(glm::dvec3(normal)), tangent));
        };
        const glm::vec3 cofactor = normalMatrix(m) * n;
        const glm::vec3 inverse = normalMatrixNaive(m) * n;
        if (flat) {
            ++singular;
            singularRight += slope(cofactor) < 1e-6 ? 1 : 0;
            naiveSingularLost += isFinite(inverse) && slope(inverse) < 1e-6 ? 0 : 1;
            continue;
        }
        byModel = std::max(byModel, slope(glm::mat3(m) * n));
        byInverseTranspose = std::max(byInverseTranspose, slope(inverse));
        byCofactors = std::max(byCofactors, slope(cofactor));
        byDoubles = std::max(byDoubles, slope(transformNormal(m, n).value_or(glm::vec3(0))));
        // A sphere's normal points away from its centre: so must the image's.
        const glm::dvec3 outward = glm::dmat3(m) * glm::dvec3(n);
        inward += glm::dot(glm::dvec3(cofactor), outward) > 0 ? 0 : 1;
        const glm::mat3 plain(crossNaive(glm::vec3(m[1]), glm::vec3(m[2])),
                              crossNaive(glm::vec3(m[2]), glm::vec3(m[0])),
                              crossNaive(glm::vec3(m[0]), glm::vec3(m[1])));
        naiveInward += glm::dot(glm::dvec3(plain * n), outward) > 0 ? 0 : 1;
    }
    // n·t is off by the roundings of n, t and M, magnified by how uneven M is: 2^4 · 2^4 · 2 by 2^-24.
    return {{"|n·t| with M, largest", byModel, "", atLeast(0.5)},
            {"|n·t| with (M⁻¹)ᵀ in float, largest", byInverseTranspose, "", atMost(2e-4)},
            {"|n·t| with the cofactor matrix, largest", byCofactors, "", atMost(3e-5)},
            {"|n·t| with transformNormal, largest", byDoubles, "", atMost(3e-5)},
            {"flattened models", static_cast<double>(singular), "", {}},
            {"of these, right by the cofactor matrix", static_cast<double>(singularRight), "",
             equals(static_cast<double>(singular))},
            {"of these, lost by (M⁻¹)ᵀ", static_cast<double>(naiveSingularLost), "",
             equals(static_cast<double>(singular))},
            {"normals turned inward by sign(det) cof M", static_cast<double>(inward), "", equals(0)},
            {"normals turned inward by cof M without the sign", static_cast<double>(naiveInward), "",
             atLeast(1)}};
}

std::vector<Measurement> measureEntries() {
    const Trs placement{.translation = {3, -2, 5},
                        .rotation = glm::mat3(glm::rotate(glm::mat4(1), 0.7f, glm::vec3(0.48f, 0.6f, 0.64f))),
                        .scale = {2, 3, 0.5f}};
    const glm::mat4 turned = compose(placement);
    glm::mat4 straight(1);
    for (int axis = 0; axis < 3; ++axis)
        straight[axis][axis] = placement.scale[axis];
    straight[3] = turned[3];

    constexpr float nudge = 1e-3f;
    std::set<int> moveOrigin;
    std::set<int> changeW;
    std::set<int> stretchStraight;
    std::set<int> stretchTurned;
    std::set<int> turnTurned;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 4; ++row) {
            const int entry = 4 * column + row;
            const auto nudged = [&](glm::mat4 m) {
                m[column][row] += nudge;
                return m;
            };
            const glm::vec4 origin = nudged(turned) * glm::vec4(0, 0, 0, 1);
            if (glm::vec3(origin) != glm::vec3(turned[3]))
                moveOrigin.insert(entry);
            const glm::vec4 corner = nudged(turned) * glm::vec4(1, 1, 1, 1);
            if (corner.w != 1)
                changeW.insert(entry);
            if (column == 3 || row == 3)
                continue;
            // To first order: a change across the axis changes its length by the square of the nudge only.
            const auto stretched = [&](const glm::mat4& m) {
                const double before = length(glm::dvec3(m[column]));
                const double after = length(glm::dvec3(nudged(m)[column]));
                return std::abs(after - before) > 0.05 * nudge;
            };
            if (stretched(straight))
                stretchStraight.insert(entry);
            if (stretched(turned))
                stretchTurned.insert(entry);
            if (angleBetween(glm::vec3(turned[column]), glm::vec3(nudged(turned)[column])).value_or(0) >
                1e-5f)
                turnTurned.insert(entry);
        }
    }
    double columnLengthError = 0;
    double diagonalError = 0;
    for (int axis = 0; axis < 3; ++axis) {
        columnLengthError = std::max<double>(
            columnLengthError, std::abs(length(glm::vec3(turned[axis])) - placement.scale[axis]));
        diagonalError = std::max<double>(diagonalError, std::abs(turned[axis][axis] - placement.scale[axis]));
    }
    const auto size = [](const std::set<int>& entries) { return static_cast<double>(entries.size()); };
    const bool onlyDiagonal = stretchStraight == std::set<int>{0, 5, 10};
    const bool onlyLastColumn = moveOrigin == std::set<int>{12, 13, 14};
    const bool onlyLastRow = changeW == std::set<int>{3, 7, 11, 15};
    return {{"entries that move the origin: m, n, o and no other", onlyLastColumn ? 1.0 : 0.0, "", equals(1)},
            {"entries that change w: d, h, l, p and no other", onlyLastRow ? 1.0 : 0.0, "", equals(1)},
            {"without rotation, entries that stretch: a, f, k and no other", onlyDiagonal ? 1.0 : 0.0, "",
             equals(1)},
            {"with rotation, entries of the nine that stretch", size(stretchTurned), "", equals(9)},
            {"with rotation, entries of the nine that turn an axis", size(turnTurned), "", equals(9)},
            {"scale read as column lengths, worst error", columnLengthError, "", atMost(4e-7)},
            {"scale read off the diagonal, worst error", diagonalError, "", atLeast(0.1)}};
}

std::vector<Measurement> measureFrameMatrix() {
    StressInputs draw(6);
    constexpr int count = 20'000;
    std::size_t axesKept = 0;
    std::size_t originsKept = 0;
    double worst = 0;
    for (int i = 0; i < count; ++i) {
        const std::array<glm::vec3, 3> axes = {draw.vectorOfMagnitude(-3, 3), draw.vectorOfMagnitude(-3, 3),
                                               draw.vectorOfMagnitude(-3, 3)};
        const glm::vec3 origin = draw.vectorOfMagnitude(-5, 5);
        const glm::mat4 worldFromModel(glm::vec4(axes[0], 0), glm::vec4(axes[1], 0), glm::vec4(axes[2], 0),
                                       glm::vec4(origin, 1));
        originsKept += worldFromModel * glm::vec4(0, 0, 0, 1) == glm::vec4(origin, 1) ? 1 : 0;
        for (int axis = 0; axis < 3; ++axis) {
            glm::vec4 unit(0);
            unit[axis] = 1;
            axesKept += worldFromModel * unit == glm::vec4(axes[static_cast<std::size_t>(axis)], 0) ? 1 : 0;
        }
        // A point of the model is the origin plus its coordinates along the axes.
        const glm::vec3 p = draw.vectorOfMagnitude(-2, 2);
        glm::dvec3 exact(origin);
        double terms = length(origin);
        for (int axis = 0; axis < 3; ++axis) {
            exact += static_cast<double>(p[axis]) * glm::dvec3(axes[static_cast<std::size_t>(axis)]);
            terms += std::abs(p[axis]) * length(axes[static_cast<std::size_t>(axis)]);
        }
        const glm::dvec3 got(worldFromModel * glm::vec4(p, 1));
        worst = std::max(worst, glm::length(got - exact) / terms);
    }
    return {{"origins mapped exactly", static_cast<double>(originsKept), "", equals(count)},
            {"axes mapped exactly", static_cast<double>(axesKept), "", equals(3 * count)},
            {"points against o + x a + y b + z c, over the terms", worst, "", atMost(4 * 0x1p-24)}};
}

/// The pixels of "marked pixel" or "vertex pixels" that a vertex lit, by x and y from the lower left.
struct LitPixel {
    int x = 0;
    int y = 0;
    std::size_t vertex = 0;
    double depth = 0;
};
std::vector<LitPixel> litPixels(const Image& marks) {
    std::vector<LitPixel> lit;
    for (int row = 0; row < marks.height; ++row)
        for (int x = 0; x < marks.width; ++x)
            if (const float* pixel = marks.pixel(x, row); pixel[0] > 0)
                lit.push_back({x, marks.height - 1 - row, static_cast<std::size_t>(pixel[0]) - 1, pixel[1]});
    return lit;
}

std::vector<Measurement> measureSpaces(Studio& studio) {
    TransformsLab lab;
    const Frame frame = plainFrame(lab, studio);
    std::vector<Measurement> figures;
    for (int choice = 0; choice < 4; ++choice) {
        lab.vertex.set(choice);
        const BoatVertex chosen = lab.chosenVertex();
        const VertexInSpaces at = throughSpaces(lab.chain(frame), glm::dvec3(chosen.positionBoat));
        const glm::dvec3 window = at.window.value_or(glm::dvec3(-1));
        if (choice == 0) {
            const auto tell = [&](const char* space, const char* names, const auto& values, int count) {
                for (int i = 0; i < count; ++i)
                    figures.push_back(
                        {fmt::format("{}, {}: {}", chosen.name, space, names[i]), values[i], "", {}});
            };
            tell("object", "xyzw", at.model, 4);
            tell("world", "xyzw", at.world, 4);
            tell("eye", "xyzw", at.eye, 4);
            tell("clip", "xyzw", at.clip, 4);
            tell("NDC", "xyz", at.ndc.value, 3);
            tell("window", "xyz", window, 3);
        }
        const std::vector<LitPixel> lit = litPixels(studio.resource(lab, frame, "marked pixel"));
        const LitPixel first = lit.empty() ? LitPixel{-1, -1, 0, -1} : lit[0];
        figures.push_back({fmt::format("{}: pixels that light up", chosen.name),
                           static_cast<double>(lit.size()), "", equals(1)});
        figures.push_back({fmt::format("{}: its column, by the window's x", chosen.name),
                           static_cast<double>(first.x), "", equals(std::floor(window.x))});
        figures.push_back({fmt::format("{}: its row, by the window's y", chosen.name),
                           static_cast<double>(first.y), "", equals(std::floor(window.y))});
        // Depth is (1 + z/w) / 2 in float: some eight roundings of 2^-24.
        figures.push_back({fmt::format("{}: its depth, by the window's z", chosen.name), first.depth, "",
                           equals(window.z, 8 * 0x1p-24)});
    }
    return figures;
}

std::vector<Measurement> measureRigid() {
    StressInputs draw(56);
    struct Kind {
        const char* name;
        bool keepsDistances;
        bool keepsAngles;
        bool keepsHands;
        double lengthChange = 0;
        double angleChange = 0;
        double leastDeterminant = std::numeric_limits<double>::infinity();
        double mostDeterminant = -std::numeric_limits<double>::infinity();
    };
    std::array<Kind, 5> kinds = {{{"rigid", true, true, true},
                                  {"uniform scale", false, true, true},
                                  {"uneven scale", false, false, true},
                                  {"shear", false, false, true},
                                  {"mirror", true, true, false}}};
    for (int i = 0; i < 4000; ++i) {
        for (std::size_t k = 0; k < kinds.size(); ++k) {
            glm::dmat3 shape(1);
            if (k == 1)
                shape = glm::dmat3(draw.random().uniform(1.5, 3));
            if (k == 2)
                shape[1][1] = draw.random().uniform(1.5, 3);
            if (k == 3)
                shape[1][0] = draw.random().uniform(0.5, 2);
            if (k == 4)
                shape[0][0] = -1;
            glm::mat4 m{glm::mat3(draw.rotation() * shape * draw.rotation())};
            m[3] = glm::vec4(draw.vectorOfMagnitude(-3, 3), 1);
            const glm::vec3 p(draw.direction());
            const glm::vec3 q(draw.direction());
            const glm::vec3 r(draw.direction());
            const auto at = [&](glm::vec3 v) {
                return glm::dvec3(glm::dmat4(m) * glm::dvec4(glm::dvec3(v), 1));
            };
            const auto angle = [](glm::dvec3 a, glm::dvec3 b) {
                return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
            };
            const glm::dvec3 pq = glm::dvec3(q) - glm::dvec3(p);
            const glm::dvec3 pr = glm::dvec3(r) - glm::dvec3(p);
            Kind& kind = kinds[k];
            kind.lengthChange =
                std::max(kind.lengthChange, std::abs(glm::length(at(q) - at(p)) / glm::length(pq) - 1));
            kind.angleChange =
                std::max(kind.angleChange, std::abs(angle(at(q) - at(p), at(r) - at(p)) - angle(pq, pr)));
            const double det = determinant(glm::mat3(m));
            kind.leastDeterminant = std::min(kind.leastDeterminant, det);
            kind.mostDeterminant = std::max(kind.mostDeterminant, det);
        }
    }
    std::vector<Measurement> figures;
    // The entries of R are rounded by 2^-25 each; angles of slender triangles magnify that.
    for (const Kind& kind : kinds) {
        figures.push_back({fmt::format("{}: largest change of a distance", kind.name),
                           100 * kind.lengthChange, "%", kind.keepsDistances ? atMost(2e-5) : atLeast(10)});
        figures.push_back({fmt::format("{}: largest change of an angle", kind.name), kind.angleChange, "rad",
                           kind.keepsAngles ? atMost(1e-5) : atLeast(0.1)});
        figures.push_back(
            {fmt::format("{}: determinant, {}", kind.name, kind.keepsHands ? "smallest" : "largest"),
             kind.keepsHands ? kind.leastDeterminant : kind.mostDeterminant, "",
             kind.keepsHands ? (kind.keepsDistances ? equals(1, 4e-7) : atLeast(0.5)) : equals(-1, 4e-7)});
    }
    return figures;
}

std::vector<Measurement> measureOrders(Studio& studio) {
    TransformsLab lab;
    const Frame frame = plainFrame(lab, studio);
    const Image intended = studio.linearPicture(lab, frame);
    std::vector<Measurement> figures;
    Trs placement;
    const auto three = [](float x, float y, float z) { return glm::vec3(x, y, z); };
    placement.translation = three(lab.translateX, lab.translateY, lab.translateZ);
    placement.rotation =
        glm::mat3(glm::rotate(glm::mat4(1), glm::radians(static_cast<float>(lab.heading)), {0, 1, 0}) *
                  glm::rotate(glm::mat4(1), glm::radians(static_cast<float>(lab.heel)), {1, 0, 0}));
    placement.scale = three(lab.scaleX, lab.scaleY, lab.scaleZ);
    figures.push_back({"T R S against the placement put together from its parts",
                       largestDifference(compose(placement), lab.worldFromBoat()), "", atMost(4e-7)});
    int same = 0;
    for (int i = 0; i < TransformsLab::orderCount; ++i) {
        lab.order.set(i);
        const double difference = rmse(intended, studio.linearPicture(lab, frame));
        same += difference == 0 ? 1 : 0;
        figures.push_back({fmt::format("picture of {} against the intended, RMSE", lab.order.text()),
                           difference, "", i == TransformsLab::intendedOrder ? equals(0) : atLeast(0.02)});
    }
    figures.push_back({"orders that give the intended picture", static_cast<double>(same), "", equals(1)});
    lab.scaleX.set(1.2f);
    lab.scaleY.set(1.2f);
    lab.scaleZ.set(1.2f);
    lab.order.parse("TRS");
    const Image even = studio.linearPicture(lab, frame);
    lab.order.parse("TSR");
    figures.push_back({"with a uniform scale, T S R against T R S, RMSE",
                       rmse(even, studio.linearPicture(lab, frame)), "", atMost(2e-3)});
    return figures;
}

std::vector<Measurement> measureProjection() {
    glm::mat4 m(1);
    m[2][2] = 0;
    StressInputs draw(58);
    std::size_t parallel = 0;
    std::size_t onPlane = 0;
    constexpr int count = 10'000;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 p = draw.vectorOfMagnitude(-5, 5);
        const glm::vec3 along = draw.vectorOfMagnitude(-5, 5);
        onPlane += (m * glm::vec4(p, 1)).z == 0 ? 1 : 0;
        const glm::vec3 first(m * glm::vec4(along, 0));
        const glm::vec3 second(m * glm::vec4(-2.0f * along, 0));
        parallel += crossInDouble(first, second) == glm::dvec3(0) && dotInDouble(first, second) < 0 ? 1 : 0;
    }
    // The rank: the determinant is zero, and a 3×3 minor is not.
    glm::mat3 minor(1);
    minor[0] = {m[0][0], m[0][1], m[0][3]};
    minor[1] = {m[1][0], m[1][1], m[1][3]};
    minor[2] = {m[3][0], m[3][1], m[3][3]};
    const glm::vec4 view = m * glm::vec4(0, 0, 1, 0);
    return {
        {"M · M against M, worst entry", largestDifference(m * m, m), "", equals(0)},
        {"det M", determinant(m), "", equals(0)},
        {"determinant of rows and columns x, y, w", determinant(minor), "", equals(1)},
        {"inverses found", inverse(m) ? 1.0 : 0.0, "", equals(0)},
        {"points that land on z = 0", static_cast<double>(onPlane), "", equals(count)},
        {"parallel lines that stay parallel", static_cast<double>(parallel), "", equals(count)},
        {"length of the image of the view direction (0, 0, 1, 0)", length(glm::vec3(view)), "", equals(0)}};
}

std::vector<Measurement> measureHomogenization() {
    StressInputs draw(70);
    std::array<std::size_t, 4> kinds{};
    double error = 0;
    double naiveError = 0;
    std::size_t notFinite = 0;
    std::size_t naiveNotFinite = 0;
    constexpr int count = 200'000;
    for (int i = 0; i < count; ++i) {
        glm::vec4 p(draw.vectorOfMagnitude(-100, 100),
                    static_cast<float>(draw.sign() * draw.magnitude(-148, 100)));
        if (i % 10 == 0)
            p.w = 0;
        const Homogenized got = homogenize(p);
        const glm::vec3 naive = homogenizeNaive(p);
        ++kinds[static_cast<std::size_t>(got.kind)];
        notFinite += isFinite(got.value) ? 0 : 1;
        naiveNotFinite += isFinite(naive) ? 0 : 1;
        if (!got.isPoint())
            continue;
        for (int axis = 0; axis < 3; ++axis) {
            const Quad exact = Quad(p[axis]) / p.w;
            error = std::max(error, ulpError(got.value[axis], exact));
            if (isFinite(naive))
                naiveError = std::max(naiveError, ulpError(naive[axis], exact));
        }
    }
    // As w falls to zero the point runs away along the same direction, which w = 0 then names.
    const glm::vec3 limit = homogenize(glm::vec4(1, 2, -2, 0)).value;
    const glm::vec3 nearLimit = normalizeOr(homogenize(glm::vec4(1, 2, -2, 1e-30f)).value, glm::vec3(0));
    return {{"(2, 4, 6, 2) / w: z", homogenize(glm::vec4(2, 4, 6, 2)).value.z, "", equals(3)},
            {"points (w > 0)", static_cast<double>(kinds[0]), "", atLeast(1000)},
            {"points behind the eye (w < 0), named so", static_cast<double>(kinds[1]), "", atLeast(1000)},
            {"directions (w = 0, or p / w beyond float), named so", static_cast<double>(kinds[2]), "",
             atLeast(0.1 * count)},
            {"worst error of p / w", error, "ulp", atMost(0.5)},
            {"worst error of p · (1 / w)", naiveError, "ulp", {}},
            {"results that are infinite or not numbers", static_cast<double>(notFinite), "", equals(0)},
            {"the same of p · (1 / w)", static_cast<double>(naiveNotFinite), "", atLeast(0.1 * count)},
            {"direction of w = 0 against the limit of w → 0",
             glm::length(glm::dvec3(limit) - glm::dvec3(nearLimit)), "", atMost(1.1e-7)}};
}

std::vector<Measurement> measureNormalization() {
    StressInputs draw(71);
    double error = 0;
    double lengthError = 0;
    std::size_t naiveWrong = 0;
    std::size_t refused = 0;
    constexpr int count = 200'000;
    for (int i = 0; i < count; ++i) {
        const glm::vec3 v = i % 2 == 0 ? draw.vectorOfMagnitude(-149, 127) : draw.finiteVector();
        const QuadVector exact = normalizeQuad(QuadVector(v));
        const std::optional<glm::vec3> unit = normalize(v);
        if (!unit) {
            ++refused;
            continue;
        }
        error = std::max(
            {error, ulpError(unit->x, exact.x), ulpError(unit->y, exact.y), ulpError(unit->z, exact.z)});
        lengthError =
            std::max(lengthError, std::abs(static_cast<double>(lengthQuad(QuadVector(*unit)) - 1)) * 0x1p23);
        const glm::vec3 naive = normalizeNaive(v);
        const bool off = !isFinite(naive) || ulpError(naive.x, exact.x) > 4 ||
                         ulpError(naive.y, exact.y) > 4 || ulpError(naive.z, exact.z) > 4;
        naiveWrong += off ? 1 : 0;
    }
    const auto answered = [](glm::vec3 v) { return normalize(v) ? 1.0 : 0.0; };
    return {{"worst component, 2^-149 … 3.4e38", error, "ulp", atMost(0.5 + 0x1p-26)},
            {"worst length of the result, from 1", lengthError, "ulp(1)", atMost(0.87)},
            {"vectors without an answer", static_cast<double>(refused), "", equals(0)},
            {"by the formula in float: wrong by more than 4 ulp or not finite",
             100.0 * static_cast<double>(naiveWrong) / count, "%", atLeast(10)},
            {"answers for the zero vector", answered(glm::vec3(0)), "", equals(0)},
            {"answers for an infinite vector", answered(glm::vec3(std::numeric_limits<float>::infinity())),
             "", equals(0)},
            {"(3, 0, 4) / 5: z", normalizeOr(glm::vec3(3, 0, 4), glm::vec3(0)).z, "", equals(0.8f)}};
}

std::vector<Measurement> measureChain(Studio& studio) {
    TransformsLab lab;
    const Frame frame = plainFrame(lab, studio);
    const SpaceChain spaces = lab.chain(frame);
    const std::vector<LitPixel> lit = litPixels(studio.resource(lab, frame, "vertex pixels"));
    std::set<std::pair<int, int>> litPlaces;
    for (const LitPixel& pixel : lit)
        litPlaces.insert({pixel.x, pixel.y});

    std::size_t compared = 0;
    std::size_t dark = 0;
    std::size_t onBorders = 0;
    std::vector<glm::dvec3> windows;
    for (std::size_t i = 0; i < lab.boatFromPart().size(); ++i)
        for (const glm::vec3& position : lab.boat().meshes[lab.boat().instances[i].mesh].positions) {
            // One by one: model, view, projection, divide, viewport.
            const glm::vec3 model(lab.boatFromPart()[i] * glm::vec4(position, 1));
            const glm::dvec4 world = glm::dmat4(spaces.worldFromModel) * glm::dvec4(glm::dvec3(model), 1);
            const glm::dvec4 eye = glm::dmat4(spaces.eyeFromWorld) * world;
            const glm::dvec4 clip = glm::dmat4(spaces.clipFromEye) * eye;
            const glm::dvec4 ndc(glm::dvec3(clip) / clip.w, 1);
            const glm::dvec3 window(glm::dmat4(viewportMatrix(spaces.viewport)) * ndc);
            windows.push_back(window);
            if (std::abs(ndc.x) > 1 || std::abs(ndc.y) > 1 || std::abs(ndc.z) > 1)
                continue;
            // OpenGL keeps window coordinates to 1/256 pixel at least; float arithmetic moves them by 1e-3.
            const auto nearBorder = [](double x) { return std::abs(x - std::round(x)) < 1.0 / 256 + 1e-3; };
            if (nearBorder(window.x) || nearBorder(window.y)) {
                ++onBorders;
                continue;
            }
            ++compared;
            dark += litPlaces.contains(
                        {static_cast<int>(std::floor(window.x)), static_cast<int>(std::floor(window.y))})
                        ? 0
                        : 1;
        }
    double farthest = 0;
    double depthError = 0;
    for (const LitPixel& pixel : lit) {
        const glm::dvec3 window = windows.at(pixel.vertex);
        farthest =
            std::max({farthest, std::abs(pixel.x + 0.5 - window.x), std::abs(pixel.y + 0.5 - window.y)});
        depthError = std::max(depthError, std::abs(pixel.depth - window.z));
    }
    return {{"vertices compared", static_cast<double>(compared), "", atLeast(4000)},
            {"of these, whose pixel OpenGL left dark", static_cast<double>(dark), "", equals(0)},
            {"vertices too near a pixel's border to say", static_cast<double>(onBorders), "", {}},
            {"pixels lit", static_cast<double>(lit.size()), "", atLeast(1000)},
            {"farthest a lit pixel's centre is from its vertex", farthest, "pixels",
             atMost(0.5 + 1.0 / 256 + 1e-3)},
            {"depth against the chain's, worst", depthError, "", atMost(8 * 0x1p-24)}};
}

std::vector<Measurement> measureScaleThroughW() {
    StressInputs draw(112);
    double error = 0;
    double naiveError = 0;
    double directionChange = 0;
    constexpr int count = 100'000;
    for (int i = 0; i < count; ++i) {
        const auto d = static_cast<float>(draw.magnitude(-140, 100));
        const glm::vec3 p = draw.vectorOfMagnitude(-20, 20);
        const glm::vec4 scaled = scaleThroughW(d) * glm::vec4(p, 1);
        const glm::vec4 naive = scaleThroughWNaive(d) * glm::vec4(p, 1);
        for (int axis = 0; axis < 3; ++axis) {
            const Quad exact = Quad(p[axis]) * d;
            error = std::max(error, ulpError(homogenize(scaled).value[axis], exact));
            naiveError = std::max(naiveError, ulpError(naive[axis] / naive.w, exact));
        }
        const glm::vec4 direction = scaleThroughWNaive(d) * glm::vec4(p, 0);
        directionChange = std::max<double>(directionChange, length(glm::vec3(direction) - p));
    }
    const glm::vec4 worked = scaleThroughWNaive(4) * glm::vec4(1, 2, 3, 1);
    return {{"M (1, 2, 3, 1) for d = 4: w", worked.w, "", equals(0.25)},
            {"after the divide: x", homogenize(worked).value.x, "", equals(4)},
            {"after the divide: y", homogenize(worked).value.y, "", equals(8)},
            {"after the divide: z", homogenize(worked).value.z, "", equals(12)},
            {"d from 2^-140 to 2^100: worst error, diag(s, s, s, s/d)", error, "ulp", atMost(2.5)},
            {"the same, diag(1, 1, 1, 1/d)", naiveError, "ulp", {}},
            {"change of a direction (w = 0) by diag(1, 1, 1, 1/d)", directionChange, "", equals(0)}};
}

}  // namespace

std::vector<Question> TransformsLab::questions() {
    return {
        {1, "What is the model–view–projection matrix, and where does it take a vertex?",
         "It is the product P · V · M: M places the model in the world, V goes over to the eye's frame, and "
         "P to clip "
         "space, where what is visible has −w ≤ x, y, z ≤ w. A vertex shader multiplies by it once. "
         "Normalized device "
         "coordinates are not reached by any matrix: they come after the division by w, which OpenGL does "
         "itself once "
         "it has clipped.",
         "the product ends in clip space; NDC only follow after dividing by w",
         [](Studio& studio) { return measureVertexShader(studio); }},
        {4,
         "Vertices are transformed by a matrix M that need not be orthogonal: which matrix do their normals "
         "need?",
         "The inverse transpose of the upper 3×3: tangents go with M, and only (M⁻¹)ᵀ keeps n·t at zero "
         "under shear "
         "and uneven scale. The cofactor matrix is det M times that, divides by nothing, and so also serves "
         "models that "
         "are flattened; multiplied by the sign of the determinant it keeps normals outward when M mirrors. "
         "The length "
         "is lost either way: normalize afterwards.",
         "the inverse does not exist for flat models; the cofactor matrix does",
         [](Studio&) { return measureNormals(); }},
        {5, "Which entries of a 4×4 matrix with columns a–d, e–h, i–l, m–p scale, rotate and translate?",
         "m, n, o translate. The nine entries a b c, e f g, i j k carry rotation and scale together: each of "
         "the three "
         "columns is where an axis goes, its direction the rotation and its length the scale. Only while "
         "nothing is "
         "rotated are a, f, k the scale. d, h, l, p decide w: 0 0 0 1 unless there is a projection.",
         "the scale is the columns' lengths; a, f, k give it only where there is no rotation",
         [](Studio&) { return measureEntries(); }},
        {6,
         "A model has axes a, b, c and origin o, all known in the world: what is its model-to-world matrix?",
         "The axes and the origin are its columns: (a 0), (b 0), (c 0), (o 1). Then (1, 0, 0, 0) goes to a, "
         "and so on, "
         "and the model's origin (0, 0, 0, 1) to o, exactly.",
         "", [](Studio&) { return measureFrameMatrix(); }},
        {55, "Through which spaces does a vertex go from the model to the screen?",
         "Object (model) space, by M to world space, by V to eye (camera) space, by P to clip space, by the "
         "division by "
         "w to normalized device coordinates, and by the viewport to window coordinates: pixels and a depth.",
         "clip space is not the unit cube: that is NDC, after the divide",
         [](Studio& studio) { return measureSpaces(studio); }},
        {56, "What is a rigid-body transform?",
         "One that keeps every distance, and with them angles, and handedness too: a rotation and a "
         "translation, "
         "det R = +1. Scales and shears change distances; a mirror keeps them but turns a right hand into a "
         "left one, "
         "so it is no motion of a body.",
         "", [](Studio&) { return measureRigid(); }},
        {57,
         "A rotation R, a scale S and a translation T define an object's placement: how is a vertex "
         "transformed?",
         "v' = T R S v: scaled first, along the object's own axes, then turned about its own origin, then "
         "carried to "
         "its place. Any other order stretches along the wrong axes, or scales or turns the translation as "
         "well.",
         "", [](Studio& studio) { return measureOrders(studio); }},
        {58, "Give a simple 4×4 matrix that projects; onto which plane, and how?",
         "diag(1, 1, 0, 1) projects onto the plane z = 0, orthographically: along z, at right angles to the "
         "plane. Doing "
         "it twice changes nothing (M M = M), it has rank 3 and no inverse, parallel lines stay parallel, "
         "and the view "
         "direction itself vanishes.",
         "", [](Studio&) { return measureProjection(); }},
        {70, "What is the homogenization of p = (x, y, z, w)?",
         "p / w = (x/w, y/w, z/w, 1), for w ≠ 0. For w = 0 there is no such point: (x, y, z, 0) is a "
         "direction, a point "
         "at infinity. For w < 0 the quotient exists but the point lies behind the eye, which is why "
         "clipping comes "
         "before the divide.",
         "it fails for w = 0, and misleads for w < 0", [](Studio&) { return measureHomogenization(); }},
        {71, "How is a vector (a, b, c) normalized?",
         "Divide by the length: (a, b, c) / √(a² + b² + c²). In float the squares leave the range for "
         "lengths beyond "
         "about 2^±63, though the result never does; summing them in double keeps every component right. The "
         "zero "
         "vector has no direction, and the routine says so.",
         "the formula divides by zero for the zero vector", [](Studio&) { return measureNormalization(); }},
        {102, "Which matrices take a vertex from model space to the screen?",
         "The model matrix (model to world), the view matrix (world to eye), together called model–view, the "
         "projection "
         "matrix (eye to clip), and after the division by w the viewport matrix (NDC to window).",
         "between projection and viewport stands the division by w, which is no matrix",
         [](Studio& studio) { return measureChain(studio); }},
        {112, "Build a 4×4 matrix that scales uniformly by d through the homogenization.",
         "diag(1, 1, 1, 1/d): (x, y, z, 1) becomes (x, y, z, 1/d), and the division by w makes that (dx, dy, "
         "dz, 1). "
         "Directions have w = 0 and are not scaled. Where 1/d is not a normal float the result is lost; "
         "diag(s, s, s, s/d) with a power of two s near d is as good for every d.",
         "", [](Studio&) { return measureScaleThroughW(); }},
    };
}

}  // namespace quincunx
