#include "base/interrupt.h"

#include <csignal>

#include "base/error.h"

namespace quincunx {
namespace {

std::atomic<bool> stopRequested = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

extern "C" void requestStop(int) {
    stopRequested = true;
}

}  // namespace

void handleInterrupts() {
    struct sigaction action {};
    action.sa_handler = requestStop;
    action.sa_flags = static_cast<int>(SA_RESETHAND);
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    std::signal(SIGPIPE, SIG_IGN);
}

bool interrupted() {
    return stopRequested;
}

const std::atomic<bool>& interruptFlag() {
    return stopRequested;
}

void throwIfInterrupted() {
    if (interrupted())
        throw Interrupted();
}

}  // namespace quincunx
