#include "passes/environment_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "gl/upload.h"
#include "image/color.h"
#include "math/projection.h"
#include "math/transform.h"
#include "passes/fullscreen.h"
#include "trace/environment_glsl.h"

namespace quincunx {
namespace {

constexpr int faceCount = gl::TextureCube::faceCount;
constexpr int irradianceSize = 16;       // texels along an edge of a face
constexpr int irradianceSourceSize = 8;  // … and of the level that is summed up
constexpr int brdfSize = 32;
constexpr int brdfSamples = 128;
constexpr float mostLight = 65504;  // the largest half float

/// Uniform block of shaders/lib/environment.glsl, std140.
struct EnvironmentBlock {
    glm::vec4 boxMin{0};
    glm::vec4 boxMax{0};
    glm::vec4 position{0};
};

glm::mat4 worldFromFace(glm::vec3 position, int face) {
    const glm::mat3 axes = glsl::cubeFaceAxes(face);
    return {glm::vec4(axes[0], 0), glm::vec4(axes[1], 0), glm::vec4(-axes[2], 0), glm::vec4(position, 1)};
}

/// A full-screen program with a sampler that reads the unit of the radiance.
const gl::Program& programReading(graph::PassContext& context, const char* name, const char* sampler) {
    gl::ProgramFiles files = fullscreenProgram(name);
    files.samplers = {{sampler, EnvironmentMap::radianceUnit}};
    return context.programs().get(files);
}

/// The first level with at most so many texels along an edge.
int levelOfSize(const gl::TextureCube& cube, int size) {
    int level = 0;
    while (cube.sizeOf(level) > size)
        ++level;
    return level;
}

/// Light that every format holds.
float usable(float light) {
    return light > 0 ? std::min(light, mostLight) : 0.0f;
}

Image usablePanorama(const Image& panorama) {
    if (panorama.pixelCount() == 0)
        throw InputError("has no pixels", "panorama", "give a picture twice as wide as high");
    const Image linear = toLinear(panorama);
    const bool grey = linear.channels < 3;
    Image result(linear.width, linear.height, 4, Encoding::linear);
    for (int y = 0; y < linear.height; ++y)
        for (int x = 0; x < linear.width; ++x) {
            for (int c = 0; c < 3; ++c)
                result.pixel(x, y)[c] = usable(linear.pixel(x, y)[grey ? 0 : c]);
            result.pixel(x, y)[3] = 1;
        }
    return result;
}

double smithLambda(double cosine, double alpha) {
    const double tangent2 = (1 - cosine * cosine) / (cosine * cosine);
    return 0.5 * (std::sqrt(1 + alpha * alpha * tangent2) - 1);
}

glm::dvec2 directionalAlbedo(double cosine, double roughness, int samples) {
    const double alpha = std::max(roughness * roughness, 1e-6);
    const glm::dvec3 v(std::sqrt(1 - cosine * cosine), 0, cosine);
    // The view in the frame in which the normals are those of a hemisphere.
    const glm::dvec3 stretched = glm::normalize(glm::dvec3(alpha * v.x, 0, v.z));
    const glm::dvec3 right(0, 1, 0);  // both the stretched view and the normal lie in the plane y = 0
    const glm::dvec3 up = glm::cross(stretched, right);
    glm::dvec2 sum(0);
    for (int i = 0; i < samples; ++i) {
        const glm::vec2 u =
            glsl::hammersley(static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(samples));
        const double radius = std::sqrt(static_cast<double>(u.x));
        const double around = 2 * std::numbers::pi * static_cast<double>(u.y);
        const double a = radius * std::cos(around);
        const double share = 0.5 * (1 + stretched.z);
        const double b = (1 - share) * std::sqrt(1 - a * a) + share * radius * std::sin(around);
        const glm::dvec3 onHemisphere =
            a * right + b * up + std::sqrt(std::max(0.0, 1 - a * a - b * b)) * stretched;
        const glm::dvec3 h = glm::normalize(
            glm::dvec3(alpha * onHemisphere.x, alpha * onHemisphere.y, std::max(0.0, onHemisphere.z)));
        const double vDotH = glm::dot(v, h);
        const double lightCosine = 2 * vDotH * h.z - v.z;
        if (lightCosine <= 0 || vDotH <= 0)
            continue;
        const double lambdaView = smithLambda(cosine, alpha);
        const double masking = (1 + lambdaView) / (1 + lambdaView + smithLambda(lightCosine, alpha));
        const double fresnel = std::pow(1 - vDotH, 5);
        sum += masking * glm::dvec2(1 - fresnel, fresnel);
    }
    return sum / static_cast<double>(samples);
}

}  // namespace

ForwardView environmentFaceView(const EnvironmentView& view, int face) {
    QX_CHECK_GE(face, 0);
    QX_CHECK_LT(face, faceCount);
    return {perspective(std::numbers::pi_v<float> / 2, 1, view.nearDistance, view.farDistance) *
                cameraFromWorld(worldFromFace(view.position, face)),
            view.position, false};
}

Image environmentBrdfTable(int size, int samples) {
    QX_CHECK_GE(size, 2);
    QX_CHECK_GE(samples, 1);
    Image table(size, size, 4, Encoding::linear);
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const glm::dvec2 albedo = directionalAlbedo(std::max(static_cast<double>(x) / (size - 1), 1e-3),
                                                        static_cast<double>(y) / (size - 1), samples);
            table.pixel(x, y)[0] = static_cast<float>(albedo.x);
            table.pixel(x, y)[1] = static_cast<float>(albedo.y);
        }
    return table;
}

