#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graph/graph.h"
#include "image/image.h"
#include "lab/knob.h"
#include "math/hard_case.h"
#include "scene/scene.h"

namespace quincunx {

class Studio;

/// Everything besides the knobs that a picture depends on.
struct Frame {
    int width = 640;   ///< pixels
    int height = 480;  ///< pixels
    Camera camera;
    double timeSeconds = 0;
    std::uint64_t seed = 1;
    /// Of the picture: rgba8Srgb for people, rgba32f (linear light) for measurements.
    graph::Format pictureFormat = graph::Format::rgba8Srgb;
    /// In a window: a picture that converges may be shown as far as it has come, and be gone on with in the
    /// frames that follow (Lab::isConverging). Elsewhere every frame is whole.
    bool live = false;
    /// Drawn to make programs ready; nobody looks at it, and it may be as rough as is cheap.
    bool unseen = false;
};

/// A figure with what it must be.
struct Bound {
    enum class Kind { atMost, atLeast, equals };
    Kind kind = Kind::atMost;
    double value = 0;
    double tolerance = 0;  ///< for `equals`

    bool holds(double measured) const;  ///< false for NaN
    std::string text() const;           ///< "≤ 1e-06"
};

inline Bound atMost(double value) {
    return {Bound::Kind::atMost, value, 0};
}
inline Bound atLeast(double value) {
    return {Bound::Kind::atLeast, value, 0};
}
inline Bound equals(double value, double tolerance = 0) {
    return {Bound::Kind::equals, value, tolerance};
}

struct Measurement {
    std::string name;
    double value = 0;
    std::string unit;
    std::optional<Bound> bound;  ///< none: told for information

    bool pass() const { return !bound || bound->holds(value); }
};

/// An exam question and its running answer.
struct Question {
    int number = 0;
    std::string asked;    ///< in the project's own words
    std::string answer;   ///< in the project's own words
    std::string cardFix;  ///< what the flashcard gets wrong; empty: nothing
    std::function<std::vector<Measurement>(Studio&)> measure;
};

using KnobValues = std::vector<std::pair<std::string, std::string>>;

/// What one setting of the knobs costs and yields. Counters repeat exactly on every machine.
struct SweepSample {
    double error = 0;
    double seconds = 0;        ///< median of repeated runs
    double secondsSpread = 0;  ///< interquartile range
    std::map<std::string, std::uint64_t> counters;
};

/// A trade of accuracy for time: the settings to try, and how to measure one.
struct Sweep {
    std::string name;
    std::string title;
    std::string reference;  ///< what the error is measured against
    std::string metric;     ///< "RMSE", "FLIP", "wrong pixels" …
    std::string errorUnit;
    int width = 480;   ///< pixels, where no other size is asked for
    int height = 360;  ///< pixels
    /// The first knob's values are the plot's series. Knobs that a point leaves out are as before the sweep.
    std::vector<KnobValues> points;
    /// Called with the knobs set to a point, and with the same frame for all points.
    std::function<SweepSample(Studio&, const Frame&)> measure;
};

/// What an instructor can set on a lab (common/grade): the effects that pictures are held against, and the
/// shader that a student is to write.
struct Exercise {
    /// Where the pictures with and without it differ, that is the effect: "the highlights", `specular` off.
    struct Effect {
        std::string name;
        KnobValues without;  ///< the knobs that take it away; none: what the handout's shader lacks
    };
    KnobValues knobs;                    ///< of the picture that is asked for; others are as the lab has them
    std::vector<Effect> effects;         ///< none: the lab's switches and choices, those that show
    std::vector<std::string> freeKnobs;  ///< cost and smoothness: a picture may choose them
    /// Relative to shaders/, with places marked `// task: …`, `// instead: …` and `// end of task`.
    std::string shader;
    /// Further settings, over `shaderKnobs`, in which a shader is looked at.
    std::vector<KnobValues> scenes;
    KnobValues shaderKnobs;  ///< with which the shader is drawn at all; over `knobs`
};

/// What a lab that plans its frames says of an effect: common/passes/frame_effects.h.
struct EffectReport {
    std::string name;
    bool calledFor = false;
    std::string reason;               ///< a sentence
    std::vector<std::string> passes;  ///< that it added to the last frame
};

/// How long a person held the keys of movement down since they were last asked for, in seconds, so that
/// nothing is lost however seldom that is. Opposite keys cancel; two keys for one thing add up.
struct HeldSeconds {
    double forwards = 0;  ///< W, up arrow; less S, down arrow
    double left = 0;      ///< A, left arrow; less D, right arrow
    double up = 0;        ///< E, less Q

    bool operator==(const HeldSeconds&) const = default;
};

/// A key that a lab answers to in the window.
struct LabKey {
    char key = ' ';                      ///< 'A' … 'Z' or '0' … '9', none that the window itself uses
    std::string what;                    ///< one line of help
    std::function<std::string()> press;  ///< returns what to tell the person; may be nothing
};

/// One topic of the exam: its knobs, how a frame of it is drawn, and what can be asked of it.
class Lab {
  public:
    virtual ~Lab() = default;
    Lab(const Lab&) = delete;
    Lab& operator=(const Lab&) = delete;

