#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "base/check.h"
#include "base/interrupt.h"
#include "gl/objects.h"
#include "gl/program.h"
#include "labs/20_post_processing/lab.h"
#include "math/projection.h"
#include "math/transform.h"

namespace quincunx {
namespace {

constexpr int width = 24;
constexpr int height = 18;

/// The steps as the question letters them.
enum Step {
    drawSpaceship,        // A
    bindGreyShader,       // B
    drawQuad,             // C
    clearTarget,          // D
    bindTextureToUnit,    // E
    bindOffScreenTarget,  // F
    bindWindowTarget,     // G
    bindFancyShader,      // H
    stepCount
};
using Order = std::array<Step, stepCount>;

/// Everything that the steps touch. What stands for the window is a target of its own, since a context
/// without a display has none.
class Stage {
  public:
    Stage()
        : offScreen_("OffScreenTexture", GL_RGBA8, width, height),
          windowTexture_("window", GL_RGBA8, width, height),
          strayTexture_("another texture", GL_RGBA8, width, height),
          strayTargetTexture_("another target's texture", GL_RGBA8, width, height),
          offScreenTarget_("off-screen target", std::array{static_cast<const gl::Texture2D*>(&offScreen_)},
                           nullptr),
          windowTarget_("window target", std::array{static_cast<const gl::Texture2D*>(&windowTexture_)},
                        nullptr),
          strayTarget_("another target", std::array{static_cast<const gl::Texture2D*>(&strayTargetTexture_)},
                       nullptr),
          fancy_({.label = "FancyShader",
                  .vertex = "labs/20_post_processing/steps.vert",
                  .fragment = "labs/20_post_processing/steps_fancy.frag"}),
          grey_({.label = "GrayScaleShader",
                 .vertex = "labs/20_post_processing/steps.vert",
                 .fragment = "labs/20_post_processing/steps_grey.frag"}),
          other_({.label = "another shader",
                  .vertex = "labs/20_post_processing/steps.vert",
                  .fragment = "labs/20_post_processing/steps_other.frag"}),
          vertexArray_("no attributes") {
        grey_.set("picture", 0);
        const gl::Framebuffer filled("another texture",
                                     std::array{static_cast<const gl::Texture2D*>(&strayTexture_)}, nullptr);
        filled.bind();
        glClearColor(0.1f, 0.7f, 0.3f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
    }

    /// Runs the steps from a start at which nothing is as it should be: both targets hold rubbish, and
    /// another target, shader and texture are bound.
    Image8 run(const Order& order) {
        offScreenTarget_.bind();
        glClearColor(0.9f, 0.2f, 0.6f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        windowTarget_.bind();
        glClearColor(0.2f, 0.9f, 0.1f, 1);
        glClear(GL_COLOR_BUFFER_BIT);
        strayTarget_.bind();
        other_.use();
        strayTexture_.bind(0);
        vertexArray_.bind();
        glClearColor(0, 0, 0, 1);
        for (const Step step : order)
            take(step);
        return gl::readPixels8(windowTexture_);
    }

  private:
    void take(Step step) {
        switch (step) {
            case drawSpaceship:
                glDrawArrays(GL_TRIANGLES, 0, 9);
                return;
            case bindGreyShader:
                grey_.use();
                return;
            case drawQuad:
                glDrawArrays(GL_TRIANGLES, 9, 3);
                return;
            case clearTarget:
                glClear(GL_COLOR_BUFFER_BIT);
                return;
            case bindTextureToUnit:
                offScreen_.bind(0);
                return;
            case bindOffScreenTarget:
                offScreenTarget_.bind();
                return;
            case bindWindowTarget:
                windowTarget_.bind();
                return;
            case bindFancyShader:
                fancy_.use();
                return;
            case stepCount:
                break;
        }
        QX_CHECK(false && "a step");
    }

    gl::Texture2D offScreen_;
    gl::Texture2D windowTexture_;
    gl::Texture2D strayTexture_;
    gl::Texture2D strayTargetTexture_;
    gl::Framebuffer offScreenTarget_;
    gl::Framebuffer windowTarget_;
    gl::Framebuffer strayTarget_;
    gl::Program fancy_;
    gl::Program grey_;
    gl::Program other_;
    gl::VertexArray vertexArray_;
};

/// ((F → D) / H) → A → (G / E / B) → C, where / leaves the order open.
bool cardAllows(const Order& order) {
    std::array<int, stepCount> at{};
    for (int i = 0; i < stepCount; ++i)
        at[order[static_cast<std::size_t>(i)]] = i;
    const auto before = [&](Step a, Step b) { return at[a] < at[b]; };
    return before(bindOffScreenTarget, clearTarget) && before(clearTarget, drawSpaceship) &&
           before(bindFancyShader, drawSpaceship) && before(drawSpaceship, bindWindowTarget) &&
           before(drawSpaceship, bindTextureToUnit) && before(drawSpaceship, bindGreyShader) &&
           before(bindWindowTarget, drawQuad) && before(bindTextureToUnit, drawQuad) &&
           before(bindGreyShader, drawQuad);
}

}  // namespace

StepOrders runAllOrders(gl::Context& context) {
    context.makeCurrent();
    Stage stage;
    const Image8 wanted = stage.run({bindOffScreenTarget, clearTarget, bindFancyShader, drawSpaceship,
                                     bindWindowTarget, bindTextureToUnit, bindGreyShader, drawQuad});
    StepOrders orders;
    Order order{};
    for (int i = 0; i < stepCount; ++i)
        order[static_cast<std::size_t>(i)] = static_cast<Step>(i);
    do {
        if (orders.tried % 1024 == 0)
            throwIfInterrupted();
        ++orders.tried;
        const bool right = stage.run(order) == wanted;
        const bool allowed = cardAllows(order);
        const auto texture = std::find(order.begin(), order.end(), bindTextureToUnit);
        const auto ship = std::find(order.begin(), order.end(), drawSpaceship);
        orders.right += right;
        orders.cards += allowed;
        orders.rightOfCards += right && allowed;
        orders.rightWithEarlyBind += right && texture < ship;
    } while (std::next_permutation(order.begin(), order.end()));
    return orders;
}

}  // namespace quincunx
