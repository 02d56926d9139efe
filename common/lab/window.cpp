#include "lab/window.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <deque>
#include <map>
#include <new>
#include <optional>
#include <utility>
#include <vector>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <backends/imgui_impl_glfw.h>
#include <backends/imgui_impl_opengl3.h>
#include <fmt/format.h>
#include <imgui.h>

#include "base/error.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "gl/executor.h"
#include "gl/window.h"
#include "image/io.h"
#include "lab/live_error.h"
#include "lab/ui_panel.h"
#include "scene/camera_control.h"

namespace quincunx {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Seconds reloadInterval{0.25};
/// The knobs and the camera have rested for so long before a reference is made.
constexpr Seconds comparisonDelay{0.25};
/// References are made of pictures whose sides are this many times smaller.
constexpr int comparisonReduction = 4;
constexpr int comparisonSideAtLeast = 64;
/// A lab that has a reference may have none for every view, knob or model.
constexpr const char* noReferenceText = "no reference for what is shown";
/// After an event the panel needs more than one frame to come to rest.
constexpr int framesAfterEvent = 3;
/// A resting picture is drawn a few times more for the median of its time.
constexpr std::size_t restingSamples = 5;
constexpr Seconds restingMeasurement{0.15};
constexpr std::size_t mostSamples = 15;

/// Dear ImGui with its two back ends, for the life of a window.
class ImGuiSession {
  public:
    explicit ImGuiSession(GLFWwindow* window) {
        IMGUI_CHECKVERSION();
        ImGui::CreateContext();
        ImGuiIO& io = ImGui::GetIO();
        io.IniFilename = nullptr;
        io.LogFilename = nullptr;
        io.ConfigFlags |= ImGuiConfigFlags_NavEnableKeyboard;
        ImGui_ImplGlfw_InitForOpenGL(window, true);
        // The key hides the panel; it does not step through the fields.
        io.KeyMap[ImGuiKey_Tab] = -1;
        ImGui_ImplOpenGL3_Init("#version 330 core");
    }
    ~ImGuiSession() {
        ImGui_ImplOpenGL3_Shutdown();
        ImGui_ImplGlfw_Shutdown();
        ImGui::DestroyContext();
    }
    ImGuiSession(const ImGuiSession&) = delete;
    ImGuiSession& operator=(const ImGuiSession&) = delete;
};

/// How long each of the keys that move something was down since it was last asked; exact however seldom that
/// is.
class HeldKeys {
  public:
    static constexpr std::array keys = {GLFW_KEY_D,  GLFW_KEY_A,   GLFW_KEY_E,     GLFW_KEY_Q,
                                        GLFW_KEY_W,  GLFW_KEY_S,   GLFW_KEY_RIGHT, GLFW_KEY_LEFT,
                                        GLFW_KEY_UP, GLFW_KEY_DOWN};
    static bool isArrow(int key) { return key >= GLFW_KEY_RIGHT && key <= GLFW_KEY_UP; }

    void set(int key, bool down) {
        const auto found = std::find(keys.begin(), keys.end(), key);
        if (found == keys.end())
            return;
        const auto i = static_cast<std::size_t>(found - keys.begin());
        settle(i);
        down_[i] = down;
    }
    void releaseAll() {
        for (const int key : keys)
            set(key, false);
    }
    bool any() const { return std::find(down_.begin(), down_.end(), true) != down_.end(); }
    /// Starts anew.
    HeldSeconds take() {
        for (std::size_t i = 0; i < keys.size(); ++i)
            settle(i);
        const HeldSeconds result{.forwards = seconds_[4] - seconds_[5] + seconds_[8] - seconds_[9],
                                 .left = seconds_[1] - seconds_[0] + seconds_[7] - seconds_[6],
                                 .up = seconds_[2] - seconds_[3]};
        seconds_.fill(0);
        return result;
    }

  private:
    void settle(std::size_t i) {
        const Clock::time_point now = Clock::now();
        if (down_[i])
            seconds_[i] += Seconds(now - since_[i]).count();
        since_[i] = now;
    }

