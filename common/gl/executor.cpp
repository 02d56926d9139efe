#include "gl/executor.h"

#include <algorithm>
#include <exception>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "gl/calls.h"

namespace quincunx::gl {
namespace {

/// For so many frames a target may lie idle, so that graphs which alternate keep theirs.
constexpr std::uint64_t idleFrames = 8;

class RunningPass final : public graph::PassContext {
  public:
    RunningPass(const graph::PassDescription& pass, const std::vector<const Texture2D*>& textures,
                ProgramCache& programs, std::map<Sampler::Params, Sampler>& samplers,
                const VertexArray& noAttributes)
        : pass_(pass),
          textures_(textures),
          programs_(programs),
          samplers_(samplers),
          noAttributes_(noAttributes) {}

    const Texture2D& texture(graph::Resource resource) const override {
        const auto in = [&](const std::vector<graph::Resource>& list) {
            return std::find(list.begin(), list.end(), resource) != list.end();
        };
        QX_CHECK(in(pass_.reads) || in(pass_.writes));
        return *textures_[resource.index];
    }

    ProgramCache& programs() override { return programs_; }

    const Sampler& sampler(const Sampler::Params& params) override {
        const auto known = samplers_.find(params);
        return known != samplers_.end() ? known->second
                                        : samplers_.emplace(params, Sampler("sampler", params)).first->second;
    }

    void drawFullscreen() override {
        noAttributes_.bind();
        glDrawArrays(GL_TRIANGLES, 0, 3);
    }

  private:
    const graph::PassDescription& pass_;
    const std::vector<const Texture2D*>& textures_;
    ProgramCache& programs_;
    std::map<Sampler::Params, Sampler>& samplers_;
    const VertexArray& noAttributes_;
};

/// Rethrows the exception being handled with the pass' name.
[[noreturn]] void rethrowNaming(const graph::PassDescription& pass) {
    const std::string where = fmt::format("pass \"{}\"", pass.name);
    try {
        throw;
    } catch (const GlError& error) {
        throw GlError(error.what(), where);
    } catch (const ShaderError& error) {
        throw ShaderError(error.what(), where);
    } catch (const EnvironmentError& error) {
        throw EnvironmentError(error.what(), where);
    } catch (const InputError& error) {
        throw InputError(error.what(), where);
    }
}

}  // namespace

GLenum internalFormat(graph::Format format) {
    switch (format) {
        case graph::Format::rgba8Srgb:
            return GL_SRGB8_ALPHA8;
        case graph::Format::rgba8:
            return GL_RGBA8;
        case graph::Format::rgba16f:
            return GL_RGBA16F;
        case graph::Format::rgba32f:
            return GL_RGBA32F;
        case graph::Format::rg16f:
            return GL_RG16F;
        case graph::Format::r32f:
            return GL_R32F;
        case graph::Format::depth24:
            return GL_DEPTH_COMPONENT24;
        case graph::Format::depth32f:
            return GL_DEPTH_COMPONENT32F;
        case graph::Format::depth24Stencil8:
            return GL_DEPTH24_STENCIL8;
    }
    QX_CHECK(false && "a format of graph::Format");
    return GL_NONE;
}

void Executor::run(const graph::FrameGraph& graph) {
    run(graph, nullptr);
}

std::vector<Executor::PassCost> Executor::runMeasured(const graph::FrameGraph& graph) {
    std::vector<PassCost> costs;
    run(graph, &costs);
    return costs;
}

void Executor::run(const graph::FrameGraph& graph, std::vector<PassCost>* costs) {
    const graph::Plan plan = graph.compile();
    ++frame_;
    byResource_.assign(graph.resourceCount(), nullptr);
    isOutput_.assign(graph.resourceCount(), false);
    std::vector<const Texture2D*> bySlot(plan.slotCount, nullptr);
    for (std::size_t r = 0; r < graph.resourceCount(); ++r) {
        if (!plan.lifetimes[r].used)
            continue;
        const Texture2D*& target = bySlot[plan.lifetimes[r].slot];
        if (target == nullptr)
            target = &takeTarget(graph.resource({r}));
        byResource_[r] = target;
        isOutput_[r] = graph.isOutput({r});
    }
    glEnable(GL_FRAMEBUFFER_SRGB);
    for (const graph::Pass handle : plan.order) {
        const graph::PassDescription& pass = graph.pass(handle);
        RunningPass context(pass, byResource_, programs_, samplers_, noAttributes_);
        const auto execute = [&] {
            framebufferFor(graph, pass).bind();
            if (!pass.execute)
                throw InputError("has nothing to execute");
            pass.execute(context);
        };
        try {
            if (costs == nullptr) {
                execute();
                continue;
            }
            PassCost cost{.pass = pass.name};
            cost.seconds = secondsOf([&] {
                const std::uint64_t before = callCount();
                execute();
                cost.glCalls = callCount() - before;
            });
            costs->push_back(std::move(cost));
        } catch (const Error&) {
            rethrowNaming(pass);
        }
    }
    dropUnusedTargets();
}

const Texture2D& Executor::output(graph::Resource resource) const {
    QX_CHECK_LT(resource.index, byResource_.size());
    QX_CHECK(isOutput_[resource.index]);
    return *byResource_[resource.index];
}

std::size_t Executor::targetBytes() const {
    std::size_t bytes = 0;
    for (const Target& target : pool_)
        bytes += target.bytes;
    return bytes;
}

const Texture2D& Executor::takeTarget(const graph::ResourceDescription& resource) {
    const GLenum format = internalFormat(resource.format);
    for (Target& target : pool_) {
        const Texture2D& texture = target.texture;
        if (target.lastFrame != frame_ && texture.internalFormat() == format &&
            texture.width() == resource.width && texture.height() == resource.height) {
            target.lastFrame = frame_;
            return texture;
        }
    }
    Texture2D texture(resource.name, format, resource.width, resource.height);
    const std::size_t bytes = static_cast<std::size_t>(resource.width) *
                              static_cast<std::size_t>(resource.height) *
                              graph::bytesPerTexel(resource.format);
    pool_.push_back({std::move(texture), bytes, frame_});
    return pool_.back().texture;
}

const Framebuffer& Executor::framebufferFor(const graph::FrameGraph& graph,
                                            const graph::PassDescription& pass) {
    std::vector<const Texture2D*> colors;
    const Texture2D* depth = nullptr;
    std::vector<GLuint> names;
    for (const graph::Resource resource : pass.writes) {
        const Texture2D* texture = byResource_[resource.index];
        if (graph::hasDepth(graph.resource(resource).format)) {
            depth = texture;
        } else {
            colors.push_back(texture);
            names.push_back(texture->get());
        }
    }
    names.push_back(depth == nullptr ? 0 : depth->get());
    const auto known = framebuffers_.find(names);
    if (known != framebuffers_.end())
        return known->second;
    return framebuffers_.emplace(std::move(names), Framebuffer(pass.name, colors, depth)).first->second;
}

void Executor::dropUnusedTargets() {
    const auto isOld = [&](const Target& target) { return target.lastFrame + idleFrames < frame_; };
    for (const Target& target : pool_)
        if (isOld(target))
            std::erase_if(framebuffers_, [name = target.texture.get()](const auto& entry) {
                return std::find(entry.first.begin(), entry.first.end(), name) != entry.first.end();
            });
    pool_.remove_if(isOld);
}

}  // namespace quincunx::gl
