#include "grade/handout.h"

#include <algorithm>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "base/paths.h"

namespace quincunx::grade {
namespace {

constexpr std::string_view taskMark = "// task:";
constexpr std::string_view insteadMark = "// instead:";
constexpr std::string_view endMark = "// end of task";
constexpr std::uintmax_t maxShaderBytes = 1 << 20;

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t'))
        text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t' || text.back() == '\r'))
        text.remove_suffix(1);
    return text;
}

}  // namespace

Handout handoutOf(std::string_view solution, std::string_view name) {
    Handout handout;
    std::size_t number = 0;
    std::size_t begun = 0;
    bool inWords = false;
    while (!solution.empty()) {
        ++number;
        const std::size_t end = std::min(solution.find('\n'), solution.size());
        const std::string_view line = solution.substr(0, end);
        solution.remove_prefix(std::min(end + 1, solution.size()));
        const std::string_view text = trimmed(line);
        const std::string indent(line.substr(0, line.size() - trimmed(line).size()));
        const std::string space = indent.substr(0, indent.find_first_not_of(" \t"));
        if (text.starts_with(taskMark)) {
            if (begun != 0)
                throw InputError("a task in a task", fmt::format("{}:{}", name, number), "end the first one");
            begun = number;
            inWords = true;
            handout.tasks.emplace_back(trimmed(text.substr(taskMark.size())));
            handout.text += fmt::format("{}// TASK: {}\n", space, handout.tasks.back());
        } else if (begun != 0 && text.starts_with(endMark)) {
            begun = 0;
        } else if (begun != 0 && text.starts_with(insteadMark)) {
            inWords = false;
            handout.text += fmt::format("{}{}\n", space, trimmed(text.substr(insteadMark.size())));
        } else if (begun != 0 && inWords && text.starts_with("//")) {
            handout.tasks.back() += ' ' + std::string(trimmed(text.substr(2)));
            handout.text += fmt::format("{}{}\n", space, text);
        } else if (begun != 0) {
            inWords = false;
        } else {
            handout.text += line;
            handout.text += '\n';
        }
    }
    if (begun != 0)
        throw InputError("a task without an end", fmt::format("{}:{}", name, begun), "write // end of task");
    return handout;
}

std::string solutionOf(const Exercise& exercise) {
    return exercise.shader.empty() ? std::string()
                                   : readFile(asset("shaders/" + exercise.shader), maxShaderBytes);
}

}  // namespace quincunx::grade
