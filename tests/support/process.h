#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <sys/types.h>

namespace quincunx::test {

/// How a program ended and what it said.
struct ProcessResult {
    int exitStatus = -1;  ///< -1 if it did not exit by itself
    int signal = 0;       ///< that ended it; 0: none
    bool timedOut = false;
    std::string out;
    std::string err;

    /// For messages of failed tests: everything above.
    std::string text() const;
};

/// How much longer programs may take than they do unsanitized.
#ifdef __SANITIZE_ADDRESS__
inline constexpr int patienceFactor = 10;
#else
inline constexpr int patienceFactor = 1;
#endif

struct ProcessOptions {
    std::filesystem::path folder;  ///< working directory; empty: the test's own
    /// Added to the test's own environment; "NAME=" sets it empty.
    std::vector<std::string> environment;
    std::filesystem::path out;  ///< where stdout goes instead of into `ProcessResult::out`
    std::chrono::seconds timeout{60 * patienceFactor};
};

/// A program that runs beside the test, in a process group of its own, with nothing on its stdin.
class Process {
  public:
    /// `words`: the program, found in PATH unless it has a slash, and its arguments. Stops the test if it
    /// cannot be started.
    explicit Process(std::vector<std::string> words, ProcessOptions options = {});
    ~Process();
    Process(const Process&) = delete;
    Process& operator=(const Process&) = delete;

    /// Waits until its output or its errors so far hold `text`; false if it ended, or its time was up,
    /// before.
    bool waitFor(std::string_view text);
    /// Closes the reading end of its stdout.
    void closeOut();
    void signal(int number);
    /// Waits for its end; kills its group when its time is up.
    ProcessResult wait();
    pid_t id() const { return process_; }

  private:
    /// Reads what there is, for at most `patience`; false once both streams have ended.
    bool read(std::chrono::milliseconds patience);
    std::chrono::milliseconds timeLeft() const;

    pid_t process_ = -1;
    int out_ = -1;
    int err_ = -1;
    bool ended_ = false;
    std::chrono::steady_clock::time_point deadline_;
    ProcessResult result_;
};

/// Runs a program to its end.
ProcessResult runProcess(std::vector<std::string> words, ProcessOptions options = {});

}  // namespace quincunx::test
