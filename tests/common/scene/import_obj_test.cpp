#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tiny_obj_loader.h>

#include "base/error.h"
#include "base/random.h"
#include "image/io.h"
#include "scene/import.h"
#include "scene/import_formats.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using test::TemporaryFolder;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

ImportedScene load(const std::string& text) {
    return importObj(text, "test.obj");
}

std::string errorOf(const std::string& text) {
    try {
        importObj(text, "test.obj");
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

const std::string cube =
    "v -1 -1 -1\nv 1 -1 -1\nv -1 1 -1\nv 1 1 -1\nv -1 -1 1\nv 1 -1 1\nv -1 1 1\nv 1 1 1\n"
    "f 1 5 7 3\nf 2 4 8 6\nf 1 2 6 5\nf 3 7 8 4\nf 1 3 4 2\nf 5 6 8 7\n";

/// The positions of all triangles' corners.
std::vector<glm::vec3> corners(const Scene& scene) {
    std::vector<glm::vec3> all;
    for (const Mesh& mesh : scene.meshes)
        for (const std::uint32_t i : mesh.indices)
            all.push_back(mesh.positions[i]);
    return all;
}

TEST(Obj, QuadrilateralsBecomeTrianglesAndSharedCornersVertices) {
    const ImportedScene imported = load(cube);
    EXPECT_THAT(imported.warnings, IsEmpty());
    ASSERT_EQ(imported.scene.meshes.size(), 1u);
    const Mesh& mesh = imported.scene.meshes[0];
    EXPECT_EQ(mesh.triangleCount(), 12u);
    EXPECT_EQ(mesh.positions.size(), 8u);
    EXPECT_TRUE(mesh.texcoords.empty());
    // Nothing in the file speaks of smoothing: smooth, along the diagonals.
    for (std::size_t i = 0; i < 8; ++i)
        EXPECT_NEAR(glm::dot(mesh.normals[i], mesh.positions[i]), std::sqrt(3.0), 1e-6);
}

TEST(Obj, SmoothingGroupsSeparateNormals) {
    const Scene flat = load("s off\n" + cube).scene;
    ASSERT_EQ(flat.meshes[0].positions.size(), 24u);
    for (std::size_t i = 0; i < 24; ++i) {
        const glm::vec3 n = glm::abs(flat.meshes[0].normals[i]);
        EXPECT_EQ(n.x + n.y + n.z, 1) << "along an axis";
    }
    // Two triangles that share an edge at a right angle, in one group and in two.
    const std::string bent = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\n";
    const Scene one = load(bent + "s 1\nf 1 3 2\nf 1 2 4\n").scene;
    const Scene two = load(bent + "s 1\nf 1 3 2\ns 2\nf 1 2 4\n").scene;
    const Scene mixed = load(bent + "s 1\nf 1 3 2\ns 0\nf 1 2 4\n").scene;
    EXPECT_EQ(one.meshes[0].positions.size(), 4u);
    EXPECT_EQ(two.meshes[0].positions.size(), 6u);
    EXPECT_EQ(mixed.meshes[0].positions.size(), 6u);
    EXPECT_NEAR(one.meshes[0].normals[0].x, one.meshes[0].normals[0].z, 1e-7);
    EXPECT_EQ(two.meshes[0].normals[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(mixed.meshes[0].normals[5], glm::vec3(1, 0, 0));
}

TEST(Obj, NormalsAndTexcoordsAreKeptAndTurnedToTheTopLeft) {
    const Scene scene = load(square +
                             "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 0.25\nvn 0 0 5\nvn nan 0 0\nvn 0 0 0\n"
                             "f 1/1/1 2/2/2 3/3/3 4/4/1\n")
                            .scene;
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 4u);
    EXPECT_EQ(mesh.texcoords[0], glm::vec2(0, 1));
    for (std::size_t i = 0; i < 4; ++i) {
        EXPECT_EQ(mesh.normals[i], glm::vec3(0, 0, 1)) << "scaled, or made where it is none";
        if (mesh.positions[i] == glm::vec3(0, 1, 0)) {
            EXPECT_EQ(mesh.texcoords[i], glm::vec2(0, 0.75f));
        }
    }
}

TEST(Obj, AllWaysToWriteACornerAgree) {
    const std::string data = square + "vt 0 0\nvn 0 0 1\n";
    const std::vector<glm::vec3> expected = corners(load(data + "f 1 2 3\n").scene);
    for (const char* face :
         {"f 1/1 2/1 3/1", "f 1//1 2//1 3//1", "f 1/1/1 2/1/1 3/1/1", "f -4 -3 -2",
          "f -4/-1/-1 -3/-1/-1 -2/-1/-1", "f\t1  2\t3  ", "  f 1 2 3", "f 1 2 3 # comment", "f 1/ 2/ 3/",
          "f 1// 2// 3//", "f 1 \\\n2 3", "f +1 +2 +3", "f 1 2 3\r", "f 1 2 \\\r\n 3\r"})
        EXPECT_EQ(corners(load(data + face + "\n").scene), expected) << face;
    std::string oldMac = data + "f 1 2 3\n";
    std::replace(oldMac.begin(), oldMac.end(), '\n', '\r');
    EXPECT_EQ(corners(load(oldMac).scene), expected);
    EXPECT_EQ(corners(load(data + "f 1 2 3").scene), expected) << "no line break at the end";
}

TEST(Obj, NumbersAreRoundedCorrectly) {
    Random random(11);
    std::string text;
    std::vector<float> expected;
    for (int i = 0; i < 30'000; ++i) {
        const double value = std::ldexp(random.uniform(-1, 1), static_cast<int>(random.below(280)) - 150);
        const std::string written = i % 3 == 0   ? fmt::format("{:.9g}", value)
                                    : i % 3 == 1 ? fmt::format("{:.25e}", value)
                                                 : fmt::format("{:.40f}", std::ldexp(value, i % 5 - 2));
        const float rounded = std::strtof(written.c_str(), nullptr);
        if (!std::isfinite(rounded))
            continue;
        expected.push_back(rounded);
        text += fmt::format("{}{}", expected.size() % 3 == 1 ? "\nv " : " ", written);
    }
    expected.resize(expected.size() / 3 * 3);
    text += " 0 0 0\n";
    for (std::size_t i = 1; i + 2 <= expected.size() / 3; i += 3)
        text += fmt::format("f {} {} {}\n", i, i + 1, i + 2);
    const std::vector<glm::vec3> found = corners(load(text).scene);
    ASSERT_GT(found.size(), 9000u);
    for (std::size_t i = 0; i < found.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
            ASSERT_EQ(found[i][axis], expected[3 * i + static_cast<std::size_t>(axis)]);
}

TEST(Obj, VerySmallNumbersAreZeroAndVeryLargeOnesErrors) {
    const Scene scene = load("v 1e-60 -1e-4000 1\nv 1e-45 0 0\nv 0 1 0\nf 1 2 3\n").scene;
    EXPECT_EQ(scene.meshes[0].positions[0], glm::vec3(0, 0, 1));
    EXPECT_EQ(scene.meshes[0].positions[1].x, std::numeric_limits<float>::denorm_min());
    for (const char* bad : {"1e39", "1e4000", "nan", "inf", "-inf", "x", "", "1.2.3", "0x10", "1,5", "1e"})
        EXPECT_THAT(errorOf(fmt::format("v 0 0 0\nv 0 0 {}\n", bad)),
                    HasSubstr("test.obj:2: a vertex needs three finite numbers"))
            << bad;
}

/// A random surface of triangles and quadrilaterals, with or without normals and texture coordinates, and
/// materials and groups in between.
std::string randomModel(Random& random, bool relative, int rows) {
    std::string text;
    const int side = 30;
    for (int row = 0; row < rows; ++row) {
        for (int x = 0; x < side; ++x)
            text += fmt::format("v {:.5f} {:.5f} {:.5f}\nvt {:.4f} {:.4f}\n", x + random.uniform(-0.1, 0.1),
                                random.uniform(-0.1, 0.1), row + random.uniform(-0.1, 0.1),
                                random.uniform(0, 1), random.uniform(0, 1));
        text += fmt::format("vn 0 {} 1\n", row % 3 + 1);
        if (row == 0)
            continue;
        if (random.below(4) == 0)
            text += fmt::format("g part{}\n", row);
        for (int x = 0; x + 1 < side; ++x) {
            const int count = side * (row + 1);
            const auto corner = [&](int dx, int dy) {
                const int i = (row - 1 + dy) * side + x + dx + 1;
                const int v = relative ? i - count - 1 : i;
                const int n = relative ? -1 : row + 1;
                return fmt::format(" {}/{}/{}", v, v, n);
            };
            if (random.below(2) == 0)
                text += fmt::format("f{}{}{}{}\n", corner(0, 0), corner(0, 1), corner(1, 1), corner(1, 0));
            else
                text += fmt::format("f{}{}{}\nf{}{}{}\n", corner(0, 0), corner(0, 1), corner(1, 1),
                                    corner(0, 0), corner(1, 1), corner(1, 0));
        }
    }
    return text;
}

using TexturedCorner = std::array<float, 8>;

TEST(Obj, GivesTheTrianglesOfTinyobjloader) {
    for (int seed = 0; seed < 20; ++seed) {
        Random random(static_cast<std::uint64_t>(seed));
        const std::string text = randomModel(random, seed % 2 == 1, 20);
        tinyobj::attrib_t attributes;
        std::vector<tinyobj::shape_t> shapes;
        std::vector<tinyobj::material_t> materials;
        std::string warning;
        std::string error;
        std::istringstream stream(text);
        ASSERT_TRUE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warning, &error, &stream));
        std::vector<TexturedCorner> theirs;
        for (const tinyobj::shape_t& shape : shapes)
            for (const tinyobj::index_t& i : shape.mesh.indices) {
                const float* v = &attributes.vertices[3 * static_cast<std::size_t>(i.vertex_index)];
                const float* n = &attributes.normals[3 * static_cast<std::size_t>(i.normal_index)];
                const float* t = &attributes.texcoords[2 * static_cast<std::size_t>(i.texcoord_index)];
                const glm::dvec3 unit = glm::normalize(glm::dvec3(n[0], n[1], n[2]));
                theirs.push_back({v[0], v[1], v[2], t[0], 1 - t[1], static_cast<float>(unit.x),
                                  static_cast<float>(unit.y), static_cast<float>(unit.z)});
            }
        const Scene scene = load(text).scene;
        std::vector<TexturedCorner> ours;
        const Mesh& mesh = scene.meshes.at(0);
        for (const std::uint32_t i : mesh.indices)
            ours.push_back({mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z,
                            mesh.texcoords[i].x, mesh.texcoords[i].y, mesh.normals[i].x, mesh.normals[i].y,
                            mesh.normals[i].z});
        ASSERT_EQ(ours.size(), theirs.size());
        for (std::size_t i = 0; i < ours.size(); ++i)
            for (std::size_t k = 0; k < 8; ++k)
                // tinyobjloader adds up decimal digits in double; five digits cost it at most one unit in the
                // last place of a float below 32.
                ASSERT_NEAR(ours[i][k], theirs[i][k], 2e-6);
        // No two vertices are equal.
        std::set<TexturedCorner> distinct(ours.begin(), ours.end());
        EXPECT_EQ(mesh.positions.size(), distinct.size());
    }
}

TEST(Obj, PartsParsedOnTheirOwnJoinToTheWhole) {
    // Several parts of a mebibyte, with indices that reach back over their borders.
    Random first(1);
    Random second(1);
    const std::string absolute = randomModel(first, false, 1500);
    const std::string relative = randomModel(second, true, 1500);
    ASSERT_GT(absolute.size(), std::size_t{4} << 20);
    const Scene a = load(absolute).scene;
    const Scene b = load(relative).scene;
    EXPECT_EQ(a.meshes[0].positions, b.meshes[0].positions);
    EXPECT_EQ(a.meshes[0].indices, b.meshes[0].indices);
    EXPECT_EQ(a.meshes[0].normals, b.meshes[0].normals);
}

TEST(Obj, IsTheSameOnAnyNumberOfThreads) {
    Random random(2);
    std::string text = randomModel(random, false, 1200);
    std::string withoutNormals;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line[0] == 'f')
            for (std::size_t slash;
                 (slash = line.rfind('/')) != std::string::npos && slash > line.rfind(' ');)
                line.erase(slash);
        withoutNormals += line + "\n";
    }
    std::vector<Scene> scenes;
    for (const std::size_t threads : {1u, 2u, 4u}) {
        const tbb::global_control control(tbb::global_control::max_allowed_parallelism, threads);
        scenes.push_back(load(withoutNormals).scene);
    }
    for (const Scene& scene : scenes) {
        EXPECT_EQ(scene.meshes[0].indices, scenes[0].meshes[0].indices);
        EXPECT_EQ(scene.meshes[0].normals, scenes[0].meshes[0].normals);
    }
}