void EnvironmentMap::addBindings(gl::ProgramFiles& files) {
    if (files.blocks.empty())
        files.blocks = SceneBuffers::bindings();
    files.blocks.push_back({"EnvironmentBlock", blockBinding});
    files.samplers.insert(files.samplers.end(), {{"environmentMap", radianceUnit},
                                                 {"environmentIrradianceMap", irradianceUnit},
                                                 {"environmentBrdfTable", brdfUnit}});
}

void EnvironmentMap::prepare(const EnvironmentParams& wanted) {
    QX_CHECK_GE(wanted.levels, 1);
    QX_CHECK_GE(wanted.samples, 1);
    EnvironmentParams params = wanted;
    const int full = gl::TextureCube::fullLevels(std::max(params.size, 1));
    params.levels = std::min(params.levels, full);
    const bool fits = source_.get() != 0 && params.size == source_.size() &&
                      params.levels == params_.levels && params.irradiance == params_.irradiance &&
                      params.format == params_.format;
    params_ = params;
    made_ = false;
    if (fits)
        return;
    // In order of deletion: framebuffers before what they draw into.
    sourceTargets_.clear();
    radianceTargets_.clear();
    irradianceTargets_.clear();
    const bool filters = params.levels > 1 || params.irradiance;
    source_ = gl::TextureCube("environment", params.format, params.size, filters ? full : 1);
    depth_ = gl::Texture2D("environment depth", GL_DEPTH_COMPONENT32F, params.size, params.size);
    for (int face = 0; face < faceCount; ++face)
        sourceTargets_.emplace_back(fmt::format("environment face {}", face), source_, face, 0, &depth_);
    radiance_ = {};
    if (params.levels > 1) {
        radiance_ = gl::TextureCube("environment radiance", params.format, params.size, params.levels);
        for (int level = 1; level < params.levels; ++level)
            for (int face = 0; face < faceCount; ++face)
                radianceTargets_.emplace_back(fmt::format("environment radiance {} of face {}", level, face),
                                              radiance_, face, level);
    }
    irradiance_ = {};
    if (params.irradiance) {
        irradiance_ = gl::TextureCube("environment irradiance", params.format, irradianceSize, 1);
        for (int face = 0; face < faceCount; ++face)
            irradianceTargets_.emplace_back(fmt::format("environment irradiance of face {}", face),
                                            irradiance_, face, 0);
    }
}

