#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "base/interrupt.h"
#include "base/random.h"
#include "base/timing.h"
#include "image/color.h"
#include "image/compare.h"
#include "lab/studio.h"
#include "labs/12_texture_filtering/driver_samples.h"
#include "labs/12_texture_filtering/lab.h"

namespace quincunx {
namespace {

using Lab12 = TextureFilteringLab;

constexpr int width = 96;
constexpr int height = 72;
constexpr int referenceSide = 32;  // 1024 samples a pixel

/// The floor, one filter, small enough to be measured in a moment.
void showFloor(Lab12& lab) {
    for (Knob* knob : lab.knobs().all())
        knob->reset();
    lab.compare.set(false);
    lab.textureSize.set(256);
}

/// The same for all questions: made by the first that asks.
const Image& floorTruth(const Lab12& lab, const Frame& frame, Image& truth) {
    if (truth.data.empty())
        truth = floorReference(lab.texture(), TextureWrap::repeat,
                               lab.floorView(frame.camera, frame.width, frame.height), referenceSide,
                               interruptFlag());
    throwIfInterrupted();
    return truth;
}

double minificationError(Lab12& lab, Studio& studio, const Frame& frame, Lab12::Filter filter,
                         const Image& truth) {
    lab.minification.set(static_cast<int>(filter));
    return rmse(truth, studio.linearPicture(lab, frame));
}

std::vector<Measurement> measureAnisotropy(Studio& studio, Image& made) {
    Lab12 lab;
    showFloor(lab);
    const Frame frame = studio.frame(lab, width, height);
    const Image& truth = floorTruth(lab, frame, made);
    std::vector<Measurement> figures;
    const double trilinear = minificationError(lab, studio, frame, Lab12::Filter::trilinear, truth);
    const double trilinearSeconds = studio.time(lab, frame, 5, 1).medianSeconds;
    figures.push_back({"trilinear: RMSE against 1024 samples a pixel", trilinear, "", {}});
    const FloorView view = lab.floorView(frame.camera, width, height);
    double last = trilinear;
    bool falls = true;
    FloorCounts counts;
    for (const int most : {1, 2, 4, 8, 16}) {
        lab.maxAnisotropy.set(most);
        const double error = minificationError(lab, studio, frame, Lab12::Filter::anisotropic, truth);
        figures.push_back({fmt::format("at most {} probes: RMSE", most), error, "", {}});
        figures.push_back({fmt::format("at most {} probes: time over trilinear's", most),
                           studio.time(lab, frame, 5, 1).medianSeconds / trilinearSeconds,
                           "times",
                           {}});
        falls = falls && error <= last;
        last = error;
        counts = countFloor(lab.texture(), lab.sampler(), view);
        figures.push_back({fmt::format("at most {} probes: probes of a pixel, mean", most),
                           static_cast<double>(counts.probes) / static_cast<double>(counts.samples),
                           "",
                           {}});
    }
    figures.push_back({"each doubling is at least as near to the truth", falls ? 1.0 : 0.0, "", equals(1)});
    // Measured 2.5: a claim of "clearly nearer" leaves room for another driver's trilinear filter.
    figures.push_back({"trilinear's RMSE over that of 16 probes", trilinear / last, "times", atLeast(1.5)});
    figures.push_back({"texels that one pixel reads with 16 probes, at most",
                       static_cast<double>(counts.mostTexels), "", atMost(16 * 8)});
    // The level where the probes are not too few: that of the short axis.
    double worst = 0;
    for (int y = 0; y < height; ++y) {
        const FloorView::Place place = view.at({0.5 * width, y + 0.5});
        if (!place.floor)
            continue;
        const Footprint footprint = footprintOf(place.point(), 256, 256, 16);
        if (footprint.probes > 1 && footprint.probes < 16 && footprint.shortTexels >= 1)
            worst = std::max(worst, std::abs(footprint.lambda - std::log2(footprint.shortTexels)));
    }
    figures.push_back({"level against log2 of the short axis, worst", worst, "levels", atMost(1e-9)});
    return figures;
}

std::vector<Measurement> measureQuad(Studio& studio) {
    Lab12 lab;
    lab.view.set(static_cast<int>(Lab12::View::quad));
    const Frame frame = studio.frame(lab, 640, 480);
    const auto count = [&] {
        const Lab12::QuadLayout quad = lab.quadLayout(frame);
        const Image8 picture = studio.picture(lab, frame);
        const auto isLight = [&](int x, int yUp) {
            return picture.pixel(quad.left + x, frame.height - 1 - quad.bottom - yUp)[1] > 127;
        };
        int across = 1;
        for (int x = 1; x < quad.width; ++x)
            across += isLight(x, 1) != isLight(x - 1, 1) ? 1 : 0;
        int up = 1;
        for (int y = 1; y < quad.height; ++y)
            up += isLight(1, y) != isLight(1, y - 1) ? 1 : 0;
        return glm::ivec2(across, up);
    };
    const glm::ivec2 asked = count();
    lab.quadU.set(1);
    lab.quadV.set(1);
    const glm::ivec2 once = count();
    return {{"squares counted across, u to 2", static_cast<double>(asked.x), "", equals(8)},
            {"squares counted up, v to 4", static_cast<double>(asked.y), "", equals(16)},
            {"squares across with u to 1", static_cast<double>(once.x), "", equals(4)},
            {"squares up with v to 1", static_cast<double>(once.y), "", equals(4)}};
}

std::vector<Measurement> measureMemory(Studio& studio) {
    studio.context();
    std::vector<Measurement> figures;
    struct Case {
        int width;
        int height;
        Bound bound;
    };
    // 1/4 + 1/16 + … + 4^-n = (1 - 4^-n) / 3. Long textures halve one side only once the other is 1.
    for (const Case& one : {Case{1024, 1024, equals((1 - std::exp2(-20)) / 3, 1e-9)},
                            Case{1024, 256, equals(1.0 / 3, 0.005)}, Case{1000, 600, equals(1.0 / 3, 0.005)},
                            Case{333, 77, equals(1.0 / 3, 0.015)}, Case{1024, 1, equals(1, 1e-3)}}) {
        const gl::Texture2D texture("measured", Image8(one.width, one.height, 4, Encoding::srgb));
        double levels = 0;
        for (int level = 1; level < mipLevelCount(one.width, one.height); ++level)
            levels += static_cast<double>(gl::levelMemory(texture, level).bytes);
        figures.push_back(
            {fmt::format("{}×{}: bytes of the other levels over the base's", one.width, one.height),
             levels / static_cast<double>(gl::levelMemory(texture, 0).bytes), "", one.bound});
    }
    return figures;
}

Frame wavesFrame(Lab12& lab, Studio& studio) {
    for (Knob* knob : lab.knobs().all())
        knob->reset();
    lab.view.set(static_cast<int>(Lab12::View::photo));
    lab.photo.set(static_cast<int>(Lab12::Photo::waves));
    lab.compare.set(false);
    return studio.frame(lab, width, height);
}

double magnificationError(Lab12& lab, Studio& studio, const Frame& frame, Magnification kernel) {
    lab.magnification.set(static_cast<int>(kernel));
    return rmse(lab.reference(frame)(interruptFlag()), studio.linearPicture(lab, frame));
}

int texelsOfOne(const MipTexture& texture, Magnification kernel) {
    SamplerSettings settings;
    settings.magnification = kernel;
    return sampleTexture(texture, settings, {.st = {0.3f, 0.7f}, .alongX = {1e-6f, 0}, .alongY = {0, 1e-6f}})
        .texels;
}

/// How far an enlarged step from 0 to 1 goes beyond 1.
double overshoot(Magnification kernel) {
    constexpr int side = 64;
    Image step(side, 1, 4, Encoding::linear);
    for (int x = 0; x < side; ++x)
        std::fill_n(step.pixel(x, 0), 4, 2 * x < side ? 0.0f : 1.0f);
    SamplerSettings settings;
    settings.magnification = kernel;
    const Image enlarged = enlarge(MipTexture(std::vector<Image>{step}), settings, {}, 32 * side, 1);
    return *std::max_element(enlarged.data.begin(), enlarged.data.end()) - 1.0;
}

std::vector<Measurement> measureEnlarging(Studio& studio) {
    Lab12 lab;
    const Frame frame = wavesFrame(lab, studio);
    std::vector<Measurement> figures;
    std::array<double, 5> errors{};
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const auto kernel = static_cast<Magnification>(i);
        errors[i] = magnificationError(lab, studio, frame, kernel);
        figures.push_back(
            {fmt::format("{}: RMSE on the band-limited picture", lab.magnification.options()[i]),
             errors[i],
             "",
             {}});
        figures.push_back({fmt::format("{}: texels of one sample", lab.magnification.options()[i]),
                           static_cast<double>(texelsOfOne(lab.texture(), kernel)),
                           "",
                           {}});
    }
    // Float's sines of arguments up to 200, and 64 weights of either sign: measured 3e-6.
    figures.push_back({"the whole sinc: RMSE", errors[4], "", atMost(5e-5)});
    figures.push_back({"tent's error over the whole sinc's", errors[1] / errors[4], "times", atLeast(100)});
    figures.push_back({"Lanczos: tent's error over it", errors[1] / errors[3], "times", atLeast(2)});
    figures.push_back({"at a step, the tent goes beyond by", 100 * overshoot(Magnification::bilinear), "%",
                       equals(0, 1e-4)});
    // Wilbraham and Gibbs: the integral of the sinc to its first zero passes 1 by 8.95%; sampled in the
    // middle between two texels a step of texels passes it by more.
    figures.push_back(
        {"at a step, the whole sinc goes beyond by", 100 * overshoot(Magnification::sinc), "%", atLeast(8)});
    return figures;
}

std::vector<Measurement> measureSincCost() {
    std::vector<Measurement> figures;
    double perTexel = 0;
    for (const int side : {16, 64, 256}) {
        std::vector<Image> levels{Image(side, side, 4, Encoding::linear)};
        const MipTexture texture(std::move(levels));
        const auto timeOf = [&](Magnification kernel, int samples) {
            SamplerSettings settings;
            settings.magnification = kernel;
            Random random(3);
            const Timing timing = timeRuns(5, [&] {
                for (int i = 0; i < samples; ++i)
                    sampleTexture(texture, settings,
                                  {.st = {random.uniform(), random.uniform()}, .alongX = {}, .alongY = {}});
            });
            return timing.medianSeconds / samples;
        };
        const int texels = texelsOfOne(texture, Magnification::sinc);
        const double ratio = timeOf(Magnification::sinc, 4) / timeOf(Magnification::bilinear, 2000);
        figures.push_back({fmt::format("{0}×{0}: texels of one sinc sample", side),
                           static_cast<double>(texels), "", equals(static_cast<double>(side) * side)});
        figures.push_back(
            {fmt::format("{0}×{0}: a sinc sample's time over a tent sample's", side), ratio, "times", {}});
        perTexel = static_cast<double>(texels) / texelsOfOne(texture, Magnification::bilinear);
    }
    figures.push_back({"256×256: texels over the tent's", perTexel, "times", equals(256.0 * 256 / 4)});
    return figures;
}

std::vector<Measurement> measureMinification(Studio& studio, Image& made) {
    Lab12 lab;
    showFloor(lab);
    const Frame frame = studio.frame(lab, width, height);
    const Image& truth = floorTruth(lab, frame, made);
    std::array<double, 5> errors{};
    std::vector<Measurement> figures;
    for (std::size_t i = 0; i < errors.size(); ++i) {
        errors[i] = minificationError(lab, studio, frame, static_cast<Lab12::Filter>(i), truth);
        figures.push_back({fmt::format("{}: RMSE", lab.minification.options()[i]), errors[i], "", {}});
    }
    using enum Lab12::Filter;
    const auto over = [&](Lab12::Filter a, Lab12::Filter b) {
        return errors[static_cast<std::size_t>(a)] / errors[static_cast<std::size_t>(b)];
    };
    figures.push_back({"nearest over bilinear", over(nearest, bilinear), "times", atLeast(1)});
    figures.push_back({"bilinear over trilinear", over(bilinear, trilinear), "times", atLeast(1)});
    figures.push_back({"trilinear over anisotropic", over(trilinear, anisotropic), "times", atLeast(1.5)});
    return figures;
}

std::vector<Measurement> measureMagnification(Studio& studio) {
    Lab12 lab;
    const Frame frame = wavesFrame(lab, studio);
    const double nearest = magnificationError(lab, studio, frame, Magnification::nearest);
    const double tent = magnificationError(lab, studio, frame, Magnification::bilinear);
    // A floor whose texels are larger than pixels everywhere that one sees.
    showFloor(lab);
    lab.textureSize.set(16);
    lab.repeats.set(0.02f);
    Frame close = studio.frame(lab, width, height);
    close.camera.worldFromCamera[1] = {0, 0, -1, 0};
    close.camera.worldFromCamera[2] = {0, 1, 0, 0};
    close.camera.worldFromCamera[0] = {1, 0, 0, 0};
    lab.minification.set(static_cast<int>(Lab12::Filter::bilinear));
    const Image without = studio.linearPicture(lab, close);
    double changed = 0;
    for (const auto filter :
         {Lab12::Filter::mipmapped, Lab12::Filter::trilinear, Lab12::Filter::anisotropic}) {
        lab.minification.set(static_cast<int>(filter));
        const Image with = studio.linearPicture(lab, close);
        for (std::size_t i = 0; i < with.data.size(); ++i)
            changed += with.data[i] != without.data[i] ? 1 : 0;
    }
    // Forced to a coarser level, the same pixels lose detail.
    lab.minification.set(static_cast<int>(Lab12::Filter::trilinear));
    lab.lodBias.set(4);
    lab.repeats.set(0.5f);
    const Image coarse = studio.linearPicture(lab, close);
    lab.lodBias.set(0);
    const double lost = rmse(studio.linearPicture(lab, close), coarse);
    return {{"nearest: RMSE on the band-limited picture", nearest, "", {}},
            {"bilinear: RMSE on the band-limited picture", tent, "", {}},
            {"nearest over bilinear", nearest / tent, "times", atLeast(1.5)},
            {"channels that mipmaps change in a magnified picture", changed, "", equals(0)},
            {"RMSE where a coarser level is forced on magnified pixels", lost, "", atLeast(0.001)}};
}

/// The mean of the texels of level 0 that a texel of the next one covers, in double, as a code.
double exactMeanCode(const Image& linear, int x, int y, int channel) {
    const auto shares = [](int i, int side) {
        const int half = mipSide(side, 1);
        const double low = static_cast<double>(i) * side / half;
        const double high = static_cast<double>(i + 1) * side / half;
        std::vector<std::pair<int, double>> all;
        for (int k = static_cast<int>(low); k < high; ++k)
            all.emplace_back(k, (std::min<double>(high, k + 1) - std::max<double>(low, k)) / (high - low));
        return all;
    };
    double mean = 0;
    for (const auto& [row, weightY] : shares(y, linear.height))
        for (const auto& [column, weightX] : shares(x, linear.width))
            mean += weightX * weightY * linear.pixel(column, row)[channel];
    return 255 * (mean <= 0.0031308 ? 12.92 * mean : 1.055 * std::pow(mean, 1 / 2.4) - 0.055);
}

std::vector<Measurement> measureLevels(Studio& studio) {
    studio.context();
    std::vector<Measurement> figures;
    struct Case {
        int width;
        int height;
    };
    for (const Case& one : {Case{256, 256}, Case{255, 131}, Case{301, 1}}) {
        Image8 base(one.width, one.height, 3, Encoding::srgb);
        Random random(63);
        for (std::uint8_t& code : base.data)
            code =
                static_cast<std::uint8_t>(random.below(2) == 0 ? random.below(256) : random.below(2) * 255);
        const std::vector<Image8> levels = makeMipmaps(base);
        const Image linear = toLinear(base);
        double worst = 0;
        for (int y = 0; y < levels[0].height; ++y)
            for (int x = 0; x < levels[0].width; ++x)
                for (int c = 0; c < 3; ++c)
                    worst =
                        std::max(worst, std::abs(levels[0].pixel(x, y)[c] - exactMeanCode(linear, x, y, c)));
        // Half a code, and what the standard's rounded constants and a float of 2^-24 add.
        figures.push_back({fmt::format("{}×{}: level 1 against exact means, worst", one.width, one.height),
                           worst, "codes", atMost(0.501)});
        double mean = 0;
        for (std::size_t i = 0; i < linear.data.size(); i += 3)
            mean += linear.data[i] / static_cast<double>(linear.pixelCount());
        figures.push_back(
            {fmt::format("{}×{}: the last level's red against the mean of the base", one.width, one.height),
             std::abs(levels.back().data[0] - 255 * (1.055 * std::pow(mean, 1 / 2.4) - 0.055)), "codes",
             atMost(0.501)});
        const gl::Texture2D driver("measured", base);
        double apart = 0;
        const Image8 theirs = gl::readLevel8(driver, 1);
        for (int y = 0; y < theirs.height; ++y)
            for (int x = 0; x < theirs.width; ++x)
                apart = std::max(
                    apart, std::abs(static_cast<double>(theirs.pixel(x, y)[0]) - levels[0].pixel(x, y)[0]));
        const bool even = one.width % 2 == 0 && one.height % 2 == 0;
        figures.push_back(
            {fmt::format("{}×{}: the driver's level 1 against ours, worst", one.width, one.height), apart,
             "codes", even ? std::optional<Bound>(atMost(1)) : std::nullopt});
    }
    // A checker of black and white: half the light is code 188, half the code 128.
    const Image8 half = checkerTexture(2, 2, 2, 2);
    MipmapParams inCodes;
    inCodes.linearLight = false;
    const double light =
        0.5 * (static_cast<double>(linearOfCode()[half.data[0]]) + linearOfCode()[half.data[3]]);
    figures.push_back({"a checker's mean light by averaging codes, over the right one",
                       linearOfCode()[makeMipmaps(half, inCodes)[0].data[0]] / light, "times", atMost(0.9)});
    return figures;
}

std::vector<Measurement> measureTrilinear(Studio& studio) {
    studio.context();
    constexpr int side = 64;
    Random random(98);
    std::vector<Image> floats;
    for (int level = 0; level < mipLevelCount(side, side); ++level) {
        Image& image = floats.emplace_back(mipSide(side, level), mipSide(side, level), 4, Encoding::linear);
        for (float& value : image.data)
            value = random.uniform();
    }
    std::vector<Image8> bytes;
    for (const Image& level : floats) {
        Image8& image = bytes.emplace_back(level.width, level.height, 4, Encoding::linear);
        std::transform(level.data.begin(), level.data.end(), image.data.begin(),
                       [](float value) { return static_cast<std::uint8_t>(255 * value); });
    }
    std::vector<TexturePoint> points;
    std::vector<float> lods;
    for (int i = 0; i < 4096; ++i) {
        points.push_back({.st = {random.uniform(-2, 2), random.uniform(-2, 2)}});
        lods.push_back(static_cast<float>(random.uniform(0.01, mipLevelCount(side, side) - 1.01)));
    }
    const SamplerSettings settings;
    const gl::Sampler::Params sampler{
        .minification = GL_LINEAR_MIPMAP_LINEAR, .magnification = GL_LINEAR, .wrap = GL_REPEAT};
    const auto apart = [&](const MipTexture& ours, const gl::Texture2D& theirs, double& notEight) {
        const std::vector<glm::vec4> samples =
            driverSamplesLod(studio.executor(), theirs, sampler, points, lods);
        double worst = 0;
        for (std::size_t i = 0; i < points.size(); ++i) {
            const TextureSample sample =
                sampleTextureLod(ours, settings, points[i].st, static_cast<double>(lods[i]));
            notEight += sample.texels == 8 ? 0 : 1;
            for (int c = 0; c < 4; ++c)
                worst = std::max(worst, std::abs(static_cast<double>(sample.color[c]) - samples[i][c]));
        }
        return worst;
    };
    double notEight = 0;
    const double floatsApart = apart(MipTexture(floats), gl::Texture2D("floats", floats), notEight);
    const double bytesApart = apart(MipTexture(bytes), gl::Texture2D("bytes", bytes), notEight);
    return {{"samples that read another number of texels than 8", notEight, "", equals(0)},
            // Coordinates of up to 2 × 64 texels in float: 2^-17 of a texel, in each direction and at both
            // levels, of differences up to 1; the level's fraction has 2^-21.
            {"32-bit floats: against the driver's sample, worst", floatsApart, "", atMost(4 * 0x1p-17)},
            // Eight-bit textures are weighted in steps of 2^-8 at best; llvmpipe's are 2^-7 in each of three
            // directions, and each of three blends is cut off to a code.
            {"8 bits: against the driver's sample, worst", bytesApart, "", atMost(3.0 / 128 + 3.0 / 255)}};
}

}  // namespace

