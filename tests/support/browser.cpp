#include "tests/support/browser.h"

#include <array>
#include <csignal>
#include <thread>

#include <arpa/inet.h>
#include <fmt/format.h>
#include <httplib.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"

namespace quincunx::test {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

constexpr const char* remedy = "install the packages chromium and chromium-driver";

/// A port of this machine that nobody listens on.
int freePort() {
    const int listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    QX_CHECK(listener >= 0 && bind(listener, any, size) == 0 && getsockname(listener, any, &size) == 0);
    close(listener);
    return ntohs(address.sin_port);
}

std::string decodedBase64(std::string_view text) {
    std::string bytes;
    unsigned bits = 0;
    int count = 0;
    for (const char c : text) {
        const unsigned digit = c >= 'A' && c <= 'Z'   ? static_cast<unsigned>(c - 'A')
                               : c >= 'a' && c <= 'z' ? static_cast<unsigned>(c - 'a' + 26)
                               : c >= '0' && c <= '9' ? static_cast<unsigned>(c - '0' + 52)
                               : c == '+'             ? 62U
                               : c == '/'             ? 63U
                                                      : 64U;
        if (digit == 64)
            continue;
        bits = bits << 6 | digit;
        count += 6;
        if (count >= 8) {
            count -= 8;
            bytes += static_cast<char>(bits >> count & 0xFF);
        }
    }
    return bytes;
}

std::string fileUrl(const std::filesystem::path& page) {
    std::string url = "file://";
    for (const char c : std::filesystem::absolute(page).string())
        url += std::isalnum(static_cast<unsigned char>(c)) != 0 ||
                       std::string_view("/._-~").find(c) != std::string_view::npos
                   ? std::string(1, c)
                   : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    return url;
}

}  // namespace

Browser::Browser(int width, int height) {
    const int port = freePort();
    driver_ = std::make_unique<Process>(
        std::vector<std::string>{"sh", "-c", fmt::format("exec chromedriver --port={}", port)},
        ProcessOptions{.folder = {},
                       .environment = {"HOME=" + profile_.path().string(), "DISPLAY=", "WAYLAND_DISPLAY="},
                       .out = {},
                       .timeout = 600s});
    if (!driver_->waitFor("started successfully"))
        throw EnvironmentError("chromedriver did not start", {}, remedy);
    client_ = std::make_unique<httplib::Client>("127.0.0.1", port);
    client_->set_read_timeout(240 * patienceFactor);  // busy machines start it slowly
    client_->set_keep_alive(true);

    const json arguments = {"--headless=new",
                            "--no-sandbox",
                            "--disable-gpu",
                            "--disable-quic",
                            "--no-first-run",
                            "--disable-background-networking",
                            "--disable-component-update",
                            "--disable-sync",
                            "--disable-dev-shm-usage",
                            "--hide-scrollbars",
                            "--force-color-profile=srgb",
                            "--user-data-dir=" + (profile_ / "profile").string(),
                            fmt::format("--window-size={},{}", width, height)};
    const json capabilities = {{"browserName", "chrome"},
                               {"goog:chromeOptions", {{"args", arguments}}},
                               {"goog:loggingPrefs", {{"browser", "ALL"}, {"performance", "ALL"}}}};
    session_ = call("POST", "/session", {{"capabilities", {{"alwaysMatch", capabilities}}}}).at("sessionId");
    resize(width, height);
    // What the browser showed before the first page is not the pages'.
    call("POST", fmt::format("/session/{}/url", session_), {{"url", "about:blank"}});
    consoleMessages();
    networkRequests();
}

Browser::~Browser() {
    if (client_ && !session_.empty())
        client_->Delete("/session/" + session_);
    if (driver_)
        driver_->signal(SIGTERM);
}

nlohmann::json Browser::call(const char* method, const std::string& path, const json& body) {
    const std::string text = body.is_null() ? "{}" : body.dump();
    const httplib::Result reply = std::string_view(method) == "GET"
                                      ? client_->Get(path)
                                      : client_->Post(path, text, "application/json; charset=utf-8");
    if (!reply)
        throw EnvironmentError(fmt::format("no reply: {}", httplib::to_string(reply.error())), path, remedy);
    const json answer = json::parse(reply->body, nullptr, false);
    if (reply->status != 200 || answer.is_discarded())
        throw EnvironmentError(printable(reply->body, 600), path, remedy);
    return answer.at("value");
}

