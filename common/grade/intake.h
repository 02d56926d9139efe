#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

/// What was handed in: whose it is, and which files it has. Nothing is opened here but the folders.
namespace quincunx::grade {

/// Who exported a folder, told from the names in it.
enum class Platform { none, canvas, moodle, gradescope };
std::string_view platformName(Platform platform);

struct SubmittedFile {
    std::filesystem::path file;
    std::string name;  ///< as the student called it, for people
};

struct Submission {
    std::string student;  ///< the name as the platform has it, else that of the file or folder
    std::string id;       ///< the platform's number for the student or the submission; empty: none
    Platform platform = Platform::none;
    bool late = false;
    std::vector<SubmittedFile> files;
    std::vector<std::string> faults;  ///< what was refused, a line each

    /// What it is filed under: hexadecimal digits from the platform, the number and the name.
    std::string key() const;
};

/// What is believed of a folder at most.
struct IntakeLimits {
    std::size_t submissions = 20000;
    std::size_t files = 500;  ///< of a submission
    int depth = 8;            ///< folders in folders
};

/// All submissions, sorted by name, then number. `place` is a folder, where each file or folder is a
/// submission but for the files of Canvas and Moodle that belong together; or one file. Names that are known:
///
///     Canvas       doejane_LATE_4711_815_shadow.png       one student's files have the same number
///     Moodle       Jane Doe_4711_assignsubmission_file_/  or files whose names begin so
///     Gradescope   submission_4711/                       names from submission_metadata.yml beside
///
/// Links and devices are refused, each with a fault; so is what exceeds a limit. Hidden files, __MACOSX and
/// the like are passed over. InputError if the place cannot be read.
std::vector<Submission> takeIn(const std::filesystem::path& place, const IntakeLimits& limits = {});

/// 64 bits of FNV-1a as 16 hexadecimal digits: for names of files, not against forgers.
std::string digest(std::string_view text);

}  // namespace quincunx::grade
