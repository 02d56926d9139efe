#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "gl/context.h"
#include "grade/rubric.h"
#include "grade/scoring.h"
#include "lab/studio.h"

namespace quincunx::grade {

/// What a picture says of itself.
struct Claim {
    int width = 0;      ///< pixels it has
    int height = 0;     ///< pixels it has
    std::string state;  ///< its record (lab/picture_state.h); empty: none
};

/// The reference for a claim.
struct References {
    std::shared_ptr<const Reference> pictures;
    std::string key;                   ///< the same for the same picture
    std::vector<std::string> remarks;  ///< where the record was not followed
};

/// Renders references, each once, on a thread of its own, which owns the context. What a record claims is
/// followed only as far as the rubric leaves it free: knobs that it names itself stay as they are, models and
/// times are not followed, sizes are bounded, and a camera that hides an effect is refused.
class ReferenceStore {
  public:
    ReferenceStore(const LabEntry& entry, Rubric rubric, gl::Backend backend);
    ~ReferenceStore();
    ReferenceStore(const ReferenceStore&) = delete;
    ReferenceStore& operator=(const ReferenceStore&) = delete;

    /// From any thread; waits until it is rendered. Rethrows what drawing threw.
    References get(const Claim& claim);

  private:
    struct Task {
        Claim claim;
        std::promise<References> result;
    };
    struct Wanted {
        KnobValues knobs;
        Frame frame;
        bool cameraClaimed = false;
    };

    void work();
    References render(const Claim& claim);
    Wanted wantedFor(const Claim& claim, std::vector<std::string>& remarks);
    bool hidesAnEffect(const Wanted& wanted);
    Reference drawn(const Wanted& wanted);
    std::vector<double> areasOf(const Wanted& wanted);
    void useShader(const std::string& text);

    const LabEntry& entry_;
    Rubric rubric_;
    gl::Backend backend_;
    std::unique_ptr<Lab> lab_;
    std::unique_ptr<Studio> studio_;
    std::string shader_;     ///< of the exercise, under shaders/
    std::string solution_;   ///< its text
    std::string untouched_;  ///< the handout's; empty: there is none
    std::map<std::string, std::shared_ptr<const Reference>> kept_;
    std::deque<std::string> order_;  ///< of kept_, oldest first
    std::size_t keptBytes_ = 0;
    std::map<std::string, bool> hiding_;  ///< by the wanted picture's text

    std::mutex mutex_;
    std::condition_variable changed_;
    std::deque<Task> tasks_;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace quincunx::grade
