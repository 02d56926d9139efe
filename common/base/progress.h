#pragma once

#include <chrono>
#include <cstddef>
#include <string>
#include <utility>

namespace quincunx {

/// A bar with the time left on a terminal's stderr; silent in a pipe or a file.
class Progress {
  public:
    /// `title` names the work; `total` > 0 is its number of pieces.
    Progress(std::string title, std::size_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Says that `done` pieces are finished, and throws Interrupted if a signal asked to stop.
    void update(std::size_t done);
    /// A few words that stand behind the time left from now on.
    void note(std::string words) { note_ = std::move(words); }

  private:
    std::string title_;
    std::string note_;
    std::size_t total_;
    bool onTerminal_;
    std::chrono::steady_clock::time_point start_;
    std::chrono::steady_clock::time_point lastDrawn_;
};

}  // namespace quincunx
