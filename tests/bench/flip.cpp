// FLIP of a 1920 × 1080 pair on one and on two threads, beside a plain implementation: whole pictures in
// passes, three interleaved channels, the library's pow and cbrt, the filters separated but not otherwise
// arranged.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <sys/resource.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include "image/color.h"
#include "image/compare.h"

namespace {

using namespace quincunx;

Image8 picture(bool distorted) {
    Image8 image(1920, 1080, 3, Encoding::srgb);
    std::uint32_t noise = 1;
    for (int y = 0; y < image.height; ++y) {
        for (int x = 0; x < image.width; ++x) {
            noise ^= noise << 13;
            noise ^= noise >> 17;
            noise ^= noise << 5;
            const int grain = distorted ? static_cast<int>(noise >> 27) : 0;
            std::uint8_t* const pixel = image.pixel(x, y);
            const bool checker = ((x / 60 + y / 45) & 1) != 0;
            pixel[0] = static_cast<std::uint8_t>(std::min(255, (x / 8 & 127) + grain));
            pixel[1] = static_cast<std::uint8_t>(std::min(255, (checker ? 200 : 60) + grain));
            pixel[2] = static_cast<std::uint8_t>(std::min(255, (y / 5 & 127) + grain));
        }
    }
    return image;
}

using Triple = std::array<float, 3>;

/// The plain way: one loop nest a step.
class PlainFlip {
  public:
    static double mean(const Image8& reference, const Image8& test) {
        const PlainFlip plain(reference.width, reference.height);
        const std::vector<Triple> colourA = plain.opponent(reference);
        const std::vector<Triple> colourB = plain.opponent(test);
        const std::vector<Triple> labA = plain.filteredLab(colourA);
        const std::vector<Triple> labB = plain.filteredLab(colourB);
        const std::vector<std::array<float, 2>> featureA = plain.features(colourA);
        const std::vector<std::array<float, 2>> featureB = plain.features(colourB);
        double sum = 0;
        for (std::size_t i = 0; i < labA.size(); ++i)
            sum += static_cast<double>(plain.error(labA[i], labB[i], featureA[i], featureB[i]));
        return sum / static_cast<double>(labA.size());
    }

  private:
    static constexpr float pixelsPerDegree = static_cast<float>(3840 * std::numbers::pi / 180);
    static constexpr float toXyz[3][3] = {{0.412386563F, 0.357591491F, 0.180450492F},
                                          {0.212636822F, 0.715182982F, 0.072180196F},
                                          {0.019330620F, 0.119197164F, 0.950372587F}};
    static constexpr float fromXyz[3][3] = {{3.241003275F, -1.537398934F, -0.498615861F},
                                            {-0.969224334F, 1.875930071F, 0.041554224F},
                                            {0.055639423F, -0.204011202F, 1.057148933F}};
    static constexpr float white[3] = {0.950428545F, 1, 1.088900371F};

    PlainFlip(int width, int height) : width_(width), height_(height) {}

    static float decode(float code) {
        return code <= 0.04045F ? code / 12.92F : std::pow((code + 0.055F) / 1.055F, 2.4F);
    }

    static Triple product(const float (&m)[3][3], const Triple& v) {
        Triple result{};
        for (std::size_t row = 0; row < 3; ++row)
            result[row] = m[row][0] * v[0] + m[row][1] * v[1] + m[row][2] * v[2];
        return result;
    }

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(std::clamp(y, 0, height_ - 1)) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(std::clamp(x, 0, width_ - 1));
    }

    template <typename Work>
    void forPixels(Work work) const {
        tbb::parallel_for(0, height_, [&](int y) {
            for (int x = 0; x < width_; ++x)
                work(x, y);
        });
    }

    std::vector<Triple> opponent(const Image8& image) const {
        std::vector<Triple> result(image.pixelCount());
        forPixels([&](int x, int y) {
            const std::uint8_t* const p = image.pixel(x, y);
            Triple xyz =
                product(toXyz, {decode(p[0] / 255.0F), decode(p[1] / 255.0F), decode(p[2] / 255.0F)});
            for (std::size_t i = 0; i < 3; ++i)
                xyz[i] /= white[i];
            result[index(x, y)] = {116 * xyz[1] - 16, 500 * (xyz[0] - xyz[1]), 200 * (xyz[1] - xyz[2])};
        });
        return result;
    }

