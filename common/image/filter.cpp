#include "image/filter.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"

namespace quincunx {

Image boxDownsample(const Image& fine, int factor) {
    QX_CHECK_GE(factor, 1);
    QX_CHECK_EQ(fine.width % factor, 0);
    QX_CHECK_EQ(fine.height % factor, 0);
    if (factor == 1)
        return fine;
    Image coarse(fine.width / factor, fine.height / factor, fine.channels, fine.encoding);
    std::vector<double> sum(static_cast<std::size_t>(fine.channels));
    for (int y = 0; y < coarse.height; ++y)
        for (int x = 0; x < coarse.width; ++x) {
            std::fill(sum.begin(), sum.end(), 0.0);
            for (int dy = 0; dy < factor; ++dy)
                for (int dx = 0; dx < factor; ++dx)
                    for (int c = 0; c < fine.channels; ++c)
                        sum[static_cast<std::size_t>(c)] += fine.pixel(x * factor + dx, y * factor + dy)[c];
            for (int c = 0; c < fine.channels; ++c)
                coarse.pixel(x, y)[c] = static_cast<float>(sum[static_cast<std::size_t>(c)] /
                                                           (static_cast<double>(factor) * factor));
        }
    return coarse;
}

Image gaussianBlur(const Image& image, double sigmaPixels) {
    QX_CHECK_GT(sigmaPixels, 0.0);
    const int radius = static_cast<int>(std::ceil(6 * sigmaPixels));
    std::vector<double> weights;
    double sum = 0;
    for (int i = -radius; i <= radius; ++i) {
        weights.push_back(std::exp(-0.5 * i * i / (sigmaPixels * sigmaPixels)));
        sum += weights.back();
    }
    const std::size_t channels = static_cast<std::size_t>(image.channels);
    std::vector<double> rows(image.data.size());
    const auto at = [&](int x, int y) {
        return (static_cast<std::size_t>(y) * static_cast<std::size_t>(image.width) +
                static_cast<std::size_t>(x)) *
               channels;
    };
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (int i = -radius; i <= radius; ++i) {
                const std::size_t from = at(std::clamp(x + i, 0, image.width - 1), y);
                for (std::size_t c = 0; c < channels; ++c)
                    rows[at(x, y) + c] += weights[static_cast<std::size_t>(i + radius)] / sum *
                                          static_cast<double>(image.data[from + c]);
            }
    Image blurred = image;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x)
            for (std::size_t c = 0; c < channels; ++c) {
                double value = 0;
                for (int i = -radius; i <= radius; ++i)
                    value += weights[static_cast<std::size_t>(i + radius)] / sum *
                             rows[at(x, std::clamp(y + i, 0, image.height - 1)) + c];
                blurred.data[at(x, y) + c] = static_cast<float>(value);
            }
    return blurred;
}

}  // namespace quincunx
