#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "image/io.h"
#include "scene/import.h"
#include "scene/import_formats.h"
#include "tests/common/scene/gltf_file.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using nlohmann::json;
using test::GltfFile;
using test::Square;
using test::TemporaryFolder;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

ImportedScene load(const GltfFile& file) {
    return importGltf(file.glb(), "test.glb");
}

std::string errorOf(const std::string& contents) {
    try {
        importGltf(contents, "test.gltf");
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

struct Corner {
    glm::vec3 position;
    glm::vec3 normal;
    glm::vec2 texcoord;
    bool operator==(const Corner&) const = default;
};

/// The corners of all triangles in world space, in order.
std::vector<Corner> corners(const Scene& scene) {
    std::vector<Corner> all;
    for (const Instance& instance : scene.instances) {
        const Mesh& mesh = scene.meshes[instance.mesh];
        for (const std::uint32_t i : mesh.indices)
            all.push_back({glm::vec3(instance.worldFromModel * glm::vec4(mesh.positions[i], 1)),
                           mesh.normals[i], mesh.texcoords.empty() ? glm::vec2(0) : mesh.texcoords[i]});
    }
    return all;
}

std::vector<Corner> squareCorners() {
    const Square square;
    std::vector<Corner> all;
    for (const std::uint32_t i : square.indices)
        all.push_back({square.positions[i], square.normals[i], square.texcoords[i]});
    return all;
}

TEST(Gltf, GivesTheSameTrianglesEmbeddedBesideAndBinary) {
    const TemporaryFolder folder;
    const GltfFile file = test::squareFile();
    folder.file("a b.bin", file.binary);
    const auto beside = folder.file("beside.gltf", file.text("a%20b.bin"));
    const auto embedded = folder.file("embedded.GLTF", file.embedded());
    const auto binary = folder.file("binary.glb", file.glb());
    for (const auto& path : {beside, embedded, binary}) {
        const ImportedScene imported = importScene(path);
        EXPECT_EQ(corners(imported.scene), squareCorners()) << path;
        EXPECT_THAT(imported.warnings, IsEmpty());
        EXPECT_TRUE(imported.scene.lights.empty());
        EXPECT_TRUE(imported.scene.cameras.empty());
        EXPECT_EQ(imported.scene.name, path.stem());
    }
}

TEST(Gltf, ReadsIndicesOfEveryWidthAndNone) {
    const Square square;
    for (const int width : {0, 1, 2, 4}) {
        GltfFile file;
        std::vector<glm::vec3> positions = square.positions;
        if (width == 0) {
            positions.clear();
            for (const std::uint32_t i : square.indices)
                positions.push_back(square.positions[i]);
        }
        json primitive{{"attributes", {{"POSITION", file.vec3s(positions)}}}};
        if (width == 1)
            primitive["indices"] = file.indices(std::vector<std::uint8_t>{0, 1, 2, 0, 2, 3});
        else if (width == 2)
            primitive["indices"] = file.indices(std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
        else if (width == 4)
            primitive["indices"] = file.indices(square.indices);
        file.node({{"mesh", file.mesh(primitive)}});
        std::vector<Corner> expected = squareCorners();
        for (Corner& corner : expected)
            corner.texcoord = glm::vec2(0);
        EXPECT_EQ(corners(load(file).scene), expected) << "bytes an index: " << width;
    }
}

TEST(Gltf, ReadsInterleavedVerticesWithOffsetsInPlace) {
    const Square square;
    std::string interleaved(8, '\x7f');
    for (std::size_t i = 0; i < 4; ++i) {
        interleaved += GltfFile::bytes(std::vector{square.positions[i]});
        interleaved += GltfFile::bytes(std::vector{square.texcoords[i]});
        interleaved += GltfFile::bytes(std::vector{square.normals[i]});
        if (i < 3)
            interleaved += std::string(4, '\x7f');
    }
    GltfFile file;
    file.view("shifts the next one");
    const int view = file.view(interleaved, 36);
    const int positions = file.accessor(view, "VEC3", 5126, 4, 8);
    const int texcoords = file.accessor(view, "VEC2", 5126, 4, 20);
    const int normals = file.accessor(view, "VEC3", 5126, 4, 28);
    file.node(
        {{"mesh", file.mesh({{"attributes",
                              {{"POSITION", positions}, {"TEXCOORD_0", texcoords}, {"NORMAL", normals}}},
                             {"indices", file.indices(square.indices)}})}});
    EXPECT_EQ(corners(load(file).scene), squareCorners());
    // The last element ends exactly at the view's end; one more does not fit.
    file.json["accessors"][static_cast<std::size_t>(positions)]["count"] = 5;
    EXPECT_THAT(errorOf(file.glb()), HasSubstr("reaches beyond its buffer view"));
}

TEST(Gltf, PutsSparseElementsIntoTheirPlaces) {
    for (const bool withBase : {true, false}) {
        for (const int indexType : {5121, 5123, 5125}) {
            const Square square;
            GltfFile file;
            std::vector<glm::vec3> base = square.positions;
            base[2] = {9, 9, 9};
            if (!withBase)
                base.assign(4, glm::vec3(0));
            const int positions = file.vec3s(base);
            json& accessor = file.json["accessors"][static_cast<std::size_t>(positions)];
            if (!withBase)
                accessor.erase("bufferView");
            const std::vector<std::uint32_t> places =
                withBase ? std::vector<std::uint32_t>{2} : std::vector<std::uint32_t>{1, 2, 3};
            std::vector<glm::vec3> values;
            std::string indices;
            for (const std::uint32_t place : places) {
                values.push_back(square.positions[place]);
                for (int byte = 0; byte < (indexType == 5121 ? 1 : indexType == 5123 ? 2 : 4); ++byte)
                    indices += static_cast<char>(place >> 8 * byte & 0xff);
            }
            const int indexView = file.view(indices);
            const int valueView = file.view(GltfFile::bytes(values));
            file.json["accessors"][static_cast<std::size_t>(positions)]["sparse"] = {
                {"count", places.size()},
                {"indices", {{"bufferView", indexView}, {"componentType", indexType}}},
                {"values", {{"bufferView", valueView}}}};
            file.node({{"mesh", file.mesh({{"attributes", {{"POSITION", positions}}},
                                           {"indices", file.indices(square.indices)}})}});
            const std::vector<Corner> found = corners(load(file).scene);
            ASSERT_EQ(found.size(), 6u);
            for (std::size_t i = 0; i < 6; ++i)
                EXPECT_EQ(found[i].position, squareCorners()[i].position);
        }
    }
}

TEST(Gltf, MapsNormalizedIntegersToTheUnitInterval) {
    const Square square;
    for (const int type : {5121, 5123}) {
        GltfFile file;
        std::string texcoords;
        for (const glm::vec2& t : square.texcoords)
            for (const float value : {t.x, t.y}) {
                texcoords += value > 0 ? "\xff" : std::string(1, '\0');
                if (type == 5123)
                    texcoords += value > 0 ? "\xff" : std::string(1, '\0');
            }
        const int view = file.view(type == 5121 ? [&] {
            // Elements of two bytes are padded to four.
            std::string padded;
            for (std::size_t i = 0; i < texcoords.size(); i += 2)
                padded += texcoords.substr(i, 2) + std::string(2, '\x55');
            return padded;
        }()
                                                : texcoords,
                                   4);
        const int accessor = file.accessor(view, "VEC2", type, 4, 0, true);
        file.node({{"mesh", file.mesh({{"attributes",
                                        {{"POSITION", file.vec3s(square.positions)},
                                         {"NORMAL", file.vec3s(square.normals)},
                                         {"TEXCOORD_0", accessor}}},
                                       {"indices", file.indices(square.indices)}})}});
        EXPECT_EQ(corners(load(file).scene), squareCorners());
    }
}

TEST(Gltf, TurnsStripsAndFansIntoTrianglesOfTheSameOrientation) {
    const std::vector<std::uint32_t> zigzag{0, 1, 3, 2};
    const std::vector<std::uint32_t> around{0, 1, 2, 3};
    for (const auto& [mode, indices] : {std::pair{5, zigzag}, std::pair{6, around}}) {
        GltfFile file;
        const int positions = file.vec3s(Square().positions);
        file.node({{"mesh", file.mesh({{"attributes", {{"POSITION", positions}}},
                                       {"indices", file.indices(indices)},
                                       {"mode", mode}})}});
        const Scene scene = load(file).scene;
        ASSERT_EQ(scene.triangleCount(), 2u);
        // The square has area 1 and looks along +z; so do both triangles, made flat.
        for (const glm::vec3& normal : scene.meshes[0].normals)
            EXPECT_EQ(normal, glm::vec3(0, 0, 1));
    }
}

TEST(Gltf, MakesMissingNormalsFlatAndMendsBrokenOnes) {
    GltfFile file;
    const int positions = file.vec3s({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    const int indices = file.indices(std::vector<std::uint8_t>{0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3});
    const int mesh = file.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}});
    file.node({{"mesh", mesh}});
    const Scene flat = load(file).scene;
    ASSERT_EQ(flat.meshes[0].normals.size(), 12u);
    EXPECT_EQ(flat.meshes[0].normals[0], glm::vec3(0, 0, -1));
    EXPECT_EQ(flat.meshes[0].normals[3], glm::vec3(0, -1, 0));

    const float nan = std::numeric_limits<float>::quiet_NaN();
    const int normals = file.vec3s({{0, 0, 0}, {3, 0, 0}, {nan, 0, 0}, {0, 0, 1e-30f}});
    file.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = normals;
    const Scene mended = load(file).scene;
    ASSERT_EQ(mended.meshes[0].normals.size(), 4u);
    EXPECT_NEAR(mended.meshes[0].normals[0].x, -1 / std::sqrt(3.0), 1e-7);
    EXPECT_EQ(mended.meshes[0].normals[1], glm::vec3(1, 0, 0));
    EXPECT_NEAR(glm::length(mended.meshes[0].normals[2]), 1, 1e-6);
    EXPECT_EQ(mended.meshes[0].normals[3], glm::vec3(0, 0, 1));
}

TEST(Gltf, MultipliesTransformsDownTheHierarchy) {
    GltfFile file = test::squareFile();
    file.json["nodes"] = json::array();
    file.node({{"translation", {10, 0, 0}}, {"children", {1, 2}}});
    // A quarter turn about z, and a mirror image.
    file.node({{"rotation", {0, 0, std::sqrt(0.5), std::sqrt(0.5)}}, {"scale", {2, 2, 2}}, {"mesh", 0}});
    file.node({{"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 5, 1}}, {"mesh", 0}});
    file.json["scenes"] = json::array({{{"nodes", {0}}}});
    const Scene scene = load(file).scene;
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.meshes.size(), 1u) << "one mesh, used twice";
    const glm::vec4 corner(1, 0, 0, 1);
    const glm::vec3 turned(scene.instances[0].worldFromModel * corner);
    EXPECT_NEAR(turned.x, 10, 1e-6);
    EXPECT_NEAR(turned.y, 2, 1e-6);
    EXPECT_EQ(glm::vec3(scene.instances[1].worldFromModel * corner), glm::vec3(9, 0, 5));
    EXPECT_LT(glm::determinant(glm::mat3(scene.instances[1].worldFromModel)), 0);
    const Bounds bounds = scene.bounds();
    EXPECT_NEAR(bounds.min.x, 8, 1e-6);
    EXPECT_NEAR(bounds.max.z, 5, 1e-6);
}

TEST(Gltf, EqualTransformsAsMatrixAndAsPartsAgree) {
    Random random(5);
    for (int round = 0; round < 50; ++round) {
        glm::dvec4 q;
        for (int i = 0; i < 4; ++i)
            q[i] = random.uniform(-1, 1);
        q /= glm::length(q);
        const std::array<double, 3> s{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2)};
        // Rotating a vector by q: v + 2 u × (u × v + w v), an independent way to the matrix.
        json matrix = json::array();
        const glm::dvec3 u(q);
        for (int column = 0; column < 3; ++column) {
            glm::dvec3 axis(0);
            axis[column] = 1;
            const glm::dvec3 image = (axis + 2.0 * glm::cross(u, glm::cross(u, axis) + q.w * axis)) *
                                     s[static_cast<std::size_t>(column)];
            for (const double value : {image.x, image.y, image.z, 0.0})
                matrix.push_back(value);
        }
        for (const double value : {7.0, -8.0, 9.0, 1.0})
            matrix.push_back(value);
        GltfFile parts = test::squareFile();
        parts.json["nodes"][0]["rotation"] = {q.x * 3, q.y * 3, q.z * 3, q.w * 3};  // not of unit length
        parts.json["nodes"][0]["scale"] = s;
        parts.json["nodes"][0]["translation"] = {7, -8, 9};
        GltfFile whole = test::squareFile();
        whole.json["nodes"][0]["matrix"] = matrix;
        const glm::mat4 a = load(parts).scene.instances[0].worldFromModel;
        const glm::mat4 b = load(whole).scene.instances[0].worldFromModel;
        for (int column = 0; column < 4; ++column)
            for (int row = 0; row < 4; ++row)
                // Both are computed in double and rounded once: at most one unit in the last place of 9.
                EXPECT_NEAR(a[column][row], b[column][row], 9.6e-7);
    }
}

TEST(Gltf, DeepHierarchiesNeedNoDeepStack) {
    GltfFile file = test::squareFile();
    file.json["nodes"] = json::array();
    const int depth = 30'000;
    for (int i = 0; i < depth; ++i)
        file.json["nodes"].push_back({{"children", {i + 1}}, {"translation", {0, 0, 0.5}}});
    file.node({{"mesh", 0}});
    EXPECT_EQ(load(file).scene.instances.at(0).worldFromModel[3].z, depth / 2);
}

TEST(Gltf, NodesThatHangFromThemselvesOrTwiceAreErrors) {
    GltfFile loop = test::squareFile();
    loop.json["nodes"] = {{{"children", {1}}}, {{"children", {0}}, {"mesh", 0}}};
    loop.json["scenes"] = json::array({{{"nodes", {0}}}});
    EXPECT_THAT(errorOf(loop.glb()), HasSubstr("nodes[0]: hangs from two nodes, or from itself"));
    GltfFile shared = test::squareFile();
    shared.json["nodes"] = {{{"children", {2}}}, {{"children", {2}}}, {{"mesh", 0}}};
    EXPECT_THAT(errorOf(shared.glb()), HasSubstr("hangs from two nodes"));
}

TEST(Gltf, MaterialsCarryBothSetsOfNumbers) {
    GltfFile file = test::squareFile();
    file.json["materials"] = {
        {{"name", "gold"},
         {"pbrMetallicRoughness",
          {{"baseColorFactor", {1.0, 0.5, 0.25, 0.75}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.5}}},
         {"emissiveFactor", {0.5, 0, 0}},
         {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}},
         {"alphaMode", "MASK"},
         {"alphaCutoff", 0.25},
         {"doubleSided", true}},
        json::object()};
    file.json["meshes"][0]["primitives"][0]["material"] = 0;
    const Scene scene = load(file).scene;
    const Material& gold = scene.materials.at(0);
    EXPECT_EQ(gold.name, "gold");
    EXPECT_EQ(gold.baseColor, glm::vec4(1, 0.5f, 0.25f, 0.75f));
    EXPECT_EQ(gold.metallic, 0.5f);
    EXPECT_EQ(gold.emission, glm::vec3(2, 0, 0));
    EXPECT_EQ(gold.alphaMode, Material::AlphaMode::mask);
    EXPECT_EQ(gold.alphaCutoff, 0.25f);
    EXPECT_TRUE(gold.doubleSided);
    EXPECT_EQ(gold.diffuse, glm::vec3(0.5f, 0.25f, 0.125f));
    EXPECT_FLOAT_EQ(gold.specular.x, 0.52f);
    // alpha = 1/4, so n = 2 · 16 - 2.
    EXPECT_FLOAT_EQ(gold.shininess, 30);
    // What the specification says of an empty material.
    EXPECT_EQ(scene.materials.at(1).metallic, 1);
    EXPECT_EQ(scene.materials.at(1).roughness, 1);
    EXPECT_EQ(scene.materials.at(1).shininess, 0);
    EXPECT_EQ(scene.instances.at(0).material, 0u);
}

TEST(Gltf, ReadsGlassAndSaysThatItIsDrawnOpaque) {
    GltfFile file = test::squareFile();
    file.json["extensionsUsed"] = {"KHR_materials_transmission", "KHR_materials_ior"};
    file.json["extensionsRequired"] = file.json["extensionsUsed"];
    const auto glass = [](double transmission, double ior) {
        return nlohmann::json{{"extensions",
                               {{"KHR_materials_transmission", {{"transmissionFactor", transmission}}},
                                {"KHR_materials_ior", {{"ior", ior}}}}}};
    };
    file.json["materials"] = {glass(0.75, 1.25), glass(3, 0.5), glass(0, 0), nlohmann::json::object()};
    file.json["meshes"][0]["primitives"][0]["material"] = 0;
    const ImportedScene imported = load(file);
    const std::vector<Material>& materials = imported.scene.materials;
    EXPECT_EQ(materials.at(0).transmission, 0.75f);
    EXPECT_EQ(materials.at(0).ior, 1.25f);
    EXPECT_EQ(materials.at(1).transmission, 1);
    EXPECT_EQ(materials.at(1).ior, 1);
    EXPECT_EQ(materials.at(2).ior, 1e6f) << "0 stands for no bound";
    EXPECT_EQ(materials.at(3).transmission, 0);
    EXPECT_EQ(materials.at(3).ior, 1.5f);
    EXPECT_THAT(imported.warnings, testing::ElementsAre(HasSubstr("glass is drawn opaque")));
}

TEST(Gltf, RefusesEnvironmentsThatAreNotWhatTheySay) {
    GltfFile file = test::squareFile();
    nlohmann::json& own = file.json["scenes"][0]["extras"]["quincunx"]["environment"];
    own = {{"bufferView", 0}, {"width", 30000}, {"height", 30000}};
    EXPECT_THROW(load(file), InputError);
    own["bufferView"] = 99;
    EXPECT_THROW(load(file), InputError);
    own = {{"bufferView", 0}, {"width", 0}, {"height", 1}};
    EXPECT_THROW(load(file), InputError);
}

Image8 picture(int width, int height, std::uint8_t start) {
    Image8 image(width, height, 3, Encoding::srgb);
    for (std::size_t i = 0; i < image.data.size(); ++i)
        image.data[i] = static_cast<std::uint8_t>(start + i * 7);
    return image;
}

std::string pictureFile(const TemporaryFolder& folder, const Image8& image) {
    writeImage(folder / "written.png", image);
    std::ifstream stream(folder / "written.png", std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Gltf, ReadsTexturesFromViewsUrisAndFilesWithTheirWrapModes) {
    const TemporaryFolder folder;
    const Image8 image = picture(5, 3, 10);
    const std::string png = pictureFile(folder, image);
    folder.file("maps/one.png", png);
    for (const int source : {0, 1, 2}) {
        GltfFile file = test::squareFile();
        file.json["materials"] =
            json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
        file.json["meshes"][0]["primitives"][0]["material"] = 0;
        file.json["textures"] = json::array({{{"source", 0}, {"sampler", 0}}});
        file.json["samplers"] = json::array({{{"wrapS", 33071}, {"wrapT", 33648}}});
        json picture;
        if (source == 0)
            picture = {{"bufferView", file.view(png)}, {"mimeType", "image/png"}};
        else if (source == 1)
            picture = {{"uri", "data:image/png;base64," + GltfFile::base64(png)}};
        else
            picture = {{"uri", "maps/one.png"}};
        file.json["images"] = json::array({picture});
        const ImportedScene imported = importScene(folder.file("model.glb", file.glb()));
        EXPECT_THAT(imported.warnings, IsEmpty());
        ASSERT_EQ(imported.scene.textures.size(), 1u) << source;
        EXPECT_EQ(imported.scene.materials[0].baseColorTexture, TextureUse(0));
        EXPECT_EQ(imported.scene.textures[0].image.data, image.data);
        EXPECT_EQ(imported.scene.textures[0].wrapS, Texture::Wrap::clampToEdge);
        EXPECT_EQ(imported.scene.textures[0].wrapT, Texture::Wrap::mirroredRepeat);
    }
}

TEST(Gltf, TexturesThatCannotBeHadAreWarningsAndStayInTheFolder) {
    const TemporaryFolder folder;
    folder.file("secret.png", pictureFile(folder, picture(2, 2, 0)));
    for (const char* uri :
         {"gone.png", "../secret.png", "sub/../../secret.png", "/etc/passwd", "file:///etc/passwd",
          "http://localhost/x.png", "%2e%2e/secret.png", "..\\secret.png", "", "."}) {
        GltfFile file = test::squareFile();
        file.json["materials"] =
            json::array({{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}});
        file.json["meshes"][0]["primitives"][0]["material"] = 0;
        file.json["textures"] = json::array({{{"source", 0}}});
        file.json["images"] = json::array({{{"uri", uri}}});
        const ImportedScene imported = importScene(folder.file("sub/model.glb", file.glb()));
        EXPECT_TRUE(imported.scene.textures.empty()) << uri;
        EXPECT_THAT(imported.warnings, Contains(HasSubstr("drawn without a texture"))) << uri;
        EXPECT_FALSE(imported.scene.materials[0].baseColorTexture);
    }
}

TEST(Gltf, BuffersOutsideTheFolderAreErrors) {
    const TemporaryFolder folder;
    const GltfFile file = test::squareFile();
    folder.file("data.bin", file.binary);
    const auto inside = folder.file("sub/model.gltf", file.text("../data.bin"));
    EXPECT_THROW(importScene(inside), InputError);
    const auto absolute = folder.file("absolute.gltf", file.text((folder / "data.bin").string()));
    EXPECT_THROW(importScene(absolute), InputError);
    const auto good = folder.file("good.gltf", file.text("data.bin"));
    EXPECT_NO_THROW(importScene(good));
}

TEST(Gltf, PlacesCamerasAndLights) {
    GltfFile file = test::squareFile();
    file.json["cameras"] = {
        {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.5}}}},
        {{"type", "orthographic"}, {"orthographic", {{"xmag", 1}, {"ymag", 1}, {"zfar", 1}, {"znear", 0}}}}};
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
        {{"type", "spot"},
         {"color", {1, 0.5, 0}},
         {"intensity", 314.15926535897932},
         {"range", 20},
         {"spot", {{"innerConeAngle", 0.1}, {"outerConeAngle", 0.2}}}},
        {{"type", "directional"}}};
    // Turned a quarter about y, so that -z becomes -x; scaled unevenly, which a camera ignores.
    const json frame{{"rotation", {0, std::sqrt(0.5), 0, std::sqrt(0.5)}},
                     {"translation", {4, 5, 6}},
                     {"scale", {2, 3, 4}}};
    json camera = frame;
    camera["camera"] = 0;
    json light = frame;
    light["extensions"]["KHR_lights_punctual"]["light"] = 0;
    file.node(camera);
    file.node(light);
    file.node({{"camera", 1}});
    const ImportedScene imported = load(file);
    ASSERT_EQ(imported.scene.cameras.size(), 1u);
    const Camera& eye = imported.scene.cameras[0];
    EXPECT_EQ(eye.fovYRadians, 1);
    EXPECT_EQ(eye.nearDistance, 0.5f);
    EXPECT_TRUE(std::isinf(eye.farDistance));
    EXPECT_NEAR(eye.worldFromCamera[2].x, 1, 1e-6);
    EXPECT_NEAR(glm::determinant(eye.worldFromCamera), 1, 1e-6);
    EXPECT_EQ(glm::vec3(eye.worldFromCamera[3]), glm::vec3(4, 5, 6));
    ASSERT_EQ(imported.scene.lights.size(), 1u);
    const Light& spot = imported.scene.lights[0];
    EXPECT_EQ(spot.kind, Light::Kind::spot);
    EXPECT_NEAR(spot.direction.x, -1, 1e-6);
    EXPECT_EQ(spot.position, glm::vec3(4, 5, 6));
    EXPECT_FLOAT_EQ(spot.intensity, 100);
    EXPECT_EQ(spot.range, 20);
    EXPECT_FLOAT_EQ(spot.outerConeRadians, 0.2f);
    EXPECT_THAT(imported.warnings, Contains(HasSubstr("not perspective")));
}

