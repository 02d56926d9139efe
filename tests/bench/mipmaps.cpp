// Our chain of mipmaps beside OpenImageIO's, of 8-bit sRGB RGBA, with the same filters: time as a ratio, and
// how many codes the two are apart. OpenImageIO decodes to float, resizes from level to level, and encodes
// each level; the row "resize alone" leaves its decoding and encoding out, which is less work than ours.

#include "image/mipmaps.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>
#include <benchmark/benchmark.h>

#include "base/random.h"

namespace quincunx {
namespace {

int side = 4096;

/// Smooth shapes with noise: what textures are like.
const Image8& base() {
    static const Image8 image = [] {
        Image8 made(side, side, 4, Encoding::srgb);
        Random random(1);
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x)
                for (int c = 0; c < 4; ++c)
                    made.pixel(x, y)[c] = static_cast<std::uint8_t>(
                        std::clamp(128 + 90 * std::sin(0.01 * x * (c + 1) + 0.003 * y) +
                                       static_cast<double>(random.below(75)) - 37,
                                   0.0, 255.0));
        return made;
    }();
    return image;
}

MipmapParams paramsOf(const std::string& filter) {
    MipmapParams params;
    params.filter = filter == "box" ? MipFilter::box : MipFilter::lanczos;
    return params;
}

using OIIO::ImageBuf;

ImageBuf peersBase() {
    const OIIO::ImageSpec spec(side, side, 4, OIIO::TypeDesc::UINT8);
    return {spec, const_cast<std::uint8_t*>(base().data.data())};
}

/// Levels of linear floats.
std::vector<ImageBuf> peersResize(const ImageBuf& linear, const std::string& filter) {
    std::vector<ImageBuf> levels;
    const ImageBuf* above = &linear;
    levels.reserve(32);
    while (above->spec().width > 1) {
        const int half = above->spec().width / 2;
        levels.push_back(
            OIIO::ImageBufAlgo::resize(*above, filter, 0, OIIO::ROI(0, half, 0, half, 0, 1, 0, 4)));
        above = &levels.back();
    }
    return levels;
}

ImageBuf peersLinear() {
    // false: alpha is not taken for premultiplied.
    return OIIO::ImageBufAlgo::colorconvert(OIIO::ImageBufAlgo::copy(peersBase(), OIIO::TypeDesc::FLOAT),
                                            "sRGB", "linear", false);
}

std::vector<Image8> peersLevels(const std::string& filter) {
    std::vector<Image8> result;
    for (const ImageBuf& level : peersResize(peersLinear(), filter)) {
        const ImageBuf coded = OIIO::ImageBufAlgo::colorconvert(level, "linear", "sRGB", false);
        Image8& image = result.emplace_back(level.spec().width, level.spec().height, 4, Encoding::srgb);
        coded.get_pixels(OIIO::ROI(), OIIO::TypeDesc::UINT8, image.data.data());
    }
    return result;
}

int codesApart(const std::string& filter) {
    const std::vector<Image8> ours = makeMipmaps(base(), paramsOf(filter));
    const std::vector<Image8> theirs = peersLevels(filter == "box" ? "box" : "lanczos3");
    int worst = 0;
    for (std::size_t i = 0; i < ours.size(); ++i)
        for (std::size_t k = 0; k < ours[i].data.size(); ++k)
            worst = std::max(worst, std::abs(ours[i].data[k] - theirs[i].data[k]));
    return worst;
}

class Reporter : public benchmark::ConsoleReporter {
  public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs)
            if (run.run_type == Run::RT_Aggregate && run.aggregate_name == "median")
                seconds[run.run_name.function_name] = run.GetAdjustedRealTime();
    }
    std::map<std::string, double> seconds;
};

}  // namespace
}  // namespace quincunx

int main(int argc, char** argv) {
    using namespace quincunx;
    benchmark::Initialize(&argc, argv);
    if (argc > 1)
        side = std::atoi(argv[1]);
    base();
    const OIIO::ImageBuf linear = peersLinear();
    for (const std::string filter : {"box", "lanczos"}) {
        const std::string theirs = filter == "box" ? "box" : "lanczos3";
        const auto add = [&](const std::string& name, auto work) {
            benchmark::RegisterBenchmark((filter + "/" + name).c_str(),
                                         [work](benchmark::State& state) {
                                             for (auto _ : state)
                                                 work();
                                         })
                ->Unit(benchmark::kMillisecond)
                ->UseRealTime()
                ->Iterations(1)
                ->Repetitions(5)
                ->ReportAggregatesOnly();
        };
        add("ours", [filter] { benchmark::DoNotOptimize(makeMipmaps(base(), paramsOf(filter))); });
        add("OpenImageIO", [theirs] { benchmark::DoNotOptimize(peersLevels(theirs)); });
        add("OpenImageIO, resize alone",
            [theirs, &linear] { benchmark::DoNotOptimize(peersResize(linear, theirs)); });
    }
    Reporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    std::printf("\n%d x %d, 8-bit sRGB RGBA\n%-10s %10s %12s %14s %10s %14s %12s\n", side, side, "filter",
                "ours ms", "OpenImageIO", "resize alone", "ratio", "ratio, resize", "codes apart");
    bool agree = true;
    for (const std::string filter : {"box", "lanczos"}) {
        const double ours = reporter.seconds[filter + "/ours"];
        const double theirs = reporter.seconds[filter + "/OpenImageIO"];
        const double resize = reporter.seconds[filter + "/OpenImageIO, resize alone"];
        const int apart = codesApart(filter);
        agree = agree && apart <= 1;
        std::printf("%-10s %10.1f %12.1f %14.1f %9.2fx %13.2fx %12d\n", filter.c_str(), ours, theirs, resize,
                    ours / theirs, ours / resize, apart);
    }
    return agree ? 0 : 1;
}
