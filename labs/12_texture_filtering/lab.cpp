#include "labs/12_texture_filtering/lab.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "base/error.h"
#include "gl/upload.h"
#include "image/color.h"
#include "image/compare.h"
#include "image/filter.h"
#include "image/io.h"
#include "math/transform.h"
#include "passes/fullscreen.h"
#include "scene/import.h"
#include "scene/still_life.h"
#include "trace/reference.h"

namespace quincunx {

namespace {

constexpr GLuint imageUnit = 1;
constexpr GLuint drawnUnit = 2;
constexpr int mostTexels = 4096;  // a side, of pictures from files: a level of floats is then 268 MB
constexpr float differenceShown = 1.0f / 64;  // as the brightest colour
/// Near the horizon a pixel covers thousands of repeats, and llvmpipe's anisotropic filter visits each texel
/// of the box around its footprint: seconds a frame.
constexpr float mostDriverRepeats = 8;
constexpr int waveSeed = 12;
constexpr double waveShare = 0.8;  // of the highest frequency
constexpr int waveSide = 64;

gl::ProgramFiles labProgram(const std::string& name) {
    return {.label = name,
            .vertex = "passes/fullscreen.vert",
            .fragment = "labs/12_texture_filtering/" + name + ".frag"};
}

GLenum glWrap(int wrap) {
    static constexpr std::array<GLenum, 4> wraps = {GL_REPEAT, GL_MIRRORED_REPEAT, GL_CLAMP_TO_EDGE,
                                                    GL_CLAMP_TO_BORDER};
    return wraps[static_cast<std::size_t>(wrap)];
}

bool isWide(Magnification kernel) {
    return kernel != Magnification::nearest && kernel != Magnification::bilinear;
}

const char* filterTitle(TextureFilteringLab::Filter filter) {
    static constexpr std::array titles = {"nearest",   "bilinear",    "one mipmap level",
                                          "trilinear", "anisotropic", "the driver's anisotropic"};
    return titles[static_cast<std::size_t>(filter)];
}

Image8 edgePicture(int side) {
    Image8 image(side, side, 3, Encoding::srgb);
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x)
            std::fill_n(image.pixel(x, y), 3, srgbCode(2 * x < side ? 0.1f : 0.7f));
    return image;
}

template <typename Channel>
void copyInto(BasicImage<Channel>& picture, const BasicImage<Channel>& part, int left) {
    for (int y = 0; y < part.height; ++y)
        std::copy_n(part.pixel(0, y), static_cast<std::ptrdiff_t>(part.width) * part.channels,
                    picture.pixel(left, y));
}

/// Only within a rectangle, until the end.
class Scissor {
  public:
    Scissor(int left, int bottom, int width, int height) {
        glEnable(GL_SCISSOR_TEST);
        glScissor(left, bottom, width, height);
    }
    ~Scissor() { glad_glDisable(GL_SCISSOR_TEST); }
    Scissor(const Scissor&) = delete;
    Scissor& operator=(const Scissor&) = delete;
};

}  // namespace

TextureFilteringLab::TextureFilteringLab() : waves_(waveSide, waveShare, waveSeed) {}

Camera TextureFilteringLab::defaultCamera() const {
    Camera camera;
    camera.worldFromCamera = lookAt({0, 1.5f, 4}, {0, 0.72f, 0}, {0, 1, 0});
    camera.fovYRadians = glm::radians(48.0f);
    camera.farDistance = 400;
    return camera;
}

Bounds TextureFilteringLab::sceneBounds() const {
    return {{-4, 0, -4}, {4, 1.5f, 4}};
}