void Browser::open(const std::filesystem::path& page, std::string_view fragment) {
    const std::string url = fileUrl(page) + (fragment.empty() ? std::string() : fmt::format("#{}", fragment));
    call("POST", fmt::format("/session/{}/url", session_), {{"url", url}});
}

void Browser::resize(int width, int height) {
    // Not the window's size, below 500 pixels of which Chromium does not go.
    call("POST", fmt::format("/session/{}/goog/cdp/execute", session_),
         {{"cmd", "Emulation.setDeviceMetricsOverride"},
          {"params", {{"width", width}, {"height", height}, {"deviceScaleFactor", 1}, {"mobile", false}}}});
}

void Browser::emulate() {
    const json features = {{{"name", "prefers-color-scheme"}, {"value", dark_ ? "dark" : "light"}}};
    call("POST", fmt::format("/session/{}/goog/cdp/execute", session_),
         {{"cmd", "Emulation.setEmulatedMedia"},
          {"params", {{"media", print_ ? "print" : ""}, {"features", features}}}});
}

void Browser::preferDark(bool dark) {
    dark_ = dark;
    emulate();
}

void Browser::preferPrint(bool print) {
    print_ = print;
    emulate();
}

nlohmann::json Browser::run(std::string_view script, const json& arguments) {
    return call("POST", fmt::format("/session/{}/execute/sync", session_),
                {{"script", script}, {"args", arguments}});
}

bool Browser::waitFor(std::string_view script, std::chrono::milliseconds patience) {
    const auto end = std::chrono::steady_clock::now() + patience * patienceFactor;
    const std::string truth = fmt::format("return Boolean((() => {{{}}})());", script);
    while (!run(truth).get<bool>()) {
        if (std::chrono::steady_clock::now() > end)
            return false;
        std::this_thread::sleep_for(20ms);
    }
    return true;
}

std::string Browser::find(std::string_view selector) {
    const json found = call("POST", fmt::format("/session/{}/element", session_),
                            {{"using", "css selector"}, {"value", selector}});
    return found.begin().value();
}

void Browser::click(std::string_view selector) {
    call("POST", fmt::format("/session/{}/element/{}/click", session_, find(selector)), json::object());
}

void Browser::type(std::string_view selector, std::string_view keys) {
    call("POST", fmt::format("/session/{}/element/{}/value", session_, find(selector)), {{"text", keys}});
}

void Browser::pointAt(std::string_view selector, int right, int down) {
    run("document.querySelector(arguments[0]).scrollIntoView({block: 'center', behavior: 'instant'})",
        json::array({selector}));
    const json origin = {{"element-6066-11e4-a52e-4f735466cecf", find(selector)}};
    const json move = {
        {"type", "pointerMove"}, {"duration", 0}, {"origin", origin}, {"x", right}, {"y", down}};
    call("POST", fmt::format("/session/{}/actions", session_),
         {{"actions", {{{"type", "pointer"}, {"id", "mouse"}, {"actions", json::array({move})}}}}});
}

nlohmann::json Browser::log(const char* kind) {
    return call("POST", fmt::format("/session/{}/se/log", session_), {{"type", kind}});
}

std::vector<std::string> Browser::consoleMessages() {
    std::vector<std::string> messages;
    for (const json& entry : log("browser"))
        messages.push_back(entry.at("message"));
    return messages;
}

std::vector<std::string> Browser::networkRequests() {
    std::vector<std::string> requests;
    for (const json& entry : log("performance")) {
        const json message = json::parse(entry.at("message").get<std::string>()).at("message");
        if (message.at("method") != "Network.requestWillBeSent")
            continue;
        const std::string url = message.at("params").at("request").at("url");
        if (!url.starts_with("file:") && !url.starts_with("data:"))
            requests.push_back(url);
    }
    return requests;
}

void Browser::screenshot(const std::filesystem::path& file) {
    writeFile(
        file,
        decodedBase64(
            call("GET", fmt::format("/session/{}/screenshot", session_)).get_ref<const std::string&>()));
}

}  // namespace quincunx::test
