#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "grade/duplicates.h"
#include "grade/grade.h"

namespace quincunx::grade {

/// index.html with the table, the distribution and the pairs, and students/KEY.html for each record: pictures
/// under a slider, the map of errors, points and reasons. Needs nothing but the folder. `names` are those
/// that are shown, by record.
void writeReport(const Class& graded, const std::vector<std::string>& names, const std::vector<Pair>& pairs,
                 const std::filesystem::path& out);

}  // namespace quincunx::grade
