#include "labs/02_car_camera/drift.h"

#include <algorithm>
#include <cmath>

#include "base/interrupt.h"
#include "math/rigid_motion.h"
#include "math/vector.h"

namespace quincunx {
namespace {

constexpr std::int64_t turnsBetweenInterrupts = 1 << 20;

glm::mat3 orthonormal(const glm::mat3& frame, Renormalizer renormalizer) {
    switch (renormalizer) {
        case Renormalizer::gramSchmidt:
            return gramSchmidt(frame).value_or(frame);
        case Renormalizer::newtonSchulz:
            return newtonSchulzStep(frame);
        case Renormalizer::nearest:
            return nearestRotation(frame).value_or(frame);
        case Renormalizer::duff:
            return orthonormalizedByDuff(frame).value_or(frame);
    }
    return frame;
}

template <typename Step>
void repeat(std::int64_t turns, const Step& step) {
    for (std::int64_t i = 0; i < turns; ++i) {
        if (i % turnsBetweenInterrupts == 0)
            throwIfInterrupted();
        step(i);
    }
}

}  // namespace

glm::dmat3 slopingFrame() {
    return turnMatrix(glm::dvec3(0, 1, 0), 0.7) * turnMatrix(glm::dvec3(1, 0, 0), -0.4) *
           turnMatrix(glm::dvec3(0, 0, 1), 0.25);
}

glm::mat3 turnedOften(const DriftSettings& settings, const glm::dmat3& start) {
    const glm::vec3 up(0, 1, 0);
    const double radians = std::atan(static_cast<double>(settings.epsilon));
    const auto rounded = static_cast<float>(radians);
    if (settings.update == TurnUpdate::exact) {
        Orientation body;
        repeat(settings.turns, [&](std::int64_t) { body.turnAboutBody(glm::dvec3(up), radians); });
        return glm::mat3(start * body.worldFromBody());
    }
    glm::mat3 frame(start);
    repeat(settings.turns, [&](std::int64_t i) {
        switch (settings.update) {
            case TurnUpdate::exact:
            case TurnUpdate::rounded:
                frame = turned(frame, up, rounded).value_or(frame);
                return;
            case TurnUpdate::product:
                frame = turnedNaive(frame, up, rounded);
                break;
            case TurnUpdate::card:
                frame = turnLeftNaive(frame, settings.epsilon);
                break;
            case TurnUpdate::cardMirrored:
                frame = turnLeftMirroredNaive(frame, settings.epsilon);
                return;
        }
        if (settings.every > 0 && (i + 1) % settings.every == 0)
            frame = orthonormal(frame, settings.renormalizer);
    });
    return frame;
}

glm::dmat3 turnedExactly(const DriftSettings& settings, const glm::dmat3& start) {
    const long double radians =
        static_cast<long double>(settings.turns) * std::atan(static_cast<long double>(settings.epsilon));
    const auto c = static_cast<double>(std::cos(radians));
    const auto s = static_cast<double>(std::sin(radians));
    return start * glm::dmat3(glm::dvec3(c, 0, -s), glm::dvec3(0, 1, 0), glm::dvec3(s, 0, c));
}

double departureFromOrthonormal(const glm::mat3& r) {
    double worst = 0;
    for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
            worst = std::max(worst, std::abs(dotInDouble(r[i], r[j]) - (i == j ? 1 : 0)));
    return worst;
}

double largestDifference(const glm::mat3& a, const glm::dmat3& b) {
    double worst = 0;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            worst = std::max(worst, std::abs(static_cast<double>(a[column][row]) - b[column][row]));
    return worst;
}

}  // namespace quincunx