void TextureFilteringLab::markIdleKnobs() {
    const View shown = view.as<View>();
    const bool floor = shown == View::floor || shown == View::footprint;
    const bool magnified = shown == View::photo;
    const char* const onFloor = floor ? "" : "the floor is not shown";
    const char* const onPhoto = magnified ? "" : "the photo is not shown";
    compare.setIdle(shown == View::floor || magnified ? "" : "this view has one picture");
    pattern.setIdle(magnified || shown == View::quad ? "the floor's texture is not shown" : "");
    photo.setIdle(onPhoto);
    file.setIdle((magnified ? photo.as<Photo>() == Photo::file : pattern.as<Pattern>() == Pattern::file)
                     ? ""
                     : "no picture from a file is shown");
    minification.setIdle(!floor ? onFloor : shown == View::floor && compare ? "all are compared" : "");
    maxAnisotropy.setIdle(onFloor);
    magnification.setIdle(shown == View::quad || shown == View::pyramid ? "texels are shown as they are"
                          : magnified && compare                        ? "all are compared"
                                                                        : "");
    lobes.setIdle(magnified && (compare || magnification.as<Magnification>() == Magnification::lanczos)
                      ? ""
                      : "there is no Lanczos filter");
    mipmaps.setIdle(magnified || shown == View::quad ? "magnified pixels read no mipmaps" : "");
    wrap.setIdle(shown == View::pyramid ? "the whole texture is shown, once" : "");
    lodBias.setIdle(onFloor);
    repeats.setIdle(onFloor);
    for (Knob* knob : std::initializer_list<Knob*>{&zoom, &centreS, &centreT})
        knob->setIdle(onPhoto);
    for (Knob* knob : std::initializer_list<Knob*>{&quadU, &quadV})
        knob->setIdle(shown == View::quad ? "" : "the quad is not shown");
    for (Knob* knob : std::initializer_list<Knob*>{&probeX, &probeY})
        knob->setIdle(shown == View::footprint ? "" : "the footprint is not shown");
    unit.setIdle(shown == View::floor || magnified ? "" : "only the floor and the photo have both");
    textureSize.setIdle(shown == View::quad                              ? "the checker has 4×4 texels"
                        : magnified && photo.as<Photo>() == Photo::waves ? "the waves have 64×64 texels"
                                                                         : "");
    storage.setIdle(magnified && photo.as<Photo>() == Photo::waves ? "the waves are kept as floats" : "");
}

TextureFilteringLab::Recipe TextureFilteringLab::recipe() const {
    Recipe recipe;
    recipe.photo = usesPhoto();
    recipe.kind = view.as<View>() == View::quad ? -1 : recipe.photo ? photo.index() : pattern.index();
    recipe.size = view.as<View>() == View::quad ? 4 : static_cast<int>(textureSize);
    const bool fromFile =
        recipe.photo ? photo.as<Photo>() == Photo::file : pattern.as<Pattern>() == Pattern::file;
    if (fromFile && recipe.kind >= 0)
        recipe.file = file.value();
    recipe.mipmaps = mipmaps.index();
    recipe.storage = recipe.photo && photo.as<Photo>() == Photo::waves ? 0 : storage.index();
    return recipe;
}

Image8 TextureFilteringLab::makeBase(const Recipe& recipe) const {
    if (recipe.kind < 0)
        return checkerTexture(4, 4, 4, 4);
    const bool fromFile = recipe.photo ? static_cast<Photo>(recipe.kind) == Photo::file
                                       : static_cast<Pattern>(recipe.kind) == Pattern::file;
    if (fromFile) {
        if (recipe.file.empty())
            throw InputError("no picture is named", "--file", "name one: --file=photo.jpg");
        Image8 image = readImage8(recipe.file);
        if (std::max(image.width, image.height) <= mostTexels)
            return image;
        Image8 reduced = reducedToSide(image, mostTexels);
        fmt::print(stderr, "{}: {}×{} texels are reduced to {}×{}: this lab takes {} a side\n", recipe.file,
                   image.width, image.height, reduced.width, reduced.height, mostTexels);
        return reduced;
    }
    constexpr std::uint64_t seed = 7;
    const int side = recipe.size;
    if (recipe.photo) {
        if (static_cast<Photo>(recipe.kind) == Photo::edge)
            return edgePicture(side);
        const int height = std::max(side * 3 / 4, 1);
        if (stillLife_.width != side) {
            constexpr int factor = 3;
            const StillLife scene = makeStillLife();
            PhongModel model;
            model.reflection = PhongModel::Reflection::blinnPhong;
            model.shadows = true;
            const Camera camera =
                fittedToAspect(scene.camera, static_cast<float>(side) / static_cast<float>(height));
            stillLife_ = toSrgb8(boxDownsample(
                traceReference(TraceScene(scene), camera, factor * side, factor * height, model), factor));
        }
        return stillLife_;
    }
    switch (static_cast<Pattern>(recipe.kind)) {
        case Pattern::bricks:
            return brickTexture(side, 8, seed);
        case Pattern::checker:
            return checkerTexture(side, side, 8, 8);
        case Pattern::zonePlate:
            return zonePlateTexture(side);
        case Pattern::wood:
            return woodTexture(side, seed);
        default:
            return noiseTexture(side, seed);
    }
}

