#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "image/image.h"
#include "lab/picture_state.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/xvfb.h"

struct _XDisplay;

namespace quincunx::test {

/// Part of the screen, in pixels.
struct Area {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

/// What a person sees: the screen of the display that DISPLAY names.
class Screen {
  public:
    Screen();
    ~Screen();
    Screen(const Screen&) = delete;
    Screen& operator=(const Screen&) = delete;

    /// RGB, sRGB-encoded, as the display shows it.
    Image8 look(const Area& area) const;
    /// Returns when the server has done all that it was asked before.
    void sync() const;
    /// Where the window is whose title starts so; none while there is none.
    std::optional<Area> find(const std::string& title) const;
    /// Makes the display say that it has so many dots an inch.
    void setDensity(int dotsPerInch) const;

    /// Asks the window whose title starts so for a sign of life, as window managers do (_NET_WM_PING of the
    /// Extended Window Manager Hints); it answers once it has taken all events that were sent before. False
    /// if there is no such window.
    bool ping(const std::string& title);
    /// True once the last ping is answered.
    bool answered();

  private:
    _XDisplay* display_;
    long pings_ = 0;
    long answeredPings_ = 0;
};

/// The program with a lab in a window of a display without a screen, and hands to use it.
class DrivenWindow {
  public:
    static constexpr int width = 320;   ///< of the picture at the start
    static constexpr int height = 480;  ///< the same: all knobs are in sight

    struct Options {
        std::string lab = "10_shading";  ///< folder name
        int width = DrivenWindow::width;
        int height = DrivenWindow::height;
        std::vector<std::string> words = {};
        std::vector<std::string> environment = {};
        int dotsPerInch = 96;
    };
    DrivenWindow();
    explicit DrivenWindow(const Options& options);

    Screen& screen() { return *screen_; }
    const TemporaryFolder& folder() const { return folder_; }
    Area area() const { return area_; }
    Area pictureArea() const { return {0, 0, options_.width, options_.height}; }
    /// What lies beside it.
    Area panelArea() const { return {options_.width, 0, area_.width - options_.width, area_.height}; }
    Image8 picture() const { return screen_->look(pictureArea()); }

    /// What an act waits for: frames that show what it did, or that nothing is left to do.
    enum class Until { shown, settled };
    /// Sends real events (words of xdotool) and waits until the window has answered.
    void act(std::vector<std::string> words, Until until = Until::settled) const;
    void press(const std::string& key, Until until = Until::settled) const;
    /// Moves the pointer there, and presses and lets go of a button.
    void click(int x, int y, int button = 1, Until until = Until::settled) const;
    /// A drag with the button, in pixels of the screen.
    void drag(int button, int fromX, int fromY, int toX, int toY) const;
    /// Presses the key for a picture, and reads it; the file is the folder's `number`-th.
    std::filesystem::path screenshot(int number, const std::string& key = "p") const;

    /// Waits until the program has taken all events, has shown the frames that they call for, and sleeps with
    /// nothing left to do, on a machine however busy; or has ended.
    void settle() const;
    /// Waits until the program has taken all events and has shown the frames that they call for; it may be at
    /// work on a picture that gets better.
    void awaitFrames() const;
    /// Waits until `condition` holds; false if it does not.
    bool waitUntil(const std::function<bool()>& condition) const;

    /// Closes the window by its key and reads how the program ended.
    ProcessResult close();
    ProcessResult wait() { return process_->wait(); }
    void signal(int number) { process_->signal(number); }
    /// What the program recorded at its end.
    PictureState record() const { return readPictureState(folder_ / "record.json"); }

    /// The picture of a state, drawn offscreen by the program.
    Image8 replay(const std::filesystem::path& file) const;

  private:
    Options options_;
    TemporaryFolder folder_;
    Xvfb xvfb_;
    std::unique_ptr<Screen> screen_;
    std::unique_ptr<Process> process_;
    Area area_;
};

/// RGB of a picture that may have more channels.
Image8 withoutAlpha(const Image8& image);
/// The largest difference of a channel; 255 if the sizes differ.
int largestDifference(const Image8& a, const Image8& b);

}  // namespace quincunx::test