TEST(Gltf, NamesWhatItDoesNotDrawOnce) {
    GltfFile file = test::squareFile();
    file.json["extensionsUsed"] = {"KHR_materials_clearcoat", "KHR_materials_clearcoat",
                                   "KHR_texture_transform"};
    file.json["skins"] = json::array({json::object()});
    json& primitives = file.json["meshes"][0]["primitives"];
    json lines = primitives[0];
    lines["mode"] = 1;
    primitives.push_back(lines);
    primitives.push_back(lines);
    primitives[0]["targets"] = json::array({json::object()});
    file.json["animations"] =
        json::array({{{"samplers", json::array()},
                      {"channels",
                       {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}},
                        {{"sampler", 0}, {"target", {{"node", 0}, {"path", "pointer"}}}}}}}});
    EXPECT_THAT(load(file).warnings,
                testing::UnorderedElementsAre(HasSubstr("KHR_materials_clearcoat"), HasSubstr("skins"),
                                              HasSubstr("lines"), HasSubstr("morph"),
                                              HasSubstr("animations of pointer")));
}

TEST(Gltf, ARequiredExtensionThatIsNotSupportedIsAnErrorThatNamesIt) {
    GltfFile file = test::squareFile();
    file.json["extensionsRequired"] = {"KHR_lights_punctual", "KHR_draco_mesh_compression"};
    EXPECT_THAT(errorOf(file.glb()), HasSubstr("requires the extension KHR_draco_mesh_compression"));
}

TEST(Gltf, PrimitivesOfAnotherMaterialShareTheirMesh) {
    GltfFile file = test::squareFile();
    file.json["materials"] = {json::object(), json::object()};
    json second = file.json["meshes"][0]["primitives"][0];
    second["material"] = 1;
    file.json["meshes"][0]["primitives"].push_back(second);
    const Scene scene = load(file).scene;
    EXPECT_EQ(scene.meshes.size(), 1u);
    ASSERT_EQ(scene.instances.size(), 2u);
    EXPECT_EQ(scene.instances[0].material, 2u) << "the default one";
    EXPECT_EQ(scene.instances[1].material, 1u);
}

TEST(Gltf, ASmallPartOfALargeVertexStoreTakesOnlyItsOwnVertices) {
    GltfFile file;
    std::vector<glm::vec3> many(1000, glm::vec3(5));
    const Square square;
    std::copy(square.positions.begin(), square.positions.end(), many.begin() + 500);
    const int positions = file.vec3s(many);
    const int normals = file.vec3s(std::vector<glm::vec3>(1000, glm::vec3(0, 0, 2)));
    file.node(
        {{"mesh",
          file.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}}},
                     {"indices", file.indices(std::vector<std::uint16_t>{500, 501, 502, 500, 502, 503})}})}});
    const Mesh mesh = load(file).scene.meshes.at(0);
    EXPECT_EQ(mesh.positions, square.positions);
    EXPECT_EQ(mesh.indices, square.indices);
}

