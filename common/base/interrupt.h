#pragma once

#include <atomic>

namespace quincunx {

/// From now on SIGINT and SIGTERM ask long work to stop instead of ending the process at once; a second
/// signal ends it. SIGPIPE is ignored, so that a closed pipe is a write error. Call once, early in `main`.
void handleInterrupts();

/// True after a signal asked to stop.
bool interrupted();

/// The same as a flag, for work that watches one.
const std::atomic<bool>& interruptFlag();

/// Throws Interrupted after a signal asked to stop; long loops call it between pieces of work.
void throwIfInterrupted();

}  // namespace quincunx
