#include "scene/car_path.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"
#include "scene/gltf_json.h"

namespace quincunx {
namespace {

constexpr std::uintmax_t largestFile = std::uintmax_t{16} << 20;
constexpr const char* formatName = "quincunx car path";

/// Numbers in a file are no larger than this, so that nothing computed from them leaves the range.
constexpr double largestNumber = 1e6;

double boundedNumber(const JsonView& json) {
    const double value = json.number();
    if (!(std::abs(value) <= largestNumber))
        json.fail("is larger than a million");
    return value;
}

/// A step's whole part and what is left over, of a time within the path.
struct PathTime {
    std::uint64_t steps = 0;
    double rest = 0;
};

PathTime timeIn(const CarPath& path, double seconds) {
    const std::uint64_t count = path.stepCount();
    if (!(seconds > 0))
        return {};
    const double steps = std::floor(seconds / path.stepSeconds);
    if (steps >= static_cast<double>(count))
        return {count, 0};
    const auto whole = static_cast<std::uint64_t>(steps);
    return {whole, std::clamp(seconds - steps * path.stepSeconds, 0.0, path.stepSeconds)};
}

double pointToSegment(glm::dvec2 p, glm::dvec2 a, glm::dvec2 b) {
    const glm::dvec2 ab = b - a;
    const double squared = glm::dot(ab, ab);
    return squared > 0 ? std::clamp(glm::dot(p - a, ab) / squared, 0.0, 1.0) : 0;
}

}  // namespace

void CarPath::record(const CarControls& controls) {
    if (!spans.empty() && spans.back().controls == controls)
        ++spans.back().steps;
    else
        spans.push_back({1, controls});
}

std::uint64_t CarPath::stepCount() const {
    std::uint64_t count = 0;
    for (const Span& span : spans)
        count += span.steps;
    return count;
}

CarState stateAt(const CarPath& path, double seconds, const CarBuild& build) {
    PathTime time = timeIn(path, seconds);
    CarState car = path.start;
    for (const CarPath::Span& span : path.spans) {
        for (std::uint32_t i = 0; i < span.steps; ++i) {
            if (time.steps == 0)
                return time.rest > 0 ? advanced(car, span.controls, time.rest, build) : car;
            car = advanced(car, span.controls, path.stepSeconds, build);
            --time.steps;
        }
    }
    return car;
}

PathPlayer::PathPlayer(CarPath path, const CarBuild& build) : path_(std::move(path)), build_(build) {
    CarState car = path_.start;
    std::uint64_t step = 0;
    for (std::size_t span = 0; span < path_.spans.size(); ++span)
        for (std::uint32_t i = 0; i < path_.spans[span].steps; ++i, ++step) {
            if (step % everySteps == 0)
                marks_.push_back({car, span, i});
            car = advanced(car, path_.spans[span].controls, path_.stepSeconds, build_);
        }
    marks_.push_back({car, path_.spans.size(), 0});
}

CarState PathPlayer::at(double seconds) const {
    const PathTime time = timeIn(path_, seconds);
    if (time.steps >= path_.stepCount())
        return marks_.back().state;
    const Mark& mark = marks_[static_cast<std::size_t>(time.steps / everySteps)];
    CarState car = mark.state;
    std::size_t span = mark.span;
    std::uint64_t inSpan = mark.stepInSpan;
    const auto controls = [&]() -> const CarControls& {
        while (inSpan >= path_.spans[span].steps) {
            ++span;
            inSpan = 0;
        }
        return path_.spans[span].controls;
    };
    for (std::uint64_t left = time.steps % everySteps; left > 0; --left) {
        car = advanced(car, controls(), path_.stepSeconds, build_);
        ++inSpan;
    }
    return time.rest > 0 ? advanced(car, controls(), time.rest, build_) : car;
}

std::string toJson(const CarPath& path) {
    const CarState& start = path.start;
    std::string text = fmt::format(
        "{{\"format\": \"{}\", \"step_seconds\": {},\n \"start\": {{\"position\": [{}, {}, {}], "
        "\"heading_radians\": {}, \"speed\": {}, \"steering_radians\": {}}},\n \"steps\": [",
        formatName, path.stepSeconds, start.position.x, start.position.y, start.position.z,
        start.heading.radians(), start.speed, start.steering);
    for (std::size_t i = 0; i < path.spans.size(); ++i)
        text +=
            fmt::format("{}{}[{}, {}, {}]", i == 0 ? "" : ",", i % 6 == 0 ? "\n  " : " ", path.spans[i].steps,
                        path.spans[i].controls.throttle, path.spans[i].controls.steering);
    return text + "]}\n";
}

CarPath parseCarPath(std::string_view json, const std::string& where) {
    const nlohmann::json document = parseBoundedJson(json, where);
    const JsonView root(document, where);
    if (root.at("format").string() != formatName)
        root.at("format").fail(fmt::format("is not \"{}\"", formatName));
    CarPath path;
    const JsonView stepSeconds = root.at("step_seconds");
    path.stepSeconds = stepSeconds.number();
    if (!(path.stepSeconds >= 1e-4 && path.stepSeconds <= 1))
        stepSeconds.fail("is not between 0.0001 and 1 second");
    const JsonView start = root.at("start");
    const JsonView position = start.at("position");
    if (position.size() != 3)
        position.fail("does not have three coordinates");
    path.start.position = {boundedNumber(position[0]), boundedNumber(position[1]),
                           boundedNumber(position[2])};
    path.start.heading = AngleSum(boundedNumber(start.at("heading_radians")));
    path.start.speed = boundedNumber(start.at("speed"));
    path.start.steering = boundedNumber(start.at("steering_radians"));
    if (!(std::abs(path.start.steering) <= 1.2))
        start.at("steering_radians").fail("is more than 1.2 radians");

    const JsonView steps = root.at("steps");
    if (steps.size() > mostPathSpans)
        steps.fail(fmt::format("has more than {} entries", mostPathSpans));
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < steps.size(); ++i) {
        const JsonView entry = steps[i];
        if (entry.size() != 3)
            entry.fail("is not [steps, throttle, steering]");
        const std::size_t count = entry[0].index();
        if (count < 1 || count > mostPathSteps || (total += count) > mostPathSteps)
            entry.fail(fmt::format("makes the path longer than {} steps, or is no step", mostPathSteps));
        CarPath::Span span;
        span.steps = static_cast<std::uint32_t>(count);
        span.controls = {entry[1].number(), entry[2].number()};
        if (!(std::abs(span.controls.throttle) <= 1 && std::abs(span.controls.steering) <= 1))
            entry.fail("has a control outside -1 … 1");
        path.spans.push_back(span);
    }
    return path;
}

