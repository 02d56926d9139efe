#pragma once

#include <filesystem>
#include <string>

#include <sys/types.h>

namespace quincunx::test {

/// A display without a screen (1280×1024, 24 bits), which stays as it is when its last client leaves: starts
/// Xvfb on a free display number, points DISPLAY to it and unsets WAYLAND_DISPLAY; its end stops the server
/// and restores both. The server dies with the test too.
class Xvfb {
  public:
    /// Throws EnvironmentError if Xvfb is not installed or does not answer within 20 seconds. The screen's
    /// pixels are in the file Xvfb_screen0 of `framebufferFolder`, which exists, in X's window dump format.
    explicit Xvfb(std::filesystem::path framebufferFolder = {});
    ~Xvfb();
    Xvfb(const Xvfb&) = delete;
    Xvfb& operator=(const Xvfb&) = delete;
    /// ":7"
    const std::string& display() const { return display_; }

  private:
    /// The display's number; empty when the server did not start.
    std::string start();
    void stop();

    std::filesystem::path framebufferFolder_;
    pid_t process_ = -1;
    std::string display_;
    std::string displayBefore_;
    std::string waylandBefore_;
};

}  // namespace quincunx::test
