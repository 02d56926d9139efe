#include <array>
#include <cmath>
#include <limits>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "image/color.h"
#include "image/compare.h"
#include "image/io.h"
#include "lab/studio.h"
#include "lab/timing_limit.h"
#include "labs/12_texture_filtering/driver_samples.h"
#include "labs/12_texture_filtering/lab.h"
#include "math/transform.h"
#include "tests/labs/lab_test.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using Lab12 = TextureFilteringLab;
using test::isFinite;
using test::largestDifference;
using test::Size;

constexpr Size small{96, 72};

class TextureFiltering12 : public testing::TestWithParam<gl::Backend> {
  protected:
    TextureFiltering12() : studio_(GetParam()) {
        lab_.textureSize.set(64);
        lab_.compare.set(false);
    }

    Frame frame(Size size) { return studio_.frame(lab_, size.width, size.height); }
    Image picture(Size size) { return studio_.linearPicture(lab_, frame(size)); }

    Lab12 lab_;
    Studio studio_;
};

// The other back end draws the same bits: TextureFiltering12Backends.
INSTANTIATE_TEST_SUITE_P(On, TextureFiltering12, testing::Values(gl::Backend::egl), test::nameOfBackend);

std::vector<Image> noiseLevels(int width, int height, std::uint64_t seed) {
    Image base(width, height, 4, Encoding::linear);
    Random random(seed);
    for (float& value : base.data)
        value = random.uniform();
    std::vector<Image> levels = makeMipmaps(base);
    // Levels that have nothing to do with one another show which one is read.
    for (Image& level : levels)
        for (float& value : level.data)
            value = random.uniform();
    levels.insert(levels.begin(), base);
    return levels;
}

struct GlFilter {
    Minification ours;
    GLenum theirs;
    bool blends;  ///< levels, so that a λ that is a little off shows little
};

TEST_P(TextureFiltering12, DriverSamplesAsOurUnitWithEveryFilterAndWrap) {
    studio_.context();
    static constexpr std::array filters = {
        GlFilter{Minification::bilinear, GL_LINEAR, true},
        GlFilter{Minification::bilinearMipmap, GL_LINEAR_MIPMAP_NEAREST, false},
        GlFilter{Minification::trilinear, GL_LINEAR_MIPMAP_LINEAR, true}};
    static constexpr std::array<GLenum, 4> wraps = {GL_REPEAT, GL_MIRRORED_REPEAT, GL_CLAMP_TO_EDGE,
                                                    GL_CLAMP_TO_BORDER};
    Random random(12);
    for (const Size shape : {Size{32, 32}, Size{13, 5}, Size{1, 16}, Size{1, 1}}) {
        const std::vector<Image> levels = noiseLevels(shape.width, shape.height, 3);
        const MipTexture ours(levels);
        const gl::Texture2D theirs("noise", levels);
        for (const GlFilter& filter : filters)
            for (std::size_t wrap = 0; wrap < wraps.size(); ++wrap) {
                std::vector<TexturePoint> points;
                for (int i = 0; i < 256; ++i) {
                    TexturePoint point;
                    point.st = {random.uniform(-2.5, 2.5), random.uniform(-2.5, 2.5)};
                    const double scale = std::exp2(random.uniform(-8, 1));
                    point.alongX = {scale * random.uniform(-1, 1), scale * random.uniform(-1, 1)};
                    point.alongY = {scale * random.uniform(-1, 1), scale * random.uniform(-1, 1)};
                    // Not where rounding decides which level is the nearest.
                    const double lambda = levelOfDetail(point, shape.width, shape.height);
                    if (filter.blends || std::abs(lambda - std::floor(lambda) - 0.5) > 0.01)
                        points.push_back(point);
                }
                const std::vector<glm::vec4> samples = driverSamples(
                    studio_.executor(), theirs,
                    {.minification = filter.theirs, .magnification = GL_LINEAR, .wrap = wraps[wrap]}, points);
                SamplerSettings settings;
                settings.minification = filter.ours;
                settings.wrapS = settings.wrapT = static_cast<TextureWrap>(wrap);
                double worst = 0;
                for (std::size_t i = 0; i < points.size(); ++i) {
                    const glm::vec4 color = sampleTexture(ours, settings, points[i]).color;
                    for (int c = 0; c < 4; ++c)
                        worst = std::max(worst, std::abs(static_cast<double>(color[c]) - samples[i][c]));
                }
                // Places are floats: 2^-17 of a texel. llvmpipe takes log2 of ρ² for its exponent plus its
                // fraction, off by up to 0.0861, and half of it: levels, which differ by up to 1, are blended
                // by 0.0431 off at most. Measured: 0.042.
                const bool trilinear = filter.ours == Minification::trilinear;
                EXPECT_LE(worst, trilinear ? 0.0431 + 1e-4 : 1e-4)
                    << shape.width << "x" << shape.height << " filter " << static_cast<int>(filter.ours)
                    << " wrap " << wrap;
            }
    }
}

