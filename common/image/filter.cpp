#include "image/filter.h"

#include <algorithm>
#include <vector>

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

}  // namespace quincunx
