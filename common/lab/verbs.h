#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "gl/context.h"
#include "image/compare.h"
#include "lab/lab.h"

/// What the command line can be asked to do, one function a verb. Each prints to stdout, text or JSON, and
/// throws an Error that the caller turns into one line on stderr.
namespace quincunx {

/// Flags that all drawing verbs share.
struct DrawOptions {
    gl::Backend backend = gl::Backend::automatic;
    std::optional<int> width;   ///< pixels
    std::optional<int> height;  ///< pixels
    std::optional<std::uint64_t> seed;
    std::string model;
    std::string out;
    bool json = false;
};

struct RunOptions {
    DrawOptions draw;
    std::string record;
    std::string replay;
    KnobValues knobs;  ///< given as flags: they win over those of a replay
};

struct SweepOptions {
    DrawOptions draw;
    std::string only;  ///< name of one sweep; empty: all
    std::optional<double> budgetSeconds;
    std::optional<double> maxError;
};

struct PlanOptions {
    DrawOptions draw;
    bool graph = false;  ///< print the frame's graph for Graphviz instead
    int frames = 0;      ///< that each variant is timed over; 0: as many as take some seconds in all
};

struct StressOptions {
    bool full = false;
    std::uint64_t seed = 1;
    bool json = false;
};

struct CompareOptions {
    std::string first;
    std::string second;
    Metric metric = Metric::flip;
    std::string out;
    std::optional<double> maxError;
    bool json = false;
};

struct DeckOptions {
    gl::Backend backend = gl::Backend::automatic;
    std::vector<std::string> labs;  ///< only these; empty: all
    std::string out;
    bool json = false;
};

void list(std::span<const LabEntry> labs, bool json);
void run(Lab& lab, const LabEntry& entry, RunOptions options);
ExitStatus ask(std::span<const LabEntry> labs, int question, const DrawOptions& options);
ExitStatus sweep(Lab& lab, const LabEntry& entry, const SweepOptions& options);
void plan(Lab& lab, const LabEntry& entry, const PlanOptions& options);
ExitStatus stress(Lab& lab, const LabEntry& entry, const StressOptions& options);
ExitStatus deck(std::span<const LabEntry> labs, const DeckOptions& options);
ExitStatus compare(const CompareOptions& options);

/// The lab of that number, name or folder; InputError listing the labs there are.
const LabEntry& findLab(std::span<const LabEntry> labs, std::string_view name);

/// Writes to stdout; a reader that has gone away ends the program quietly, a full disk is an InputError.
void print(std::string_view text);

}  // namespace quincunx
