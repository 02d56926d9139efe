#pragma once

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include <sys/types.h>

#include "grade/channel.h"
#include "grade/rubric.h"
#include "grade/sandbox.h"

namespace quincunx::grade {

/// The other side of runWorker: a process of the same program that does one job at a time, and is started
/// afresh when one has cost its life.
class Worker {
  public:
    /// `words`: the program and what makes it call runWorker.
    Worker(std::vector<std::string> words, std::string lab, std::string rubric, ProcessLimits limits);
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    /// Begins a job that may take these seconds of processor time. EnvironmentError if no process starts.
    void begin(const Message& job, std::chrono::seconds most);
    void send(const Message& message);
    /// The job's next message; "failed" {reason} if its process was killed, ran out of time or said nonsense:
    /// then the job is over.
    Message next();
    /// Waits for the job's end.
    void finish();

  private:
    void start();
    void stop();
    Message ended();

    std::vector<std::string> words_;
    std::string lab_;
    std::string rubric_;
    ProcessLimits limits_;
    pid_t process_ = -1;
    int to_ = -1;
    int from_ = -1;
    bool busy_ = false;
    std::chrono::steady_clock::time_point deadline_;
    std::chrono::seconds most_{};
};

}  // namespace quincunx::grade