    std::array<bool, keys.size()> down_{};
    std::array<double, keys.size()> seconds_{};
    std::array<Clock::time_point, keys.size()> since_{};
};

/// The time of a frame as the median of the last ones that were drawn with the same settings.
class FrameTimes {
  public:
    /// Settings changed: the next frame may build programs and buffers, so it counts only until another is
    /// there.
    void restart() {
        seconds_.clear();
        warm_ = false;
        resting_ = Seconds(0);
    }
    void rest() { resting_ = Seconds(0); }
    void add(double seconds) {
        if (!warm_ && !seconds_.empty()) {
            seconds_.clear();
            warm_ = true;
        }
        seconds_.push_back(seconds);
        if (seconds_.size() > mostSamples)
            seconds_.pop_front();
        resting_ += Seconds(seconds);
    }
    bool enough() const {
        return warm_ && (seconds_.size() >= restingSamples || resting_ > restingMeasurement);
    }
    std::string text() const {
        if (seconds_.empty())
            return "…";
        std::vector<double> sorted(seconds_.begin(), seconds_.end());
        std::sort(sorted.begin(), sorted.end());
        const double median = sorted[sorted.size() / 2];
        return fmt::format("{:.{}f} ms, {:.3g} a second", median * 1e3, median < 0.01 ? 2 : 1, 1 / median);
    }

  private:
    std::deque<double> seconds_;
    bool warm_ = false;
    Seconds resting_{0};
};

/// Digits in groups of three.
std::string grouped(std::uint64_t count) {
    const std::string digits = std::to_string(count);
    std::string result;
    for (std::size_t i = 0; i < digits.size(); ++i) {
        if (i > 0 && (digits.size() - i) % 3 == 0)
            result += ' ';
        result += digits[i];
    }
    return result;
}

/// Copies `source` to `target`, byte for byte, sRGB or not; 0 is the window. Where the sizes differ, the
/// picture is fitted into the target and keeps its shape.
void copyPixels(GLuint source, glm::ivec2 sourceSize, GLuint target, glm::ivec2 targetSize) {
    glDisable(GL_FRAMEBUFFER_SRGB);
    glDisable(GL_SCISSOR_TEST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, source);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target);
    const double scale = std::min(static_cast<double>(targetSize.x) / sourceSize.x,
                                  static_cast<double>(targetSize.y) / sourceSize.y);
    const glm::ivec2 size(std::lround(sourceSize.x * scale), std::lround(sourceSize.y * scale));
    const glm::ivec2 corner = (targetSize - size) / 2;
    glBlitFramebuffer(0, 0, sourceSize.x, sourceSize.y, corner.x, corner.y, corner.x + size.x,
                      corner.y + size.y, GL_COLOR_BUFFER_BIT, size == sourceSize ? GL_NEAREST : GL_LINEAR);
}

/// The last good picture and the state that made it.
struct ShownPicture {
    gl::Texture2D texture;
    gl::Framebuffer framebuffer;
    PictureState state;
    std::map<std::string, std::uint64_t> counters = {};

    glm::ivec2 size() const { return {texture.width(), texture.height()}; }
};

/// A lab in a window, from its opening to its end.
class LabWindow {
  public:
    LabWindow(Lab& lab, const LabEntry& entry, const std::function<PictureState()>& begin,
              const WindowOptions& options)
        : lab_(lab),
          options_(options),
          window_(fmt::format("{} - quincunx", entry.folder()),
                  options.width + static_cast<int>(PanelLayout::width), options.height),
          camera_(lab.defaultCamera(), lab.sceneBounds()),
          liveError_([] { glfwPostEmptyEvent(); }) {
        if (options.sceneIsComing)
            warmUp();
        state_ = begin();
        camera_ = CameraControl(state_.frame.camera, lab.sceneBounds());
        state_.lab = entry.folder();
        state_.renderer = window_.renderer();
        state_.frame.pictureFormat = graph::Format::rgba8Srgb;
        state_.frame.live = true;
        labKeys_ = lab.keys();
        installCallbacks();
        glfwGetCursorPos(window_.glfw(), &cursor_.x, &cursor_.y);
        imgui_.emplace(window_.glfw());
        restyle();
        fitWindow();
        drawPicture();
    }

    /// Until the person closes the window or the program is interrupted.
    void loop() {
        while (!window_.shouldClose() && !interrupted()) {
            advance();
            if (uiFrames_ > 0 || stale_)
                present();
            // All that was done before the key is in the picture.
            if (screenshotWanted_ && ((uiFrames_ == 0 && !stale_) || held_.any() || lab_.isMoving()))
                writeScreenshot();
            wait();
        }
        throwIfInterrupted();
        if (!options_.record.empty())
            writeFile(options_.record, toJson(shown_->state) + "\n");
    }