    std::vector<Triple> filteredLab(const std::vector<Triple>& colours) const {
        const int radius = static_cast<int>(
            std::ceil(3 * std::sqrt(0.04F / (2 * std::numbers::pi_v<float> * std::numbers::pi_v<float>)) *
                      pixelsPerDegree));
        std::vector<std::array<float, 4>> weights;
        std::array<float, 4> sums{};
        for (int i = -radius; i <= radius; ++i) {
            const float x2 = static_cast<float>(i * i) / (pixelsPerDegree * pixelsPerDegree);
            const auto gauss = [&](float a, float b) {
                constexpr float pi = std::numbers::pi_v<float>;
                return std::sqrt(a * std::sqrt(pi / b)) * std::exp(-pi * pi * x2 / b);
            };
            weights.push_back(
                {gauss(1, 0.0047F), gauss(1, 0.0053F), gauss(34.1F, 0.04F), gauss(13.5F, 0.025F)});
            for (std::size_t k = 0; k < 4; ++k)
                sums[k] += weights.back()[k];
        }
        const float sumCz = std::sqrt(sums[2] * sums[2] + sums[3] * sums[3]);
        for (std::array<float, 4>& weight : weights)
            weight = {weight[0] / sums[0], weight[1] / sums[1], weight[2] / sumCz, weight[3] / sumCz};
        std::vector<std::array<float, 4>> rows(colours.size());
        forPixels([&](int x, int y) {
            std::array<float, 4> sum{};
            for (int k = -radius; k <= radius; ++k) {
                const std::array<float, 4>& w = weights[static_cast<std::size_t>(k + radius)];
                const Triple& c = colours[index(x + k, y)];
                sum[0] += w[0] * c[0];
                sum[1] += w[1] * c[1];
                sum[2] += w[2] * c[2];
                sum[3] += w[3] * c[2];
            }
            rows[index(x, y)] = sum;
        });
        std::vector<Triple> result(colours.size());
        forPixels([&](int x, int y) {
            std::array<float, 4> sum{};
            for (int k = -radius; k <= radius; ++k)
                for (std::size_t i = 0; i < 4; ++i)
                    sum[i] += weights[static_cast<std::size_t>(k + radius)][i] * rows[index(x, y + k)][i];
            const float fy = (sum[0] + 16) / 116;
            Triple rgb = product(
                fromXyz, {(fy + sum[1] / 500) * white[0], fy, (fy - (sum[2] + sum[3]) / 200) * white[2]});
            for (float& value : rgb)
                value = std::clamp(value, 0.0F, 1.0F);
            result[index(x, y)] = hunt(rgb);
        });
        return result;
    }

    static Triple hunt(const Triple& rgb) {
        Triple f = product(toXyz, rgb);
        for (std::size_t i = 0; i < 3; ++i) {
            f[i] /= white[i];
            f[i] = f[i] > 216.0F / 24389 ? std::pow(f[i], 1.0F / 3) : f[i] * 841 / 108 + 4.0F / 29;
        }
        const float lightness = 116 * f[1] - 16;
        return {lightness, 0.01F * lightness * 500 * (f[0] - f[1]), 0.01F * lightness * 200 * (f[1] - f[2])};
    }

