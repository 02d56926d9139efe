#include "labs/16_shadow_maps/mask_figures.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace quincunx {
namespace {

bool besideBackground(const Image& traced, int x, int y) {
    for (int ny = std::max(y - 1, 0); ny <= std::min(y + 1, traced.height - 1); ++ny)
        for (int nx = std::max(x - 1, 0); nx <= std::min(x + 1, traced.width - 1); ++nx)
            if (*traced.pixel(nx, ny) < 0)
                return true;
    return false;
}

}  // namespace

MaskFigures compareMasks(const Image& mask, const Image& traced) {
    QX_CHECK_EQ(mask.width, traced.width);
    QX_CHECK_EQ(mask.height, traced.height);
    MaskFigures figures;
    double squares = 0;
    for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x) {
            if (besideBackground(traced, x, y))
                continue;
            const float expected = *traced.pixel(x, y);
            const float share = mask.pixel(x, y)[0];
            ++figures.surface;
            figures.lit += expected > 0.5f;
            figures.acne += expected > 0.5f && share < 0.5f;
            figures.leaks += expected < 0.5f && share > 0.5f;
            squares += static_cast<double>(share - expected) * static_cast<double>(share - expected);
        }
    if (figures.surface > 0)
        figures.rmse = std::sqrt(squares / static_cast<double>(figures.surface));
    return figures;
}

}  // namespace quincunx