  private:
    struct KeyBinding {
        std::vector<int> keys;
        const char* names;
        const char* what;
        void (LabWindow::*press)();
    };

    static const std::vector<KeyBinding>& bindings() {
        static const std::vector<KeyBinding> all = {
            {{GLFW_KEY_H, GLFW_KEY_F1}, "H, F1", "this help", &LabWindow::toggleHelp},
            {{GLFW_KEY_TAB}, "Tab", "hide or show the panel", &LabWindow::togglePanel},
            {{GLFW_KEY_C}, "C", "camera: orbit or fly", &LabWindow::toggleCamera},
            {{GLFW_KEY_R}, "R", "camera: back to the start", &LabWindow::resetCamera},
            {{GLFW_KEY_M}, "M", "map of the error", &LabWindow::toggleMap},
            {{GLFW_KEY_P, GLFW_KEY_F12}, "P, F12", "write the picture as PNG", &LabWindow::screenshot},
            {{GLFW_KEY_F5}, "F5", "reload the shaders", &LabWindow::reloadNow},
            {{GLFW_KEY_ESCAPE}, "Esc", "close the window", &LabWindow::escape},
        };
        return all;
    }

    std::vector<KeyHelp> help() const {
        std::vector<KeyHelp> lines;
        for (const KeyBinding& binding : bindings())
            lines.push_back({binding.names, binding.what});
        for (const LabKey& key : labKeys_)
            lines.push_back({std::string(1, key.key), key.what});
        lines.push_back({"Orbit", "left drag turns, right or middle drag moves, wheel zooms"});
        lines.push_back({"Fly", "drag looks around, W A S D moves, E up, Q down, wheel: speed"});
        lines.push_back({"Knobs", "right-click for the default, Ctrl-click to type a value"});
        return lines;
    }

    // ---- the person ----

