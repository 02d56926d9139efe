#pragma once

#include <map>
#include <string>
#include <vector>

#include "lab/lab.h"
#include "labs/03_rotations/drift.h"
#include "labs/03_rotations/gimbal.h"
#include "labs/03_rotations/paths.h"
#include "passes/forward.h"
#include "passes/labels.h"
#include "passes/lines.h"

namespace quincunx {

/// Euler angles as three rings, the lock, and ways from one pose to another.
class RotationsLab final : public Lab {
  public:
    enum class View { gimbal, lock, interpolation, drift };

    RotationsLab();

    std::string topic() const override {
        return "Euler angles, gimbal lock, quaternions and their interpolation";
    }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob view{knobs(),
                    "view",
                    {"gimbal", "lock", "interpolation", "drift"},
                    0,
                    "Three rings; free and locked; four ways from pose to pose; a million small turns"};
    ChoiceKnob order{knobs(),
                     "order",
                     {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"},
                     4,
                     "How the three matrices are multiplied, left to right: the outer ring comes first"};
    FloatKnob head{knobs(), "head", -25, {-180, 180}, "degrees", "Turn about y; the goal of interpolation"};
    FloatKnob pitch{knobs(), "pitch", 30, {-180, 180}, "degrees", "Turn about x; the goal of interpolation"};
    FloatKnob roll{knobs(), "roll", -20, {-180, 180}, "degrees", "Turn about z; the goal of interpolation"};
    FloatKnob fromHead{knobs(),     "from-head", -160,
                       {-180, 180}, "degrees",   "Turn about y where the interpolation starts"};
    FloatKnob fromPitch{knobs(),     "from-pitch", 55,
                        {-180, 180}, "degrees",    "Turn about x where the interpolation starts"};
    FloatKnob fromRoll{knobs(),     "from-roll", -115,
                       {-180, 180}, "degrees",   "Turn about z where the interpolation starts"};
    FloatKnob t{knobs(), "t", 0.35f, {0, 1}, "", "How far the interpolation is"};
    ChoiceKnob method{knobs(),
                      "method",
                      {methodNames.begin(), methodNames.end()},
                      static_cast<int>(Method::slerp),
                      "What the last panel of the interpolation shows"};
    IntKnob renormalizeEvery{
        knobs(),    "renormalize-every",
        16,         {0, 1 << 20, true},
        "products", "Small turns after which drift makes the quaternion unit length again; 0: never"};
    BoolKnob rings{knobs(), "rings", true, "Draw the gimbal around the aeroplane"};
    BoolKnob notes{knobs(), "notes", true, "Write names and figures into the picture"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Samples along a side of a pixel, averaged"};

    EulerOrder eulerOrder() const { return order.as<EulerOrder>(); }
    /// As the knobs say, in radians.
    EulerAngles angles() const;
    EulerAngles startAngles() const;
    /// The same with the middle ring at ±90°, on the side where it is.
    EulerAngles lockedAngles() const;
    Flight flight() const { return {startAngles(), angles(), eulerOrder()}; }

  private:
    /// A part of the picture, in pixels of the drawn target from its bottom left.
    struct Panel {
        int left = 0;
        int bottom = 0;
        int width = 1;
        int height = 1;
        float unit = 1;  ///< pixels of the target for a pixel of a picture 480 high
        ForwardView view;

        glm::vec2 size() const { return {width, height}; }
    };
    Panel panelOf(const Frame& frame, int factor, int column, int row, int columns, int rows) const;
    void say(const std::string& words, glm::vec2 at, float size, Labels::Anchor anchor, glm::vec3 color,
             const Panel& panel);
    void finish(graph::PassContext& context, const Panel& panel);

    void drawFrame(graph::PassContext& context, const Frame& frame, int factor);
    void drawGimbal(graph::PassContext& context, const Panel& panel, EulerAngles angles, bool showAxes);
    void drawFlight(graph::PassContext& context, const Panel& panel, Method method);
    void drawDrift(graph::PassContext& context, const Panel& panel, int every);
    void drawSpeed(graph::PassContext& context, const Panel& panel, Method method, glm::vec3 color);

    static constexpr std::size_t ghosts = 9;
    std::map<int, Drift> drifts_;  ///< by products between renormalisations; of the knob's value, and never
    ForwardScene gimbal_;
    ForwardScene flight_;
    Lines lines_;
    Labels labels_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx
