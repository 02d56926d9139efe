#include "base/progress.h"

#include <cstdio>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "base/check.h"
#include "base/interrupt.h"

namespace quincunx {

Progress::Progress(std::string title, std::size_t total)
    : title_(std::move(title)),
      total_(total),
      onTerminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()) {
    QX_CHECK_GT(total, 0u);
}

Progress::~Progress() {
    if (onTerminal_)
        std::fputs("\r\x1b[K", stderr);
}

void Progress::update(std::size_t done) {
    throwIfInterrupted();
    if (!onTerminal_)
        return;
    const auto now = std::chrono::steady_clock::now();
    if (now - lastDrawn_ < std::chrono::milliseconds(50) && done < total_)
        return;
    lastDrawn_ = now;
    constexpr std::size_t barWidth = 30;
    const std::size_t filled = barWidth * done / total_;
    const double elapsed = std::chrono::duration<double>(now - start_).count();
    const double left =
        done > 0 ? elapsed * static_cast<double>(total_ - done) / static_cast<double>(done) : 0;
    const std::string bar =
        fmt::format("\r\x1b[K{} [{:=<{}}{: <{}}] {}/{}  {:.0f} s left{}{}", title_, "", filled, "",
                    barWidth - filled, done, total_, left, note_.empty() ? "" : "  ", note_);
    std::fputs(bar.c_str(), stderr);
    std::fflush(stderr);
}

}  // namespace quincunx