void TextureFilteringLab::prepareTexture() const {
    const Recipe wanted = recipe();
    if (made_ == wanted)
        return;
    made_.reset();
    texture_ = {};
    levels_.clear();
    floatLevels_.clear();
    const Mipmaps by = static_cast<Mipmaps>(wanted.mipmaps);
    MipmapParams params;
    params.filter = by == Mipmaps::kaiser    ? MipFilter::kaiser
                    : by == Mipmaps::lanczos ? MipFilter::lanczos
                                             : MipFilter::box;
    params.linearLight = by != Mipmaps::codes;
    params.repeats = wrap.as<TextureWrap>() == TextureWrap::repeat;
    if (wanted.photo && static_cast<Photo>(wanted.kind) == Photo::waves) {
        const Image grey = waves_.texels();
        Image base(grey.width, grey.height, 4, Encoding::linear);
        for (std::size_t i = 0; i < grey.pixelCount(); ++i) {
            std::fill_n(&base.data[4 * i], 3, grey.data[i]);
            base.data[4 * i + 3] = 1;
        }
        floatLevels_ = makeMipmaps(base, params);
        floatLevels_.insert(floatLevels_.begin(), std::move(base));
    } else {
        Image8 base = makeBase(wanted);
        levels_ = makeMipmaps(base, params);
        levels_.insert(levels_.begin(), std::move(base));
    }
    made_ = wanted;
}

const MipTexture& TextureFilteringLab::texture() const {
    prepareTexture();
    if (texture_.levels() == 0) {
        const auto kept = static_cast<Storage>(made_->storage);
        if (!floatLevels_.empty()) {
            texture_ = MipTexture(floatLevels_);
        } else if (kept == Storage::bc1 || kept == Storage::bc4) {
            std::vector<Image8> decoded;
            for (const Image8& level : levels_)
                decoded.push_back(decompressBlocks(
                    compressBlocks(level, kept == Storage::bc1 ? BlockFormat::bc1 : BlockFormat::bc4)));
            if (kept == Storage::bc4)
                for (Image8& level : decoded)
                    level.encoding = Encoding::linear;
            texture_ = MipTexture(decoded);
        } else {
            texture_ = MipTexture(levels_);
        }
    }
    return texture_;
}

void TextureFilteringLab::uploadTexture() {
    prepareTexture();
    if (uploaded_ == made_)
        return;
    uploaded_.reset();
    device_.reset();
    const auto kept = static_cast<Storage>(made_->storage);
    const bool byDriver = static_cast<Mipmaps>(made_->mipmaps) == Mipmaps::driver;
    if (!floatLevels_.empty()) {
        device_.emplace("texture", floatLevels_);
    } else if (kept == Storage::bc1 || kept == Storage::bc4) {
        std::vector<BlockImage> blocks;
        for (const Image8& level : levels_) {
            Image8 source = level;
            if (kept == Storage::bc4)
                source.encoding = Encoding::linear;  // no block format of one channel has the curve
            blocks.push_back(
                compressBlocks(source, kept == Storage::bc1 ? BlockFormat::bc1 : BlockFormat::bc4));
        }
        device_.emplace("texture", blocks);
    } else {
        device_.emplace("texture", levels_, kept == Storage::bc7 ? gl::compressedSrgbAlphaBptc : 0);
        if (byDriver)
            device_->generateMipmaps();
        if (byDriver || kept == Storage::bc7) {
            std::vector<Image8> read;
            for (std::size_t level = 0; level < levels_.size(); ++level)
                read.push_back(gl::readLevel8(*device_, static_cast<int>(level)));
            texture_ = MipTexture(read);
        }
    }
    uploaded_ = made_;
}