void EnvironmentMap::finish(graph::PassContext& context) {
    if (source_.levels() > 1)
        source_.generateMipmaps();
    if (params_.levels > 1) {
        const gl::Program& program = programReading(context, "environment_prefilter", "source");
        source_.bind(radianceUnit);
        program.set("sourceSize", static_cast<float>(source_.size()));
        program.set("lastLevel", static_cast<float>(source_.levels() - 1));
        program.set("samples", (params_.samples + 3) / 4 * 4);
        program.set("levelBias", params_.filteredSamples ? 0.5f : -100.0f);
        for (int face = 0; face < faceCount; ++face)
            radiance_.copyFrom(sourceTargets_[static_cast<std::size_t>(face)], face, 0);
        for (int level = 1; level < params_.levels; ++level) {
            const float roughness = static_cast<float>(level) / static_cast<float>(params_.levels - 1);
            program.set("alpha", roughness * roughness);
            for (int face = 0; face < faceCount; ++face) {
                radianceTargets_[static_cast<std::size_t>(faceCount * (level - 1) + face)].bind();
                program.set("face", face);
                program.use();
                context.drawFullscreen();
            }
        }
    }
    if (params_.irradiance) {
        const gl::Program& program = programReading(context, "environment_irradiance", "source");
        source_.bind(radianceUnit);
        const int level = levelOfSize(source_, irradianceSourceSize);
        program.set("sourceLevel", static_cast<float>(level));
        program.set("sourceSize", source_.sizeOf(level));
        for (int face = 0; face < faceCount; ++face) {
            irradianceTargets_[static_cast<std::size_t>(face)].bind();
            program.set("face", face);
            program.use();
            context.drawFullscreen();
        }
    }
    made_ = true;
}

void EnvironmentMap::drawGradient(graph::PassContext& context, int face, glm::vec3 zenith, glm::vec3 nadir) {
    const auto light = [](glm::vec3 color) {
        return glm::vec3(usable(color.r), usable(color.g), usable(color.b));
    };
    const gl::Program& program = context.programs().get(fullscreenProgram("environment_gradient"));
    program.set("face", face);
    program.set("zenith", light(zenith));
    program.set("nadir", light(nadir));
    program.use();
    context.drawFullscreen();
}

void EnvironmentMap::fromGradient(graph::PassContext& context, glm::vec3 zenith, glm::vec3 nadir,
                                  const EnvironmentParams& params) {
    prepare(params);
    position_ = glm::vec3(0);
    for (int face = 0; face < faceCount; ++face) {
        sourceTargets_[static_cast<std::size_t>(face)].bind();
        drawGradient(context, face, zenith, nadir);
    }
    finish(context);
}

void EnvironmentMap::fromBackground(graph::PassContext& context, const Scene& scene,
                                    const EnvironmentParams& params) {
    fromGradient(context, scene.backgroundTop, scene.backgroundBottom, params);
}

void EnvironmentMap::fromPanorama(graph::PassContext& context, const Image& panorama, glm::vec3 position,
                                  const EnvironmentParams& params) {
    const Image usable = usablePanorama(panorama);
    prepare(params);
    position_ = position;
    gl::Texture2D texture("panorama", GL_RGBA32F, usable.width, usable.height);
    texture.setFilter(GL_LINEAR, GL_LINEAR);
    texture.setWrap(GL_REPEAT, GL_CLAMP_TO_EDGE);
    gl::upload(texture, 0, 0, usable);
    texture.bind(radianceUnit);
    const gl::Program& program = programReading(context, "environment_panorama", "panorama");
    // A quarter of the panorama's width is seen by a face: at least one sample a pixel of it.
    const int samples = std::clamp((usable.width / 4 + params.size - 1) / params.size, 1, 8);
    program.set("size", params.size);
    program.set("samples", samples);
    for (int face = 0; face < faceCount; ++face) {
        sourceTargets_[static_cast<std::size_t>(face)].bind();
        program.set("face", face);
        program.use();
        context.drawFullscreen();
    }
    finish(context);
}

