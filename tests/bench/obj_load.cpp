// How long importScene takes on an OBJ of a million triangles, beside tinyobjloader's parsing alone.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <tiny_obj_loader.h>
#include <unistd.h>

#include "base/check.h"
#include "scene/import.h"

namespace {

namespace fs = std::filesystem;

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

struct Model {
    explicit Model(bool withNormalsAndTexcoords)
        : path(fs::temp_directory_path() /
               fmt::format("quincunx_obj_load_{}_{}.obj", getpid(), withNormalsAndTexcoords)) {
        std::ofstream(path, std::ios::binary) << surface(708, withNormalsAndTexcoords);
    }
    ~Model() {
        std::error_code error;
        fs::remove(path, error);
    }
    fs::path path;
};

void byTinyobj(const fs::path& path) {
    tinyobj::attrib_t attributes;
    std::vector<tinyobj::shape_t> shapes;
    std::vector<tinyobj::material_t> materials;
    std::string warning;
    std::string error;
    QX_CHECK(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, path.c_str()));
    benchmark::DoNotOptimize(attributes.vertices.data());
    QX_CHECK_EQ(shapes.at(0).mesh.indices.size(), 3u * 2 * 708 * 708);
}

void byUs(const fs::path& path) {
    const quincunx::ImportedScene imported = quincunx::importScene(path);
    const quincunx::Bounds bounds = imported.scene.bounds();
    benchmark::DoNotOptimize(bounds.radius());
    QX_CHECK_EQ(imported.scene.triangleCount(), 2u * 708 * 708);
}

template <typename Load>
double medianSeconds(const Load& load, const fs::path& path) {
    std::vector<double> seconds;
    for (int run = 0; run < 5; ++run) {
        const auto start = std::chrono::steady_clock::now();
        load(path);
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    std::sort(seconds.begin(), seconds.end());
    return seconds[2];
}

}  // namespace

int main(int argc, char** argv) {
    benchmark::Initialize(&argc, argv);
    const Model plain(false);
    const Model full(true);
    for (const auto& [name, model] : {std::pair{"positions only, normals made", &plain},
                                      std::pair{"with normals and texture coordinates", &full}}) {
        const fs::path path = model->path;
        benchmark::RegisterBenchmark(fmt::format("tinyobjloader alone, {}", name).c_str(),
                                     [path](benchmark::State& state) {
                                         for (auto _ : state)
                                             byTinyobj(path);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
        benchmark::RegisterBenchmark(fmt::format("importScene, {}", name).c_str(),
                                     [path](benchmark::State& state) {
                                         for (auto _ : state)
                                             byUs(path);
                                     })
            ->Unit(benchmark::kMillisecond)
            ->UseRealTime();
    }
    benchmark::RunSpecifiedBenchmarks();
    for (const auto& [name, model] : {std::pair{"positions only, normals made", &plain},
                                      std::pair{"with normals and texture coordinates", &full}}) {
        const double tinyobj = medianSeconds(byTinyobj, model->path);
        const double ours = medianSeconds(byUs, model->path);
        std::printf("ratio importScene / tinyobjloader alone, %s: %.3f (%.0f ms / %.0f ms, medians of 5)\n",
                    name, ours / tinyobj, ours * 1e3, tinyobj * 1e3);
    }
}
