#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/random.h"
#include "image/compare.h"
#include "lab/studio.h"
#include "labs/10_shading/lab.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr int answerWidth = 320;
constexpr int answerHeight = 240;
constexpr std::size_t directionCount = 100'000;

glm::vec3 randomDirection(Random& random) {
    for (;;) {
        const glm::vec3 v(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (glm::dot(v, v) > 0.01f && glm::dot(v, v) <= 1)
            return *normalize(v);
    }
}

Image referenceOf(const ShadingLab& lab, const Frame& frame) {
    return lab.reference(frame)(interruptFlag());
}

/// RMSE of the picture against the exact surfaces, one sample a pixel on both sides.
double errorOf(ShadingLab& lab, Studio& studio, const Frame& frame, ShadingModel shading, int segments,
               const Image& reference) {
    lab.shading.set(static_cast<int>(shading));
    lab.tessellation.set(segments);
    return rmse(reference, studio.linearPicture(lab, frame));
}

Frame plainFrame(ShadingLab& lab, Studio& studio) {
    for (Knob* knob : lab.knobs().all())
        knob->reset();
    lab.supersample.set(1);
    return studio.frame(lab, answerWidth, answerHeight);
}

std::vector<Measurement> measureHalfVector() {
    Random random(32);
    double worst = 0;
    std::size_t unanswered = 0;
    std::size_t naiveNotFinite = 0;
    for (std::size_t i = 0; i < directionCount; ++i) {
        const glm::vec3 wi = randomDirection(random);
        const glm::vec3 wo = i % 2 == 0 ? randomDirection(random) : -wi;
        const std::optional<glm::vec3> half = halfVector(wi, wo);
        if (!half) {
            ++unanswered;
            naiveNotFinite += isFinite(halfVectorNaive(wi, wo)) ? 0 : 1;
            continue;
        }
        // The half vector makes the same angle with both: |cos(wi, wh) − cos(wo, wh)| is zero but for
        // rounding.
        worst = std::max(worst, std::abs(dotInDouble(wi, *half) - dotInDouble(wo, *half)));
    }
    return {{"difference of the cosines to wi and wo, worst", worst, "", atMost(3e-7)},
            {"opposite pairs told to have none", static_cast<double>(unanswered), "pairs",
             equals(0.5 * static_cast<double>(directionCount))},
            {"of these, not finite by the card's formula", static_cast<double>(naiveNotFinite), "pairs", {}}};
}

std::vector<Measurement> measureExample() {
    const glm::vec3 l(1, 2, 3);
    const glm::vec3 n(2, 3, 4);
    const glm::vec3 r = mirrorDirection(l, n).value_or(glm::vec3(0));
    const glm::vec3 unit = normalizeOr(r, glm::vec3(0));
    return {{"29 r, x", 29.0 * r.x, "", equals(51, 4e-6)},
            {"29 r, y", 29.0 * r.y, "", equals(62, 4e-6)},
            {"29 r, z", 29.0 * r.z, "", equals(73, 4e-6)},
            {"length of r, squared", dotInDouble(r, r), "", equals(14, 3e-6)},
            {"r / |r|, x", unit.x, "", equals(51 / (29 * std::sqrt(14.0)), 6e-8)},
            {"r / |r|, y", unit.y, "", equals(62 / (29 * std::sqrt(14.0)), 6e-8)},
            {"r / |r|, z", unit.z, "", equals(73 / (29 * std::sqrt(14.0)), 6e-8)},
            {"length of r / |r|", std::sqrt(dotInDouble(unit, unit)), "", equals(1, 1e-7)}};
}

std::vector<Measurement> measureReflection() {
    Random random(114);
    double signMismatch = 0;
    double lengthError = 0;
    double naiveLengthError = 0;
    for (std::size_t i = 0; i < directionCount; ++i) {
        const glm::vec3 l = randomDirection(random);
        const glm::vec3 n = randomDirection(random) * static_cast<float>(random.uniform(0.5, 2));
        const glm::vec3 in = reflect(l, n).value_or(glm::vec3(0));
        // The other question's formula, written out in double for the light seen from the surface.
        const glm::dvec3 away(-l);
        const glm::dvec3 normal(n);
        const glm::dvec3 out = 2 * glm::dot(normal, away) / glm::dot(normal, normal) * normal - away;
        signMismatch = std::max(signMismatch, glm::length(glm::dvec3(in) - out));
        lengthError = std::max(lengthError, std::abs(std::sqrt(dotInDouble(in, in)) - 1));
        const glm::vec3 naive = reflectNaive(l, n);
        naiveLengthError = std::max(naiveLengthError, std::abs(std::sqrt(dotInDouble(naive, naive)) - 1));
    }
    return {{"l at the surface against -l away from it: difference", signMismatch, "", atMost(6e-8)},
            {"| |r| - 1 | for unit l and a normal of any length", lengthError, "", atMost(2e-7)},
            {"the same by the card's formula", naiveLengthError, "", {}}};
}

std::vector<Measurement> measureModels(Studio& studio) {
    ShadingLab lab;
    const Frame frame = plainFrame(lab, studio);
    const Image reference = referenceOf(lab, frame);
    static constexpr std::array names = {"flat", "Gouraud", "Phong"};
    std::array<double, 3> coarse{};
    std::array<double, 3> fine{};
    std::vector<Measurement> figures;
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto shading = static_cast<ShadingModel>(i);
        coarse[i] = errorOf(lab, studio, frame, shading, 24, reference);
        fine[i] = errorOf(lab, studio, frame, shading, 96, reference);
        figures.push_back({fmt::format("{}: RMSE with 24 segments", names[i]), coarse[i], "", {}});
        figures.push_back({fmt::format("{}: RMSE with 96 segments", names[i]), fine[i], "", {}});
    }
    // Measured 1.30, 1.29, 1.39 and 1.64: the order is the claim, so the bounds lie between them and a tie.
    figures.push_back({"24 segments: flat over Gouraud", coarse[0] / coarse[1], "times", atLeast(1.05)});
    figures.push_back({"24 segments: Gouraud over Phong", coarse[1] / coarse[2], "times", atLeast(1.05)});
    figures.push_back({"96 segments: flat over Gouraud", fine[0] / fine[1], "times", atLeast(1.2)});
    figures.push_back({"96 segments: Gouraud over Phong", fine[1] / fine[2], "times", atLeast(1.2)});
    return figures;
}