TEST_P(TextureFiltering12, DriverKeepsHardDerivativesWithinTheTexels) {
    studio_.context();
    const std::vector<Image> levels = noiseLevels(16, 16, 4);
    const gl::Texture2D theirs("noise", levels);
    const MipTexture ours(levels);
    std::vector<TexturePoint> points;
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const float along : {0.0f, 1e-38f, 1e30f, infinity, -infinity, std::nanf("")})
        for (const glm::vec2 st : {glm::vec2(0.3f), glm::vec2(-1e7f, 1e7f), glm::vec2(1e30f)}) {
            points.push_back({st, {along, 0}, {0, 0.01f}});
            points.push_back({st, {along, along}, {along, along}});
        }
    for (const glm::vec4 sample : driverSamples(
             studio_.executor(), theirs,
             {.minification = GL_LINEAR_MIPMAP_LINEAR, .magnification = GL_LINEAR, .wrap = GL_REPEAT},
             points))
        for (int c = 0; c < 4; ++c)
            EXPECT_TRUE(sample[c] >= 0 && sample[c] <= 1) << sample[c];
    for (const TexturePoint& point : points)
        for (const Minification filter : {Minification::trilinear, Minification::anisotropic}) {
            SamplerSettings settings;
            settings.minification = filter;
            const glm::vec4 color = sampleTexture(ours, settings, point).color;
            for (int c = 0; c < 4; ++c)
                EXPECT_TRUE(color[c] >= 0 && color[c] <= 1) << color[c];
        }
}

TEST_P(TextureFiltering12, LevelsThatAreMissingAreNotRead) {
    studio_.context();
    std::vector<Image> levels = noiseLevels(16, 16, 5);
    levels.resize(2);
    const gl::Texture2D theirs("two levels", levels);
    const MipTexture ours(levels);
    EXPECT_TRUE(ours.complete());
    const std::vector<TexturePoint> points(1, {{0.4f, 0.7f}, {0.5f, 0}, {0, 0.5f}});
    const glm::vec4 sample = driverSamples(
        studio_.executor(), theirs,
        {.minification = GL_LINEAR_MIPMAP_LINEAR, .magnification = GL_LINEAR, .wrap = GL_REPEAT}, points)[0];
    const glm::vec4 color = sampleTexture(ours, {}, points[0]).color;
    for (int c = 0; c < 4; ++c)
        EXPECT_NEAR(sample[c], color[c], 1e-5);
}

TEST_P(TextureFiltering12, FloorIsTheSameByOurUnit) {
    for (const auto filter : {Lab12::Filter::nearest, Lab12::Filter::bilinear, Lab12::Filter::mipmapped,
                              Lab12::Filter::trilinear, Lab12::Filter::anisotropic}) {
        lab_.minification.set(static_cast<int>(filter));
        lab_.unit.parse("opengl");
        const Image drawn = picture(small);
        lab_.unit.parse("cpu");
        const Image made = picture(small);
        // Bytes are blended in steps of 1/128 (the driver), and a place that rounds to another texel or level
        // shows in full: nearest texels and nearest levels differ at some pixels. Measured: 0.0017, 0.0012,
        // 0.0017, 0.0009, 0.0010.
        EXPECT_LE(rmse(made, drawn), 0.004) << lab_.minification.text();
        EXPECT_TRUE(isFinite(drawn));
    }
}

TEST_P(TextureFiltering12, PhotoIsTheSameByOurUnitWithEveryKernelAndWrap) {
    lab_.view.parse("photo");
    for (const char* photo : {"waves", "edge"}) {
        lab_.photo.parse(photo);
        lab_.textureSize.set(21);  // odd, for the sinc's other formula
        lab_.zoom.set(1);          // with what is beyond the edges
        lab_.centreS.set(0.9f);
        for (const std::string& kernel : lab_.magnification.options())
            for (const std::string& wrap : lab_.wrap.options()) {
                lab_.magnification.parse(kernel);
                lab_.wrap.parse(wrap);
                lab_.unit.parse("opengl");
                const Image drawn = picture(small);
                lab_.unit.parse("cpu");
                // Waves are floats: what is left is the sines' rounding. The step is sRGB bytes, which the
                // driver decodes by a polynomial (measured: 9.6e-4), and its bilinear filter blends in steps
                // of 1/128.
                const bool step = std::string(photo) == "edge";
                EXPECT_LE(rmse(picture(small), drawn), kernel == "nearest" ? 0.02
                                                       : step              ? 0.004
                                                                           : 2e-4)
                    << photo << " " << kernel << " " << wrap;
            }
    }
}