TEST(Obj, ReadsMaterialsAndMakesOneMeshOfEach) {
    const TemporaryFolder folder;
    Image8 image(2, 2, 3, Encoding::srgb);
    image.data = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
    std::filesystem::create_directories(folder / "maps");
    writeImage(folder / "maps/wood.png", image);
    folder.file(
        "my colours.mtl",
        "newmtl wood\nKd 0.5 0.25 0.125\nKs 0.1 0.2 0.3\nKa 0 0 0\nNs 30\nKe 1 2 3\nmap_Kd maps\\wood.png\n"
        "map_bump bump.png\n\nnewmtl glass\nKd 0.5 0.5 0.5\nd 0.25\nNs 1e9\nPm 0.5\nPr 0.75\n");
    const auto file =
        folder.file("model.obj", "mtllib my colours.mtl\n" + square +
                                     "vt 0 0\nusemtl wood\nf 1/1 2/1 3/1\nusemtl glass\nf 1 3 4\n"
                                     "usemtl wood\nf 1/1 2/1 4/1\nusemtl other\nf 2 3 4\n");
    const ImportedScene imported = importScene(file);
    EXPECT_THAT(imported.warnings, testing::UnorderedElementsAre(HasSubstr("other"), HasSubstr("bump maps"),
                                                                 HasSubstr("blended")));
    const Scene& scene = imported.scene;
    ASSERT_EQ(scene.meshes.size(), 3u);
    EXPECT_EQ(scene.meshes[0].triangleCount(), 2u);
    EXPECT_EQ(scene.meshes[0].name, "wood");
    const Material& wood = scene.materials[scene.instances[0].material];
    EXPECT_EQ(wood.diffuse, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_EQ(wood.baseColor, glm::vec4(0.5f, 0.25f, 0.125f, 1));
    EXPECT_EQ(wood.specular, glm::vec3(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(wood.ambient, glm::vec3(0));
    EXPECT_EQ(wood.emission, glm::vec3(1, 2, 3));
    EXPECT_EQ(wood.shininess, 30);
    // n = 30: alpha = sqrt(2/32) = 1/4.
    EXPECT_FLOAT_EQ(wood.roughness, 0.5f);
    EXPECT_TRUE(wood.doubleSided);
    ASSERT_TRUE(wood.baseColorTexture);
    EXPECT_EQ(scene.textures[wood.baseColorTexture->texture].image.data, image.data);
    const Material& glass = scene.materials[scene.instances[1].material];
    EXPECT_EQ(glass.alphaMode, Material::AlphaMode::blend);
    EXPECT_EQ(glass.baseColor.w, 0.25f);
    EXPECT_EQ(glass.shininess, 1e5f);
    EXPECT_EQ(glass.metallic, 0.5f);
    EXPECT_EQ(glass.roughness, 0.75f);
    EXPECT_EQ(glass.ambient, glass.diffuse) << "not given";
}

TEST(Obj, GlassIsReadFromItsIlluminationModelIndexAndFilter) {
    const TemporaryFolder folder;
    folder.file("m.mtl",
                "newmtl clear\nKd 0.8 0.8 0.8\nNi 1.33\nillum 7\nTf 0.5 0.75 1\n"
                "newmtl thin\nillum 4\nd 0.25\n"
                "newmtl wood\nillum 2\nNi 1.0\n");
    const std::filesystem::path file =
        folder.file("m.obj",
                    "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl clear\nf 1 2 3\nusemtl thin\nf 1 2 3\n"
                    "usemtl wood\nf 1 2 3\n");
    const ImportedScene imported = importScene(file);
    const std::vector<Material>& materials = imported.scene.materials;
    EXPECT_EQ(materials.at(0).transmission, 1);
    EXPECT_EQ(materials.at(0).ior, 1.33f);
    EXPECT_EQ(materials.at(0).baseColor, glm::vec4(0.5f, 0.75f, 1, 1));
    EXPECT_EQ(materials.at(1).transmission, 0.75f);
    EXPECT_EQ(materials.at(1).ior, 1.5f);
    EXPECT_EQ(materials.at(2).transmission, 0);
    EXPECT_EQ(materials.at(2).ior, 1.5f);
    EXPECT_THAT(imported.warnings, testing::Contains(HasSubstr("glass is drawn opaque")));
}

TEST(Obj, LibrariesAndTexturesStayInTheFolder) {
    const TemporaryFolder folder;
    folder.file("outside.mtl", "newmtl a\nKd 1 0 0\n");
    for (const std::string& name : {std::string("../outside.mtl"), (folder / "outside.mtl").string(),
                                    std::string("gone.mtl"), std::string("."), std::string("")}) {
        const auto file =
            folder.file("sub/model.obj", "mtllib " + name + "\nusemtl a\n" + square + "f 1 2 3\n");
        const ImportedScene imported = importScene(file);
        EXPECT_THAT(imported.warnings, Contains(HasSubstr("material library"))) << name;
        EXPECT_EQ(imported.scene.materials.at(0).name, "default");
    }
    folder.file("sub/ok.mtl", "newmtl a\nmap_Kd ../outside.mtl\n");
    const ImportedScene imported =
        importScene(folder.file("sub/model.obj", "mtllib ok.mtl\nusemtl a\n" + square + "f 1 2 3\n"));
    EXPECT_THAT(imported.warnings, Contains(HasSubstr("not a name of a file beside the model")));
    EXPECT_TRUE(imported.scene.textures.empty());
}

TEST(Obj, FaultsAreNamedWithTheirLine) {
    EXPECT_THAT(errorOf(square + "f 1 2 3\nf 1 2 5\n"), HasSubstr("test.obj:6: a face names a vertex"));
    EXPECT_THAT(errorOf(square + "f 1 2 -5\n"), HasSubstr("test.obj:5:"));
    EXPECT_THAT(errorOf(square + "f 1/1 2/1 3/1\n"), HasSubstr("test.obj:5:"));
    EXPECT_THAT(errorOf(square + "f 1//1 2//1 3//1\n"), HasSubstr("test.obj:5:"));
    for (const char* face :
         {"0 1 2", "1 2 x", "1 2 3.5", "1 2 99999999999999999999", "1 2 2147483647", "1 2 -2147483648",
          "1 2 536870913", "1/x 2 3", "1/2/3/4 2 3", "1 2 3/", "1 2 /3"})
        EXPECT_THAT(errorOf(square + "# comment\nf " + face + "\n"),
                    testing::AnyOf(HasSubstr("test.obj:6:"), HasSubstr("no error")))
            << face;
    EXPECT_THAT(errorOf(square + "f 0 1 2\n"), HasSubstr("count from 1"));
    EXPECT_THAT(errorOf(square), HasSubstr("holds no triangles"));
    EXPECT_THAT(errorOf(""), HasSubstr("holds no triangles"));
    EXPECT_THAT(errorOf("f 1 2\nl 1 2\n"), HasSubstr("holds no triangles"));
}

TEST(Obj, NamesWhatItDoesNotDrawOnce) {
    const ImportedScene imported = load(square + "f 1 2 3\nf 1 2\nf 1 2\nl 1 2\nl 1 2\np 1\ncurv 0 1 1 2\n");
    EXPECT_THAT(imported.warnings,
                testing::UnorderedElementsAre(HasSubstr("fewer than three"), HasSubstr("lines"),
                                              HasSubstr("points"), HasSubstr("curves")));
}

TEST(Obj, AVertexWithEverNewNormalsCostsNoMoreThanOthers) {
    // Each corner at position 1 has a normal of its own: joining equal ones must not search all before it.
    std::string text = square;
    const int count = 60'000;
    for (int i = 0; i < count; ++i)
        text += fmt::format("vn {} 1 1\n", i);
    for (int i = 1; i <= count; ++i)
        text += fmt::format("f 1//{} 2//1 3//1\n", i);
    const Scene scene = load(text).scene;
    EXPECT_EQ(scene.triangleCount(), static_cast<std::size_t>(count));
    EXPECT_EQ(scene.meshes[0].positions.size(), static_cast<std::size_t>(count) + 2);
}

TEST(Import, TellsFormatsByTheirExtension) {
    const TemporaryFolder folder;
    EXPECT_EQ(importScene(folder.file("A.OBJ", cube)).scene.triangleCount(), 12u);
    EXPECT_THROW(importScene(folder.file("a.stl", cube)), InputError);
    EXPECT_THROW(importScene(folder.file("a", cube)), InputError);
    EXPECT_THROW(importScene(folder / "gone.obj"), InputError);
    EXPECT_THROW(importScene(folder.path()), InputError);
}

}  // namespace
}  // namespace quincunx
