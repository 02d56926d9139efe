// From exec to the written picture of lab 10, at 640x480: the lab's own program and `quincunx run`, beside
// the bare program, which draws the same frame by hand and writes it by the same image module. Run
// alternately.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/check.h"
#include "base/paths.h"

namespace {

namespace fs = std::filesystem;

struct Cost {
    double wallSeconds = 0;
    double cpuSeconds = 0;
};

double secondsOf(const timeval& time) {
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
}

/// Runs a program to its end, its output thrown away.
Cost costOf(const std::vector<std::string>& command) {
    std::vector<char*> arguments;
    for (const std::string& word : command)
        arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t process = 0;
    const auto start = std::chrono::steady_clock::now();
    QX_CHECK_EQ(posix_spawn(&process, arguments[0], &actions, nullptr, arguments.data(), environ), 0);
    int status = 0;
    rusage usage{};
    QX_CHECK_EQ(wait4(process, &status, 0, &usage), process);
    const std::chrono::duration<double> wall = std::chrono::steady_clock::now() - start;
    posix_spawn_file_actions_destroy(&actions);
    QX_CHECK_EQ(status, 0);
    return {wall.count(), secondsOf(usage.ru_utime) + secondsOf(usage.ru_stime)};
}

struct Contender {
    std::string name;
    std::vector<std::string> command;
    std::vector<double> wall;
    std::vector<double> cpu;
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    const fs::path programs = quincunx::executablePath().parent_path();
    const std::string picture =
        (fs::temp_directory_path() / ("quincunx_exec_to_png_" + std::to_string(getpid()) + ".png")).string();
    std::vector<Contender> contenders = {
        {"bare program", {(programs / "bare_shading_main").string(), picture}, {}, {}},
        {"10_shading --out", {(programs / "10_shading").string(), "--out", picture}, {}, {}},
        {"quincunx run shading --out",
         {(programs / "quincunx").string(), "run", "shading", "--out", picture},
         {},
         {}},
        {"quincunx list", {(programs / "quincunx").string(), "list"}, {}, {}},
    };
    for (const Contender& contender : contenders)
        benchmark::RegisterBenchmark(contender.name.c_str(),
                                     [&contender](benchmark::State& state) {
                                         for (auto _ : state)
                                             state.SetIterationTime(costOf(contender.command).wallSeconds);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseManualTime();
    benchmark::RunSpecifiedBenchmarks();

    constexpr int rounds = 21;
    for (int round = 0; round < rounds; ++round)
        for (Contender& contender : contenders) {
            const Cost cost = costOf(contender.command);
            contender.wall.push_back(cost.wallSeconds);
            contender.cpu.push_back(cost.cpuSeconds);
        }
    for (const Contender& contender : contenders)
        std::printf(
            "ratio %s / bare program: wall %.3f (%.0f ms / %.0f ms), CPU %.3f (%.0f ms / %.0f ms), "
            "medians of %d\n",
            contender.name.c_str(), median(contender.wall) / median(contenders[0].wall),
            median(contender.wall) * 1e3, median(contenders[0].wall) * 1e3,
            median(contender.cpu) / median(contenders[0].cpu), median(contender.cpu) * 1e3,
            median(contenders[0].cpu) * 1e3, rounds);
    std::error_code error;
    fs::remove(picture, error);
}