SamplerSettings TextureFilteringLab::settingsOf(Filter filter) const {
    SamplerSettings settings;
    settings.wrapS = settings.wrapT = wrap.as<TextureWrap>();
    static constexpr std::array filters = {Minification::nearest,        Minification::bilinear,
                                           Minification::bilinearMipmap, Minification::trilinear,
                                           Minification::anisotropic,    Minification::anisotropic};
    settings.minification = filters[static_cast<std::size_t>(filter)];
    settings.magnification = magnification.as<Magnification>();
    if (!usesPhoto() && isWide(settings.magnification))
        settings.magnification = Magnification::bilinear;
    settings.maxAnisotropy = maxAnisotropy;
    settings.lobes = lobes;
    settings.lodBias = lodBias;
    return settings;
}

SamplerSettings TextureFilteringLab::sampler() const {
    return settingsOf(minification.as<Filter>());
}

gl::Sampler::Params TextureFilteringLab::samplerParams(Filter filter) const {
    static constexpr std::array<GLenum, 6> filters = {GL_NEAREST,
                                                      GL_LINEAR,
                                                      GL_LINEAR_MIPMAP_NEAREST,
                                                      GL_LINEAR_MIPMAP_LINEAR,
                                                      GL_LINEAR_MIPMAP_LINEAR,
                                                      GL_LINEAR_MIPMAP_LINEAR};
    gl::Sampler::Params params;
    params.minification = filters[static_cast<std::size_t>(filter)];
    params.magnification =
        magnification.as<Magnification>() == Magnification::nearest ? GL_NEAREST : GL_LINEAR;
    params.wrap = glWrap(wrap.index());
    params.maxAnisotropy = filter == Filter::driver ? static_cast<int>(maxAnisotropy) : 1;
    return params;
}

FloorView TextureFilteringLab::floorView(const Camera& camera, int width, int height) const {
    return {camera, width, height, static_cast<double>(repeats)};
}

TextureWindow TextureFilteringLab::photoWindow(double aspect) const {
    const MipTexture& shown = texture();
    const glm::dvec2 half(0.5 / zoom * aspect * shown.height() / shown.width(), 0.5 / zoom);
    const glm::dvec2 centre(double{float{centreS}}, double{float{centreT}});
    return {centre - half, centre + half};
}

std::vector<TextureFilteringLab::Panel> TextureFilteringLab::panels(const Frame& frame) const {
    std::vector<Panel> panels;
    if (usesPhoto()) {
        if (compare)
            for (const auto kernel : {Magnification::nearest, Magnification::bilinear,
                                      Magnification::mitchell, Magnification::lanczos, Magnification::sinc})
                panels.push_back(
                    {.name = magnification.options()[static_cast<std::size_t>(kernel)], .kernel = kernel});
        else
            panels.push_back({.kernel = magnification.as<Magnification>()});
    } else if (view.as<View>() == View::floor && compare) {
        for (const auto filter : {Filter::nearest, Filter::bilinear, Filter::trilinear, Filter::anisotropic})
            panels.push_back({.name = filterTitle(filter), .filter = filter});
    } else {
        panels.push_back({.filter = minification.as<Filter>()});
    }
    if (frame.width < static_cast<int>(panels.size()))
        panels.resize(1);
    for (std::size_t i = 0; i < panels.size(); ++i) {
        const auto count = static_cast<int>(panels.size());
        panels[i].left = frame.width * static_cast<int>(i) / count;
        panels[i].width = frame.width * (static_cast<int>(i) + 1) / count - panels[i].left;
    }
    return panels;
}

