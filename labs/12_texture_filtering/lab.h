#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "gl/objects.h"
#include "image/patterns.h"
#include "image/texture_unit.h"
#include "lab/lab.h"
#include "labs/12_texture_filtering/floor.h"
#include "passes/labels.h"
#include "passes/lines.h"

namespace quincunx {

/// Textures made smaller and larger: what each filter reads, what it costs and how far it is from the truth;
/// the driver's texture unit beside one on the CPU.
class TextureFilteringLab final : public Lab {
  public:
    enum class View { floor, photo, quad, footprint, pyramid };
    enum class Pattern { bricks, checker, zonePlate, wood, noise, file };
    enum class Photo { stillLife, waves, edge, file };
    enum class Unit { opengl, cpu, difference };
    /// The first ones of Minification that the knob offers, in its order.
    enum class Filter { nearest, bilinear, mipmapped, trilinear, anisotropic, driver };
    enum class Mipmaps { box, kaiser, lanczos, codes, driver };
    enum class Storage { rgba8, bc1, bc4, bc7 };

    TextureFilteringLab();

    std::string topic() const override { return "texture filters: minification, magnification, mipmaps"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override;
    Bounds sceneBounds() const override;
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override {
        return "the mean of 256 samples a pixel; of the waves, their formula";
    }
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    /// "texels read" by the filters of floor and photo in OpenGL, as the specification has it; nothing where
    /// they are not known, as of the driver's own anisotropic filter.
    std::map<std::string, std::uint64_t> counters() const override;

    ChoiceKnob view{knobs(),
                    "view",
                    {"floor", "photo", "quad", "footprint", "pyramid"},
                    0,
                    "A receding floor, a magnified picture, a repeated checker, a pixel seen on the texture, "
                    "or the mipmaps"};
    BoolKnob compare{knobs(), "compare", true, "Several filters side by side (floor and photo)"};
    ChoiceKnob pattern{knobs(),
                       "pattern",
                       {"bricks", "checker", "zone-plate", "wood", "noise", "file"},
                       0,
                       "The floor's texture"};
    ChoiceKnob photo{
        knobs(),
        "photo",
        {"still-life", "waves", "edge", "file"},
        0,
        "What is magnified: a rendered picture, a sum of waves that is known everywhere, a step"};
    TextKnob file{knobs(), "file", "", "a picture's file name", "The picture where `file` is chosen"};
    ChoiceKnob minification{knobs(),
                            "minification",
                            {"nearest", "bilinear", "mipmapped", "trilinear", "anisotropic", "driver"},
                            4,
                            "How the floor is filtered; the last is the driver's own anisotropic filter"};
    IntKnob maxAnisotropy{knobs(), "max-anisotropy",
                          16,      {1, 16, true},
                          "",      "Most probes of the anisotropic filters along the footprint"};
    ChoiceKnob magnification{knobs(),
                             "magnification",
                             {"nearest", "tent", "mitchell", "lanczos", "sinc"},
                             1,
                             "How texels larger than pixels are filtered; the floor has the first two"};
    IntKnob lobes{knobs(), "lobes", 3, {1, 16}, "a side", "How wide the Lanczos filter is"};
    ChoiceKnob mipmaps{
        knobs(),
        "mipmaps",
        {"box", "kaiser", "lanczos", "codes", "driver"},
        0,
        "How levels are made: by us in linear light, from codes as if they were light, by OpenGL"};
    ChoiceKnob wrap{knobs(),
                    "wrap",
                    {"repeat", "mirrored", "edge", "border"},
                    0,
                    "What is found beyond the texture's edges"};
    ChoiceKnob storage{knobs(),
                       "storage",
                       {"rgba8", "bc1", "bc4", "bc7"},
                       0,
                       "How the device keeps the texture: bytes, or blocks of 4×4 texels (bc4: grey)"};
    FloatKnob lodBias{knobs(), "lod-bias", 0, {-4, 4}, "levels", "Coarser (above 0) or finer mipmaps"};
    IntKnob textureSize{knobs(),         "texture-size", 256,
                        {1, 4096, true}, "texels",       "Side of the textures that are made by code"};
    FloatKnob repeats{knobs(),           "repeats", 0.5f,
                      {0.01f, 16, true}, "times",   "The texture on a unit of the floor"};
    FloatKnob zoom{knobs(),       "zoom",  6,
                   {1, 64, true}, "times", "How much of the photo's height fills the picture"};
    FloatKnob centreS{knobs(), "centre-s", 0.42f, {0, 1}, "", "Where on the photo"};
    FloatKnob centreT{knobs(), "centre-t", 0.36f, {0, 1}, "", "Where on the photo, from the top"};
    FloatKnob quadU{knobs(), "quad-u", 2, {-8, 8}, "", "u at the quad's right corners"};
    FloatKnob quadV{knobs(), "quad-v", 4, {-8, 8}, "", "v at the quad's upper corners"};
    FloatKnob probeX{knobs(), "probe-x", 0.36f, {0, 1}, "of the width", "The pixel whose footprint is shown"};
    FloatKnob probeY{knobs(), "probe-y", 0.56f, {0, 1}, "of the height", "… from the bottom"};
    ChoiceKnob unit{knobs(),
                    "unit",
                    {"opengl", "cpu", "difference"},
                    0,
                    "Who filters: the driver, our texture unit, or the difference of the two"};

    /// The texture of the view as the CPU's unit reads it, and how it samples. What only the driver can make
    /// (mipmaps, BC7) is here once a frame was drawn.
    const MipTexture& texture() const;
    SamplerSettings sampler() const;
    /// Where the photo is seen, in a picture of this aspect.
    TextureWindow photoWindow(double aspect) const;
    FloorView floorView(const Camera& camera, int width, int height) const;
    const WavePicture& waves() const { return waves_; }
    /// Where the view "quad" shows the quad, in pixels from the bottom left; a multiple of 8 by one of 16.
    struct QuadLayout {
        int left = 0;
        int bottom = 0;
        int width = 8;
        int height = 16;
        int squareLeft = 0;  ///< of the texture beside it, half as wide as the quad
    };
    QuadLayout quadLayout(const Frame& frame) const;
    /// The texture on the device; a frame has been drawn.
    const gl::Texture2D& deviceTexture() const { return *device_; }

  private:
    struct Panel {
        int left = 0;
        int width = 1;
        std::string name = {};
        Filter filter = Filter::nearest;
        Magnification kernel = Magnification::nearest;
    };
    /// What the texture is made from; another one means another texture.
    struct Recipe {
        bool photo = false;
        int kind = 0;
        int size = 0;
        std::string file;
        int mipmaps = 0;
        int storage = 0;
        bool operator==(const Recipe&) const = default;
    };

    bool usesPhoto() const { return view.as<View>() == View::photo; }
    Recipe recipe() const;
    Image8 makeBase(const Recipe& recipe) const;
    /// Makes the texture for the knobs, on the CPU.
    void prepareTexture() const;
    /// … and on the device; a context is current.
    void uploadTexture();
    std::vector<Panel> panels(const Frame& frame) const;
    gl::Sampler::Params samplerParams(Filter filter) const;
    SamplerSettings settingsOf(Filter filter) const;

    graph::Resource buildFloor(graph::FrameGraph& graph, const Frame& frame);
    graph::Resource buildPhoto(graph::FrameGraph& graph, const Frame& frame);
    graph::Resource buildDiagram(graph::FrameGraph& graph, const Frame& frame);
    graph::Resource addShown(graph::FrameGraph& graph, const Frame& frame,
                             std::optional<graph::Resource> drawn);
    void drawFloorPanel(graph::PassContext& context, const Frame& frame, const Panel& panel, Filter filter);
    void drawWindow(graph::PassContext& context, glm::vec4 rectangle, const TextureWindow& window,
                    float level, const gl::Sampler::Params& sampler, float dim = 1);
    void drawQuad(graph::PassContext& context, const Frame& frame);
    void drawFootprint(graph::PassContext& context, const Frame& frame);
    void drawPyramid(graph::PassContext& context, const Frame& frame);
    void drawTitles(graph::PassContext& context, const Frame& frame, const std::vector<Panel>& panels);
    Image cpuPicture(const Frame& frame) const;
    std::uint64_t countTexels(const Frame& frame) const;
    float textSize(const Frame& frame) const;

    WavePicture waves_;
    mutable Image8 stillLife_;  ///< made when first needed
    mutable std::optional<Recipe> made_;
    mutable MipTexture texture_;
    mutable std::vector<Image8> levels_;
    mutable std::vector<Image> floatLevels_;
    std::optional<Recipe> uploaded_;
    std::optional<gl::Texture2D> device_;
    std::optional<gl::Texture2D> cpuTexture_;
    Lines lines_;
    Labels labels_;
    std::optional<Frame> drawn_;                   ///< the last frame
    mutable std::optional<std::uint64_t> texels_;  ///< that it reads, once counted
};

}  // namespace quincunx
