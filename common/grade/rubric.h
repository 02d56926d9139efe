#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "grade/alignment.h"
#include "lab/lab.h"

namespace quincunx::grade {

/// How a property is measured.
enum class Measure {
    flip,    ///< mean ꟻLIP over the picture: less is better
    ssim,    ///< mean structural similarity: more is better
    effect,  ///< the share of an effect that is there (scoring.h): more is better
    task     ///< the share of what a picture by the handout's shader lacks (scoring.h): more is better
};

/// Points for a property, by a measured figure: all of them from `full` on, none from `none` on, and a
/// straight line between.
struct Property {
    std::string name;
    Measure measure = Measure::effect;
    KnobValues without;  ///< of an effect
    double points = 0;
    double full = 0;
    double none = 0;

    double pointsFor(double figure) const;  ///< 0 for NaN
};

/// What is asked for and what it is worth. From a file (TOML or JSON) over the lab's default:
///
///     title = "Shadows"             # of the assignment
///     size = [960, 720]             # of the picture, where its own record does not say
///     camera = "task"               # or "picture": as its record says, as long as the effects are in sight
///     free = ["supersample"]        # knobs that the picture's record may choose
///     [knobs]                       # of the picture that is asked for
///     light-turn = 40
///     [handling]                    # greatest share of the points for pictures that are …
///     gamma = 0.8
///     [[property]]                  # given: replaces all of the default ones
///     name = "the highlights"
///     measure = "effect"            # flip, ssim, effect, task
///     points = 30
///     full = 0.85                   # this figure and better: all points
///     none = 0.25                   # this and worse: none
///     without = { specular = "off" }
struct Rubric {
    std::string lab;  ///< folder
    std::string title;
    std::optional<std::pair<int, int>> size;
    bool cameraIsFree = true;
    KnobValues knobs;
    std::vector<std::string> freeKnobs;
    std::vector<Property> properties;          ///< of screenshots
    std::vector<Property> shaderProperties;    ///< of shaders
    std::array<double, handlingCount> most{};  ///< share of the points, by Handling

    double points() const;  ///< of all properties of a screenshot; those of a shader have as many

    /// All of it as JSON, as a file may have it: what results depend on.
    std::string text() const;
};

/// For the lab as it is: 60 points for the effects of its exercise, 20 for ꟻLIP, 20 for SSIM.
Rubric defaultRubric(const LabEntry& entry, Lab& lab);

/// The inverse of Rubric::text.
Rubric rubricFromText(const std::string& text, const LabEntry& entry, Lab& lab);

/// The lab's default, changed by the file. InputError with file and place: no such knob, no measure of that
/// name, limits that are equal, points that are not positive, unknown fields, another lab's rubric.
Rubric readRubric(const std::filesystem::path& file, const LabEntry& entry, Lab& lab);

}  // namespace quincunx::grade
