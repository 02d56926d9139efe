#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>

#include "lab/lab.h"
#include "passes/environment_map.h"
#include "passes/targets.h"
#include "scene/mirror_hall.h"
#include "trace/mirror.h"

namespace quincunx {

/// Environment maps: a ball and a plane that reflect a hall by its image on a cube, held against traced
/// reflections.
class EnvironmentMappingLab final : public Lab {
  public:
    enum class View { picture, traced, error, vectors, faces };
    enum class Source { rendered, still, panorama };
    enum class Reflector { ball, plane, both };

    EnvironmentMappingLab();

    std::string topic() const override { return "environment maps: cube maps, roughness, box projection"; }
    graph::Resource build(graph::FrameGraph& graph, const Frame& frame) override;
    void markIdleKnobs() override;
    Camera defaultCamera() const override { return hall_.contents.camera; }
    Bounds sceneBounds() const override;
    ReferenceJob reference(const Frame& frame) const override;
    std::string referenceName() const override {
        return "rays traced to the exact mirrors and on to what they reflect, in double";
    }
    std::vector<Question> questions() override;
    Exercise exercise() const override;
    std::vector<Sweep> sweeps() override;
    std::vector<HardCase> hardCases() override;
    std::map<std::string, std::uint64_t> counters() const override { return counters_; }

    ChoiceKnob view{knobs(),
                    "view",
                    {"picture", "traced", "error", "vectors", "faces"},
                    0,
                    "The picture, the traced one, how far they differ, reflection vectors, the map itself"};
    ChoiceKnob reflector{
        knobs(), "reflector", {"ball", "plane", "both"}, 2, "What reflects: a ball, a plane, or both"};
    ChoiceKnob source{knobs(),
                      "map",
                      {"rendered", "still", "panorama"},
                      0,
                      "Six views drawn each frame, the same drawn once, or a panorama"};
    TextKnob panorama{knobs(), "panorama", "", "a picture file, or nothing for the traced hall",
                      "What --map=panorama shows: an equirectangular picture (HDR, EXR, PNG, JPEG)"};
    IntKnob resolution{knobs(),         "resolution",    512,
                       {1, 2048, true}, "texels a side", "Of each of the map's six faces"};
    FloatKnob roughness{knobs(), "roughness", 0, {0, 1}, "", "0 is a mirror, 1 is dull"};
    IntKnob samples{knobs(),         "samples",    64,
                    {4, 4096, true}, "directions", "That each texel of the rough levels is averaged from"};
    BoolKnob filtered{knobs(), "filtered-samples", true,
                      "Wide samples read coarse texels, not the finest ones"};
    BoolKnob boxProjection{knobs(), "box-projection", false,
                           "Look up where the reflected ray meets the hall's walls"};
    BoolKnob seamless{knobs(), "seamless", true, "Blend texels across the edges of the cube's faces"};
    FloatKnob distance{knobs(),       "distance", 1,
                       {1, 64, true}, "times",    "How far away the hall and all in it is from the mirrors"};
    FloatKnob turn{knobs(), "turn", 0, {-180, 180}, "degrees", "Carries the solids about the ball"};
    BoolKnob solids{knobs(), "solids", true,
                    "The hall's solids; without them its walls are all that is seen"};
    IntKnob tessellation{knobs(),    "tessellation",
                         48,         {3, 512, true},
                         "segments", "Triangles around each solid; the mirror has four times as many"};
    IntKnob supersample{knobs(), "supersample", 2,
                        {1, 4},  "per side",    "Samples along a side of a pixel, averaged"};

    /// The hall as the knobs have it.
    MirrorHall currentHall() const;
    MirrorsSeen mirrors() const;
    /// Where the map is taken: in the ball's centre, or, for the plane alone, above its middle.
    glm::vec3 mapPosition() const;
    EnvironmentParams environmentParams() const;
    const EnvironmentMap& map() const { return map_; }

  private:
    void prepareScene();
    void makeMap(graph::PassContext& context);
    void drawPicture(graph::PassContext& context, const Frame& frame);
    void showTraced(graph::PassContext& context, const Frame& frame, const gl::Texture2D* drawn);
    std::string key(const std::string& what) const;

    MirrorHall hall_;
    std::string builtScene_;  ///< the knobs that the scene was made for
    std::unique_ptr<ForwardScene> scene_;
    std::unique_ptr<ForwardScene> mirrorScene_;
    EnvironmentMap map_;
    std::string builtMap_;  ///< the knobs that a map that stays was made for; empty: none stays
    Image panoramaImage_;
    std::string loadedPanorama_;
    gl::Texture2D tracedTexture_;
    Frame tracedFrame_;
    std::string tracedKnobs_;
    std::map<std::string, std::uint64_t> counters_;
};

}  // namespace quincunx
