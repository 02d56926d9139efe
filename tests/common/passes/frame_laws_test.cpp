// The two laws of planned frames, and what the table says of scenes that are known.

#include <cmath>
#include <memory>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "geometry/shapes.h"
#include "gl/calls.h"
#include "gl/context.h"
#include "gl/executor.h"
#include "math/transform.h"
#include "passes/frame_renderer.h"
#include "scene/colonnade.h"
#include "scene/finish.h"
#include "scene/import.h"
#include "scene/spaceship.h"
#include "scene/town.h"

namespace quincunx {
namespace {

EffectSet allEffects() {
    EffectSet all;
    for (std::size_t i = 0; i < effects().size(); ++i)
        all.set(i);
    return all;
}

class FrameLaws : public testing::Test {
  protected:
    FrameLaws() : context_(gl::createOffscreenContext(gl::Backend::automatic)) {}

    Image drawn(const FrameView& view) {
        graph::FrameGraph graph;
        const graph::Resource picture = renderer_.build(graph, view);
        graph.addOutput(picture);
        executor_.run(graph);
        return gl::readPixels(executor_.output(picture));
    }

    /// Law 1 for that view, in eight bits and in float.
    void expectForcingChangesNothing(FrameView view, const std::string& what) {
        for (const graph::Format format : {graph::Format::rgba8Srgb, graph::Format::rgba32f}) {
            view.pictureFormat = format;
            view.settings.forced = {};
            const Image planned = drawn(view);
            view.settings.forced = allEffects();
            const Image forced = drawn(view);
            for (const PlannedEffect& effect : renderer_.plan().effects)
                ASSERT_TRUE(effect.added) << effect.name;
            ASSERT_EQ(planned, forced) << what;
        }
    }

    std::unique_ptr<gl::Context> context_;
    gl::Executor executor_;
    FrameRenderer renderer_;
};

Camera cameraFor(const Scene& scene, float aspect) {
    return scene.cameras.empty() ? frameBounds(scene.bounds(), aspect) : scene.cameras.front();
}

TEST_F(FrameLaws, ForcingEveryEffectChangesNoBitOfTheBuiltInScenes) {
    const std::pair<const char*, Scene> scenes[] = {{"still life", tessellate(makeStillLife(), 24)},
                                                    {"colonnade", tessellate(makeColonnade(), 24)},
                                                    {"spaceship", makeSpaceship(16)},
                                                    {"town", makeTown().scene}};
    for (const auto& [name, scene] : scenes) {
        renderer_.reset();
        FrameView view{.scene = scene, .camera = cameraFor(scene, 1.5f), .width = 96, .height = 64};
        expectForcingChangesNothing(view, name);
        view.settings.toneCurve = ToneCurve::filmic;
        view.settings.fxaa = true;
        view.settings.bloomStrength = 0.4f;
        expectForcingChangesNothing(view, name);
    }
}

}  // namespace
}  // namespace quincunx
