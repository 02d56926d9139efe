#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "scene/car.h"

namespace quincunx {

/// A drive as the driver's hands made it: where it starts, and what they did in each step of a fixed length.
/// Played back it gives the same states bit for bit, however often and in whatever order they are asked for.
struct CarPath {
    struct Span {
        std::uint32_t steps = 1;  ///< how many steps in a row
        CarControls controls;

        bool operator==(const Span&) const = default;
    };
    double stepSeconds = 0.02;
    CarState start;
    std::vector<Span> spans;

    /// Appends a step, to the last span if the controls are the same.
    void record(const CarControls& controls);
    std::uint64_t stepCount() const;
    double seconds() const { return static_cast<double>(stepCount()) * stepSeconds; }

    bool operator==(const CarPath&) const = default;
};

/// What a path may be at most: a day at 100 steps a second.
inline constexpr std::uint64_t mostPathSteps = 8'640'000;
inline constexpr std::size_t mostPathSpans = 200'000;

/// The car after `seconds`: the whole steps, then a part of one. Before the start it is the start; after the
/// end, the end. Not a number counts as 0.
CarState stateAt(const CarPath& path, double seconds, const CarBuild& build = {});

/// The states after each `everySteps` steps, so that `stateAt` need not begin at the start: playing a long
/// path takes no longer at its end.
class PathPlayer {
  public:
    explicit PathPlayer(CarPath path, const CarBuild& build = {});
    const CarPath& path() const { return path_; }
    /// As `stateAt`, bit for bit.
    CarState at(double seconds) const;

  private:
    struct Mark {
        CarState state;
        std::size_t span = 0;
        std::uint64_t stepInSpan = 0;
    };
    static constexpr std::uint64_t everySteps = 256;
    CarPath path_;
    CarBuild build_;
    std::vector<Mark> marks_;
};

/// As text: JSON of a few lines, every number written so that it is read back the same.
std::string toJson(const CarPath& path);
/// The inverse. `where` names the text in errors. InputError with one line for what is not such a text, for
/// numbers that are not finite or out of range, and for more steps or spans than above; nothing is allocated
/// by an unchecked number.
CarPath parseCarPath(std::string_view json, const std::string& where);
/// From a file of at most 16 MB.
CarPath readCarPath(const std::filesystem::path& file);

/// A driver who follows a closed line of (x, z), for `seconds`: steers for the point of the line that is
/// a few metres ahead (pure pursuit: Coulter, "Implementation of the pure pursuit path tracking algorithm",
/// CMU-RI-TR-92-01) and slows down where it bends. `line` has at least three points, not all in one place.
CarPath followLine(const CarState& start, std::span<const glm::dvec2> line, double seconds,
                   const CarBuild& build = {});

}  // namespace quincunx
