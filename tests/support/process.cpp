#include "tests/support/process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/check.h"

namespace quincunx::test {
namespace {

using namespace std::chrono_literals;

struct Pipe {
    std::array<int, 2> ends{};
    Pipe() { QX_CHECK(pipe2(ends.data(), O_CLOEXEC) == 0); }
};

void closeEnd(int& end) {
    if (end >= 0)
        close(end);
    end = -1;
}

std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> result;
    for (std::string& text : texts)
        result.push_back(text.data());
    result.push_back(nullptr);
    return result;
}

/// The test's environment with `changes` put in.
std::vector<std::string> environmentWith(const std::vector<std::string>& changes) {
    std::vector<std::string> result = changes;
    for (char** entry = environ; *entry != nullptr; ++entry) {
        const std::string_view name(*entry, std::strcspn(*entry, "="));
        const bool changed = std::any_of(changes.begin(), changes.end(), [&](const std::string& change) {
            return std::string_view(change).substr(0, change.find('=')) == name;
        });
        if (!changed)
            result.emplace_back(*entry);
    }
    return result;
}

}  // namespace

std::string ProcessResult::text() const {
    return fmt::format("exit status {}, signal {}{}\nstdout:\n{}\nstderr:\n{}", exitStatus, signal,
                       timedOut ? ", killed when its time was up" : "", out, err);
}

Process::Process(std::vector<std::string> words, ProcessOptions options)
    : deadline_(std::chrono::steady_clock::now() + options.timeout) {
    const Pipe out;
    const Pipe err;
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    if (options.out.empty())
        posix_spawn_file_actions_adddup2(&actions, out.ends[1], STDOUT_FILENO);
    else
        posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, options.out.c_str(),
                                         O_WRONLY | O_CREAT | O_TRUNC, 0644);
    posix_spawn_file_actions_adddup2(&actions, err.ends[1], STDERR_FILENO);
    if (!options.folder.empty())
        posix_spawn_file_actions_addchdir_np(&actions, options.folder.c_str());

    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    sigset_t defaults;
    sigfillset(&defaults);
    sigset_t unblocked;
    sigemptyset(&unblocked);
    posix_spawnattr_setsigdefault(&attributes, &defaults);
    posix_spawnattr_setsigmask(&attributes, &unblocked);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes,
                             POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);

    std::vector<std::string> environment = environmentWith(options.environment);
    const int error = posix_spawnp(&process_, words.front().c_str(), &actions, &attributes,
                                   pointers(words).data(), pointers(environment).data());
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(out.ends[1]);
    close(err.ends[1]);
    out_ = out.ends[0];
    err_ = err.ends[0];
    if (error != 0)
        throw std::runtime_error(fmt::format("{}: {}", words.front(), std::strerror(error)));
}

Process::~Process() {
    if (!ended_) {
        kill(-process_, SIGKILL);
        wait();
    }
}

std::chrono::milliseconds Process::timeLeft() const {
    const auto left =
        std::chrono::ceil<std::chrono::milliseconds>(deadline_ - std::chrono::steady_clock::now());
    return std::max(left, 0ms);
}

bool Process::read(std::chrono::milliseconds patience) {
    std::array<pollfd, 2> streams{{{out_, POLLIN, 0}, {err_, POLLIN, 0}}};
    if (poll(streams.data(), streams.size(), static_cast<int>(patience.count())) <= 0)
        return true;
    std::array<char, 65536> buffer;
    const auto take = [&](const pollfd& stream, int& end, std::string& text) {
        if (stream.revents == 0)
            return;
        const ssize_t count = ::read(end, buffer.data(), buffer.size());
        if (count > 0)
            text.append(buffer.data(), static_cast<std::size_t>(count));
        else if (count == 0 || errno != EINTR)
            closeEnd(end);
    };
    take(streams[0], out_, result_.out);
    take(streams[1], err_, result_.err);
    return out_ >= 0 || err_ >= 0;
}

bool Process::waitFor(std::string_view text) {
    const auto said = [&] {
        return result_.out.find(text) != std::string::npos || result_.err.find(text) != std::string::npos;
    };
    while (!said())
        if (timeLeft() == 0ms || !read(timeLeft()))
            return said();
    return true;
}

void Process::closeOut() {
    closeEnd(out_);
}

void Process::signal(int number) {
    kill(process_, number);
}

ProcessResult Process::wait() {
    while ((out_ >= 0 || err_ >= 0) && timeLeft() > 0ms)
        read(timeLeft());
    int status = 0;
    pid_t gone = 0;
    while ((gone = waitpid(process_, &status, WNOHANG)) == 0 && timeLeft() > 0ms)
        poll(nullptr, 0, 1);
    if (gone == 0) {
        result_.timedOut = true;
        kill(-process_, SIGKILL);
        waitpid(process_, &status, 0);
    }
    ended_ = true;
    closeEnd(out_);
    closeEnd(err_);
    if (WIFEXITED(status) && !result_.timedOut)
        result_.exitStatus = WEXITSTATUS(status);
    if (WIFSIGNALED(status))
        result_.signal = WTERMSIG(status);
    return result_;
}

ProcessResult runProcess(std::vector<std::string> words, ProcessOptions options) {
    return Process(std::move(words), std::move(options)).wait();
}

}  // namespace quincunx::test
