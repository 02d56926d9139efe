#include "labs/02_car_camera/lab.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "math/projection.h"
#include "math/transform.h"

namespace quincunx {

namespace {

constexpr double pi = std::numbers::pi;
constexpr double tourSeconds = 240;
constexpr double longestFrame = 0.25;  // seconds that a car moves at most from one picture to the next

float clampedTo(const FloatKnob& knob, double value) {
    return std::clamp(static_cast<float>(value), knob.range().min, knob.range().max);
}

float degreesOf(double radians) {
    return static_cast<float>(radians * (180 / pi));
}

/// A tripod at the kerb, looking to the roundabout.
Camera streetCamera() {
    Camera camera;
    camera.worldFromCamera = lookAt({2.4f, 1.7f, -55}, {-2.2f, 1.4f, -36}, {0, 1, 0});
    camera.fovYRadians = 0.9f;
    camera.nearDistance = 0.4f;
    camera.farDistance = 1500;
    return camera;
}

}  // namespace

CarCameraLab::CarCameraLab() : town_(makeTown()) {
    Scene scene = town_.scene;
    model_ = addCar(scene);
    model_.first -= town_.ground.size();
    pass_ = std::make_unique<TownPass>(std::move(scene), town_.ground);
    for (const Instance& instance : pass_->objects().instances)
        places_.emplace_back(glm::vec3(instance.worldFromModel[3]));
    for (const Instance& instance : pass_->ground().instances)
        groundPlaces_.emplace_back(glm::vec3(instance.worldFromModel[3]));
    driven_ = car();
}

Camera CarCameraLab::defaultCamera() const {
    Camera camera;
    camera.worldFromCamera = lookAt({92, 58, -96}, {-2, 0, -2}, {0, 1, 0});
    camera.fovYRadians = 0.7f;
    camera.nearDistance = 1;
    camera.farDistance = 1500;
    return camera;
}

Bounds CarCameraLab::sceneBounds() const {
    constexpr auto reach = static_cast<float>(townRadius);
    return {.min = {-reach, 0, -reach}, .max = {reach, 30, reach}};
}

const PathPlayer* CarCameraLab::player() const {
    if (path.value() == "off")
        return nullptr;
    if (!player_ || playerName_ != path.value()) {
        player_.emplace(path.value() == "tour" ? followLine(town_.start, town_.tour, tourSeconds)
                                               : readCarPath(path.value()));
        playerName_ = path.value();
    }
    return &*player_;
}

bool CarCameraLab::pathCanBeRead() const {
    try {
        player();
        return true;
    } catch (const InputError&) {
        return false;
    }
}

CarState CarCameraLab::car() const {
    const PathPlayer* played = player();
    return played == nullptr ? parkedCar() : played->at(static_cast<double>(time));
}

CarState CarCameraLab::parkedCar() const {
    CarState state;
    state.position = {static_cast<double>(carX), 0, static_cast<double>(carZ)};
    state.heading = AngleSum(glm::radians(static_cast<double>(heading)));
    state.steering = glm::radians(static_cast<double>(steering));
    state.distanceTravelled = glm::radians(static_cast<double>(wheelRoll)) * CarBuild().wheelRadius;
    return state;
}

DriftSettings CarCameraLab::drift() const {
    return {.update = update.as<TurnUpdate>(),
            .turns = turns,
            .every = every,
            .renormalizer = renormalizer.as<Renormalizer>()};
}

glm::dmat3 CarCameraLab::driftedTurn() const {
    const DriftSettings settings = drift();
    if (driftMade_ != settings) {
        const glm::dmat3 start = slopingFrame();
        drift_ = settings.turns == 0 ? glm::dmat3(1)
                                     : glm::transpose(start) * glm::dmat3(turnedOften(settings, start));
        driftMade_ = settings;
    }
    return drift_;
}

void CarCameraLab::markIdleKnobs() {
    const bool onPath = path.value() != "off";
    time.setIdle(onPath ? "" : "nothing plays; say --path=tour");
    for (Knob* knob : {static_cast<Knob*>(&carX), static_cast<Knob*>(&carZ), static_cast<Knob*>(&heading),
                       static_cast<Knob*>(&steering), static_cast<Knob*>(&wheelRoll)})
        knob->setIdle(onPath ? "the path drives" : "");
    const TurnUpdate chosen = update.as<TurnUpdate>();
    const bool drifts = turns > 0 && (chosen == TurnUpdate::product || chosen == TurnUpdate::card);
    update.setIdle(turns > 0 ? "" : "the car is not turned; say --turns=157");
    every.setIdle(drifts ? "" : "for --turns by --update=product or card");
    renormalizer.setIdle(drifts && every > 0 ? "" : "for --renormalize-every above 0");
    cameraRelative.setIdle(far > 0 ? "" : "the world is at its origin; say --far=1000000");
}

std::optional<Camera> CarCameraLab::ownCamera() const {
    if (view.as<View>() == View::free)
        return {};
    // A path that cannot be read is told when the picture is built.
    return cameraOf(pathCanBeRead() ? car() : parkedCar(), Frame{});
}

Camera CarCameraLab::cameraOf(const CarState& state, const Frame& frame) const {
    // The cameras ride on the car as it should be turned, so that what drifted is seen.
    RigidPose pose = poseOf(state);
    if (turns > 0)
        pose.rotation = pose.rotation * turnedExactly(drift(), glm::dmat3(1));
    switch (view.as<View>()) {
        case View::chase:
            return chaseCamera(pose);
        case View::driver:
            return driverCamera(pose);
        case View::bird:
            return birdCamera(pose, 52);
        case View::street:
            return streetCamera();
        case View::free:
            break;
    }
    return frame.camera;
}

graph::Resource CarCameraLab::build(graph::FrameGraph& graph, const Frame& frame) {
    const PictureTargets targets = addPictureTargets(
        graph,
        {.format = frame.pictureFormat, .width = frame.width, .height = frame.height, .factor = supersample});
    const CarState state = car();
    Camera camera = cameraOf(state, frame);

    // Everything is carried `offset` away from the world's origin; where the camera's place is subtracted
    // first, in double, that cancels before it costs bits. Heights stay, for the plane of the shadows.
    const glm::dvec3 eye(glm::vec3(camera.worldFromCamera[3]));
    const glm::dvec3 offset(static_cast<double>(far), 0, static_cast<double>(far));
    const glm::dvec3 origin =
        far > 0 && cameraRelative ? glm::dvec3(eye.x, 0, eye.z) + offset : glm::dvec3(0);
    const auto carried = [&](glm::dvec3 place) { return glm::vec4(glm::vec3((place + offset) - origin), 1); };
    Scene& objects = pass_->objects();
    for (std::size_t i = 0; i < places_.size(); ++i)
        objects.instances[i].worldFromModel[3] = carried(places_[i]);
    for (std::size_t i = 0; i < groundPlaces_.size(); ++i)
        pass_->ground().instances[i].worldFromModel[3] = carried(groundPlaces_[i]);
    camera.worldFromCamera[3] = carried(eye);
    glm::mat4 worldFromCar{glm::mat3(poseOf(state).rotation * driftedTurn())};
    worldFromCar[3] = carried(state.position);
    placeCar(objects, model_, worldFromCar, state.steering, state.distanceTravelled);

    const float aspect = static_cast<float>(frame.width) / static_cast<float>(frame.height);
    TownPass::Params params{.view = forwardView(camera, aspect), .shadows = shadows, .over = {}};
    if (axes)
        params.over = [this, worldFromCar, params, targets, &graph](graph::PassContext& context) {
            const graph::ResourceDescription& size = graph.resource(targets.color);
            if (!lines_)
                lines_.emplace();
            lines_->clear();
            glm::mat4 atRoof =
                worldFromCar * glm::mat4(glm::vec4(2.2f, 0, 0, 0), glm::vec4(0, 2.2f, 0, 0),
                                         glm::vec4(0, 0, 2.2f, 0), glm::vec4(0, 0.8f, 1.1f, 1));
            lines_->axes(atRoof, 3.0f * static_cast<float>(targets.factor));
            lines_->draw(context, {.clipFromWorld = params.view.clipFromWorld,
                                   .viewportPixels = {size.width, size.height},
                                   .depthTest = false});
        };
    pass_->addPasses(graph, targets, params);
    addResolvePass(graph, targets);
    counters_ = {{"triangles", pass_->triangleCount()},
                 {"instances", objects.instances.size() + pass_->ground().instances.size()}};
    return targets.picture;
}

// ---- driving ----

CarCameraLab::CarPlace CarCameraLab::placeOf(const CarState& state) const {
    const glm::dvec2 direction = state.heading.direction();
    const double rolled = std::remainder(state.distanceTravelled / CarBuild().wheelRadius, 2 * pi);
    return {clampedTo(carX, state.position.x), clampedTo(carZ, state.position.z),
            clampedTo(heading, degreesOf(std::atan2(direction.y, direction.x))),
            clampedTo(steering, degreesOf(state.steering)), clampedTo(wheelRoll, degreesOf(rolled))};
}

bool CarCameraLab::showsDriven() const {
    return placeOf(driven_) == CarPlace{carX, carZ, heading, steering, wheelRoll};
}

void CarCameraLab::drive(const CarState& next) {
    driven_ = next;
    const CarPlace place = placeOf(next);
    carX.set(place.x);
    carZ.set(place.z);
    heading.set(place.heading);
    steering.set(place.steering);
    wheelRoll.set(place.wheelRoll);
    // What the edge of the map stops has no speed left.
    if (std::abs(next.position.x) >= carX.range().max || std::abs(next.position.z) >= carZ.range().max) {
        driven_ = car();
        driven_.speed = 0;
    }
}

bool CarCameraLab::isMoving() const {
    return playing_ || (path.value() == "off" && (driven_.speed != 0 || driven_.steering != 0));
}

bool CarCameraLab::advance(double seconds, const HeldSeconds& held) {
    if (!pathCanBeRead())
        return false;
    seconds = std::clamp(seconds, 0.0, longestFrame);
    const bool hands = held != HeldSeconds{};
    const PathPlayer* played = player();
    playing_ = playing_ && played != nullptr;
    if (playing_ && !hands) {
        const double end = std::min<double>(played->path().seconds(), time.range().max);
        const double next = std::min(static_cast<double>(time) + seconds, end);
        playing_ = next < end;
        time.set(clampedTo(time, next));
        return true;
    }
    if (played != nullptr) {
        // A hand on the wheel ends the playing.
        drive(car());
        path.set("off");
        playing_ = false;
        recording_.spans.clear();
    }
    if (!showsDriven()) {
        // Somebody put the car elsewhere by the knobs.
        driven_ = car();
        recording_.spans.clear();
    }
    if (recording_.spans.empty())
        recording_.start = driven_;
    const double span = std::max(seconds, 1e-9);
    const CarControls controls{std::clamp(held.forwards / span, -1.0, 1.0),
                               std::clamp(held.left / span, -1.0, 1.0)};
    unplayed_ += seconds;
    CarState next = driven_;
    while (unplayed_ >= recording_.stepSeconds) {
        unplayed_ -= recording_.stepSeconds;
        next = advanced(next, controls, recording_.stepSeconds);
        if (recording_.spans.size() < mostPathSpans)
            recording_.record(controls);
    }
    drive(next);
    return true;
}

std::vector<LabKey> CarCameraLab::keys() {
    return {{'V', "the next view: chase, driver, bird, street, free",
             [this] {
                 view.set((view.index() + 1) % static_cast<int>(view.options().size()));
                 return std::string();
             }},
            {'T', "play or stop the tour, or the path that is chosen",
             [this] {
                 if (path.value() == "off") {
                     path.set("tour");
                     driven_ = CarState{};
                 }
                 playing_ = !playing_;
                 return std::string();
             }},
            {'K', "write down what was driven by keys, for --path", [this]() -> std::string {
                 if (recording_.spans.empty())
                     return "nothing was driven yet: W A S D";
                 requireFolder("out");
                 std::filesystem::path file;
                 do
                     file = fmt::format("out/drive_{:03}.json", ++written_);
                 while (std::filesystem::exists(file));
                 writeFile(file, toJson(recording_));
                 return fmt::format("wrote {}: play it with --path={}", file.string(), file.string());
             }}};
}

Exercise CarCameraLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the shadows", {{"shadows", "off"}}},
                        {"the car's heading", {{"heading", "25"}}},
                        {"where the car is", {{"car-z", "-38"}, {"car-x", "3"}}}};
    exercise.freeKnobs = {"supersample", "camera-relative"};
    exercise.shader = "labs/02_car_camera/ground.frag";
    exercise.scenes = {{{"heading", "40"}}, {{"view", "street"}}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::CarCameraLab)