std::vector<Measurement> measureCost(Studio& studio) {
    ShadingLab lab;
    const Frame frame = plainFrame(lab, studio);
    std::vector<Measurement> figures;
    const auto look = [&](int segments) {
        lab.tessellation.set(segments);
        lab.shading.set(static_cast<int>(ShadingModel::gouraud));
        const double gouraud = studio.time(lab, frame, 5, 1).medianSeconds;
        const auto vertices = static_cast<double>(lab.counters().at("vertices"));
        lab.shading.set(static_cast<int>(ShadingModel::phong));
        const double phong = studio.time(lab, frame, 5, 1).medianSeconds;
        const double background = static_cast<double>(frame.width) * frame.height;
        const double fragments = static_cast<double>(studio.samplesPassed(lab, frame)) - background;
        figures.push_back({fmt::format("{} segments: vertices", segments), vertices, "", {}});
        figures.push_back({fmt::format("{} segments: fragments", segments), fragments, "", {}});
        figures.push_back({fmt::format("{} segments: Phong's time over Gouraud's", segments),
                           phong / gouraud,
                           "times",
                           {}});
        return fragments / vertices;
    };
    const double coarse = look(16);
    double turn = 0;
    for (const int segments : {32, 64, 128, 256})
        if (look(segments) < 1 && turn == 0)
            turn = segments;
    const double fine = look(512);
    // Counts, the same on every machine: 28 and 20 times. A factor of 2 is clear of the turn.
    figures.push_back({"16 segments: Phong lights more often than Gouraud by", coarse, "times", atLeast(2)});
    figures.push_back(
        {"512 segments: Gouraud lights more often than Phong by", 1 / fine, "times", atLeast(2)});
    figures.push_back({"vertices outnumber fragments from", turn, "segments", equals(128)});
    return figures;
}