Image TextureFilteringLab::cpuPicture(const Frame& frame) const {
    Image picture(frame.width, frame.height, 4, Encoding::linear);
    for (const Panel& panel : panels(frame)) {
        if (usesPhoto()) {
            SamplerSettings settings = sampler();
            settings.magnification = panel.kernel;
            copyInto(
                picture,
                enlarge(texture(), settings, photoWindow(static_cast<double>(panel.width) / frame.height),
                        panel.width, frame.height),
                panel.left);
        } else {
            copyInto(picture,
                     floorPicture(texture(), settingsOf(panel.filter),
                                  floorView(frame.camera, panel.width, frame.height)),
                     panel.left);
        }
    }
    return picture;
}

Lab::ReferenceJob TextureFilteringLab::reference(const Frame& frame) const {
    if (unit.as<Unit>() == Unit::difference)
        return {};
    const std::vector<Panel> shown = panels(frame);
    if (view.as<View>() == View::floor) {
        std::vector<FloorView> views;
        for (const Panel& panel : shown)
            views.push_back(floorView(frame.camera, panel.width, frame.height));
        return [texture = texture(), wraps = wrap.as<TextureWrap>(), views, shown,
                frame](const std::atomic<bool>& stop) {
            constexpr int side = 16;
            Image picture(frame.width, frame.height, 4, Encoding::linear);
            for (std::size_t i = 0; i < shown.size() && !stop; ++i)
                copyInto(picture, floorReference(texture, wraps, views[i], side, stop), shown[i].left);
            return picture;
        };
    }
    if (!usesPhoto() || photo.as<Photo>() != Photo::waves)
        return {};
    std::vector<TextureWindow> windows;
    for (const Panel& panel : shown)
        windows.push_back(photoWindow(static_cast<double>(panel.width) / frame.height));
    return [waves = waves_, windows, shown, frame](const std::atomic<bool>& stop) {
        Image picture(frame.width, frame.height, 4, Encoding::linear);
        for (int y = 0; y < frame.height && !stop; ++y)
            for (std::size_t i = 0; i < shown.size(); ++i)
                for (int x = 0; x < shown[i].width; ++x) {
                    const glm::dvec2 st =
                        glm::mix(windows[i].low, windows[i].high,
                                 glm::dvec2((x + 0.5) / shown[i].width, (y + 0.5) / frame.height));
                    float* const to = picture.pixel(shown[i].left + x, y);
                    std::fill_n(to, 3, static_cast<float>(waves.at(st.x, st.y)));
                    to[3] = 1;
                }
        return picture;
    };
}

float TextureFilteringLab::textSize(const Frame& frame) const {
    return std::clamp(static_cast<float>(frame.height) / 26, 8.0f, 28.0f);
}

std::uint64_t TextureFilteringLab::countTexels(const Frame& frame) const {
    std::uint64_t texels = 0;
    for (const Panel& panel : panels(frame)) {
        if (!usesPhoto()) {
            texels += countFloor(texture(), settingsOf(panel.filter),
                                 floorView(frame.camera, panel.width, frame.height))
                          .texels;
            continue;
        }
        // Wide filters run along all rows first, then along the columns of the picture.
        const auto pixels =
            static_cast<std::uint64_t>(panel.width) * static_cast<std::uint64_t>(frame.height);
        const auto rows =
            static_cast<std::uint64_t>(panel.width) * static_cast<std::uint64_t>(texture().height());
        const auto tapsOf = [&](int side) {
            std::vector<LineTap> taps;
            lineTaps(panel.kernel, lobes, 0.5 * side, side, wrap.as<TextureWrap>(), taps);
            return static_cast<std::uint64_t>(taps.size());
        };
        texels += isWide(panel.kernel)
                      ? rows * tapsOf(texture().width()) + pixels * tapsOf(texture().height())
                      : pixels * (panel.kernel == Magnification::nearest ? 1 : 4);
    }
    return texels;
}

