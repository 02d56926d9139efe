#include <array>
#include <memory>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "image/compare.h"
#include "lab/studio.h"
#include "labs/10_shading/lab.h"

namespace quincunx {
namespace {

/// Shading model × tessellation. The reference does not depend on either knob: it is traced once a size.
Sweep tessellationSweep(ShadingLab& lab, std::string name, std::string title, int width, int height,
                        const std::array<std::vector<int>, 3>& segmentsByModel) {
    Sweep sweep;
    sweep.name = std::move(name);
    sweep.title = std::move(title);
    sweep.reference = lab.referenceName();
    sweep.metric = "RMSE";
    sweep.errorUnit = "of linear light";
    for (std::size_t model = 0; model < segmentsByModel.size(); ++model)
        for (const int segments : segmentsByModel[model])
            sweep.points.push_back({{"shading", lab.shading.options()[model]},
                                    {"tessellation", std::to_string(segments)},
                                    {"supersample", "1"}});
    sweep.width = width;
    sweep.height = height;
    const auto reference = std::make_shared<Image>();
    sweep.measure = [&lab, reference](Studio& studio, const Frame& frame) {
        if (reference->width != frame.width || reference->height != frame.height) {
            *reference = lab.reference(frame)(interruptFlag());
        }
        SweepSample sample;
        sample.error = rmse(*reference, studio.linearPicture(lab, frame));
        const Studio::Timing timing = studio.time(lab, frame);
        sample.seconds = timing.medianSeconds;
        sample.secondsSpread = timing.spreadSeconds;
        sample.counters = lab.counters();
        const std::uint64_t background =
            static_cast<std::uint64_t>(frame.width) * static_cast<std::uint64_t>(frame.height);
        sample.counters["fragments"] = studio.samplesPassed(lab, frame) - background;
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> ShadingLab::sweeps() {
    std::vector<Sweep> sweeps;
    sweeps.push_back(tessellationSweep(
        *this, "tessellation", "triangles or fragments: where to spend the light", 480, 360,
        {{{8, 16, 32, 64, 128, 256}, {8, 16, 32, 64, 128, 256}, {8, 16, 32, 64, 128, 256}}}));
    sweeps.push_back(tessellationSweep(
        *this, "subpixel", "triangles smaller than pixels: Gouraud becomes the dearer one", 96, 72,
        {{{}, {16, 32, 64, 128, 256, 512, 1024}, {16, 32, 64, 128, 256, 512, 1024}}}));
    return sweeps;
}

}  // namespace quincunx