TEST_P(TextureFiltering12, TexelsAreCountedAsOurUnitReadsThem) {
    const Frame view = frame({40, 30});
    for (const auto filter : {Lab12::Filter::nearest, Lab12::Filter::bilinear, Lab12::Filter::mipmapped,
                              Lab12::Filter::trilinear, Lab12::Filter::anisotropic})
        for (const float bias : {0.0f, -1.5f, 2.0f}) {
            lab_.minification.set(static_cast<int>(filter));
            lab_.lodBias.set(bias);
            studio_.linearPicture(lab_, view);
            const FloorView floor = lab_.floorView(view.camera, view.width, view.height);
            std::uint64_t texels = 0;
            for (int y = 0; y < view.height; ++y)
                for (int x = 0; x < view.width; ++x)
                    if (const FloorView::Place place = floor.at({x + 0.5, y + 0.5}); place.floor)
                        texels += static_cast<std::uint64_t>(
                            sampleTexture(lab_.texture(), lab_.sampler(), place.point()).texels);
            EXPECT_EQ(lab_.counters().at("texels read"), texels) << lab_.minification.text() << " " << bias;
        }
    lab_.minification.parse("driver");
    studio_.linearPicture(lab_, view);
    EXPECT_TRUE(lab_.counters().empty()) << "what the driver's own filter reads is not known";
    lab_.view.parse("photo");
    lab_.photo.parse("waves");
    for (const auto& [kernel, texels] : {std::pair("nearest", 40u * 30), std::pair("tent", 40u * 30 * 4),
                                         std::pair("mitchell", 40u * 64 * 4 + 40 * 30 * 4),
                                         std::pair("sinc", 40u * 64 * 64 + 40 * 30 * 64)}) {
        lab_.magnification.parse(kernel);
        studio_.linearPicture(lab_, view);
        EXPECT_EQ(lab_.counters().at("texels read"), texels) << kernel;
    }
}

TEST_P(TextureFiltering12, DifferenceIsDarkWhereTheUnitsAgree) {
    lab_.unit.parse("difference");
    const Image map = picture(small);
    double mean = 0;
    for (std::size_t i = 0; i < map.pixelCount(); ++i)
        mean += map.data[4 * i] / static_cast<double>(map.pixelCount());
    EXPECT_LT(mean, 0.1);
    // The sky has no texture: nothing there.
    EXPECT_LT(map.pixel(5, 2)[0], 1e-3);
}

TEST_P(TextureFiltering12, BlocksAreReadAsWeDecodeThem) {
    lab_.pattern.parse("bricks");
    for (const char* storage : {"bc1", "bc4"}) {
        lab_.storage.parse(storage);
        lab_.mipmaps.parse("box");
        picture(small);
        const Image8 theirs = gl::readLevel8(lab_.deviceTexture(), 0);
        const Image8 base = brickTexture(64, 8, 7);
        Image8 source = base;
        const bool grey = lab_.storage.as<Lab12::Storage>() == Lab12::Storage::bc4;
        const Image8 ours =
            decompressBlocks(compressBlocks(source, grey ? BlockFormat::bc4 : BlockFormat::bc1));
        int worst = 0;
        for (std::size_t i = 0; i < ours.pixelCount(); ++i)
            for (int c = 0; c < ours.channels; ++c)
                worst = std::max(worst, std::abs(theirs.data[4 * i + static_cast<std::size_t>(c)] -
                                                 ours.data[i * static_cast<std::size_t>(ours.channels) +
                                                           static_cast<std::size_t>(c)]));
        // Steps between the endpoints are rounded as each decoder likes.
        EXPECT_LE(worst, 1) << storage;
        // 4 bits a texel, against 24 for bytes.
        EXPECT_EQ(gl::levelMemory(lab_.deviceTexture(), 0).bytes, 64u * 64 / 2);
    }
}

