#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "grade/record.h"

namespace quincunx::grade {

/// Two submissions that are alike beyond what the task makes alike. Pointed out, never punished.
struct Pair {
    std::size_t first = 0;  ///< of the records
    std::size_t second = 0;
    std::string text;  ///< in which way
};

/// A shader's text as what it says: words and signs with comments, spaces and the names that it makes up
/// itself left out, each five that follow each other as a number, sorted, in hexadecimal. Those that `known`
/// (the handout and the solution) has as well are left out.
std::string shaderTokens(std::string_view shader, const std::vector<std::string_view>& known);

/// Pairs of records of different students: screenshots that are wrong in the same way (those that are right
/// are all alike), shaders that share eight tenths of what is their own.
std::vector<Pair> findPairs(const std::vector<Record>& records);

}  // namespace quincunx::grade
