#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "lab/lab.h"

namespace quincunx {

/// Of the exam; numbered from 1.
inline constexpr int questionCount = 118;

/// An exam question with the figures that its lab measured just now.
struct Answer {
    std::string lab;  ///< folder name, "10_shading"
    Question question;
    std::vector<Measurement> measurements;

    bool pass() const;  ///< all bounds hold
};

Answer answerQuestion(const LabEntry& entry, const Question& question, Studio& studio);

/// For a terminal: wrapped text and a table of figures.
std::string toText(const Answer& answer);
nlohmann::ordered_json toJson(const Answer& answer);

/// A measured figure as people read it: six digits, whole numbers whole.
std::string figureText(double value);

/// Words joined to lines of at most `width` bytes, but where one word is longer; ends with a new line.
std::string wrapped(std::string_view text, std::size_t width);

}  // namespace quincunx