TEST(Gltf, FaultsAreNamedWithTheirPlace) {
    const auto broken = [](const std::string& pointer, const json& value) {
        GltfFile file = test::squareFile();
        file.json[json::json_pointer(pointer)] = value;
        return errorOf(file.glb());
    };
    EXPECT_THAT(broken("/accessors/0/count", 5),
                HasSubstr("test.gltf: accessors[0]: reaches beyond its buffer view"));
    EXPECT_THAT(broken("/accessors/0/count", -1), HasSubstr("accessors[0].count: is not a whole number"));
    EXPECT_THAT(broken("/accessors/0/count", 0), HasSubstr("has no elements"));
    EXPECT_THAT(broken("/accessors/0/count", 9007199254740992), HasSubstr("more than 2^32"));
    EXPECT_THAT(broken("/accessors/0/byteOffset", 9007199254740992), HasSubstr("reaches beyond"));
    EXPECT_THAT(broken("/accessors/0/componentType", 5130), HasSubstr("not a component type"));
    EXPECT_THAT(broken("/accessors/0/type", "MAT3"), HasSubstr("type"));
    EXPECT_THAT(broken("/accessors/1/count", 3), HasSubstr("another number of elements"));
    EXPECT_THAT(broken("/bufferViews/0/byteLength", 1e15),
                HasSubstr("bufferViews[0]: reaches beyond its buffer"));
    EXPECT_THAT(broken("/bufferViews/0/byteOffset", 9007199254740992),
                HasSubstr("reaches beyond its buffer"));
    EXPECT_THAT(broken("/bufferViews/0/buffer", 7), HasSubstr("buffer 7"));
    EXPECT_THAT(broken("/nodes/0/mesh", 7), HasSubstr("has no entry 7"));
    EXPECT_THAT(broken("/meshes/0/primitives/0/indices", "x"), HasSubstr("indices: is not a whole number"));
    EXPECT_THAT(broken("/meshes/0/primitives/0/material", 3), HasSubstr("material 3"));
    EXPECT_THAT(broken("/nodes/0/scale", {1, 2}), HasSubstr("wrong number of entries"));
    EXPECT_THAT(broken("/nodes/0/scale", {1e38, 1e39, 1}), HasSubstr("not a finite number"));
    EXPECT_THAT(broken("/nodes/0/rotation", {0, 0, 0, 0}), HasSubstr("zero length"));
    EXPECT_THAT(broken("/asset/version", "1.0"), HasSubstr("glTF of version 1.0"));
    EXPECT_THAT(broken("/nodes", json::array()), HasSubstr("holds no triangles"));

    GltfFile index = test::squareFile();
    index.binary[index.binary.size() - 1] = '\x7f';
    EXPECT_THAT(errorOf(index.glb()), HasSubstr("names vertex 2130706435 of only 4"));
    GltfFile position = test::squareFile();
    position.binary.replace(0, 4, std::string("\0\0\xc0\x7f", 4));
    EXPECT_THAT(errorOf(position.glb()), HasSubstr("position, number 0, that is not finite"));
    GltfFile overflow = test::squareFile();
    overflow.json["nodes"] = {{{"children", {1}}, {"scale", {1e30, 1, 1}}},
                              {{"scale", {1e30, 1, 1}}, {"mesh", 0}}};
    EXPECT_THAT(errorOf(overflow.glb()), HasSubstr("transform that overflows"));
}

}  // namespace
}  // namespace quincunx
