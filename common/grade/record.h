#pragma once

#include <string>
#include <vector>

#include "grade/intake.h"
#include "lab/json.h"

namespace quincunx::grade {

/// A property's outcome, or a limit's.
struct Line {
    std::string name;
    double figure = 0;
    double points = 0;
    double of = 0;
    std::string reason;
};

/// What a submission that is all right has.
inline constexpr double pointsOfAll = 100;

/// Points as all outputs have them: two digits.
std::string pointsText(double points);

/// What was graded of a submission: its screenshot or its shader.
struct Part {
    std::string kind;  ///< "screenshot", "shader"
    std::string file;  ///< as the student called it
    std::vector<Line> lines;
    std::vector<std::pair<double, std::string>> limits;  ///< share, reason
    std::vector<std::string> remarks;
    std::string reference;  ///< names of pictures beside the report; empty: none
    std::string submitted;
    std::string errors;
    bool exact = false;     ///< the very codes of the reference
    std::string signature;  ///< how it differs, coarsely; hexadecimal

    double points() const;
    double of() const;
    double share() const;  ///< 0 … 1
};

/// Everything that the outputs say of a submission: a line of the journal.
struct Record {
    std::string key;
    std::string student;
    std::string id;
    Platform platform = Platform::none;
    bool late = false;
    std::string digest;  ///< of what was handed in and of what it was held against
    std::vector<Part> parts;
    std::vector<std::string> faults;
    std::string shaderTokens;  ///< of the shader, as duplicates.h compares them

    double points(double most) const;  ///< of `most`: the mean share of the parts
    /// Every lost point's reason, and every fault, a line each.
    std::vector<std::string> reasons() const;
};

Json toJson(const Record& record);
/// The inverse; InputError if it is no such text.
Record parseRecord(const std::string& text, const std::string& where);

}  // namespace quincunx::grade
