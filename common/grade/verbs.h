#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "grade/grade.h"

/// What the command line can ask of this room, one function a verb, as in lab/verbs.h.
namespace quincunx {

struct GradeOptions {
    std::string lab;
    grade::Options grade;
    bool merge = false;
    std::vector<std::filesystem::path> places;  ///< submissions, or with `merge` the folders of shards
    bool json = false;
};

struct HandoutOptions {
    std::string out;
    bool json = false;
};

void gradeSubmissions(std::span<const LabEntry> labs, const GradeOptions& options);
void handout(const LabEntry& entry, const HandoutOptions& options);

}  // namespace quincunx
