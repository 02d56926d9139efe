#include "tests/support/xvfb.h"

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"

namespace quincunx::test {
namespace {

constexpr int startMilliseconds = 20000;

std::string variable(const char* name) {
    const char* value = std::getenv(name);
    return value == nullptr ? "" : value;
}

void setVariable(const char* name, const std::string& value) {
    if (value.empty())
        unsetenv(name);
    else
        setenv(name, value.c_str(), 1);
}

/// The line that `-displayfd` promises; empty when the server ends or says nothing in time.
std::string readNumber(int descriptor) {
    std::string line;
    for (;;) {
        pollfd waiting{.fd = descriptor, .events = POLLIN, .revents = 0};
        if (poll(&waiting, 1, startMilliseconds) <= 0)
            return {};
        char c = 0;
        if (read(descriptor, &c, 1) != 1)
            return {};
        if (c == '\n')
            return line;
        line += c;
    }
}

}  // namespace

Xvfb::Xvfb(std::filesystem::path framebufferFolder)
    : framebufferFolder_(std::move(framebufferFolder)),
      displayBefore_(variable("DISPLAY")),
      waylandBefore_(variable("WAYLAND_DISPLAY")) {
    // Two servers that start at the same moment may want the same number, and one of them gives up.
    constexpr int attempts = 5;
    std::string number;
    for (int i = 0; i < attempts && number.empty(); ++i)
        number = start();
    if (number.empty())
        throw EnvironmentError("did not start", "Xvfb", "install the package xvfb");
    display_ = ":" + number;
    setVariable("DISPLAY", display_);
    setVariable("WAYLAND_DISPLAY", "");
}

std::string Xvfb::start() {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0)
        throw EnvironmentError(std::strerror(errno), "pipe");
    const std::string descriptor = std::to_string(ends[1]);
    process_ = fork();
    if (process_ == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        fcntl(ends[1], F_SETFD, 0);
        const int null = open("/dev/null", O_RDWR | O_CLOEXEC);
        dup2(null, STDOUT_FILENO);
        dup2(null, STDERR_FILENO);
        execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "1280x1024x24", "-nolisten",
               "tcp", "-noreset", framebufferFolder_.empty() ? nullptr : "-fbdir", framebufferFolder_.c_str(),
               static_cast<char*>(nullptr));
        _exit(127);
    }
    close(ends[1]);
    std::string number = process_ > 0 ? readNumber(ends[0]) : std::string();
    close(ends[0]);
    if (number.empty())
        stop();
    return number;
}

Xvfb::~Xvfb() {
    stop();
    setVariable("DISPLAY", displayBefore_);
    setVariable("WAYLAND_DISPLAY", waylandBefore_);
}

void Xvfb::stop() {
    if (process_ <= 0)
        return;
    kill(process_, SIGTERM);
    waitpid(process_, nullptr, 0);
    process_ = -1;
}

}  // namespace quincunx::test
