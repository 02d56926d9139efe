#include <algorithm>
#include <string>
#include <vector>

#include "base/timing.h"
#include "lab/studio.h"
#include "labs/02_car_camera/lab.h"

namespace quincunx {
namespace {

constexpr int repeats = 5;

/// How far a turned frame is off, by whatever `error` measures, against the time that all turns take.
template <typename Error>
Sweep driftSweep(CarCameraLab& lab, std::string name, std::string title, std::string reference,
                 std::string metric, const Error& error) {
    Sweep sweep;
    sweep.name = std::move(name);
    sweep.title = std::move(title);
    sweep.reference = std::move(reference);
    sweep.metric = std::move(metric);
    const auto point = [&](const char* update, const char* every, const char* renormalizer) {
        sweep.points.push_back({{"turns", "199999"},
                                {"update", update},
                                {"renormalize-every", every},
                                {"renormalizer", renormalizer}});
    };
    // The last turn is one before R would be made orthonormal again: drift is at its largest.
    for (const char* every : {"0", "1", "4", "16", "64", "256", "4096"})
        point("product", every, "gram-schmidt");
    for (const char* every : {"1", "16", "256"})
        point("product", every, "newton-schulz");
    point("product", "16", "nearest");
    point("product", "16", "duff");
    point("card", "0", "gram-schmidt");
    point("card", "16", "gram-schmidt");
    point("rounded", "0", "gram-schmidt");
    point("exact", "0", "gram-schmidt");
    sweep.measure = [&lab, error](Studio&, const Frame&) {
        const DriftSettings settings = lab.drift();
        const glm::dmat3 start = slopingFrame();
        SweepSample sample;
        glm::mat3 frame(1);
        const Timing timing = timeRuns(repeats, [&] { frame = turnedOften(settings, start); });
        sample.error = error(frame, settings, start);
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        sample.counters["turns"] = static_cast<std::uint64_t>(settings.turns);
        sample.counters["renormalizations"] =
            settings.every > 0 ? static_cast<std::uint64_t>(settings.turns / settings.every) : 0;
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> CarCameraLab::sweeps() {
    std::vector<Sweep> sweeps;
    sweeps.push_back(driftSweep(*this, "orthonormality",
                                "making R orthonormal after every k turns: drift against time", "RᵀR = I",
                                "largest entry of |RᵀR - I| after 199 999 turns",
                                [](const glm::mat3& frame, const DriftSettings&, const glm::dmat3&) {
                                    return departureFromOrthonormal(frame);
                                }));
    sweeps.push_back(
        driftSweep(*this, "direction", "the way the car faces in the end, against time",
                   "one turn by the sum of the angles, in long double",
                   "largest entry of |R - exact| after 199 999 turns",
                   [](const glm::mat3& frame, const DriftSettings& settings, const glm::dmat3& start) {
                       return largestDifference(frame, turnedExactly(settings, start));
                   }));
    return sweeps;
}

}  // namespace quincunx
