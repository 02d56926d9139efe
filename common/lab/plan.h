#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lab/studio.h"

namespace quincunx {

/// What an effect that the frame calls for costs it.
struct EffectCost {
    std::int64_t glCalls = 0;
    std::int64_t bytes = 0;    ///< of targets
    double seconds = 0;        ///< what switching it on adds to this frame …
    double firstSeconds = 0;   ///< … by the even ones of the frames that were measured …
    double secondSeconds = 0;  ///< … and by the odd ones
    double aloneSeconds = 0;   ///< what it adds to a frame without other effects
};

/// What a frame does, why, and what each of its effects costs it.
struct FramePlan {
    struct Effect {
        EffectReport report;
        EffectCost cost;  ///< all zero unless it is called for
    };
    std::string scene;  ///< the model's name, or the lab's
    std::string lab;    ///< folder name
    std::string renderer;
    int width = 0;   ///< pixels
    int height = 0;  ///< pixels
    std::vector<Effect> effects;
    std::vector<gl::Executor::PassCost> passes;  ///< each waited for
    std::uint64_t glCalls = 0;
    double seconds = 0;           ///< of a frame
    std::size_t memoryBytes = 0;  ///< of its targets
};

/// Draws the frame with and without its effects, with progress. `frames`: that each variant is timed over; 0:
/// as many as take some seconds in all.
FramePlan planFrame(Lab& lab, const LabEntry& entry, const std::string& scene, Studio& studio,
                    const Frame& frame, int frames);

std::string toText(const FramePlan& plan);
nlohmann::ordered_json toJson(const FramePlan& plan);

}  // namespace quincunx
