#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "lab/lab.h"
#include "labs/10_shading/shading_pass.h"
#include "passes/scene_buffers.h"
#include "scene/still_life.h"
#include "trace/reference.h"

namespace quincunx {

/// Flat, Gouraud and Phong shading, with Phong's and Blinn's reflection model: where the light is evaluated
/// decides what it costs and how wrong it is.
class ShadingLab final : public Lab {
  public:
    /// The first three are those of ShadingModel.
    enum class Shading { flat, gouraud, phong, compare };
    enum class Normals { cofactor, inverseTranspose, model };

    ShadingLab();

    std::string topic() const override { return "flat, Gouraud and Phong shading; reflection models"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void useScene(Scene scene) override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override {
        return builtIn_ ? "rays traced to the exact surfaces, shaded in double"
                        : "rays traced to the triangles, shaded in double at every pixel";
    }
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob shading{knobs(),
                       "shading",
                       {"flat", "gouraud", "phong", "compare"},
                       2,
                       "Where light is evaluated: triangle, vertex, pixel, or all three side by side"};
    ChoiceKnob reflection{knobs(),
                          "reflection",
                          {"phong", "blinn-phong"},
                          1,
                          "The highlight: by the mirrored light or by the half vector"};
    IntKnob tessellation{knobs(),    "tessellation",
                         48,         {3, 2048, true},
                         "segments", "Triangles around each solid of the built-in scene"};
    BoolKnob ambient{knobs(), "ambient", true, "Add the ambient term"};
    BoolKnob diffuse{knobs(), "diffuse", true, "Add the diffuse term"};
    BoolKnob specular{knobs(), "specular", true, "Add the specular term"};
    BoolKnob emission{knobs(), "emission", true, "Add the emission term"};
    FloatKnob shininessScale{knobs(), "shininess-scale",
                             1,       {0, 1000, true},
                             "times", "Sharper (above 1) or wider (below 1) highlights"};
    FloatKnob lightTurn{knobs(),     "light-turn", 0,
                        {-180, 180}, "degrees",    "Carries the lights about the upright axis"};
    FloatKnob shear{knobs(), "shear", 0, {-2, 2}, "times the height", "Slants the scene sideways"};
    BoolKnob mirror{knobs(), "mirror", false, "Mirrors the scene left to right"};
    ChoiceKnob normals{knobs(),
                       "normals",
                       {"cofactor", "inverse-transpose", "model"},
                       0,
                       "The matrix that carries the normals; under shear the model matrix is wrong"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Samples along a side of a pixel, averaged"};

    const StillLife& stillLife() const { return stillLife_; }

  private:
    /// The scene's placement in the world after the shear and mirror knobs.
    glm::mat4 worldFromScene() const;
    PhongModel model() const;
    /// Makes what is drawn as the knobs say, to be traced: solids, or the triangles of an imported model.
    std::function<TraceScene()> exactScene() const;
    void prepareScene();
    std::optional<SceneBuffers>& buffersFor(ShadingModel model);
    std::vector<ObjectBlock> objectBlocks() const;
    std::vector<Light> turnedLights() const;
    void drawScene(graph::PassContext& context, const Frame& frame, int factor);

    StillLife stillLife_;
    bool builtIn_ = true;
    int builtTessellation_ = 0;
    std::shared_ptr<const Scene> scene_;
    std::optional<SceneBuffers> shared_;
    std::optional<SceneBuffers> facets_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx
