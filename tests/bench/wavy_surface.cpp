#include "wavy_surface.h"

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <system_error>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tiny_obj_loader.h>
#include <unistd.h>

#include "base/check.h"

namespace quincunx::bench {
namespace {

/// A wavy surface of 2 · cells² triangles.
std::string surface(int cells, bool withNormalsAndTexcoords) {
    std::string text;
    text.reserve(static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells) * 200);
    const auto out = std::back_inserter(text);
    const int side = cells + 1;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const double u = static_cast<double>(x) / cells;
            const double v = static_cast<double>(y) / cells;
            fmt::format_to(out, "v {:.6f} {:.6f} {:.6f}\n", u, 0.05 * std::sin(40 * u) * std::cos(30 * v), v);
            if (withNormalsAndTexcoords) {
                const double dx = 2 * std::cos(40 * u) * std::cos(30 * v);
                const double dz = -1.5 * std::sin(40 * u) * std::sin(30 * v);
                const double length = std::sqrt(dx * dx + 1 + dz * dz);
                fmt::format_to(out, "vn {:.4f} {:.4f} {:.4f}\nvt {:.6f} {:.6f}\n", -dx / length, 1 / length,
                               -dz / length, u, v);
            }
        }
    const auto corner = [&](int i) {
        if (withNormalsAndTexcoords)
            fmt::format_to(out, " {}/{}/{}", i, i, i);
        else
            fmt::format_to(out, " {}", i);
    };
    const auto face = [&](int a, int b, int c) {
        text += 'f';
        corner(a);
        corner(b);
        corner(c);
        text += '\n';
    };
    for (int y = 0; y < cells; ++y)
        for (int x = 0; x < cells; ++x) {
            const int i = y * side + x + 1;
            face(i, i + side, i + 1);
            face(i + 1, i + side, i + side + 1);
        }
    return text;
}

}  // namespace

WavySurface::WavySurface(bool withNormalsAndTexcoords)
    : path_(std::filesystem::temp_directory_path() /
            fmt::format("quincunx_wavy_surface_{}_{}.obj", getpid(), withNormalsAndTexcoords)) {
    std::ofstream(path_, std::ios::binary) << surface(708, withNormalsAndTexcoords);
}

WavySurface::~WavySurface() {
    std::error_code error;
    std::filesystem::remove(path_, error);
}

void parseByTinyobj(const std::filesystem::path& path) {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning;
    std::string error;
    QX_CHECK(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, path.c_str()));
    benchmark::DoNotOptimize(attributes.vertices.data());
    QX_CHECK_EQ(shapes.at(0).mesh.indices.size(), 3 * WavySurface::triangleCount);
}

}  // namespace quincunx::bench
