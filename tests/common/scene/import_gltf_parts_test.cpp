// What glTF files say of materials, vertices and motion, beyond shape and place.
#include <array>
#include <cmath>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "image/io.h"
#include "scene/animation.h"
#include "scene/import_formats.h"
#include "tests/common/scene/gltf_file.h"

namespace quincunx {
namespace {

using nlohmann::json;
using test::GltfFile;
using test::Square;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

ImportedScene load(const GltfFile& file) {
    return importGltf(file.glb(), "test.glb");
}

std::string errorOf(const GltfFile& file) {
    try {
        importGltf(file.glb(), "test.glb");
    } catch (const InputError& error) {
        return error.what();
    }
    return "no error";
}

std::string png(std::uint8_t start, int channels = 3) {
    Image8 image(4, 2, channels, Encoding::srgb);
    for (std::size_t i = 0; i < image.data.size(); ++i)
        image.data[i] = static_cast<std::uint8_t>(start + i);
    const std::vector<unsigned char> bytes = encodedPng(image, "a test's picture");
    return {bytes.begin(), bytes.end()};
}

/// A square of one material that is given, with as many textures of a picture each.
GltfFile withMaterial(const json& material, int textures) {
    GltfFile file = test::squareFile();
    file.json["materials"] = json::array({material});
    file.json["meshes"][0]["primitives"][0]["material"] = 0;
    for (int i = 0; i < textures; ++i) {
        file.json["images"].push_back(
            {{"bufferView", file.view(png(static_cast<std::uint8_t>(40 * i)))}, {"mimeType", "image/png"}});
        file.json["textures"].push_back({{"source", i}});
    }
    return file;
}

TEST(GltfMaterial, KeepsEveryTextureAndFactor) {
    const ImportedScene imported =
        load(withMaterial({{"pbrMetallicRoughness",
                            {{"baseColorTexture", {{"index", 0}}},
                             {"metallicRoughnessTexture", {{"index", 1}}},
                             {"roughnessFactor", 0.5}}},
                           {"normalTexture", {{"index", 2}, {"scale", -0.25}}},
                           {"occlusionTexture", {{"index", 3}, {"strength", 0.75}}},
                           {"emissiveTexture", {{"index", 4}}},
                           {"emissiveFactor", {1, 0.5, 0}},
                           {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}},
                           {"alphaMode", "BLEND"}},
                          5));
    EXPECT_THAT(imported.warnings, IsEmpty());
    const Material& material = imported.scene.materials[0];
    const std::vector<Texture>& textures = imported.scene.textures;
    ASSERT_EQ(textures.size(), 5u);
    EXPECT_EQ(material.baseColorTexture, TextureUse(0));
    EXPECT_EQ(material.metallicRoughnessTexture, TextureUse(1));
    EXPECT_EQ(material.normalTexture, TextureUse(2));
    EXPECT_EQ(material.normalScale, -0.25f);
    EXPECT_EQ(material.occlusionTexture, TextureUse(3));
    EXPECT_EQ(material.occlusionStrength, 0.75f);
    EXPECT_EQ(material.emissionTexture, TextureUse(4));
    EXPECT_EQ(material.emission, glm::vec3(8, 4, 0));
    EXPECT_EQ(material.alphaMode, Material::AlphaMode::blend);
    // Factors stay factors; the Phong numbers take the texture's mean: G is 40 + 1 + 3 i, i = 0 … 7.
    EXPECT_EQ(material.roughness, 0.5f);
    EXPECT_EQ(material.metallic, 1);
    const float meanRoughness = 0.5f * (41 + 3 * 3.5f) / 255;
    EXPECT_NEAR(material.shininess, std::min(2 / std::pow(meanRoughness, 4.0) - 2, 1e5), 1);
    const std::array encodings{Encoding::srgb, Encoding::linear, Encoding::linear, Encoding::linear,
                               Encoding::srgb};
    for (std::size_t i = 0; i < 5; ++i) {
        EXPECT_EQ(textures[i].image.encoding, encodings[i]) << i;
        EXPECT_EQ(textures[i].image.data[0], 40 * i);
    }
}

TEST(GltfMaterial, APictureUsedAsColourAndAsNumbersBecomesTwoTextures) {
    const Scene scene =
        load(withMaterial(
                 {{"pbrMetallicRoughness",
                   {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 0}}}}},
                  {"occlusionTexture", {{"index", 0}}},
                  {"emissiveTexture", {{"index", 0}}}},
                 1))
            .scene;
    ASSERT_EQ(scene.textures.size(), 2u);
    const Material& material = scene.materials[0];
    EXPECT_EQ(material.baseColorTexture, material.emissionTexture);
    EXPECT_EQ(material.metallicRoughnessTexture, material.occlusionTexture);
    EXPECT_EQ(scene.textures[material.baseColorTexture->texture].image.encoding, Encoding::srgb);
    EXPECT_EQ(scene.textures[material.occlusionTexture->texture].image.encoding, Encoding::linear);
    EXPECT_EQ(scene.textures[0].image.data, scene.textures[1].image.data);
}

