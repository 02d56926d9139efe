#pragma once

#include <array>
#include <string_view>

#include "lab/answer.h"

namespace quincunx::atlas {

/// What a question of the exam is about, whether a lab answers it or not.
struct ExamSubject {
    std::string_view topic;    ///< what questions are filtered by: "shadows"
    std::string_view subject;  ///< a few words
};

/// Of question `number`, 1 … questionCount.
const ExamSubject& examSubject(int number);

}  // namespace quincunx::atlas