std::map<std::string, std::uint64_t> TextureFilteringLab::counters() const {
    const View shown = view.as<View>();
    const bool filters = shown == View::floor || shown == View::photo;
    const bool drivers = shown == View::floor && !compare && minification.as<Filter>() == Filter::driver;
    if (!drawn_ || !filters || drivers || unit.as<Unit>() == Unit::cpu)
        return {};
    if (!texels_)
        texels_ = countTexels(*drawn_);
    return {{"texels read", *texels_}};
}

graph::Resource TextureFilteringLab::build(graph::FrameGraph& graph, const Frame& frame) {
    drawn_ = frame;
    texels_.reset();
    prepareTexture();
    switch (view.as<View>()) {
        case View::floor:
            return buildFloor(graph, frame);
        case View::photo:
            return buildPhoto(graph, frame);
        default:
            return buildDiagram(graph, frame);
    }
}

graph::Resource TextureFilteringLab::addShown(graph::FrameGraph& graph, const Frame& frame,
                                              std::optional<graph::Resource> drawn) {
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    std::vector<graph::Resource> reads;
    if (drawn)
        reads.push_back(*drawn);
    graph.addPass({.name = drawn ? "difference" : "show",
                   .reads = reads,
                   .writes = {picture},
                   .execute = [this, frame, drawn](graph::PassContext& context) {
                       uploadTexture();
                       if (!cpuTexture_ || cpuTexture_->width() != frame.width ||
                           cpuTexture_->height() != frame.height)
                           cpuTexture_.emplace("made on the CPU", GL_RGBA32F, frame.width, frame.height);
                       gl::upload(*cpuTexture_, 0, 0, cpuPicture(frame));
                       const gl::Program& program = context.programs().get(labProgram("show"));
                       program.use();
                       program.set("made", static_cast<int>(imageUnit));
                       program.set("drawn", static_cast<int>(drawnUnit));
                       program.set("difference", drawn ? 1 : 0);
                       program.set("maximum", differenceShown);
                       cpuTexture_->bind(imageUnit);
                       if (drawn) {
                           context.texture(*drawn).bind(drawnUnit);
                           Image ramp(5, 1, 1, Encoding::linear);
                           for (int i = 0; i < 5; ++i)
                               *ramp.pixel(i, 0) = static_cast<float>(i) / 4;
                           const Image colors = toLinear(errorMap(ramp));
                           for (int i = 0; i < 5; ++i) {
                               const float* const c = colors.pixel(i, 0);
                               program.set(fmt::format("ramp[{}]", i), glm::vec3(c[0], c[1], c[2]));
                           }
                       }
                       context.drawFullscreen();
                       drawTitles(context, frame, panels(frame));
                   }});
    return picture;
}

graph::Resource TextureFilteringLab::buildFloor(graph::FrameGraph& graph, const Frame& frame) {
    const Unit by = unit.as<Unit>();
    if (by == Unit::cpu)
        return addShown(graph, frame, {});
    const bool direct = by == Unit::opengl;
    const graph::Resource target =
        graph.addResource({direct ? "picture" : "drawn",
                           direct ? frame.pictureFormat : graph::Format::rgba32f, frame.width, frame.height});
    graph.addPass({.name = "floor",
                   .reads = {},
                   .writes = {target},
                   .execute = [this, frame, direct](graph::PassContext& context) {
                       uploadTexture();
                       const std::vector<Panel> shown = panels(frame);
                       for (const Panel& panel : shown)
                           drawFloorPanel(context, frame, panel, panel.filter);
                       if (direct)
                           drawTitles(context, frame, shown);
                   }});
    return direct ? target : addShown(graph, frame, target);
}

