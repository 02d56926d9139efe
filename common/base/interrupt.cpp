#include "base/interrupt.h"

#include <csignal>

#include "base/error.h"

namespace quincunx {
namespace {

volatile std::sig_atomic_t stopRequested = 0;

extern "C" void requestStop(int) {
    stopRequested = 1;
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
    return stopRequested != 0;
}

void throwIfInterrupted() {
    if (interrupted())
        throw Interrupted();
}

}  // namespace quincunx
