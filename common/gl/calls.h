#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "base/error.h"

namespace quincunx::gl {

/// OpenGL or its driver refused a call: "glDrawElements: GL_INVALID_OPERATION: what the driver said".
class GlError : public Error {
  public:
    using Error::Error;
    ExitStatus exitStatus() const override { return ExitStatus::notPossibleHere; }
};

/// Installs the loader's callbacks on the current context: each GL call is counted, and a GL error or a
/// KHR_debug message of type error or severity high becomes a GlError that names the call. Called by every
/// context.
void watchCalls();

/// GL calls since the program began.
std::uint64_t callCount();

/// Counts by function name while it lives (slower than callCount; for tests and `plan`). Recorders nest: each
/// counts all calls of its life.
class CallRecorder {
  public:
    CallRecorder();
    ~CallRecorder();
    CallRecorder(const CallRecorder&) = delete;
    CallRecorder& operator=(const CallRecorder&) = delete;
    const std::map<std::string, std::uint64_t>& calls() const { return calls_; }

  private:
    std::map<std::string, std::uint64_t> calls_;
};

}  // namespace quincunx::gl
