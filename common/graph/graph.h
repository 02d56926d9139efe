#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

/// The frame graph: a frame's passes and the images between them as plain data. It knows no GL; gl/executor.h
/// runs it. A pass that nobody reads from is dropped, and with it the memory of what only it wrote.
namespace quincunx::graph {

/// What a texel of a resource holds.
enum class Format { rgba8Srgb, rgba8, rgba16f, rgba32f, rg16f, r32f, depth24, depth32f, depth24Stencil8 };
bool hasDepth(Format format);
std::size_t bytesPerTexel(Format format);

/// Typed handles: indices that cannot be mixed up.
struct Resource {
    std::size_t index = 0;
    bool operator==(const Resource&) const = default;
};
struct Pass {
    std::size_t index = 0;
    bool operator==(const Pass&) const = default;
};

struct ResourceDescription {
    std::string name = {};
    Format format = Format::rgba8;
    int width = 0;   ///< texels, ≥ 1
    int height = 0;  ///< texels, ≥ 1
};

/// What a running pass can ask for; the GL back end derives from it.
class PassContext;

struct PassDescription {
    std::string name = {};
    std::vector<Resource> reads = {};
    std::vector<Resource> writes =
        {};  ///< colour targets in order of attachment, and at most one depth target
    std::function<void(PassContext&)> execute = {};
};

/// What will run, in order, and how long each resource lives.
struct Plan {
    struct Lifetime {
        std::size_t first = 0;  ///< position in `order` of the first pass that uses it
        std::size_t last = 0;   ///< … and of the last
        std::size_t slot = 0;   ///< resources with the same slot share one target
        bool used = false;
    };
    std::vector<Pass> order;
    std::vector<Lifetime> lifetimes;  ///< by resource
    std::size_t slotCount = 0;
};

class FrameGraph {
  public:
    /// Throws InputError for an empty name, one that another resource has, or a size below 1×1.
    Resource addResource(ResourceDescription description);
    /// Errors (bad handles, two depth targets, targets of different sizes, a resource both read and written)
    /// throw InputError naming the pass. A pass without writes is never needed.
    Pass addPass(PassDescription description);
    /// Marks a resource as wanted outside: it and what leads to it will run. It never shares its target.
    void addOutput(Resource resource);

    /// Orders the passes (each after those whose results it reads; ties in the order of adding), drops the
    /// unneeded, assigns targets. Throws InputError naming pass and resource for a cycle, for a resource
    /// written twice, and for one that is read or an output but never written.
    Plan compile() const;

    const ResourceDescription& resource(Resource handle) const;
    const PassDescription& pass(Pass handle) const;
    std::size_t resourceCount() const { return resources_.size(); }
    std::size_t passCount() const { return passes_.size(); }
    bool isOutput(Resource handle) const;
    /// The resource of that name; throws InputError listing the names there are.
    Resource find(std::string_view name) const;

    /// One line a pass: "shade: reads (shadow map) writes (picture, depth)"; dropped passes are marked.
    std::string describe() const;
    /// The same for Graphviz.
    std::string graphviz() const;

  private:
    std::vector<ResourceDescription> resources_;
    std::vector<PassDescription> passes_;
    std::vector<bool> isOutput_;  ///< by resource
    std::map<std::string, std::size_t, std::less<>> resourceByName_;
};

}  // namespace quincunx::graph
