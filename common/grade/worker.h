#pragma once

#include <span>

#include "lab/lab.h"

namespace quincunx::grade {

/// The hidden verb: what handles submissions, one process each. Speaks with `grade` through stdin and stdout
/// (channel.h): a message "begin", then jobs; each is done by a process forked for it alone, which reads the
/// files, closes itself in (sandbox.h), decodes, compares, and answers. Ends when stdin does, and when such a
/// process dies: then with its exit status, or 64 and the signal.
///
/// Jobs:
/// - "look" {files: [{path, name}]}: answers "seen" {faults, picture, shader}, waits for "reference" or
/// "done", and
///   answers "scored".
/// - "draw" {name} with a shader's text: answers "scored".
int runWorker(std::span<const LabEntry> labs);

/// What `runWorker` returns for a process that a signal ended.
inline constexpr int diedBySignal = 64;

/// Longest side of pictures in reports, pixels.
inline constexpr int reportSide = 480;

}  // namespace quincunx::grade