TEST_P(TextureFiltering12, EveryStorageAndEveryChainShowTheSameFloor) {
    const Image plain = picture(small);
    for (const char* storage : {"bc1", "bc7"}) {
        lab_.storage.parse(storage);
        EXPECT_LE(rmse(plain, picture(small)), 0.02) << storage;
    }
    lab_.storage.parse("rgba8");
    for (const char* mipmaps : {"kaiser", "lanczos", "driver", "codes"}) {
        lab_.mipmaps.parse(mipmaps);
        EXPECT_LE(rmse(plain, picture(small)), 0.03) << mipmaps;
    }
}

TEST_P(TextureFiltering12, EveryViewIsFiniteWithTheSmallestTextures) {
    lab_.textureSize.set(1);
    for (const std::string& view : lab_.view.options())
        for (const bool compare : {false, true}) {
            lab_.view.parse(view);
            lab_.compare.set(compare);
            for (const Size size : {Size{1, 1}, Size{3, 40}, Size{64, 48}})
                EXPECT_TRUE(isFinite(picture(size))) << view << " " << size.width << "x" << size.height;
        }
}

TEST_P(TextureFiltering12, CameraOnUnderAndAlongTheFloorGivesFinitePictures) {
    for (const float eye : {-1.0f, 0.0f, 1e-30f, 1e-6f, 1e6f})
        for (const glm::vec3 target : {glm::vec3(0, 0, -5), glm::vec3(0, 1e3f, -5), glm::vec3(0, -1e7f, 0)})
            for (const std::string& filter : lab_.minification.options()) {
                lab_.minification.parse(filter);
                Frame view = frame({24, 18});
                view.camera.worldFromCamera = lookAt({0, eye, 0}, target, {0, 1, 0});
                for (const char* unit : {"opengl", "cpu"}) {
                    lab_.unit.parse(unit);
                    EXPECT_TRUE(isFinite(studio_.linearPicture(lab_, view)))
                        << eye << " to " << target.y << " " << filter << " " << unit;
                }
            }
}

TEST_P(TextureFiltering12, MagnifiedFloorIsNotChangedByMipmaps) {
    lab_.repeats.set(0.01f);
    lab_.textureSize.set(8);
    Frame view = frame(small);
    view.camera.worldFromCamera = lookAt({0, 2, 0}, {0, 0, -0.1f}, {0, 1, 0});
    lab_.minification.parse("bilinear");
    const Image without = studio_.linearPicture(lab_, view);
    // llvmpipe's own anisotropic filter is an ellipse of weights on magnified pixels too, and left out.
    for (const char* filter : {"mipmapped", "trilinear", "anisotropic"}) {
        lab_.minification.parse(filter);
        EXPECT_EQ(studio_.linearPicture(lab_, view), without) << filter;
    }
}

/// How much of its limit a picture's error takes: above 1, a test would fail.
struct Mutation {
    const char* file;
    const char* from;
    const char* to;
    const char* view;
};

constexpr Mutation mutations[] = {
    {"floor.frag", "max(narrow, longTexels / float(probes))", "longTexels", "floor"},
    {"floor.frag", "- 0.5) * longAxis", "+ 0.5) * longAxis", "floor"},
    {"floor.frag", "abs(x.x * y.y - x.y * y.x)", "abs(x.x * y.y)", "floor turned"},
    {"floor.frag", "repeats * reach / ray.y", "repeats * reach", "floor"},
    {"enlarge.frag", "(7.0 * x - 12.0)", "(6.0 * x - 12.0)", "mitchell"},
    {"enlarge.frag", "sincOf(x) * sincOf(x / float(lobes))", "sincOf(x)", "lanczos"},
    {"enlarge.frag", "period % 2 == 0 ? tan(part)", "period % 2 == 0 ? sin(part)", "sinc"},
    {"enlarge.frag", "- 0.5;", ";", "mitchell"},
    {"window.frag", "1.0 - at.y", "at.y", "tent"},
};

