#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace httplib {
class Client;
}

namespace quincunx::test {

/// Chromium without a screen, driven by chromedriver over the WebDriver protocol (W3C recommendation of
/// 2018). With a profile of its own that goes with it. What the protocol refuses stops the test with an
/// EnvironmentError that holds the browser's words.
class Browser {
  public:
    /// Of the window; pixels. EnvironmentError if chromium or chromium-driver is not installed.
    explicit Browser(int width = 1200, int height = 900);
    ~Browser();
    Browser(const Browser&) = delete;
    Browser& operator=(const Browser&) = delete;

    /// Opens a file and waits until it has loaded. `fragment`: what follows '#'; empty: nothing.
    void open(const std::filesystem::path& page, std::string_view fragment = {});
    void resize(int width, int height);
    /// As a person prefers it on their machine.
    void preferDark(bool dark);
    void preferPrint(bool print);

    /// The value of a script's `return`, with `arguments` as its `arguments`; a promise is waited for.
    nlohmann::json run(std::string_view script, const nlohmann::json& arguments = nlohmann::json::array());
    /// Waits until the script returns something true; false when `patience` is over before.
    bool waitFor(std::string_view script, std::chrono::milliseconds patience = std::chrono::seconds(10));
    /// The first element that the selector finds is clicked, or typed into ("\uE014" is the right arrow: the
    /// protocol's table of keys). An element that nobody could click is an error.
    void click(std::string_view selector);
    void type(std::string_view selector, std::string_view keys);
    /// Moves the pointer over the middle of the element, offset by pixels.
    void pointAt(std::string_view selector, int right = 0, int down = 0);

    /// What pages wrote to the console, and what the browser itself complained of, since the last call.
    std::vector<std::string> consoleMessages();
    /// What was asked for since the last call, but for files and data URIs.
    std::vector<std::string> networkRequests();

    /// Of the window, PNG.
    void screenshot(const std::filesystem::path& file);

  private:
    nlohmann::json call(const char* method, const std::string& path, const nlohmann::json& body = nullptr);
    nlohmann::json log(const char* kind);
    void emulate();
    std::string find(std::string_view selector);

    TemporaryFolder profile_;
    std::unique_ptr<Process> driver_;
    std::unique_ptr<httplib::Client> client_;
    std::string session_;
    bool dark_ = false;
    bool print_ = false;
};

}  // namespace quincunx::test