void EnvironmentMap::render(graph::PassContext& context, const EnvironmentView& view,
                            const EnvironmentDraw& draw, const EnvironmentParams& params) {
    prepare(params);
    position_ = view.position;
    for (int face = 0; face < faceCount; ++face) {
        sourceTargets_[static_cast<std::size_t>(face)].bind();
        drawGradient(context, face, view.zenith, view.nadir);
        glClear(GL_DEPTH_BUFFER_BIT);
        draw(context, environmentFaceView(view, face));
    }
    finish(context);
}

void EnvironmentMap::fromFaces(graph::PassContext& context, const std::vector<Image>& faces,
                               const EnvironmentParams& params) {
    QX_CHECK_EQ(faces.size(), static_cast<std::size_t>(faceCount));
    prepare(params);
    position_ = glm::vec3(0);
    for (int face = 0; face < faceCount; ++face) {
        Image image = faces[static_cast<std::size_t>(face)];
        std::transform(image.data.begin(), image.data.end(), image.data.begin(), usable);
        source_.upload(face, 0, image);
    }
    finish(context);
}

void EnvironmentMap::bind(const Lookup& lookup) {
    QX_CHECK(made_);
    if (brdf_.get() == 0) {
        static const Image table = environmentBrdfTable(brdfSize, brdfSamples);
        brdf_ = gl::Texture2D("environment BRDF", GL_RG16F, brdfSize, brdfSize);
        brdf_.setFilter(GL_LINEAR, GL_LINEAR);
        gl::upload(brdf_, 0, 0, table);
    }
    EnvironmentBlock block;
    if (lookup.box) {
        block.boxMin = glm::vec4(lookup.box->min, 1);
        block.boxMax = glm::vec4(lookup.box->max, 0);
    }
    block.boxMax.w = static_cast<float>(params_.levels);
    block.position = glm::vec4(position_, lookup.strength);
    const auto bytes = std::as_bytes(std::span(&block, 1));
    if (!block_)
        block_.emplace("environment block", GL_UNIFORM_BUFFER, bytes, GL_DYNAMIC_DRAW);
    else if (!std::equal(bytes.begin(), bytes.end(), sent_.begin(), sent_.end()))
        block_->upload(bytes);
    sent_.assign(bytes.begin(), bytes.end());
    block_->bindUniform(blockBinding, 0, sizeof(EnvironmentBlock));
    radiance().bind(radianceUnit, lookup.seamless);
    if (params_.irradiance)
        irradiance_.bind(irradianceUnit, lookup.seamless);
    brdf_.bind(brdfUnit);
}

std::size_t EnvironmentMap::bytes() const {
    const std::size_t texel = params_.format == GL_RGBA32F ? 16 : 8;
    const std::size_t cubes =
        (source_.texelCount() + radiance_.texelCount() + irradiance_.texelCount()) * texel;
    const auto pixels = [](const gl::Texture2D& texture) {
        return static_cast<std::size_t>(texture.width()) * static_cast<std::size_t>(texture.height());
    };
    return cubes + 4 * (pixels(depth_) + pixels(brdf_));
}

std::uint64_t EnvironmentMap::prefilterSamples() const {
    if (!made_ || params_.levels == 1)
        return 0;
    const auto first = static_cast<std::size_t>(faceCount) * static_cast<std::size_t>(params_.size) *
                       static_cast<std::size_t>(params_.size);
    return (radiance_.texelCount() - first) * static_cast<std::uint64_t>((params_.samples + 3) / 4 * 4);
}

graph::Resource addEnvironmentPass(graph::FrameGraph& graph, std::function<void(graph::PassContext&)> make,
                                   const char* name) {
    const graph::Resource done =
        graph.addResource({fmt::format("{} done", name), graph::Format::rgba8, 1, 1});
    graph.addPass({.name = name,
                   .reads = {},
                   .writes = {done},
                   .execute = [make = std::move(make)](graph::PassContext& context) {
                       // What the resource holds is not read, yet it is defined.
                       glClear(GL_COLOR_BUFFER_BIT);
                       make(context);
                   }});
    return done;
}

}  // namespace quincunx