std::vector<Measurement> measureTerms(Studio& studio) {
    ShadingLab lab;
    const Frame frame = plainFrame(lab, studio);
    const std::array<BoolKnob*, 4> terms = {&lab.ambient, &lab.diffuse, &lab.specular, &lab.emission};
    const Image whole = studio.linearPicture(lab, frame);
    for (BoolKnob* term : terms)
        term->set(false);
    // Without any term the objects are black; the background is in every picture and must count once.
    const Image none = studio.linearPicture(lab, frame);
    std::vector<double> sum(none.data.begin(), none.data.end());
    std::vector<Measurement> figures;
    for (BoolKnob* term : terms) {
        term->set(true);
        const Image alone = studio.linearPicture(lab, frame);
        term->set(false);
        double mean = 0;
        const double colorValues = 3.0 * static_cast<double>(none.pixelCount());  // alpha does not differ
        for (std::size_t i = 0; i < sum.size(); ++i) {
            const double light = static_cast<double>(alone.data[i]) - none.data[i];
            sum[i] += light;
            mean += light / colorValues;
        }
        figures.push_back({"mean light of the term \"" + term->name() + "\"", mean, "", atLeast(1e-5)});
    }
    double worst = 0;
    for (std::size_t i = 0; i < sum.size(); ++i)
        worst = std::max(worst, std::abs(sum[i] - whole.data[i]));
    // Five pictures in float, each rounded by 2^-24 of values up to 4.
    figures.push_back({"sum of the four against the whole, worst pixel", worst, "", atMost(2e-6)});
    return figures;
}

}  // namespace

std::vector<Question> ShadingLab::questions() {
    return {
        {32, "How is the half vector of a direction wi to the light and a direction wo to the eye found?",
         "Add the two unit vectors and make the sum unit length: wh = (wi + wo) / |wi + wo|. It bisects the "
         "angle between them, and it is the normal that a tiny mirror would need to send light from wi to "
         "wo. When the two are opposite the sum is zero and there is no half vector: the highlight is then "
         "zero, since such light grazes the surface.",
         "the formula divides by zero for opposite directions", [](Studio&) { return measureHalfVector(); }},
        {37, "What are flat, Gouraud and Phong shading?",
         "They differ in where the light is evaluated. Flat: once a triangle, with the normal of its plane. "
         "Gouraud: once a vertex, and the colours are interpolated, so a highlight between vertices is lost "
         "or smeared. Phong: at every fragment, with the interpolated normal made unit length again. "
         "Against the exact surface each is more accurate than the one before, at every fineness.",
         "", [](Studio& studio) { return measureModels(studio); }},
        {90, "Which costs a GPU less, Gouraud or Phong shading?",
         "Gouraud evaluates the light once a vertex, Phong once a fragment, so Gouraud is cheaper while "
         "triangles cover many pixels. When triangles become smaller than pixels there are more vertices "
         "than fragments, and the order turns over; the interpolation that Gouraud saves with is then worth "
         "nothing.",
         "", [](Studio& studio) { return measureCost(studio); }},
        {105,
         "The light comes along l = (1,2,3), the surface has the normal n = (2,3,4): what is the reflected "
         "direction, and what is it at unit length?",
         "With l taken as pointing from the surface, r = 2 (n·l) n / (n·n) - l = 2 · 20/29 · (2,3,4) - "
         "(1,2,3) = (51,62,73)/29. Reflection keeps the length: |r| = |l| = √14, so the unit vector is "
         "(51,62,73) / (29 √14).",
         "normalising divides r by its length; the card sets r to its length, a number",
         [](Studio&) { return measureExample(); }},
        {113, "Which terms does the classic illumination model of real-time graphics add up?",
         "Ambient (light from everywhere, a constant), diffuse (light spread evenly, with the cosine of its "
         "angle to the normal) and specular (the highlight around the mirror direction); often emission, "
         "light of the surface's own. They are independent: rendered apart and added, they give the whole "
         "picture.",
         "", [](Studio& studio) { return measureTerms(studio); }},
        {114, "The light travels along l towards a surface with normal n: which way does it leave?",
         "r = l - 2 (n·l) n for a unit normal: the part of l along n is turned round. For a vector that "
         "points away from the surface the signs change, r = 2 (n·l) n - l; both give the same direction "
         "for the same light. Dividing by n·n makes it right for normals of any length, and the length of l "
         "is kept.",
         "the formula holds for unit normals only", [](Studio&) { return measureReflection(); }},
    };
}

}  // namespace quincunx
