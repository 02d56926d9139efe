#include "grade/sandbox.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>

#include <fmt/format.h>
#include <sched.h>
#include <seccomp.h>
#include <sys/resource.h>
#include <unistd.h>

#include "base/error.h"

namespace quincunx::grade {
namespace {

void limit(int resource, rlim_t most) {
    rlimit limits{};
    getrlimit(static_cast<__rlimit_resource>(resource), &limits);
    limits.rlim_max = limits.rlim_max == RLIM_INFINITY ? most : std::min(limits.rlim_max, most);
    limits.rlim_cur = limits.rlim_max;
    if (setrlimit(static_cast<__rlimit_resource>(resource), &limits) != 0)
        throw EnvironmentError(fmt::format("a limit cannot be set: {}", std::strerror(errno)));
}

/// Addresses that are mapped now.
[[maybe_unused]] std::uint64_t mappedBytes() {
    std::ifstream status("/proc/self/statm");
    std::uint64_t pages = 0;
    status >> pages;
    return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

void require(int result, const char* what) {
    if (result < 0)
        throw EnvironmentError(fmt::format("{}: {}", what, std::strerror(-result)), "seccomp",
                               "grade on a Linux whose kernel has seccomp filters");
}

/// What computing, threads, pipes and the end need.
constexpr int allowed[] = {SCMP_SYS(read),
                           SCMP_SYS(write),
                           SCMP_SYS(readv),
                           SCMP_SYS(writev),
                           SCMP_SYS(close),
                           SCMP_SYS(lseek),
                           SCMP_SYS(fstat),
                           SCMP_SYS(poll),
                           SCMP_SYS(ppoll),
                           SCMP_SYS(mmap),
                           SCMP_SYS(mprotect),
                           SCMP_SYS(munmap),
                           SCMP_SYS(mremap),
                           SCMP_SYS(madvise),
                           SCMP_SYS(brk),
                           SCMP_SYS(futex),
                           SCMP_SYS(futex_waitv),
                           SCMP_SYS(clock_gettime),
                           SCMP_SYS(clock_getres),
                           SCMP_SYS(clock_nanosleep),
                           SCMP_SYS(nanosleep),
                           SCMP_SYS(gettimeofday),
                           SCMP_SYS(time),
                           SCMP_SYS(times),
                           SCMP_SYS(getrusage),
                           SCMP_SYS(sysinfo),
                           SCMP_SYS(uname),
                           SCMP_SYS(getpid),
                           SCMP_SYS(gettid),
                           SCMP_SYS(getcpu),
                           SCMP_SYS(sched_yield),
                           SCMP_SYS(sched_getaffinity),
                           SCMP_SYS(sched_setaffinity),
                           SCMP_SYS(set_robust_list),
                           SCMP_SYS(rseq),
                           SCMP_SYS(membarrier),
                           SCMP_SYS(restart_syscall),
                           SCMP_SYS(rt_sigaction),
                           SCMP_SYS(rt_sigprocmask),
                           SCMP_SYS(rt_sigreturn),
                           SCMP_SYS(sigaltstack),
                           SCMP_SYS(getrandom),
                           SCMP_SYS(exit),
                           SCMP_SYS(exit_group)};

}  // namespace

void limitProcess(const ProcessLimits& limits) {
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_FSIZE, 0);
    rusage used{};
    getrusage(RUSAGE_SELF, &used);
    limit(RLIMIT_CPU,
          static_cast<rlim_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec + 1 + limits.cpuSeconds));
#ifndef __SANITIZE_ADDRESS__
    limit(RLIMIT_AS, mappedBytes() + limits.memoryBytes);
#endif
}

void closeSandbox() {
    const std::unique_ptr<void, void (*)(void*)> filter(seccomp_init(SCMP_ACT_ERRNO(EPERM)),
                                                        &seccomp_release);
    if (!filter)
        require(-ENOSYS, "no filter");
    require(seccomp_attr_set(filter.get(), SCMP_FLTATR_CTL_TSYNC, 1), "filters for all threads");
    for (const int call : allowed)
        require(seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, call, 0), "a rule");
    // New threads, no new processes. Of clone3 a filter cannot see the flags: the library then uses clone.
    require(seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(clone), 1,
                             SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD)),
            "the rule for threads");
    require(seccomp_rule_add(filter.get(), SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0),
            "the rule for clone3");
    // Signals to itself only: how abort ends.
    require(seccomp_rule_add(filter.get(), SCMP_ACT_ALLOW, SCMP_SYS(tgkill), 1,
                             SCMP_A0(SCMP_CMP_EQ, static_cast<scmp_datum_t>(getpid()))),
            "the rule for signals");
    require(seccomp_load(filter.get()), "the filter");
}

}  // namespace quincunx::grade