TEST(GltfMaterial, SamplersGiveFiltersMipmapsAndWraps) {
    using Filter = Texture::Filter;
    using Mipmaps = Texture::Mipmaps;
    struct Case {
        int code;
        Filter minification;
        Mipmaps mipmaps;
    };
    for (const Case& c :
         {Case{9728, Filter::nearest, Mipmaps::none}, Case{9729, Filter::linear, Mipmaps::none},
          Case{9984, Filter::nearest, Mipmaps::nearest}, Case{9985, Filter::linear, Mipmaps::nearest},
          Case{9986, Filter::nearest, Mipmaps::linear}, Case{9987, Filter::linear, Mipmaps::linear}}) {
        GltfFile file = withMaterial({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}, 1);
        file.json["textures"][0]["sampler"] = 0;
        file.json["samplers"] = json::array({{{"minFilter", c.code}, {"magFilter", 9728}, {"wrapT", 33648}}});
        const Texture texture = load(file).scene.textures.at(0);
        EXPECT_EQ(texture.minification, c.minification) << c.code;
        EXPECT_EQ(texture.mipmaps, c.mipmaps) << c.code;
        EXPECT_EQ(texture.magnification, Filter::nearest);
        EXPECT_EQ(texture.wrapS, Texture::Wrap::repeat);
        EXPECT_EQ(texture.wrapT, Texture::Wrap::mirroredRepeat);
    }
    const Texture usual =
        load(withMaterial({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}, 1))
            .scene.textures.at(0);
    EXPECT_EQ(usual.magnification, Filter::linear);
    EXPECT_EQ(usual.mipmaps, Mipmaps::linear);
}

TEST(GltfMaterial, TextureTransformsScaleThenTurnThenMove) {
    const json transform{
        {"offset", {0.5, 0.25}}, {"rotation", std::acos(-1.0) / 2}, {"scale", {2, 3}}, {"texCoord", 1}};
    GltfFile file = withMaterial(
        {{"pbrMetallicRoughness",
          {{"baseColorTexture",
            {{"index", 0}, {"texCoord", 0}, {"extensions", {{"KHR_texture_transform", transform}}}}}}}},
        1);
    file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] =
        file.vec2s({{0, 0}, {0.5f, 0}, {0.5f, 0.5f}, {0, 0.5f}});
    file.json["extensionsRequired"] = {"KHR_texture_transform"};
    const ImportedScene imported = load(file);
    EXPECT_THAT(imported.warnings, IsEmpty());
    const TextureUse use = imported.scene.materials[0].baseColorTexture.value();
    EXPECT_EQ(use.texcoordSet, 1);
    EXPECT_EQ(imported.scene.meshes[0].texcoords1.size(), 4u);
    EXPECT_EQ(imported.scene.meshes[0].texcoords, Square().texcoords);
    // A quarter turn, counter-clockwise where t points down: s goes to −t, t to s.
    const glm::vec3 found = use.textureFromTexcoord * glm::vec3(1, 1, 1);
    EXPECT_NEAR(found.x, 0.5 + 3, 1e-6);
    EXPECT_NEAR(found.y, 0.25 - 2, 1e-6);
    EXPECT_EQ(found.z, 1);
}