    /// One line for `list`.
    virtual std::string topic() const = 0;
    KnobSet& knobs() { return knobs_; }
    const KnobSet& knobs() const { return knobs_; }

    /// Adds the passes of a frame; one of them writes the resource that is returned, the picture, of
    /// `frame.pictureFormat` and size. Called for every frame, with the same context current: a lab belongs
    /// to the first context that draws it.
    virtual graph::Resource build(graph::FrameGraph& graph, const Frame& frame) = 0;

    /// Draws this scene from now on (`--model`). InputError from labs that draw their own only.
    virtual void useScene(Scene scene);
    /// The camera at the start.
    virtual Camera defaultCamera() const = 0;
    /// What the window's orbit camera turns about, and how far it may go.
    virtual Bounds sceneBounds() const = 0;

    /// Says by Knob::setIdle which knobs are without effect at the values that the others have.
    virtual void markIdleKnobs() {}

    /// The camera where the lab holds it itself, for the picture as its knobs say; none where the camera is
    /// the frame's, and the person's. Throws nothing; neither does `advance`.
    virtual std::optional<Camera> ownCamera() const { return {}; }

    /// For what moves or is driven, in a window. While `takesControls`, W A S D, E and Q and the arrows are
    /// the lab's; while `isMoving`, it goes on without a hand. Then `advance` is called once a frame with the
    /// time since the last call, and changes the knobs that the picture is drawn by; true if it changed any.
    virtual bool takesControls() const { return false; }
    virtual bool isMoving() const { return false; }
    virtual bool advance(double /*seconds*/, const HeldSeconds& /*held*/) { return false; }
    virtual std::vector<LabKey> keys() { return {}; }

    /// True if the live frame that was built last shows less than it will: it is built again, as it is, until
    /// this is false or anything has changed. Throws nothing.
    virtual bool isConverging() const { return false; }

    /// Work that makes the reference picture (linear light) of this frame on the CPU, on any thread, without
    /// touching the lab again; it may give up, returning an empty image, once `stop` is set. Empty: no
    /// reference.
    using ReferenceJob = std::function<Image(const std::atomic<bool>& stop)>;
    virtual ReferenceJob reference(const Frame& frame) const;
    /// What the reference is, for people.
    virtual std::string referenceName() const { return {}; }

    virtual std::vector<Question> questions() { return {}; }
    virtual std::vector<Sweep> sweeps() { return {}; }
    virtual std::vector<HardCase> hardCases() { return {}; }
    virtual Exercise exercise() const { return {}; }

    /// The effects of the last frame, in and out; nothing from labs that draw all they have.
    virtual std::vector<EffectReport> effects() const { return {}; }
    /// Draws frames without these effects from now on, although they are called for. For measuring.
    virtual void leaveOut(const std::vector<std::string>& /*effects*/) {}
    /// Whether `plan` may show any file as this lab would draw it.
    virtual bool plansFiles() const { return false; }

    /// What the last frame drew: "triangles" and the like, exact.
    virtual std::map<std::string, std::uint64_t> counters() const { return {}; }

  protected:
    Lab() = default;

  private:
    KnobSet knobs_;
};

/// A lab as the program finds it: by the name of its folder.
struct LabEntry {
    int number = 0;
    std::string_view name;  ///< "shading"
    std::unique_ptr<Lab> (*make)() = nullptr;

    std::string folder() const;  ///< "10_shading"
    /// True for its number, its name and its folder.
    bool isCalled(std::string_view word) const;
};

/// Whole program: understands the command line, does what it says, returns the exit status.
int runCommandLine(int argc, const char* const* argv, std::span<const LabEntry> labs);

/// The same for the program of one lab: no lab is named, and the verb is `run` where none is given.
int runCommandLine(int argc, const char* const* argv, const LabEntry& lab);

}  // namespace quincunx

/// In lab.cpp: makes the lab known under its folder's name. The build system names the factory.
#define QUINCUNX_DEFINE_LAB(Type)                           \
    std::unique_ptr<quincunx::Lab> QUINCUNX_LAB_FACTORY() { \
        return std::make_unique<Type>();                    \
    }

/// In main.cpp: the program of this one lab.
#define QUINCUNX_LAB_MAIN                                                                            \
    std::unique_ptr<quincunx::Lab> QUINCUNX_LAB_FACTORY();                                           \
    int main(int argc, char** argv) {                                                                \
        const quincunx::LabEntry lab{QUINCUNX_LAB_NUMBER, QUINCUNX_LAB_NAME, &QUINCUNX_LAB_FACTORY}; \
        return quincunx::runCommandLine(argc, argv, lab);                                            \
    }
