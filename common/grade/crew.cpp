#include "grade/crew.h"

#include <cerrno>
#include <csignal>
#include <cstring>

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "grade/worker.h"

namespace quincunx::grade {
namespace {

std::string causeOf(int status, int cpuSeconds) {
    int signal = 0;
    if (WIFSIGNALED(status))
        signal = WTERMSIG(status);
    else if (WIFEXITED(status) && WEXITSTATUS(status) > diedBySignal)
        signal = WEXITSTATUS(status) - diedBySignal;
    switch (signal) {
        case 0:
            return "its process ended early";
        case SIGXCPU:
        case SIGKILL:
            return fmt::format("its process was ended: it took more than {} s of processor time", cpuSeconds);
        case SIGSEGV:
        case SIGBUS:
            return "its process crashed on an address";
        case SIGABRT:
            return "its process gave up, as when memory ends";
        default:
            return fmt::format("its process was ended by signal {}", signal);
    }
}

}  // namespace

Worker::Worker(std::vector<std::string> words, std::string lab, std::string rubric, ProcessLimits limits)
    : words_(std::move(words)), lab_(std::move(lab)), rubric_(std::move(rubric)), limits_(limits) {}

Worker::~Worker() {
    stop();
}

void Worker::start() {
    int in[2];
    int out[2];
    if (pipe2(in, O_CLOEXEC) != 0 || pipe2(out, O_CLOEXEC) != 0)
        throw EnvironmentError(fmt::format("no pipe: {}", std::strerror(errno)), {}, "use fewer --jobs");
#ifdef F_SETPIPE_SZ
    fcntl(in[0], F_SETPIPE_SZ, 1 << 20);
#endif
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, in[0], STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out[1], STDOUT_FILENO);
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::vector<char*> pointers;
    for (std::string& word : words_)
        pointers.push_back(word.data());
    pointers.push_back(nullptr);
    const int error =
        posix_spawn(&process_, words_.front().c_str(), &actions, &attributes, pointers.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    close(in[0]);
    close(out[1]);
    to_ = in[1];
    from_ = out[0];
    if (error != 0) {
        process_ = -1;
        throw EnvironmentError(std::strerror(error), words_.front(), "the program cannot start itself again");
    }
    const Json header{{"lab", lab_},
                      {"rubric", rubric_},
                      {"cpu_seconds", limits_.cpuSeconds},
                      {"memory_bytes", limits_.memoryBytes}};
    quincunx::grade::send(to_, {"begin", header, {}});
    // Libraries are loaded once, before any submission's time begins.
    constexpr auto patience = std::chrono::minutes(5);
    if (const auto ready = receive(from_, std::chrono::steady_clock::now() + patience);
        !ready || ready->kind != "ready") {
        stop();
        throw EnvironmentError("the processes for submissions do not start", words_.front(),
                               "see whether compare works");
    }
}

void Worker::stop() {
    if (process_ < 0)
        return;
    kill(-process_, SIGKILL);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
    close(to_);
    close(from_);
    process_ = -1;
    busy_ = false;
}

void Worker::begin(const Message& job, std::chrono::seconds most) {
    if (process_ < 0)
        start();
    // Processor time is what is limited, so that a busy machine gives the same grades; this is for what
    // sleeps.
    most_ = 5 * most + std::chrono::seconds(15);
    deadline_ = std::chrono::steady_clock::now() + most_;
    busy_ = true;
    send(job);
}

void Worker::send(const Message& message) {
    quincunx::grade::send(to_, message);
}

Message Worker::ended() {
    Message message{"failed", Json::object(), {}};
    if (std::chrono::steady_clock::now() >= deadline_) {
        message.header["reason"] =
            fmt::format("its process was ended: it did not come to an end in {} s", most_.count());
        stop();
        return message;
    }
    int status = 0;
    constexpr auto patience = std::chrono::seconds(2);
    const auto end = std::chrono::steady_clock::now() + patience;
    pid_t gone = 0;
    while ((gone = waitpid(process_, &status, WNOHANG)) == 0 && std::chrono::steady_clock::now() < end)
        usleep(1000);
    message.header["reason"] =
        gone > 0 ? causeOf(status, limits_.cpuSeconds) : "its process said what makes no sense";
    if (gone > 0) {
        kill(-process_, SIGKILL);
        close(to_);
        close(from_);
        process_ = -1;
        busy_ = false;
    } else {
        stop();
    }
    return message;
}

Message Worker::next() {
    std::optional<Message> message = receive(from_, deadline_);
    if (!message)
        return ended();
    if (message->kind == "end") {
        busy_ = false;
        return {"failed", {{"reason", "its process ended early"}}, {}};
    }
    return std::move(*message);
}

void Worker::finish() {
    while (busy_)
        next();
}

}  // namespace quincunx::grade