TEST(GltfMaterial, HighSetsOfTextureCoordinatesTakeThePlacesOfUnusedOnes) {
    GltfFile file = withMaterial({{"pbrMetallicRoughness",
                                   {{"baseColorTexture", {{"index", 0}, {"texCoord", 3}}},
                                    {"metallicRoughnessTexture", {{"index", 1}, {"texCoord", 0}}}}},
                                  {"emissiveTexture", {{"index", 2}, {"texCoord", 2}}},
                                  {"emissiveFactor", {1, 1, 1}}},
                                 3);
    const std::vector<glm::vec2> third(4, glm::vec2(0.25f));
    json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["TEXCOORD_3"] = file.vec2s(third);
    const ImportedScene imported = load(file);
    const Material& material = imported.scene.materials[0];
    EXPECT_EQ(material.baseColorTexture->texcoordSet, 0);
    EXPECT_EQ(material.metallicRoughnessTexture->texcoordSet, 1);
    EXPECT_EQ(imported.scene.meshes[0].texcoords, third);
    EXPECT_EQ(imported.scene.meshes[0].texcoords1, Square().texcoords);
    EXPECT_FALSE(material.emissionTexture);
    EXPECT_EQ(material.emission, glm::vec3(0)) << "it would glow all over";
    EXPECT_THAT(imported.warnings, Contains(HasSubstr("third set")));
}

TEST(GltfVertices, ColoursOfAllKindsAreRead) {
    const auto loadColors = [](const char* type, int componentType, const std::string& bytes, int stride) {
        GltfFile file = test::squareFile();
        const int view = file.view(bytes, stride);
        file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
            file.accessor(view, type, componentType, 4, 0, componentType != 5126);
        const ImportedScene imported = load(file);
        EXPECT_THAT(imported.warnings, IsEmpty());
        return imported.scene.meshes[0].colors;
    };
    const std::vector<glm::vec4> expected{{1, 0, 0, 1}, {0, 1, 0, 1}, {0, 0, 1, 1}, {1, 1, 1, 1}};
    std::string floats3, floats4, bytes3, bytes4, shorts3, shorts4;
    for (const glm::vec4& color : expected) {
        floats3 += GltfFile::bytes(std::vector{glm::vec3(color)});
        floats4 += GltfFile::bytes(std::vector{color});
        for (int c = 0; c < 4; ++c) {
            const auto part = static_cast<std::uint16_t>(color[c] * 65535);
            bytes4 += static_cast<char>(part);
            bytes3 += c < 3 ? static_cast<char>(part) : 'x';  // padding
            shorts4 += GltfFile::bytes(std::vector{part});
            shorts3 += c < 3 ? GltfFile::bytes(std::vector{part}) : "xx";
        }
    }
    EXPECT_EQ(loadColors("VEC3", 5126, floats3, 0), expected);
    EXPECT_EQ(loadColors("VEC4", 5126, floats4, 0), expected);
    EXPECT_EQ(loadColors("VEC3", 5121, bytes3, 4), expected);
    EXPECT_EQ(loadColors("VEC4", 5121, bytes4, 0), expected);
    EXPECT_EQ(loadColors("VEC3", 5123, shorts3, 8), expected);
    EXPECT_EQ(loadColors("VEC4", 5123, shorts4, 0), expected);
    const std::vector<glm::vec4> odd{{-1, 2, std::nanf(""), 0.5f}, {0, 0, 0, 0}, {1, 1, 1, 1}, {1, 1, 1, 1}};
    EXPECT_EQ(loadColors("VEC4", 5126, GltfFile::bytes(odd), 0)[0], glm::vec4(0, 1, 1, 0.5f));
}

TEST(GltfVertices, TangentsAreReadMendedOrMadeForNormalMaps) {
    const json normalMap{{"normalTexture", {{"index", 0}}}};
    GltfFile file = withMaterial(normalMap, 1);
    // Made: s runs along x, the picture is upright.
    const std::vector<glm::vec4> upright(4, glm::vec4(1, 0, 0, 1));
    EXPECT_EQ(load(file).scene.meshes[0].tangents, upright);
    // Not made where no map asks for them.
    EXPECT_THAT(load(withMaterial(json::object(), 0)).scene.meshes[0].tangents, IsEmpty());
    // A mesh that one material wants with tangents and another without becomes two.
    GltfFile both = withMaterial(normalMap, 1);
    both.json["materials"].push_back(json::object());
    json second = both.json["meshes"][0]["primitives"][0];
    second["material"] = 1;
    both.json["meshes"][0]["primitives"].push_back(second);
    EXPECT_EQ(load(both).scene.meshes.size(), 2u);
    // Read: brought to unit length, the sign to 1, those without a direction mended.
    const std::vector<glm::vec4> tangents{{0, 2, 0, -0.5f}, {0, 0, 0, 1}, {1, 0, 0, 1}, {1, 0, 0, 1}};
    json& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
    attributes["TANGENT"] = file.accessor(file.view(GltfFile::bytes(tangents)), "VEC4", 5126, 4);
    const std::vector<glm::vec4> read = load(file).scene.meshes[0].tangents;
    ASSERT_EQ(read.size(), 4u);
    EXPECT_EQ(read[0], glm::vec4(0, 1, 0, -1));
    EXPECT_NEAR(glm::length(glm::vec3(read[1])), 1, 1e-6);
    EXPECT_EQ(read[1].z, 0) << "perpendicular to the normal";
    EXPECT_EQ(read[2], tangents[2]);
    // Made normals do not go with the file's tangents.
    attributes.erase("NORMAL");
    EXPECT_EQ(load(file).scene.meshes[0].tangents, std::vector<glm::vec4>(6, upright[0]));
}

