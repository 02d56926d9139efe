#include "trace/triangle_items.h"

#include <algorithm>

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include "base/check.h"

namespace quincunx::detail {
namespace {

bool isFinite(const Triangle& triangle) {
    const glm::vec3 zero = (triangle.a - triangle.a) + (triangle.b - triangle.b) + (triangle.c - triangle.c);
    return zero == glm::vec3(0);
}

}  // namespace

std::vector<BvhItem> itemsOf(TriangleView triangles) {
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<BvhItem> items(triangles.size());
    oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<std::size_t>(0, items.size(), 4096),
                              [&](const auto& part) {
                                  for (std::size_t i = part.begin(); i != part.end(); ++i) {
                                      const Triangle triangle = triangles[i];
                                      items[i] = {glm::min(triangle.a, glm::min(triangle.b, triangle.c)),
                                                  isFinite(triangle) ? static_cast<std::uint32_t>(i) : none,
                                                  glm::max(triangle.a, glm::max(triangle.b, triangle.c)), 0};
                                  }
                              });
    std::erase_if(items, [](const BvhItem& item) { return item.index == none; });
    return items;
}

}  // namespace quincunx::detail
