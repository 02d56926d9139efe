#pragma once

#include <memory>
#include <optional>

#include "lab/lab.h"
#include "labs/02_car_camera/drift.h"
#include "labs/02_car_camera/town_pass.h"
#include "passes/lines.h"
#include "scene/car_path.h"
#include "scene/town.h"

namespace quincunx {

/// A car in a small town, driven by keys or by a recorded path, seen from outside and from its seat. Its
/// matrix M = T R, how R is turned over and over, and the camera in it, V = (T R)⁻¹.
class CarCameraLab final : public Lab {
  public:
    enum class View { chase, driver, bird, street, free };

    CarCameraLab();

    std::string topic() const override { return "a car's model matrix, and the camera in it"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    std::optional<Camera> ownCamera() const override;
    bool takesControls() const override { return view.as<View>() != View::free; }
    bool isMoving() const override;
    bool advance(double seconds, const HeldSeconds& held) override;
    std::vector<LabKey> keys() override;
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob view{knobs(),
                    "view",
                    {"chase", "driver", "bird", "street", "free"},
                    0,
                    "From behind the car, its seat, above, a street corner, or by the mouse"};
    TextKnob path{knobs(), "path", "off", "off, tour, or a file that was recorded",
                  "What drives: the knobs and keys, a tour of the town, or a record"};
    FloatKnob time{knobs(), "time", 8, {0, 600}, "s", "Where on its path the car is"};
    FloatKnob carX{knobs(), "car-x", -2, {-300, 300}, "m", "The car's place, to its left at heading 0"};
    FloatKnob carZ{knobs(), "car-z", -46, {-300, 300}, "m", "The car's place, ahead at heading 0"};
    FloatKnob heading{knobs(),     "heading", 0,
                      {-180, 180}, "degrees", "How far the car has turned to the left of the z axis"};
    FloatKnob steering{knobs(), "steering", 0, {-35, 35}, "degrees", "The front wheels, to the left"};
    FloatKnob wheelRoll{knobs(),     "wheel-roll", 0,
                        {-180, 180}, "degrees",    "How far the wheels have rolled forwards"};
    IntKnob turns{knobs(), "turns", 0, {0, 10'000'000}, "", "Turns the car left so often, by atan 0.01 each"};
    ChoiceKnob update{knobs(),
                      "update",
                      {"exact", "rounded", "product", "card", "card-mirrored"},
                      0,
                      "How R is turned: see README"};
    IntKnob every{knobs(), "renormalize-every",
                  0,       {0, 10'000},
                  "turns", "Makes R orthonormal after so many turns; 0: never"};
    ChoiceKnob renormalizer{knobs(),
                            "renormalizer",
                            {"gram-schmidt", "newton-schulz", "nearest", "duff"},
                            0,
                            "How R is made orthonormal"};
    FloatKnob far{knobs(),          "far", 0,
                  {0, 100'000'000}, "m",   "Moves the whole world so far along x and z from its origin"};
    BoolKnob cameraRelative{knobs(), "camera-relative", true,
                            "Subtracts the camera's place in double before anything becomes float"};
    BoolKnob axes{knobs(), "axes", false, "Draws the car's axes: x red, y green, z blue"};
    BoolKnob shadows{knobs(), "shadows", true, "Shadows on the ground"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Samples along a side of a pixel, averaged"};

    const Town& town() const { return town_; }
    /// The car as the knobs say: on its path, or where it was put. InputError if the path cannot be read.
    CarState car() const;
    DriftSettings drift() const;

  private:
    /// The knobs that say where the car is.
    struct CarPlace {
        float x = 0;
        float z = 0;
        float heading = 0;
        float steering = 0;
        float wheelRoll = 0;

        bool operator==(const CarPlace&) const = default;
    };

    /// None where no path is chosen. InputError if it cannot be read.
    const PathPlayer* player() const;
    bool pathCanBeRead() const;
    /// The car as the knobs say, whatever the path.
    CarState parkedCar() const;
    CarPlace placeOf(const CarState& state) const;
    /// The knobs are where the keys put them.
    bool showsDriven() const;
    void drive(const CarState& next);
    glm::dmat3 driftedTurn() const;
    Camera cameraOf(const CarState& car, const Frame& frame) const;

    Town town_;
    CarInstances model_;
    std::unique_ptr<TownPass> pass_;
    std::vector<glm::dvec3> places_;        ///< of the town's instances, by that of TownPass::objects
    std::vector<glm::dvec3> groundPlaces_;  ///< … and of TownPass::ground
    std::optional<Lines> lines_;
    std::map<std::string, std::uint64_t> counters_;

    mutable std::optional<PathPlayer> player_;
    mutable std::string playerName_;
    mutable std::optional<DriftSettings> driftMade_;
    mutable glm::dmat3 drift_{1};

    CarState driven_;      ///< by keys, in double; the knobs hold it rounded
    CarPath recording_;    ///< of the keys
    double unplayed_ = 0;  ///< seconds held less than a step of the recording
    bool playing_ = false;
    int written_ = 0;
};

}  // namespace quincunx