TEST(TextureFiltering12Mutations, EachBreakIsSeen) {
    const auto verdict = [](Studio& studio, const std::string& view) {
        Lab12 lab;
        lab.textureSize.set(64);
        lab.compare.set(false);
        Frame frame = studio.frame(lab, small.width, small.height);
        double limit = 0.004;
        if (view.starts_with("floor")) {
            if (view == "floor turned")
                frame.camera.worldFromCamera =
                    frame.camera.worldFromCamera * glm::rotate(glm::mat4(1), 0.6f, glm::vec3(0, 0, 1));
        } else {
            lab.view.parse("photo");
            lab.photo.parse("waves");
            lab.magnification.parse(view);
            limit = 2e-4;
        }
        const Image drawn = studio.linearPicture(lab, frame);
        lab.unit.parse("cpu");
        return rmse(studio.linearPicture(lab, frame), drawn) / limit;
    };
    Studio whole(gl::Backend::egl);
    for (const char* view : {"floor", "floor turned", "mitchell", "lanczos", "sinc", "tent"})
        EXPECT_LE(verdict(whole, view), 1) << view;
    for (const Mutation& mutation : mutations) {
        const test::BrokenShaders broken(std::string("labs/12_texture_filtering/") + mutation.file,
                                         mutation.from, mutation.to);
        ASSERT_TRUE(broken.found()) << mutation.file << " no longer holds: " << mutation.from;
        Studio studio(gl::Backend::egl);  // with no program cached
        EXPECT_GT(verdict(studio, mutation.view), 1)
            << mutation.file << ": " << mutation.from << " -> " << mutation.to;
    }
}

TEST(TextureFiltering12Answers, HoldOnEveryQuestion) {
    Lab12 lab;
    Studio studio(gl::Backend::egl);
    test::expectAnswersHold(lab, studio, {9, 11, 39, 61, 62, 63, 76, 89, 98});
}

TEST(TextureFiltering12Sweeps, FallWithProbesAndWithLobes) {
    Lab12 lab;
    Studio studio(gl::Backend::egl);
    const TimingLimit once;
    for (const Sweep& sweep : lab.sweeps()) {
        if (sweep.name == "floor-checker")
            continue;  // the same points on another texture
        EXPECT_GE(sweep.points.size(), 8u);
        const Frame frame = studio.frame(lab, 64, 48);
        double last = std::numeric_limits<double>::infinity();
        const KnobScope scope(lab.knobs());
        for (const KnobValues& point : sweep.points) {
            lab.knobs().set(point);
            const std::string& filter = point[0].second;
            if (filter != "anisotropic" && filter != "lanczos")
                continue;
            const SweepSample sample = sweep.measure(studio, frame);
            // 64×48 pixels: the last doublings change next to nothing.
            EXPECT_LE(sample.error, 1.02 * last) << sweep.name << " " << filter << " " << point[1].second;
            EXPECT_GT(sample.seconds, 0);
            last = sample.error;
        }
        EXPECT_LT(last, 0.02) << sweep.name;
    }
}

TEST(TextureFiltering12HardCases, KeepTheirBounds) {
    Lab12 lab;
    test::expectStressHolds(lab, 500);
}

TEST(TextureFiltering12Files, PicturesFromFilesAreShownAndHugeOnesReducedWithALine) {
    const test::TemporaryFolder folder;
    Image8 wide(5000, 2, 3, Encoding::srgb);
    std::fill(wide.data.begin(), wide.data.end(), std::uint8_t{200});
    writeImage(folder / "wide.png", wide);
    Lab12 lab;
    Studio studio(gl::Backend::egl);
    lab.pattern.parse("file");
    EXPECT_THROW(studio.picture(lab, studio.frame(lab, 16, 12)), InputError);
    lab.file.set((folder / "none.png").string());
    EXPECT_THROW(studio.picture(lab, studio.frame(lab, 16, 12)), InputError);
    lab.file.set((folder / "wide.png").string());
    testing::internal::CaptureStderr();
    const Image shown = studio.linearPicture(lab, studio.frame(lab, 16, 12));
    EXPECT_NE(testing::internal::GetCapturedStderr().find("5000×2 texels are reduced to 2500×1"),
              std::string::npos);
    EXPECT_TRUE(isFinite(shown));
    EXPECT_EQ(lab.deviceTexture().width(), 2500);
}

TEST(TextureFiltering12Backends, DrawTheSameBits) {
    std::vector<test::MakeLab> makers;
    for (const char* view : {"floor", "photo", "quad", "footprint", "pyramid"})
        makers.push_back([view] {
            auto lab = std::make_unique<Lab12>();
            lab->view.parse(view);
            lab->photo.parse("edge");
            lab->textureSize.set(64);
            return lab;
        });
    test::expectSameBitsOnBothBackends(makers, {small, {160, 90}});
}

TEST(TextureFiltering12Goldens, LookAsTheyDid) {
    Studio studio(gl::Backend::egl);
    for (const char* view : {"floor", "photo", "footprint"}) {
        Lab12 lab;
        lab.view.parse(view);
        lab.textureSize.set(96);
        test::expectGolden(studio.picture(lab, studio.frame(lab, 240, 120)), "12_texture_filtering", view);
    }
}

}  // namespace
}  // namespace quincunx