    std::vector<std::array<float, 2>> features(const std::vector<Triple>& colours) const {
        const float deviation = 0.5F * 0.082F * pixelsPerDegree;
        const int radius = static_cast<int>(std::ceil(3 * deviation));
        std::vector<Triple> weights;
        float sumGauss = 0;
        float sumEdge = 0;
        float positive = 0;
        float negative = 0;
        for (int i = -radius; i <= radius; ++i) {
            const float x = static_cast<float>(i);
            const float gauss = std::exp(-x * x / (2 * deviation * deviation));
            const float point = (x * x / (deviation * deviation) - 1) * gauss;
            weights.push_back({gauss, -x * gauss, point});
            sumGauss += gauss;
            sumEdge += std::abs(x * gauss) / 2;
            (point > 0 ? positive : negative) += std::abs(point);
        }
        for (Triple& weight : weights)
            weight = {weight[0] / sumGauss, weight[1] / sumEdge,
                      weight[2] / (weight[2] > 0 ? positive : negative)};
        std::vector<Triple> rows(colours.size());
        forPixels([&](int x, int y) {
            Triple sum{};
            for (int k = -radius; k <= radius; ++k) {
                const float value = (colours[index(x + k, y)][0] + 16) / 116;
                for (std::size_t i = 0; i < 3; ++i)
                    sum[i] += weights[static_cast<std::size_t>(k + radius)][i] * value;
            }
            rows[index(x, y)] = sum;
        });
        std::vector<std::array<float, 2>> result(colours.size());
        forPixels([&](int x, int y) {
            std::array<float, 4> sum{};
            for (int k = -radius; k <= radius; ++k) {
                const Triple& w = weights[static_cast<std::size_t>(k + radius)];
                const Triple& row = rows[index(x, y + k)];
                sum[0] += w[0] * row[1];
                sum[1] += w[1] * row[0];
                sum[2] += w[0] * row[2];
                sum[3] += w[2] * row[0];
            }
            result[index(x, y)] = {std::sqrt(sum[0] * sum[0] + sum[1] * sum[1]),
                                   std::sqrt(sum[2] * sum[2] + sum[3] * sum[3])};
        });
        return result;
    }

    float error(const Triple& a, const Triple& b, const std::array<float, 2>& featureA,
                const std::array<float, 2>& featureB) const {
        const float raised = std::pow(distance(a, b), 0.7F);
        const float knee = 0.4F * largest_;
        const float colour =
            raised < knee ? raised * 0.95F / knee : 0.95F + 0.05F * (raised - knee) / (largest_ - knee);
        const float feature =
            std::max(std::abs(featureA[0] - featureB[0]), std::abs(featureA[1] - featureB[1]));
        return std::pow(colour, 1 - std::sqrt(feature / std::numbers::sqrt2_v<float>));
    }

    static float distance(const Triple& a, const Triple& b) {
        return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
    }

    int width_;
    int height_;
    float largest_ = std::pow(distance(hunt({0, 1, 0}), hunt({0, 0, 1})), 0.7F);
};

/// Peak of the resident set in MB.
double peakMegabytes() {
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<double>(usage.ru_maxrss) / 1024;
}

double memoryOfOurs = 0;

template <double (*Mean)(const Image8&, const Image8&)>
void measure(benchmark::State& state) {
    static const Image8 reference = picture(false);
    static const Image8 test = picture(true);
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<std::size_t>(state.range(0)));
    double mean = 0;
    for (auto _ : state)
        mean = Mean(reference, test);
    state.counters["mean"] = mean;
    if (memoryOfOurs == 0)
        memoryOfOurs = peakMegabytes();
    state.counters["peak_MB"] = peakMegabytes();
}

double ours(const Image8& reference, const Image8& test) {
    return flip(reference, test);
}

BENCHMARK(measure<ours>)
    ->Name("ours")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();
BENCHMARK(measure<PlainFlip::mean>)
    ->Name("plain")
    ->Arg(1)
    ->Arg(2)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime()
    ->UseRealTime();

/// Prints as the console does, and keeps the times for the ratio.
class Reporter : public benchmark::ConsoleReporter {
  public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs)
            seconds_.push_back(run.GetAdjustedRealTime() / 1000);
    }

    void printRatios() const {
        if (seconds_.size() != 4)
            return;
        for (std::size_t i = 0; i < 2; ++i)
            fmt::print("{} thread{}: {:.3f} s against {:.3f} s: {:.3f} of the plain implementation\n", i + 1,
                       i == 0 ? "" : "s", seconds_[i], seconds_[i + 2], seconds_[i] / seconds_[i + 2]);
        fmt::print("peak memory of the process with both pictures: {:.0f} MB\n", memoryOfOurs);
    }

  private:
    std::vector<double> seconds_;
};

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    Reporter reporter;
    benchmark::RunSpecifiedBenchmarks(&reporter);
    reporter.printRatios();
    return 0;
}