void TextureFilteringLab::drawFloorPanel(graph::PassContext& context, const Frame& frame, const Panel& panel,
                                         Filter filter) {
    const FloorView view3d = floorView(frame.camera, panel.width, frame.height);
    const gl::Program& program = context.programs().get(labProgram("floor"));
    program.use();
    program.set("image", static_cast<int>(imageUnit));
    program.set("rayFromPixel", glm::mat3(view3d.rayFromPixel()));
    program.set("eye", glm::vec3(view3d.eye()));
    program.set("repeats", static_cast<float>(view3d.repeats()));
    program.set("left", static_cast<float>(panel.left));
    program.set("hazeDistance", static_cast<float>(hazeDistance));
    program.set("horizonColor", glm::vec3(horizonColor));
    program.set("zenithColor", glm::vec3(zenithColor));
    program.set("lodScale", std::exp2(static_cast<float>(lodBias)));
    program.set("mostRepeats",
                filter == Filter::driver ? mostDriverRepeats : std::numeric_limits<float>::max());
    program.set("maxProbes", filter == Filter::anisotropic ? static_cast<int>(maxAnisotropy) : 0);
    device_->bind(imageUnit);
    const gl::Sampler::Use use(context.sampler(samplerParams(filter)), imageUnit);
    const Scissor scissor(panel.left, 0, panel.width, frame.height);
    context.drawFullscreen();
}

graph::Resource TextureFilteringLab::buildPhoto(graph::FrameGraph& graph, const Frame& frame) {
    const Unit by = unit.as<Unit>();
    if (by == Unit::cpu)
        return addShown(graph, frame, {});
    const bool direct = by == Unit::opengl;
    const std::vector<Panel> shown = panels(frame);
    const MipTexture& source = texture();
    const auto setLine = [this](const gl::Program& program, const Panel& panel, bool across, double low,
                                double high, int pixels, int side) {
        program.use();
        program.set("source", static_cast<int>(imageUnit));
        program.set("across", across ? 1 : 0);
        program.set("kernel", static_cast<int>(panel.kernel));
        program.set("lobes", static_cast<int>(lobes));
        program.set("wrap", wrap.index());
        program.set("low", static_cast<float>(low * side));
        program.set("scale", static_cast<float>((high - low) / pixels * side));
    };
    std::vector<std::optional<graph::Resource>> wide(shown.size());
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const Panel panel = shown[i];
        if (!isWide(panel.kernel))
            continue;
        const TextureWindow window = photoWindow(static_cast<double>(panel.width) / frame.height);
        wide[i] = graph.addResource(
            {"rows enlarged by " + magnification.options()[static_cast<std::size_t>(panel.kernel)],
             graph::Format::rgba32f, panel.width, source.height()});
        graph.addPass(
            {.name = "enlarge rows by " + magnification.options()[static_cast<std::size_t>(panel.kernel)],
             .reads = {},
             .writes = {*wide[i]},
             .execute = [this, panel, window, setLine](graph::PassContext& context) {
                 uploadTexture();
                 const gl::Program& program = context.programs().get(labProgram("enlarge"));
                 setLine(program, panel, true, window.low.x, window.high.x, panel.width, device_->width());
                 program.set("origin", glm::vec2(0));
                 device_->bind(imageUnit);
                 context.drawFullscreen();
             }});
    }
    const graph::Resource target =
        graph.addResource({direct ? "picture" : "drawn",
                           direct ? frame.pictureFormat : graph::Format::rgba32f, frame.width, frame.height});
    std::vector<graph::Resource> reads;
    for (const auto& resource : wide)
        if (resource)
            reads.push_back(*resource);
    graph.addPass(
        {.name = "enlarge",
         .reads = reads,
         .writes = {target},
         .execute = [this, frame, shown, wide, direct, setLine](graph::PassContext& context) {
             uploadTexture();
             for (std::size_t i = 0; i < shown.size(); ++i) {
                 const Panel& panel = shown[i];
                 const TextureWindow window = photoWindow(static_cast<double>(panel.width) / frame.height);
                 if (!wide[i]) {
                     gl::Sampler::Params params = samplerParams(Filter::bilinear);
                     params.minification = params.magnification =
                         panel.kernel == Magnification::nearest ? GL_NEAREST : GL_LINEAR;
                     drawWindow(context, {panel.left, 0, panel.width, frame.height}, window, 0, params);
                     continue;
                 }
                 const gl::Program& program = context.programs().get(labProgram("enlarge"));
                 const gl::Texture2D& rows = context.texture(*wide[i]);
                 setLine(program, panel, false, window.low.y, window.high.y, frame.height, rows.height());
                 program.set("origin", glm::vec2(panel.left, 0));
                 program.set("targetHeight", static_cast<float>(frame.height));
                 rows.bind(imageUnit);
                 const Scissor scissor(panel.left, 0, panel.width, frame.height);
                 context.drawFullscreen();
             }
             if (direct)
                 drawTitles(context, frame, shown);
         }});
    return direct ? target : addShown(graph, frame, target);
}