/// The square on node 1 below node 0, moved by one sampler.
GltfFile animatedFile(const std::string& path, const std::string& interpolation,
                      const std::vector<float>& keys, int output) {
    GltfFile file = test::squareFile();
    file.json["nodes"] = {{{"children", {1}}, {"translation", {0, 0, 5}}}, {{"mesh", 0}}};
    file.json["scenes"] = json::array({{{"nodes", {0}}}});
    const int input = file.accessor(file.view(GltfFile::bytes(keys)), "SCALAR", 5126, keys.size());
    file.json["animations"] = json::array(
        {{{"samplers",
           json::array({{{"input", input}, {"output", output}, {"interpolation", interpolation}}})},
          {"channels", json::array({{{"sampler", 0}, {"target", {{"node", 1}, {"path", path}}}}})}}});
    return file;
}

GltfFile moving(const std::vector<float>& keys, const std::vector<glm::vec3>& values,
                const std::string& interpolation = "LINEAR") {
    GltfFile file = animatedFile("translation", interpolation, keys, 0);
    file.json["animations"][0]["samplers"][0]["output"] = file.vec3s(values);
    return file;
}

TEST(GltfAnimation, MovesWhatHangsFromItsNode) {
    ImportedScene imported = load(moving({0, 2}, {{0, 0, 0}, {4, 0, 0}}));
    EXPECT_THAT(imported.warnings, IsEmpty());
    Scene& scene = imported.scene;
    EXPECT_TRUE(isAnimated(scene));
    EXPECT_EQ(scene.nodes.size(), 2u);
    EXPECT_EQ(scene.attachments.size(), 1u);
    EXPECT_EQ(glm::vec3(scene.instances[0].worldFromModel[3]), glm::vec3(0, 0, 5)) << "at rest";
    pose(scene, 1);
    EXPECT_EQ(glm::vec3(scene.instances[0].worldFromModel[3]), glm::vec3(2, 0, 5));
}

TEST(GltfAnimation, NodesThatDoNotMoveAreNotKept) {
    GltfFile file = moving({0, 2}, {{0, 0, 0}, {4, 0, 0}});
    // A sibling beside it, and a grandchild below it, one scaled unit up.
    file.json["nodes"][0]["children"].push_back(2);
    file.node({{"mesh", 0}, {"translation", {1, 1, 1}}});
    file.json["nodes"][1]["children"] = {3};
    file.node({{"scale", {2, 2, 2}}, {"children", {4}}});
    file.node({{"mesh", 0}, {"translation", {0, 1, 0}}});
    Scene scene = load(file).scene;
    EXPECT_EQ(scene.nodes.size(), 2u);
    ASSERT_EQ(scene.instances.size(), 3u);
    EXPECT_EQ(scene.attachments.size(), 2u);
    pose(scene, 1);
    EXPECT_EQ(glm::vec3(scene.instances[0].worldFromModel[3]), glm::vec3(2, 0, 5));
    EXPECT_EQ(glm::vec3(scene.instances[1].worldFromModel[3]), glm::vec3(1, 1, 6)) << "stays";
    EXPECT_EQ(glm::vec3(scene.instances[2].worldFromModel[3]), glm::vec3(2, 2, 5));
    // Channels of nodes that bear nothing, or of no node, leave no trace.
    GltfFile idle = moving({0, 2}, {{0, 0, 0}, {4, 0, 0}});
    idle.node(json::object());
    idle.json["animations"][0]["channels"][0]["target"]["node"] = 2;
    EXPECT_FALSE(isAnimated(load(idle).scene));
    idle.json["animations"][0]["channels"][0]["target"].erase("node");
    EXPECT_TRUE(load(idle).scene.nodes.empty());
}