CarPath readCarPath(const std::filesystem::path& file) {
    return parseCarPath(readFile(file, largestFile), file.string());
}

CarPath followLine(const CarState& start, std::span<const glm::dvec2> line, double seconds,
                   const CarBuild& build) {
    QX_CHECK_GE(line.size(), 3u);
    QX_CHECK(seconds >= 0 && seconds <= 1e5);
    constexpr double lookAhead = 5.5;  // metres, of the point that is steered for
    constexpr double glance = 11;      // metres, of the one that decides the speed
    constexpr double slow = 4.2;       // m/s in bends
    constexpr double fast = 10;
    CarPath path;
    path.start = start;
    CarState car = start;
    std::size_t leg = 0;
    const auto count = static_cast<std::uint64_t>(seconds / path.stepSeconds);
    for (std::uint64_t step = 0; step < count; ++step) {
        const glm::dvec2 here(car.position.x, car.position.z);
        // The nearest point of the line, on this leg or one of the next.
        double nearest = 1e300;
        std::size_t foundLeg = leg;
        for (std::size_t ahead = 0; ahead < 3; ++ahead) {
            const std::size_t i = (leg + ahead) % line.size();
            const glm::dvec2 a = line[i];
            const glm::dvec2 b = line[(i + 1) % line.size()];
            const double distance = glm::length(here - glm::mix(a, b, pointToSegment(here, a, b)));
            if (distance < nearest - 1e-9) {
                nearest = distance;
                foundLeg = i;
            }
        }
        leg = foundLeg;
        const auto pointAhead = [&](double metres) {
            std::size_t i = leg;
            glm::dvec2 a = glm::mix(line[i], line[(i + 1) % line.size()],
                                    pointToSegment(here, line[i], line[(i + 1) % line.size()]));
            for (std::size_t hops = 0; hops < line.size(); ++hops) {
                const glm::dvec2 b = line[(i + 1) % line.size()];
                const double length = glm::length(b - a);
                if (metres <= length)
                    return length > 0 ? glm::mix(a, b, metres / length) : b;
                metres -= length;
                a = b;
                i = (i + 1) % line.size();
            }
            return a;
        };
        // To the left and ahead, in the car's own axes.
        const glm::dvec2 direction = car.heading.direction();
        const auto inCar = [&](glm::dvec2 p) {
            const glm::dvec2 d = p - here;
            return glm::dvec2(direction.x * d.x - direction.y * d.y, direction.y * d.x + direction.x * d.y);
        };
        const glm::dvec2 target = inCar(pointAhead(lookAhead));
        const double squared = std::max(glm::dot(target, target), 1e-6);
        const double curvature = 2 * target.x / squared;
        const glm::dvec2 further = inCar(pointAhead(glance));
        const double bend = std::abs(std::atan2(further.x, std::max(further.y, 1e-3)));
        const double wanted = glm::mix(fast, slow, std::clamp(bend / 0.45, 0.0, 1.0));
        // In steps of a driver's hand, so that the record stays short.
        const double steering = std::atan(curvature * build.wheelbase) / build.mostSteering;
        const double throttle = (wanted - car.speed) * 0.5;
        CarControls controls;
        controls.steering = std::clamp(std::round(steering * 32) / 32, -1.0, 1.0);
        // Pedals: on, half, off or brake.
        controls.throttle = throttle > 0.5 ? 1 : throttle > 0.05 ? 0.75 : throttle < -0.6 ? -0.5 : 0;
        path.record(controls);
        car = advanced(car, controls, path.stepSeconds, build);
    }
    return path;
}

}  // namespace quincunx
