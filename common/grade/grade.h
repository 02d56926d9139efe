#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "gl/context.h"
#include "grade/record.h"
#include "grade/rubric.h"
#include "grade/sandbox.h"
#include "lab/lab.h"

/// Scores for a class: what `quincunx grade` does. The folder that is written:
///
///     grades.csv               a line a student: score, reasons
///     index.html, students/    the report
///     lms/                     canvas.csv, moodle.csv, gradescope/ID/results.json: with names
///     grades.json              the same for programs
///     journal/                 a record a submission, written when it is done: what a later call goes on
///     from pictures/                what the report shows
namespace quincunx::grade {

/// A part of a class: submissions whose place in the sorted class is `index` modulo `count`.
struct Shard {
    std::size_t index = 0;
    std::size_t count = 1;
};

/// From the variables that batch systems set: SLURM_ARRAY_TASK_ID with SLURM_ARRAY_TASK_MIN, _STEP and
/// _COUNT; JOB_COMPLETION_INDEX with QUINCUNX_SHARDS (Kubernetes says no count); CI_NODE_INDEX (from 1) and
/// CI_NODE_TOTAL. Nothing if none is set, or if there is one shard only. InputError if they make no sense.
std::optional<Shard> shardFromEnvironment();

struct Options {
    std::filesystem::path submissions;
    std::filesystem::path rubric;  ///< empty: the lab's default
    std::filesystem::path out = "out/grade";
    int jobs = 0;  ///< processes at a time; 0: as many as there are processors
    gl::Backend backend = gl::Backend::automatic;
    bool anonymous = false;  ///< names in lms/ and journal/ only
    std::optional<Shard> shard;
    int secondsEach = 60;             ///< of processor time that a submission may take
    std::vector<std::string> worker;  ///< words that call runWorker; empty: this program and `grade-worker`
};

struct Summary {
    std::filesystem::path out;
    std::size_t submissions = 0;  ///< of this call's part
    std::size_t done = 0;         ///< that this call graded; the others were in the journal
    std::size_t faulty = 0;       ///< with something that was refused or broken
    double points = 0;            ///< that there are
    double mean = 0;
    bool merged = true;  ///< false: a shard; the outputs wait for `merge`
};

/// Grades what is handed in. Killed and called again, it goes on; the outputs have the same bytes.
Summary gradeClass(const LabEntry& entry, const Options& options);

/// Outputs from the journals of shards, in one folder or several. InputError naming what is missing: a shard
/// that has not finished, journals of different classes or rubrics.
Summary mergeShards(std::span<const std::filesystem::path> folders, const std::filesystem::path& out,
                    bool anonymous);

/// All that the outputs are made from.
struct Class {
    std::string lab;
    std::string topic;
    Rubric rubric;
    std::vector<Record> records;  ///< sorted by student, then number
};

/// Writes grades.csv, grades.json, lms/ and the report.
void writeOutputs(const Class& graded, const std::filesystem::path& out, bool anonymous);

/// A CSV field: quoted where it must be, on one line, and never what a spreadsheet takes for a formula.
std::string csvField(std::string_view text);

}  // namespace quincunx::grade