void TextureFilteringLab::drawWindow(graph::PassContext& context, glm::vec4 rectangle,
                                     const TextureWindow& window, float level,
                                     const gl::Sampler::Params& sampler, float dim) {
    const gl::Program& program = context.programs().get(labProgram("window"));
    program.use();
    program.set("image", static_cast<int>(imageUnit));
    program.set("rectangle", rectangle);
    program.set("window", glm::vec4(glm::vec2(window.low), glm::vec2(window.high)));
    program.set("level", level);
    program.set("dim", dim);
    device_->bind(imageUnit);
    const gl::Sampler::Use use(context.sampler(sampler), imageUnit);
    const Scissor scissor(static_cast<int>(rectangle.x), static_cast<int>(rectangle.y),
                          static_cast<int>(rectangle.z), static_cast<int>(rectangle.w));
    context.drawFullscreen();
}

graph::Resource TextureFilteringLab::buildDiagram(graph::FrameGraph& graph, const Frame& frame) {
    const graph::Resource picture =
        graph.addResource({"picture", frame.pictureFormat, frame.width, frame.height});
    graph.addPass({.name = view.text(),
                   .reads = {},
                   .writes = {picture},
                   .execute = [this, frame](graph::PassContext& context) {
                       uploadTexture();
                       glClearColor(0.014f, 0.017f, 0.024f, 1);
                       glClear(GL_COLOR_BUFFER_BIT);
                       if (view.as<View>() == View::quad)
                           drawQuad(context, frame);
                       else if (view.as<View>() == View::footprint)
                           drawFootprint(context, frame);
                       else
                           drawPyramid(context, frame);
                   }});
    return picture;
}

void TextureFilteringLab::drawTitles(graph::PassContext& context, const Frame& frame,
                                     const std::vector<Panel>& shown) {
    if (shown.size() < 2)
        return;
    labels_.clear();
    const float size = textSize(frame);
    for (const Panel& panel : shown) {
        if (panel.left > 0)
            labels_.plate({panel.left - 1, 0}, {2, frame.height}, {1, 1, 1, 1});
        labels_.text(panel.name,
                     {static_cast<float>(panel.left) + 0.5f * static_cast<float>(panel.width), 0.5f * size},
                     {.sizePixels = size,
                      .color = {1, 1, 1, 1},
                      .backing = {0.01f, 0.015f, 0.03f, 0.6f},
                      .anchor = Labels::Anchor::topCenter});
    }
    labels_.draw(context, {frame.width, frame.height});
}

Exercise TextureFilteringLab::exercise() const {
    Exercise exercise;
    exercise.effects = {{"the filters side by side", {{"compare", "off"}}},
                        {"the texture", {{"pattern", "checker"}}},
                        {"how often the texture repeats", {{"repeats", "0.3"}}}};
    exercise.shader = "labs/12_texture_filtering/floor.frag";
    exercise.scenes = {{{"pattern", "checker"}}, {{"lod-bias", "1"}}};
    exercise.shaderKnobs = {{"compare", "off"}, {"minification", "trilinear"}, {"repeats", "2"}};
    return exercise;
}

}  // namespace quincunx

QUINCUNX_DEFINE_LAB(quincunx::TextureFilteringLab)
