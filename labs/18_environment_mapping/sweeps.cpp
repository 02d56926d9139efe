#include <array>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "image/compare.h"
#include "lab/studio.h"
#include "labs/18_environment_mapping/lab.h"
#include "labs/18_environment_mapping/mirror_figures.h"

namespace quincunx {
namespace {

std::vector<Image> facesOf(const gl::TextureCube& cube, int level) {
    std::vector<Image> faces;
    for (int face = 0; face < gl::TextureCube::faceCount; ++face)
        faces.push_back(gl::readPixels(cube, face, level));
    return faces;
}

void time(EnvironmentMappingLab& lab, Studio& studio, const Frame& frame, SweepSample& sample) {
    const Studio::Timing timing = studio.time(lab, frame, 5, 1);
    sample.seconds = timing.medianSeconds;
    sample.secondsSpread = timing.spreadSeconds;
    sample.counters = lab.counters();
}

/// Texels and box projection against traced reflections, over the pixels of the ball.
Sweep resolutionSweep(EnvironmentMappingLab& lab) {
    Sweep sweep;
    sweep.name = "resolution";
    sweep.title = "texels of the map, with and without box projection, in the empty hall";
    sweep.reference = lab.referenceName();
    sweep.metric = "mean error";
    sweep.errorUnit = "of linear light, over the mirrors";
    for (const char* projection : {"off", "on"})
        for (const int texels : {16, 32, 64, 128, 256, 512, 1024})
            sweep.points.push_back({{"box-projection", projection}, {"resolution", std::to_string(texels)}});
    sweep.width = 320;
    sweep.height = 240;
    struct Reference {
        Image traced;
        Image vectors;
    };
    const auto reference = std::make_shared<Reference>();
    sweep.measure = [&lab, reference](Studio& studio, const Frame& frame) {
        lab.supersample.set(1);
        lab.solids.set(false);
        lab.reflector.set(static_cast<int>(EnvironmentMappingLab::Reflector::ball));
        if (reference->traced.width != frame.width || reference->traced.height != frame.height) {
            const MirrorHall hall = lab.currentHall();
            reference->traced =
                traceMirrors(hall, frame.camera, frame.width, frame.height, lab.mirrors(), &interruptFlag());
            reference->vectors =
                traceReflectionVectors(hall, frame.camera, frame.width, frame.height, lab.mirrors());
        }
        SweepSample sample;
        sample.error =
            compareMirrors(studio.linearPicture(lab, frame), reference->traced, reference->vectors, 1)
                .meanError;
        time(lab, studio, frame, sample);
        return sample;
    };
    return sweep;
}

/// Directions a texel against the integral itself.
Sweep sampleSweep(EnvironmentMappingLab& lab) {
    Sweep sweep;
    sweep.name = "samples";
    sweep.title = "directions a texel of the rough levels, from fine texels or from coarse ones";
    sweep.reference = "GGX's lobe summed up over all texels of the map, in double";
    sweep.metric = "RMSE";
    sweep.errorUnit = "of the mean radiance";
    for (const char* filtered : {"off", "on"})
        for (const int directions : {4, 16, 64, 256, 1024})
            sweep.points.push_back({{"filtered-samples", filtered}, {"samples", std::to_string(directions)}});
    sweep.width = 64;
    sweep.height = 48;
    sweep.measure = [&lab](Studio& studio, const Frame& frame) {
        constexpr int size = 64;
        constexpr int level = 3;  // of 6: roughness 0.6
        constexpr int stride = 5;
        lab.supersample.set(1);
        lab.resolution.set(size);
        lab.roughness.set(0.6f);
        SweepSample sample;
        studio.linearPicture(lab, frame);
        sample.error = prefilterError(facesOf(lab.map().radiance(), 0), facesOf(lab.map().radiance(), level),
                                      0.36, stride);
        time(lab, studio, frame, sample);
        sample.counters["texels looked up"] = lab.map().prefilterSamples();
        return sample;
    };
    return sweep;
}

}  // namespace

std::vector<Sweep> EnvironmentMappingLab::sweeps() {
    return {resolutionSweep(*this), sampleSweep(*this)};
}

}  // namespace quincunx
