#include "tests/common/window/driver.h"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <stdexcept>
#include <thread>

#include <X11/Xatom.h>
#include <X11/Xlib.h>
#include <X11/Xutil.h>

#include "image/io.h"

namespace quincunx::test {
namespace {

using Clock = std::chrono::steady_clock;

/// On a busy machine a first frame takes seconds.
constexpr std::chrono::seconds patience{20 * patienceFactor};
constexpr std::chrono::milliseconds pollInterval{2};

/// So often in a row, so long apart, is the program found asleep before it counts as settled.
constexpr int sleepingSamples = 6;
constexpr std::chrono::milliseconds sampleInterval{4};

/// So many times in a row the program must take its events: more often than an event calls for frames.
constexpr int pingsPerAct = 6;

/// The letter of a thread's state (proc(5)); none if there is no such thread.
char stateOf(const std::filesystem::path& thread) {
    std::ifstream file(thread / "stat");
    std::string line;
    std::getline(file, line);
    // It follows the name, which is in brackets.
    const std::size_t end = line.rfind(')');
    return end != std::string::npos && end + 2 < line.size() ? line[end + 2] : '\0';
}

std::filesystem::path folderOf(pid_t process) {
    return "/proc/" + std::to_string(process);
}

/// True if no thread of the process runs or waits for a processor; also when it has ended.
bool asleep(pid_t process) {
    std::error_code error;
    for (const auto& thread : std::filesystem::directory_iterator(folderOf(process) / "task", error)) {
        const char state = stateOf(thread.path());
        if (state == 'R' || state == 'D')
            return false;
    }
    return true;
}

bool hasEnded(pid_t process) {
    const char state = stateOf(folderOf(process));
    return state == '\0' || state == 'Z' || state == 'X';
}

/// Windows may vanish between two requests.
int ignoreError(Display*, XErrorEvent*) {
    return 0;
}

struct FoundWindow {
    Window id = 0;
    Area area;
};

std::optional<FoundWindow> findWindow(Display* display, const std::string& title) {
    Window root = 0;
    Window parent = 0;
    Window* children = nullptr;
    unsigned count = 0;
    if (XQueryTree(display, DefaultRootWindow(display), &root, &parent, &children, &count) == 0)
        return std::nullopt;
    std::optional<FoundWindow> found;
    for (unsigned i = 0; i < count; ++i) {
        char* name = nullptr;
        XWindowAttributes attributes;
        if (XFetchName(display, children[i], &name) == 0)
            continue;
        if (std::string(name).starts_with(title) &&
            XGetWindowAttributes(display, children[i], &attributes) != 0 &&
            attributes.map_state == IsViewable)
            found = {children[i], {attributes.x, attributes.y, attributes.width, attributes.height}};
        XFree(name);
    }
    if (children != nullptr)
        XFree(children);
    return found;
}

}  // namespace

Screen::Screen() : display_(XOpenDisplay(nullptr)) {
    if (display_ == nullptr)
        throw std::runtime_error("the display cannot be opened");
    XSetErrorHandler(ignoreError);
}

Screen::~Screen() {
    XCloseDisplay(display_);
}

Image8 Screen::look(const Area& area) const {
    Image8 image(area.width, area.height, 3, Encoding::srgb);
    XImage* seen =
        XGetImage(display_, DefaultRootWindow(display_), area.x, area.y, static_cast<unsigned>(area.width),
                  static_cast<unsigned>(area.height), AllPlanes, ZPixmap);
    if (seen == nullptr)
        throw std::runtime_error("the area is not on the screen");
    for (int y = 0; y < area.height; ++y)
        for (int x = 0; x < area.width; ++x) {
            const unsigned long value = XGetPixel(seen, x, y);
            for (int channel = 0; channel < 3; ++channel)
                image.pixel(x, y)[channel] = static_cast<std::uint8_t>(value >> (16 - 8 * channel));
        }
    XDestroyImage(seen);
    return image;
}

std::optional<Area> Screen::find(const std::string& title) const {
    const std::optional<FoundWindow> found = findWindow(display_, title);
    return found ? std::optional(found->area) : std::nullopt;
}

bool Screen::ping(const std::string& title) {
    const std::optional<FoundWindow> found = findWindow(display_, title);
    if (!found)
        return false;
    // Windows answer to the root, where window managers listen.
    XSelectInput(display_, DefaultRootWindow(display_), SubstructureNotifyMask);
    XEvent event{};
    event.xclient.type = ClientMessage;
    event.xclient.window = found->id;
    event.xclient.message_type = XInternAtom(display_, "WM_PROTOCOLS", False);
    event.xclient.format = 32;
    event.xclient.data.l[0] = static_cast<long>(XInternAtom(display_, "_NET_WM_PING", False));
    event.xclient.data.l[1] = ++pings_;
    event.xclient.data.l[2] = static_cast<long>(found->id);
    XSendEvent(display_, found->id, False, NoEventMask, &event);
    XFlush(display_);
    return true;
}

bool Screen::answered() {
    while (XPending(display_) > 0) {
        XEvent event;
        XNextEvent(display_, &event);
        if (event.type == ClientMessage &&
            event.xclient.data.l[0] == static_cast<long>(XInternAtom(display_, "_NET_WM_PING", False)))
            answeredPings_ = event.xclient.data.l[1];
    }
    return answeredPings_ == pings_;
}

void Screen::sync() const {
    XSync(display_, False);
}

void Screen::setDensity(int dotsPerInch) const {
    const std::string resources = "Xft.dpi:\t" + std::to_string(dotsPerInch) + "\n";
    XChangeProperty(display_, DefaultRootWindow(display_), XA_RESOURCE_MANAGER, XA_STRING, 8, PropModeReplace,
                    reinterpret_cast<const unsigned char*>(resources.data()),
                    static_cast<int>(resources.size()));
    XSync(display_, False);
}

DrivenWindow::DrivenWindow() : DrivenWindow(Options{}) {}

DrivenWindow::DrivenWindow(const Options& options) : options_(options), screen_(std::make_unique<Screen>()) {
    screen_->setDensity(options.dotsPerInch);
    // The pointer rests where it points at nothing.
    act({"mousemove", "1279", "1023"});
    std::vector<std::string> command = {QUINCUNX_PROGRAM,
                                        "run",
                                        options.lab,
                                        "--backend",
                                        "window",
                                        "--size",
                                        std::to_string(options.width) + "x" + std::to_string(options.height),
                                        "--record",
                                        "record.json"};
    command.insert(command.end(), options.words.begin(), options.words.end());
    ProcessOptions process;
    process.folder = folder_.path();
    process.environment = options.environment;
    process_ = std::make_unique<Process>(command, process);
    // The picture has more than one colour as soon as it is there.
    const bool open = waitUntil([this] {
        const std::optional<Area> found = screen_->find(options_.lab);
        if (!found || found->width <= options_.width)
            return false;
        area_ = *found;
        const Image8 seen = picture();
        return withoutAlpha(seen).data != std::vector<std::uint8_t>(seen.data.size(), seen.data[0]);
    });
    if (!open) {
        process_->signal(SIGKILL);
        throw std::runtime_error("no window opened: " + process_->wait().text());
    }
    settle();
}

void DrivenWindow::act(std::vector<std::string> words, Until until) const {
    words.insert(words.begin(), "xdotool");
    const ProcessResult result = runProcess(words);
    if (result.exitStatus != 0)
        throw std::runtime_error("xdotool failed: install the package xdotool\n" + result.text());
    if (until == Until::shown)
        awaitFrames();
    else
        settle();
}

void DrivenWindow::press(const std::string& key, Until until) const {
    // Dear ImGui looks at the keys, like at the pointer, once a frame.
    act({"keydown", key}, until);
    act({"keyup", key}, until);
}

void DrivenWindow::awaitFrames() const {
    if (!process_)
        return;
    for (int i = 0; i < pingsPerAct && screen_->ping(options_.lab); ++i)
        if (!waitUntil([this] { return screen_->answered() || hasEnded(process_->id()); }))
            throw std::runtime_error("the window does not answer");
}

void DrivenWindow::settle() const {
    if (!process_)
        return;
    awaitFrames();
    const Clock::time_point end = Clock::now() + patience;
    for (int samples = 0; samples < sleepingSamples && Clock::now() < end; ++samples) {
        screen_->sync();
        std::this_thread::sleep_for(sampleInterval);
        if (!asleep(process_->id()))
            samples = -1;
    }
}

void DrivenWindow::click(int x, int y, int button, Until until) const {
    // Down and up one after the other, as a hand does: Dear ImGui looks at the pointer once a frame.
    const std::string number = std::to_string(button);
    act({"mousemove", std::to_string(x), std::to_string(y), "mousedown", number}, until);
    act({"mouseup", number}, until);
}

std::filesystem::path DrivenWindow::screenshot(int number, const std::string& key) const {
    press(key);
    const std::filesystem::path file =
        folder_ / ("out/" + options_.lab + "_00" + std::to_string(number) + ".png");
    if (!waitUntil([&] { return exists(file); }))
        throw std::runtime_error("no screenshot " + file.string());
    return file;
}

void DrivenWindow::drag(int button, int fromX, int fromY, int toX, int toY) const {
    const std::string number = std::to_string(button);
    act({"mousemove", std::to_string(fromX), std::to_string(fromY), "mousedown", number, "mousemove",
         std::to_string((fromX + toX) / 2), std::to_string((fromY + toY) / 2), "mousemove",
         std::to_string(toX), std::to_string(toY), "mouseup", number});
}

bool DrivenWindow::waitUntil(const std::function<bool()>& condition) const {
    const Clock::time_point end = Clock::now() + patience;
    while (!condition()) {
        if (Clock::now() > end)
            return false;
        std::this_thread::sleep_for(pollInterval);
    }
    return true;
}

ProcessResult DrivenWindow::close() {
    press("Escape");
    return process_->wait();
}

Image8 DrivenWindow::replay(const std::filesystem::path& file) const {
    ProcessOptions options;
    options.folder = folder_.path();
    const std::filesystem::path out = folder_ / "replayed.png";
    const ProcessResult result = runProcess({QUINCUNX_PROGRAM, "run", options_.lab, "--backend", "egl",
                                             "--replay", file.string(), "--out", out.string()},
                                            options);
    if (result.exitStatus != 0)
        throw std::runtime_error("the replay failed\n" + result.text());
    return withoutAlpha(readImage8(out));
}

Image8 withoutAlpha(const Image8& image) {
    Image8 result(image.width, image.height, 3, image.encoding);
    for (std::size_t i = 0; i < image.pixelCount(); ++i)
        for (std::size_t channel = 0; channel < 3; ++channel)
            result.data[3 * i + channel] = image.data[static_cast<std::size_t>(image.channels) * i + channel];
    return result;
}

int largestDifference(const Image8& a, const Image8& b) {
    if (a.width != b.width || a.height != b.height || a.channels != b.channels)
        return 255;
    int largest = 0;
    for (std::size_t i = 0; i < a.data.size(); ++i)
        largest = std::max(largest, std::abs(int{a.data[i]} - int{b.data[i]}));
    return largest;
}

}  // namespace quincunx::test