std::vector<Question> TextureFilteringLab::questions() {
    const auto truth = std::make_shared<Image>();
    return {
        {9, "How does anisotropic filtering work, and what is it needed for?",
         "A pixel of a slanted surface covers a long narrow piece of the texture. A mipmap level has one "
         "size in both directions: taken by the long side it blurs across, by the short side it aliases "
         "along. Anisotropic filtering takes the level by the short side and averages several samples of it "
         "in a row along the long side, as many as the piece is longer than wide, up to a limit (often 16).",
         "the row is of up to 16 probes, each a trilinear sample of up to 8 texels; the level is that of the "
         "short side",
         [truth](Studio& studio) { return measureAnisotropy(studio, *truth); }},
        {11,
         "A quad of 8 × 16 is to show a chessboard texture of 4 × 4 squares, repeated so that its squares "
         "are "
         "1 × 1. With REPEAT, which texture coordinates do the corners get?",
         "The texture spans 4 × 4, so it goes 8 / 4 = 2 times across and 16 / 4 = 4 times up: (0,0), (2,0), "
         "(2,4), (0,4).",
         "", [](Studio& studio) { return measureQuad(studio); }},
        {39, "How much more memory does a texture take with its mipmaps?",
         "A third: each level has a quarter of the texels of the one before, and 1/4 + 1/16 + … = 1/3. "
         "That holds for any sides that are not far from equal; a texture of a single row takes twice as "
         "much, since only one side halves.",
         "", [](Studio& studio) { return measureMemory(studio); }},
        {61, "If a GPU offered the tent and the sinc filter: which enlarges textures best, and why?",
         "The sinc. The texels of a picture without detail finer than two texels determine it at every "
         "point, and the sinc, which weights all of them, gives it back exactly; the tent blurs what is near "
         "the limit and lets copies of the spectrum through, seen as creases. Where a picture does have "
         "sharp edges the sinc rings: there it passes the true value, and ripples.",
         "the sinc is exact for band-limited pictures alone; at edges it overshoots",
         [](Studio& studio) { return measureEnlarging(studio); }},
        {62, "Which filters are common where textures are made smaller?",
         "Nearest texel; bilinear, without or with mipmaps; trilinear, between two levels; anisotropic. Each "
         "comes nearer to the mean over the pixel's area. Without mipmaps a pixel still reads four texels at "
         "most, however many it covers.",
         "", [truth](Studio& studio) { return measureMinification(studio, *truth); }},
        {63, "What is a mipmap hierarchy?",
         "The texture at ever halved sides, down to one texel, each texel the mean of the 2 × 2 texels that "
         "it stands for in the level above. An odd side halves to the whole number below, and its texels "
         "then cover shares of three. The mean must be one of light: of the decoded values, not of codes.",
         "", [](Studio& studio) { return measureLevels(studio); }},
        {76, "Would a sinc filter in the GPU's texture unit be realistic?",
         "No: each sample reads every texel, so its cost grows with the texture. Windowed sincs of a few "
         "lobes come close for a few dozen texels, and where a whole picture is enlarged, the filter can run "
         "along rows and then along columns.",
         "", [](Studio&) { return measureSincCost(); }},
        {89, "Which filters are common where textures are made larger?",
         "Nearest texel (a box) and bilinear (a tent). Mipmaps are of no use: the texture already has fewer "
         "texels than the picture has pixels, and every level below the first has fewer still.",
         "", [](Studio& studio) { return measureMagnification(studio); }},
        {98, "How does trilinear filtering work, and how many texels does one sample need?",
         "The level of detail, a fractional number, lies between two levels of the mipmaps. In each, the "
         "four "
         "texels around the place are blended bilinearly, and the two results linearly by the fraction: 8 "
         "texels. Below the last level and on magnified pixels there is one level, and 4 texels.",
         "", [](Studio& studio) { return measureTrilinear(studio); }},
    };
}

}  // namespace quincunx
