// From exec to the first picture of a million triangles in lab 10's window, under Xvfb, beside
// tinyobjloader's parsing of the same file alone. The screen is watched from outside, in the server's own
// memory.
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/check.h"
#include "base/paths.h"
#include "tests/support/xvfb.h"
#include "wavy_surface.h"

namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using quincunx::bench::parseByTinyobj;
using quincunx::bench::WavySurface;

double secondsSince(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The pixels of a screen that an X server keeps in a file (X11/XWDFile.h: numbers are big-endian).
class Screen {
  public:
    explicit Screen(const fs::path& file) {
        const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
        QX_CHECK_GE(descriptor, 0);
        bytes_ = fs::file_size(file);
        void* const mapped = mmap(nullptr, bytes_, PROT_READ, MAP_SHARED, descriptor, 0);
        close(descriptor);
        QX_CHECK(mapped != MAP_FAILED);
        data_ = static_cast<const volatile unsigned char*>(mapped);
        pixels_ = number(0) + 12 * number(19);
        bytesPerLine_ = number(12);
    }
    /// Red, green, blue.
    std::uint32_t pixel(std::size_t x, std::size_t y) const {
        const std::size_t at = pixels_ + y * bytesPerLine_ + 4 * x;
        return static_cast<std::uint32_t>(data_[at + 2]) << 16 |
               static_cast<std::uint32_t>(data_[at + 1]) << 8 | data_[at];
    }

  private:
    std::size_t number(std::size_t index) const {
        std::size_t value = 0;
        for (std::size_t i = 0; i < 4; ++i)
            value = value << 8 | data_[4 * index + i];
        return value;
    }
    const volatile unsigned char* data_ = nullptr;
    std::size_t bytes_ = 0;
    std::size_t pixels_ = 0;
    std::size_t bytesPerLine_ = 0;
};

/// Waits until `condition` holds; returns the seconds since `start`. Stops the program where it never does.
template <typename Condition>
double secondsUntil(Clock::time_point start, const Condition& condition) {
    constexpr double patienceSeconds = 60;
    while (!condition()) {
        QX_CHECK_LE(secondsSince(start), patienceSeconds);
        usleep(1000);
    }
    return secondsSince(start);
}

/// Starts a lab's window on the model, waits for its picture, and ends it.
double secondsToPicture(const Screen& screen, const fs::path& program, const fs::path& model) {
    // The panel stands to the right of the picture: the picture's middle is here.
    constexpr std::size_t x = 320;
    constexpr std::size_t y = 240;
    secondsUntil(Clock::now(), [&] { return screen.pixel(x, y) == 0; });
    const std::vector<std::string> command = {program.string(), "--backend", "window",      "--size",
                                              "640x480",        "--model",   model.string()};
    std::vector<char*> arguments;
    for (const std::string& word : command)
        arguments.push_back(const_cast<char*>(word.c_str()));
    arguments.push_back(nullptr);
    const Clock::time_point start = Clock::now();
    pid_t process = 0;
    QX_CHECK_EQ(posix_spawn(&process, arguments[0], nullptr, nullptr, arguments.data(), environ), 0);
    const double seconds = secondsUntil(start, [&] { return screen.pixel(x, y) != 0; });
    kill(process, SIGTERM);
    int status = 0;
    QX_CHECK_EQ(waitpid(process, &status, 0), process);
    return seconds;
}

template <typename Work>
double medianSeconds(const Work& work) {
    std::vector<double> seconds;
    for (int run = 0; run < 7; ++run)
        seconds.push_back(work());
    std::sort(seconds.begin(), seconds.end());
    return seconds[3];
}

}  // namespace

int main() {
    const fs::path folder = fs::temp_directory_path() / ("quincunx_screen_" + std::to_string(getpid()));
    fs::create_directories(folder);
    {
        const quincunx::test::Xvfb server(folder);
        const Screen screen(folder / "Xvfb_screen0");
        const fs::path program = quincunx::executablePath().parent_path() / "10_shading";
        const WavySurface plain(false);
        const WavySurface full(true);
        for (const auto& [name, model] : {std::pair{"positions only, normals made", &plain},
                                          std::pair{"with normals and texture coordinates", &full}}) {
            const fs::path path = model->path();
            const double tinyobj = medianSeconds([&path] {
                const Clock::time_point start = Clock::now();
                parseByTinyobj(path);
                return secondsSince(start);
            });
            const double ours = medianSeconds([&] { return secondsToPicture(screen, program, path); });
            std::printf(
                "ratio exec to picture / tinyobjloader's parse, %s: %.3f (%.0f ms / %.0f ms, medians of 7)\n",
                name, ours / tinyobj, ours * 1e3, tinyobj * 1e3);
        }
    }
    std::error_code error;
    fs::remove_all(folder, error);
}
