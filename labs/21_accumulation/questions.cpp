#include <array>
#include <cmath>

#include <fmt/format.h>

#include "image/compare.h"
#include "labs/21_accumulation/measure.h"

namespace quincunx {
namespace {

void measureEdges(AccumulationLab& lab, Studio& studio, std::vector<Measurement>& figures) {
    struct Edge {
        Subject subject;
        const char* what;
        double bound;
    };
    // Measured 0.0014, 0.0004, 0.0023, 0.0063 and 0.0016; the penumbra has the texels of its map in it.
    for (const Edge& edge : {Edge{Subject::movingEdge, "motion blur, an edge that moves", 0.008},
                             Edge{Subject::turningEdge, "motion blur, an edge that turns", 0.008},
                             Edge{Subject::defocusedEdge, "depth of field, an edge before the focus", 0.012},
                             Edge{Subject::penumbra, "soft shadow, the penumbra of an edge", 0.015},
                             Edge{Subject::edge, "antialiasing, pixels that an edge cuts", 0.008}}) {
        lab.subject.set(static_cast<int>(edge.subject));
        figures.push_back({fmt::format("{}: RMSE of 64 passes against the closed form", edge.what),
                           edgeError(lab, studio, 96, 24), "", atMost(edge.bound)});
    }
    lab.subject.set(static_cast<int>(Subject::movingEdge));
    const std::vector<int> passes = {4, 16, 64};
    const double random = convergenceOf(lab, studio, SamplePattern::random, passes, 8).slope;
    const double sobol = convergenceOf(lab, studio, SamplePattern::sobol, passes, 4).slope;
    // One half and one; over a few seeds slopes scatter by 0.1.
    figures.push_back({"slope of the error over passes, random moments", random, "", equals(-0.5, 0.15)});
    figures.push_back({"slope of the error over passes, Sobol' moments", sobol, "", equals(-1, 0.15)});
    lab.subject.set(static_cast<int>(Subject::toys));
}

void measureToys(AccumulationLab& lab, Studio& studio, std::vector<Measurement>& figures) {
    const Frame frame = studio.frame(lab, 64, 48);
    const Image converged = convergedPicture(lab, studio, frame, 256);
    double few = 0;
    double many = 0;
    for (const int passes : {1, 4, 16, 64}) {
        lab.passes.set(passes);
        const double error = rmse(converged, studio.linearPicture(lab, frame));
        const double seconds = studio.pictureSeconds();
        figures.push_back({fmt::format("toys, all four effects, {} passes: RMSE against 256 others", passes),
                           error,
                           "",
                           {}});
        figures.push_back({fmt::format("toys, {} passes: time", passes), seconds * 1e3, "ms", {}});
        (passes == 4 ? few : many) = error;
    }
    // 16 times the passes: 4 times less for random ones, up to 16 times less for even ones.
    figures.push_back({"toys: 4 passes over 64 passes, error", few / many, "times", atLeast(4)});

    lab.passes.set(8);
    studio.linearPicture(lab, frame);
    figures.push_back({"passes for all four effects at once, 8 asked for",
                       static_cast<double>(lab.counters().at("passes")), "", equals(8)});
    lab.leaveOut({"depth of field", "soft shadows", "motion blur"});
    studio.linearPicture(lab, frame);
    figures.push_back(
        {"passes for one of them", static_cast<double>(lab.counters().at("passes")), "", equals(8)});
    figures.push_back({"shadow maps where neither light nor toys move",
                       static_cast<double>(lab.counters().at("shadow maps")), "", equals(1)});
    lab.leaveOut({"antialiasing", "depth of field", "soft shadows", "motion blur"});
    studio.linearPicture(lab, frame);
    figures.push_back({"passes where no effect is called for",
                       static_cast<double>(lab.counters().at("passes")), "", equals(1)});
    lab.leaveOut({});
}

void measureBuffers(Studio& studio, std::vector<Measurement>& figures) {
    constexpr float grey = 0.7f;
    struct Kept {
        const char* what;
        AccumulationBuffer buffer;
        Summation summation;
        std::optional<Bound> bound;
    };
    constexpr std::size_t frames = 2048;
    for (const Kept& kept :
         {Kept{"8 bits, each frame divided by their number", AccumulationBuffer::rgba8, Summation::weighted,
               equals(1)},
          Kept{"16-bit float, the same", AccumulationBuffer::rgba16f, Summation::weighted, atLeast(0.01)},
          Kept{"32-bit float, the same", AccumulationBuffer::rgba32f, Summation::weighted, atMost(1e-3)},
          // Blocks of 16: bound (16 + 3) · 2^-24.
          Kept{"32-bit float, compensated", AccumulationBuffer::rgba32f, Summation::compensated,
               atMost(1.14e-6)}}) {
        const double mean = meanOfSameFrames(
            studio, {.summation = kept.summation, .buffer = kept.buffer, .passes = frames}, grey);
        figures.push_back({fmt::format("{} equal frames, {}: relative error", frames, kept.what),
                           std::abs(mean / static_cast<double>(grey) - 1), "", kept.bound});
    }
}

std::vector<Measurement> measureEffects(Studio& studio) {
    AccumulationLab lab;
    lab.tessellation.set(10);
    lab.shadowResolution.set(256);
    std::vector<Measurement> figures;
    measureEdges(lab, studio, figures);
    measureToys(lab, studio, figures);
    measureBuffers(studio, figures);
    return figures;
}

}  // namespace

std::vector<Question> AccumulationLab::questions() {
    return {
        {111, "What can an accumulation buffer be used for? Name at least two effects.",
         "For whatever is a mean over many pictures. Motion blur: the scene at moments while the shutter is "
         "open. "
         "Depth of field: seen from points of a lens, each view sheared so that the plane of focus stays in "
         "place. Soft shadows: lit from points of a lamp, each with hard shadows. Antialiasing: moved by "
         "fractions of a pixel. The pictures are drawn one after the other and their mean is kept in a "
         "buffer "
         "with more bits than a screen has; with eight bits the shares of many passes round to nothing. One "
         "set "
         "of passes does all of it at once, if each draws its pixel, lens, lamp and moment from one sample. "
         "The error falls with the root of the number of passes where samples are random, and nearly with "
         "the "
         "number itself where they are evenly spread.",
         "", [](Studio& studio) { return measureEffects(studio); }},
    };
}

}  // namespace quincunx