TEST(GltfAnimation, RotationsMayBeNormalizedIntegers) {
    // Half a turn about z and none, as shorts and as bytes.
    for (const int type : {5122, 5120}) {
        GltfFile file = animatedFile("rotation", "LINEAR", {0, 1}, 0);
        std::string values;
        for (const std::array<int, 4>& q : {std::array{0, 0, 0, 1}, std::array{0, 0, 1, 0}})
            for (const int part : q)
                values += type == 5122 ? GltfFile::bytes(std::vector{static_cast<std::int16_t>(32767 * part)})
                                       : std::string(1, static_cast<char>(127 * part));
        file.json["animations"][0]["samplers"][0]["output"] =
            file.accessor(file.view(values), "VEC4", type, 2, 0, true);
        Scene scene = load(file).scene;
        pose(scene, 0.5);
        // A quarter turn.
        EXPECT_NEAR(scene.instances[0].worldFromModel[0].y, 1, 1e-6) << type;
    }
}

TEST(GltfAnimation, AMatrixInPlaceOfTranslationRotationAndScaleIsTakenApart) {
    GltfFile file = moving({0, 2}, {{0, 0, 0}, {4, 0, 0}});
    file.json["nodes"][1]["matrix"] = {0, 2, 0, 0, -2, 0, 0, 0, 0, 0, 2, 0, 7, 8, 9, 1};
    Scene scene = load(file).scene;
    EXPECT_LT(glm::length(scene.instances[0].worldFromModel[0] - glm::vec4(0, 2, 0, 0)), 1e-6f);
    pose(scene, 1);
    EXPECT_LT(glm::length(scene.instances[0].worldFromModel[0] - glm::vec4(0, 2, 0, 0)), 1e-6f);
    EXPECT_EQ(glm::vec3(scene.instances[0].worldFromModel[3]), glm::vec3(2, 0, 5));
}

TEST(GltfAnimation, FaultsAreOneLineWithTheirPlace) {
    const std::vector<glm::vec3> two{{0, 0, 0}, {4, 0, 0}};
    const float nan = std::nanf("");
    EXPECT_THAT(errorOf(moving({1, 0}, two)), HasSubstr("not in the order of time"));
    EXPECT_THAT(errorOf(moving({0, nan}, two)), HasSubstr("time cannot be"));
    EXPECT_THAT(errorOf(moving({-1, 0}, two)), HasSubstr("time cannot be"));
    EXPECT_THAT(errorOf(moving({0, INFINITY}, two)), HasSubstr("time cannot be"));
    EXPECT_THAT(errorOf(moving({0, 1, 2}, two)), HasSubstr("2 values for 3 keys"));
    EXPECT_THAT(errorOf(moving({0, 1}, two, "CUBICSPLINE")), HasSubstr("2 values for 2 keys"));
    EXPECT_THAT(errorOf(moving({0, 1}, two, "BEZIER")), HasSubstr("interpolation"));
    EXPECT_THAT(errorOf(moving({0, 1}, {{0, 0, 0}, {nan, 0, 0}})), HasSubstr("value, number 1"));
    GltfFile wrongKind = moving({0, 1}, two);
    wrongKind.json["animations"][0]["channels"][0]["target"]["path"] = "rotation";
    EXPECT_THAT(errorOf(wrongKind), HasSubstr("values of another kind"));
    GltfFile noNode = moving({0, 1}, two);
    noNode.json["animations"][0]["channels"][0]["target"]["node"] = 9;
    EXPECT_THAT(errorOf(noNode), HasSubstr("names node 9"));
    GltfFile noSampler = moving({0, 1}, two);
    noSampler.json["animations"][0]["channels"][0]["sampler"] = 5;
    EXPECT_THAT(errorOf(noSampler), HasSubstr("animations[0].samplers: has no entry 5"));
    GltfFile noRotation = animatedFile("rotation", "STEP", {0}, 0);
    noRotation.json["animations"][0]["samplers"][0]["output"] =
        noRotation.accessor(noRotation.view(std::string(16, '\0')), "VEC4", 5126, 1);
    EXPECT_THAT(errorOf(noRotation), HasSubstr("rotation, number 0, of zero length"));
    EXPECT_EQ(errorOf(moving({0.5f}, {{1, 2, 3}})), "no error");
    EXPECT_EQ(errorOf(moving({1, 1}, two)), "no error");
}

}  // namespace
}  // namespace quincunx
