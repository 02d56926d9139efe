#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "lab/lab.h"

namespace quincunx::grade {

/// A shader as a student gets it, made from the solution. Lines of the solution mark what is taken out:
///
///     // task: Lambert's law: the share of the light that a surface turned away from it receives.
///     result = max(0.0, dot(n, wi));
///     // instead: result = 0.0;
///     // end of task
///
/// The handout has the words of the task as a comment, and what stands after `instead:` (any number of such
/// lines, before or after the solution's own) in place of the other lines. Text without such marks is
/// returned as it is. InputError naming the line for a mark without its end.
struct Handout {
    std::string text;
    std::vector<std::string> tasks;  ///< their words
};
Handout handoutOf(std::string_view solution, std::string_view name);

/// The file of the exercise's shader under shaders/, as it is; empty if the lab sets none.
std::string solutionOf(const Exercise& exercise);

}  // namespace quincunx::grade
