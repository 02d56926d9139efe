// What a closed-in process cannot do. Each test forks one, whose exit status tells.

#include "grade/sandbox.h"

#include <atomic>
#include <cerrno>
#include <csignal>
#include <functional>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace quincunx::grade {
namespace {

/// The wait status of a process that does this.
int statusOf(const std::function<int()>& work) {
    const pid_t child = fork();
    if (child == 0)
        _exit(work());
    int status = 0;
    waitpid(child, &status, 0);
    return status;
}

bool denied(const std::function<long()>& call) {
    const int status = statusOf([&] {
        closeSandbox();
        errno = 0;
        return call() == -1 && errno == EPERM ? 0 : 1;
    });
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Sandbox, OpensNoFiles) {
    EXPECT_TRUE(denied([] { return open("/etc/passwd", O_RDONLY); }));
    EXPECT_TRUE(denied([] { return open("/tmp/quincunx_escape", O_CREAT | O_WRONLY, 0600); }));
    EXPECT_TRUE(denied([] { return unlink("/tmp/quincunx_escape"); }));
    EXPECT_TRUE(denied([] { return memfd_create("x", 0); }));
}

TEST(Sandbox, ReachesNoNetwork) {
    EXPECT_TRUE(denied([] { return socket(AF_INET, SOCK_STREAM, 0); }));
    EXPECT_TRUE(denied([] { return socket(AF_UNIX, SOCK_STREAM, 0); }));
}

TEST(Sandbox, StartsAndSignalsNoProcesses) {
    EXPECT_TRUE(denied([] { return fork(); }));
    EXPECT_TRUE(denied([] { return execl("/bin/true", "true", nullptr); }));
    EXPECT_TRUE(denied([] { return kill(getppid(), 0); }));
}

TEST(Sandbox, StillComputesWithThreadsAndPipes) {
    const int status = statusOf([] {
        int ends[2];
        if (pipe(ends) != 0)
            return 1;
        closeSandbox();
        int sum = 0;
        std::thread([&] { sum = 3; }).join();
        const std::vector<char> memory(64 << 20, 'x');
        char c = 0;
        return write(ends[1], memory.data(), 1) == 1 && read(ends[0], &c, 1) == 1 && c == 'x' && sum == 3 ? 0
                                                                                                          : 2;
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(Sandbox, HoldsForThreadsThatWereThereBefore) {
    const int status = statusOf([] {
        std::atomic<bool> closed = false;
        std::atomic<int> result = 1;
        std::thread thread([&] {
            while (!closed)
                std::this_thread::yield();
            result = open("/etc/passwd", O_RDONLY) < 0 && errno == EPERM ? 0 : 2;
        });
        closeSandbox();
        closed = true;
        thread.join();
        return result.load();
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}

TEST(Limits, EndAProcessThatComputesTooLong) {
    const int status = statusOf([] {
        limitProcess({.cpuSeconds = 1, .memoryBytes = 1 << 30});
        const std::atomic<bool> forever = true;
        while (forever) {
        }
        return 0;
    });
    EXPECT_TRUE(WIFSIGNALED(status));
}

#ifndef __SANITIZE_ADDRESS__
TEST(Limits, KeepMemoryBounded) {
    const int status = statusOf([] {
        limitProcess({.cpuSeconds = 10, .memoryBytes = 64 << 20});
        return mmap(nullptr, 128 << 20, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) ==
                       MAP_FAILED
                   ? 0
                   : 1;
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}
#endif

TEST(Limits, LetNoFileGrow) {
    const int status = statusOf([] {
        signal(SIGXFSZ, SIG_IGN);
        const int file = memfd_create("x", 0);
        limitProcess({});
        return write(file, "x", 1) == -1 && errno == EFBIG ? 0 : 1;
    });
    EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
}

}  // namespace
}  // namespace quincunx::grade
