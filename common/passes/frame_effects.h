#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "graph/graph.h"
#include "passes/frame_device.h"
#include "passes/frame_shadows.h"
#include "passes/frame_visibility.h"

/// The table of effects: what each is, when a frame calls for it and why, and what it adds to the frame.
///
/// Two laws hold for every row (FrameLaws.*): forcing it on where nothing calls for it changes no bit of the
/// picture; and where it is not called for it makes no GL call, takes no memory, and compiles no program.
namespace quincunx {

/// A frame while it is put together. An effect adds passes, replaces `picture` by what it made of it, or
/// changes how the scene is shaded.
struct FrameBuilder {
    graph::FrameGraph& graph;
    const FrameView& view;
    const Visibility& visibility;
    FrameDevice& device;

    /// The picture so far, once the scene is shaded: linear light, unbounded until the tone map.
    graph::Resource picture = {};
    graph::Resource depth = {};  ///< of the shaded scene
    /// Where the last effect of the frame may write, instead of a resource of its own.
    graph::Resource target = {};
    bool isLast = false;  ///< no effect follows

    struct ShadowMapUse {
        std::shared_ptr<const ShadowAtlas> atlas;
        graph::Resource map;
    };
    std::vector<ShadowMapUse> shadowMaps = {};
    std::optional<graph::Resource> environment = {};
    bool sortsBlended = false;

    /// A resource of the picture's size in linear float light.
    graph::Resource addPicture(const std::string& name);
    /// Where this effect writes: `target` if it is the last, else a resource of that name.
    graph::Resource destination(const std::string& name);
};

struct Effect {
    /// When an effect's passes are added: before the scene is shaded, as part of it, or after.
    enum class Stage { before, shading, after };
    std::string_view name;
    Stage stage;
    /// Whether a frame calls for it. `why`, if not null, gets a sentence for that, with names and numbers.
    bool (*calledFor)(const Visibility&, const FrameView&, std::string* why);
    void (*addTo)(FrameBuilder&);
};

/// All rows, in the order in which they are added to a frame.
std::span<const Effect> effects();
/// The row of that name; InputError listing the names there are.
std::size_t findEffect(std::string_view name);

}  // namespace quincunx