    void toggleHelp() { helpOpen_ = !helpOpen_; }
    void togglePanel() { panelOpen_ = !panelOpen_; }
    void toggleMap() { mapOpen_ = !mapOpen_; }
    void toggleCamera() {
        camera_.setMode(camera_.mode() == CameraControl::Mode::orbit ? CameraControl::Mode::fly
                                                                     : CameraControl::Mode::orbit);
        held_.releaseAll();
        held_.take();
    }
    void resetCamera() {
        camera_.reset();
        cameraMoved();
    }
    void screenshot() { screenshotWanted_ = true; }
    void reloadNow() {
        lastReload_ = {};
        retry_ = true;
    }
    void escape() {
        if (helpOpen_)
            helpOpen_ = false;
        else if (!ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup))
            glfwSetWindowShouldClose(window_.glfw(), GLFW_TRUE);
    }

    static LabWindow& of(GLFWwindow* window) {
        LabWindow& self = *static_cast<LabWindow*>(glfwGetWindowUserPointer(window));
        self.uiFrames_ = framesAfterEvent;
        return self;
    }

    /// Dear ImGui calls these before it looks at an event itself.
    void installCallbacks() {
        GLFWwindow* window = window_.glfw();
        glfwSetWindowUserPointer(window, this);
        glfwSetKeyCallback(window,
                           [](GLFWwindow* w, int key, int, int action, int) { of(w).onKey(key, action); });
        glfwSetMouseButtonCallback(
            window, [](GLFWwindow* w, int button, int action, int) { of(w).onMouseButton(button, action); });
        glfwSetCursorPosCallback(window, [](GLFWwindow* w, double x, double y) { of(w).onCursor({x, y}); });
        glfwSetScrollCallback(window, [](GLFWwindow* w, double, double y) { of(w).onScroll(y); });
        glfwSetCharCallback(window, [](GLFWwindow* w, unsigned) { of(w); });
        glfwSetCursorEnterCallback(window, [](GLFWwindow* w, int) { of(w); });
        glfwSetFramebufferSizeCallback(window, [](GLFWwindow* w, int, int) { of(w); });
        glfwSetWindowRefreshCallback(window, [](GLFWwindow* w) { of(w); });
        glfwSetWindowContentScaleCallback(window,
                                          [](GLFWwindow* w, float, float) { of(w).styleStale_ = true; });
        glfwSetWindowFocusCallback(window, [](GLFWwindow* w, int focused) {
            if (LabWindow& self = of(w); focused == GLFW_FALSE)
                self.held_.releaseAll();
        });
    }

    void onKey(int key, int action) {
        if (action == GLFW_RELEASE)
            held_.set(key, false);
        if (action != GLFW_PRESS || ImGui::GetIO().WantTextInput)
            return;
        // Arrows step through the panel's fields while one of those is lit, and through open lists.
        const bool arrow = HeldKeys::isArrow(key);
        const bool steps = ImGui::GetIO().NavVisible || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopup);
        const bool drives = lab_.takesControls() && !(arrow && steps);
        if (drives || (camera_.mode() == CameraControl::Mode::fly && !arrow))
            held_.set(key, true);
        for (const KeyBinding& binding : bindings())
            if (std::find(binding.keys.begin(), binding.keys.end(), key) != binding.keys.end())
                (this->*binding.press)();
        for (const LabKey& labKey : labKeys_)
            if (key == labKey.key)
                pressLabKey(labKey);
    }

    void pressLabKey(const LabKey& key) {
        try {
            if (std::string told = key.press(); !told.empty())
                notice_ = std::move(told);
        } catch (const Interrupted&) {
            throw;
        } catch (const Error& e) {
            notice_ = e.what();
        }
        settingsChanged();
    }

    /// True where the mouse is over the picture and nothing lies above it.
    bool overPicture() const {
        const bool coveredByHelp = helpOpen_ && ImGui::GetIO().WantCaptureMouse;
        return cursor_.x < pictureWidthScreen() && !coveredByHelp;
    }

    void onMouseButton(int button, int action) {
        if (action == GLFW_PRESS && !dragButton_ && overPicture())
            dragButton_ = button;
        else if (action == GLFW_RELEASE && dragButton_ == button)
            dragButton_.reset();
    }

    void onCursor(glm::dvec2 position) {
        const glm::dvec2 drag = (position - cursor_) / static_cast<double>(window_.screenSize().y);
        cursor_ = position;
        if (!dragButton_ || lab_.ownCamera())
            return;
        if (*dragButton_ == GLFW_MOUSE_BUTTON_LEFT || camera_.mode() == CameraControl::Mode::fly)
            camera_.turn(drag);
        else
            camera_.pan(drag);
        cameraMoved();
    }

    void onScroll(double notches) {
        if (!overPicture() || lab_.ownCamera())
            return;
        camera_.zoom(notches);
        cameraMoved();
    }

    // ---- sizes ----

    float screenToPixels() const {
        const float screen = static_cast<float>(std::max(window_.screenSize().x, 1));
        return std::max(static_cast<float>(window_.framebufferSize().x) / screen, 0.1f);
    }
    float pointsToScreen() const { return std::max(window_.contentScale() / screenToPixels(), 0.1f); }

    float panelWidthScreen() const {
        return panelOpen_ ? std::round(PanelLayout::width * pointsToScreen()) : 0;
    }
    float pictureWidthScreen() const {
        return static_cast<float>(window_.screenSize().x) - panelWidthScreen();
    }
    glm::ivec2 pictureSize() const {
        const glm::ivec2 all = window_.framebufferSize();
        const int panel = static_cast<int>(std::lround(panelWidthScreen() * screenToPixels()));
        return {std::clamp(all.x - panel, 1, maxPictureSide), std::clamp(all.y, 1, maxPictureSide)};
    }

    /// Gives the picture the size it was asked for, where the display's density made the window another.
    void fitWindow() {
        const float toPixels = screenToPixels();
        const int width = static_cast<int>(std::lround(static_cast<float>(state_.frame.width) / toPixels +
                                                       PanelLayout::width * pointsToScreen()));
        const int height = static_cast<int>(std::lround(static_cast<float>(state_.frame.height) / toPixels));
        if (window_.screenSize() != glm::ivec2(width, height))
            glfwSetWindowSize(window_.glfw(), width, height);
        window_.pollEvents();
    }

    void restyle() {
        styleStale_ = false;
        applyStyle(pointsToScreen(), screenToPixels());
        ImGui_ImplOpenGL3_DestroyFontsTexture();
        ImGui_ImplOpenGL3_CreateFontsTexture();
    }

    // ---- the picture ----

    void cameraMoved() {
        stale_ = true;
        compared_ = false;
        errorText_ = "…";
        liveError_.cancel();
        lastChange_ = Clock::now();
        times_.rest();
        uiFrames_ = std::max(uiFrames_, framesAfterEvent);
    }

    void settingsChanged() {
        cameraMoved();
        times_.restart();
    }

    void advance() {
        const Clock::time_point now = Clock::now();
        const double elapsed = Seconds(now - std::exchange(lastAdvance_, now)).count();
        if (const HeldSeconds held = held_.take(); lab_.takesControls() || lab_.isMoving()) {
            if ((lab_.isMoving() || held != HeldSeconds{}) && lab_.advance(elapsed, held))
                cameraMoved();
        } else if (held != HeldSeconds{} && camera_.mode() == CameraControl::Mode::fly) {
            camera_.fly({-held.left, held.up, held.forwards});
            cameraMoved();
        }
        if (Clock::now() - lastReload_ >= reloadInterval)
            guarded([this] { reload(); });
        if (auto result = liveError_.take())
            takeError(*result);
        if (!compared_ && !stale_ && fault_.empty() && Clock::now() - lastChange_ >= comparisonDelay)
            compare();
        if (!stale_ && uiFrames_ == 0 && fault_.empty() && !times_.enough()) {
            guarded([this] { runTimed(); });
            if (times_.enough())
                uiFrames_ = 1;
        }
    }

    void reload() {
        lastReload_ = Clock::now();
        const std::uint64_t before = executor_.programs().rebuilds();
        const std::string broken = executor_.programs().reloadChanged().value_or("");
        // A program that could never be built is not watched: the picture is tried again.
        const bool again = std::exchange(retry_, false) || faultIsShader_;
        if (executor_.programs().rebuilds() != before || again)
            settingsChanged();
        if (broken != brokenEdit_) {
            brokenEdit_ = broken;
            uiFrames_ = std::max(uiFrames_, framesAfterEvent);
        }
    }

    /// Runs what may fail for reasons that the person can mend: the window then shows why.
    template <typename Work>
    bool guarded(Work&& work) {
        try {
            work();
            fault_.clear();
            faultIsShader_ = false;
            return true;
        } catch (const Interrupted&) {
            throw;
        } catch (const gl::ShaderError& e) {
            fault_ = e.what();
            faultIsShader_ = true;
        } catch (const Error& e) {
            fault_ = e.what();
            faultIsShader_ = false;
        } catch (const std::bad_alloc&) {
            fault_ = "not enough memory; use a smaller picture or model";
            faultIsShader_ = false;
        }
        // A pass that failed may have left anything switched on.
        for (const GLenum capability :
             {GL_SCISSOR_TEST, GL_DEPTH_TEST, GL_CULL_FACE, GL_BLEND, GL_DEPTH_CLAMP, GL_POLYGON_OFFSET_FILL})
            glDisable(capability);
        glCullFace(GL_BACK);
        glFrontFace(GL_CCW);
        glDepthFunc(GL_LESS);
        glDepthMask(GL_TRUE);
        uiFrames_ = std::max(uiFrames_, framesAfterEvent);
        return false;
    }

    /// Draws the lab's own scene very small: drivers finish programs at their first use.
    void warmUp() {
        Frame frame;
        frame.width = 16;
        frame.height = 12;
        frame.camera = lab_.defaultCamera();
        run(frame);
    }

    const gl::Texture2D& run(const Frame& frame) {
        graph::FrameGraph graph;
        const graph::Resource picture = lab_.build(graph, frame);
        graph.addOutput(picture);
        executor_.run(graph);
        return executor_.output(picture);
    }

    const gl::Texture2D& runTimed() {
        const gl::Texture2D* picture = nullptr;
        times_.add(gl::secondsOf([&] { picture = &run(state_.frame); }));
        return *picture;
    }

    void drawPicture() {
        const glm::ivec2 size = pictureSize();
        state_.frame.width = size.x;
        state_.frame.height = size.y;
        state_.frame.camera = lab_.ownCamera().value_or(camera_.camera());
        const gl::Texture2D& picture = runTimed();
        if (!shown_ || shown_->size() != size) {
            ShownPicture next;
            next.texture = gl::Texture2D("shown picture", GL_SRGB8_ALPHA8, size.x, size.y);
            const std::array<const gl::Texture2D*, 1> colors = {&next.texture};
            next.framebuffer = gl::Framebuffer("shown picture", colors, nullptr);
            shown_ = std::move(next);
        }
        const std::array<const gl::Texture2D*, 1> colors = {&picture};
        const gl::Framebuffer source("picture", colors, nullptr);
        copyPixels(source.get(), size, shown_->framebuffer.get(), size);
        shown_->state = state_;
        shown_->state.knobs = lab_.knobs().values();
        shown_->counters = lab_.counters();
        if (lab_.isConverging()) {
            stale_ = true;
            uiFrames_ = std::max(uiFrames_, 1);
        }
    }

    void compare() {
        compared_ = true;
        guarded([this] {
            Frame frame = state_.frame;
            const auto reduced = [](int side) {
                return std::max(side / comparisonReduction, std::min(side, comparisonSideAtLeast));
            };
            frame.width = reduced(frame.width);
            frame.height = reduced(frame.height);
            frame.pictureFormat = graph::Format::rgba32f;
            frame.live = false;
            Lab::ReferenceJob job = lab_.reference(frame);
            if (!job) {
                errorText_ = lab_.referenceName().empty() ? "no reference" : noReferenceText;
                map_.reset();
                return;
            }
            liveError_.start(std::move(job), gl::readPixels(run(frame)));
            errorText_ = "…";
            comparedSize_ = {frame.width, frame.height};
        });
        uiFrames_ = std::max(uiFrames_, 1);
    }

    void takeError(const LiveError::Result& result) {
        uiFrames_ = std::max(uiFrames_, framesAfterEvent);
        if (!result.failure.empty()) {
            errorText_ = result.failure;
            return;
        }
        errorText_ = fmt::format("RMSE {:.3g} at {}×{}", result.rmse, comparedSize_.x, comparedSize_.y);
        map_.emplace("error map", result.map);
        map_->setFilter(GL_NEAREST, GL_NEAREST);
    }

    void writeScreenshot() {
        screenshotWanted_ = false;
        try {
            const PictureState& state = shown_->state;
            std::filesystem::path file;
            for (int i = 1; file.empty() || std::filesystem::exists(file); ++i)
                file = options_.pictureFolder / fmt::format("{}_{:03}.png", state.lab, i);
            writeImage(file, gl::readPixels8(shown_->texture),
                       {{std::string(pictureStateKey), toJson(state)}});
            notice_ = "wrote " + file.string();
        } catch (const Interrupted&) {
            throw;
        } catch (const std::exception& e) {
            notice_ = fmt::format("no picture written: {}", e.what());
        }
        uiFrames_ = std::max(uiFrames_, framesAfterEvent);
    }

    // ---- the screen ----

    PanelText panelText() const {
        PanelText text;
        text.title = state_.lab;
        text.topic = lab_.topic();
        text.facts.emplace_back("frame", times_.text());
        text.facts.emplace_back("size", fmt::format("{}×{}", shown_->size().x, shown_->size().y));
        for (const auto& [name, count] : shown_->counters)
            text.facts.emplace_back(name, grouped(count));
        text.facts.emplace_back("error", errorText_);
        if (!lab_.referenceName().empty() && errorText_ != noReferenceText)
            text.facts.emplace_back("against", lab_.referenceName());
        text.facts.emplace_back("renderer", state_.renderer);
        text.camera =
            lab_.takesControls() ? "The camera is the lab's. W A S D or the arrows drive; H lists the keys."
            : lab_.ownCamera()   ? "The camera is the lab's."
            : camera_.mode() == CameraControl::Mode::orbit
                ? "Orbit: drag turns, right drag moves, wheel zooms. C flies."
                : fmt::format("Fly at {:.3g} a second: W A S D, E up, Q down, drag looks. C orbits.",
                              camera_.speed());
        return text;
    }

    std::string faultText() const { return fault_.empty() ? brokenEdit_ : fault_; }

    void buildUi() {
        if (styleStale_)
            restyle();
        ImGui_ImplOpenGL3_NewFrame();
        ImGui_ImplGlfw_NewFrame();
        ImGui::NewFrame();
        const float points = pointsToScreen();
        if (panelOpen_) {
            lab_.markIdleKnobs();
            const PanelActions actions = drawPanel(lab_.knobs(), panelText(), points);
            if (actions.knobsChanged)
                settingsChanged();
            if (actions.helpWanted)
                toggleHelp();
        }
        drawMessages(notice_, faultText(), panelOpen_, points);
        if (mapOpen_ && map_)
            drawInset({map_->get(), map_->width(), map_->height(),
                       "Error: black none, red, yellow, white 0.25 and more"},
                      pictureWidthScreen(), points);
        if (helpOpen_)
            drawHelp(help(), pictureWidthScreen(), points);
        ImGui::Render();
    }

    void present() {
        if (uiFrames_ > 0)
            --uiFrames_;
        const glm::ivec2 all = window_.framebufferSize();
        if (all.x < 1 || all.y < 1) {
            // Nothing to draw on while minimised; what is stale is drawn when the size comes back.
            redrawWhenRestored_ = redrawWhenRestored_ || stale_;
            stale_ = false;
            uiFrames_ = 0;
            return;
        }
        stale_ = std::exchange(redrawWhenRestored_, false) || stale_;
        buildUi();
        const glm::ivec2 size = pictureSize();
        if (size != glm::ivec2(state_.frame.width, state_.frame.height))
            settingsChanged();
        if (std::exchange(stale_, false))
            guarded([this] { drawPicture(); });
        glDisable(GL_SCISSOR_TEST);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        glViewport(0, 0, all.x, all.y);
        glClearColor(0.05f, 0.055f, 0.065f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        copyPixels(shown_->framebuffer.get(), shown_->size(), 0, size);
        glBindFramebuffer(GL_FRAMEBUFFER, 0);
        ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
        window_.swapBuffers();
    }

    /// Sleeps until there is something to do, so that a resting window costs nothing.
    void wait() {
        const bool measuring = fault_.empty() && !times_.enough();
        if (uiFrames_ > 0 || stale_ || measuring || screenshotWanted_ || held_.any() || lab_.isMoving()) {
            window_.pollEvents();
            return;
        }
        Seconds until = lastReload_ + reloadInterval - Clock::now();
        if (!compared_ && fault_.empty())
            until = std::min<Seconds>(until, lastChange_ + comparisonDelay - Clock::now());
        glfwWaitEventsTimeout(std::max(until.count(), 1e-3));
        // Nothing moved while the window slept.
        lastAdvance_ = Clock::now();
        if (ImGui::GetIO().WantTextInput)
            uiFrames_ = std::max(uiFrames_, 1);
    }

    Lab& lab_;
    WindowOptions options_;
    PictureState state_;
    gl::Window window_;
    gl::Executor executor_;
    std::optional<ImGuiSession> imgui_;
    CameraControl camera_;
    std::optional<ShownPicture> shown_;
    std::optional<gl::Texture2D> map_;
    FrameTimes times_;
    HeldKeys held_;
    std::vector<LabKey> labKeys_;

    bool stale_ = false;  ///< the picture is not what knobs and camera say
    bool redrawWhenRestored_ = false;
    int uiFrames_ = framesAfterEvent;  ///< still to be shown
    bool styleStale_ = false;
    bool panelOpen_ = true;
    bool helpOpen_ = false;
    bool mapOpen_ = false;
    bool screenshotWanted_ = false;
    bool retry_ = false;
    glm::dvec2 cursor_{0};  ///< screen coordinates
    std::optional<int> dragButton_;

    std::string fault_;
    bool faultIsShader_ = false;
    std::string brokenEdit_;
    std::string notice_;
    std::string errorText_ = "…";
    glm::ivec2 comparedSize_{0};
    bool compared_ = false;
    Clock::time_point lastChange_ = Clock::now();
    Clock::time_point lastReload_ = Clock::now();
    Clock::time_point lastAdvance_ = Clock::now();
    LiveError liveError_;
};

}  // namespace

void runWindow(Lab& lab, const LabEntry& entry, const std::function<PictureState()>& begin,
               const WindowOptions& options) {
    LabWindow(lab, entry, begin, options).loop();
}

}  // namespace quincunx
