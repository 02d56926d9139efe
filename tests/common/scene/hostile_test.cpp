// Files that lie, break off or make no sense: each is loaded or refused with one line, in bounded memory.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/file.h"
#include "base/random.h"
#include "scene/animation.h"
#include "scene/export_gltf.h"
#include "scene/import_formats.h"
#include "tests/common/scene/gltf_file.h"
#include "tests/common/scene/random_scene.h"
#include "tests/support/allocations.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using nlohmann::json;
using test::GltfFile;
using testing::HasSubstr;

struct Outcome {
    bool loaded = false;
    std::string error;
    std::size_t mostBytes = 0;  ///< allocated at the same time
};

bool isFinite(const glm::mat4& m) {
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            if (!std::isfinite(m[column][row]))
                return false;
    return true;
}

/// What was loaded is whole: indices in range, one entry a vertex or none, frames of unit length.
void expectWhole(const Scene& scene) {
    for (const Mesh& mesh : scene.meshes) {
        const std::size_t count = mesh.positions.size();
        EXPECT_EQ(mesh.normals.size(), count);
        EXPECT_TRUE(mesh.texcoords.empty() || mesh.texcoords.size() == count);
        EXPECT_TRUE(mesh.texcoords1.empty() || mesh.texcoords1.size() == count);
        EXPECT_TRUE(mesh.tangents.empty() || mesh.tangents.size() == count);
        EXPECT_TRUE(mesh.colors.empty() || mesh.colors.size() == count);
        for (const std::uint32_t index : mesh.indices)
            EXPECT_LT(index, count);
        for (const glm::vec3& normal : mesh.normals)
            EXPECT_NEAR(glm::length(glm::dvec3(normal)), 1, 1e-6);
        for (const glm::vec4& tangent : mesh.tangents)
            EXPECT_NEAR(glm::length(glm::dvec3(glm::vec3(tangent))), 1, 1e-6);
    }
    for (const Material& material : scene.materials)
        for (const auto& use : {material.baseColorTexture, material.metallicRoughnessTexture,
                                material.normalTexture, material.occlusionTexture, material.emissionTexture})
            if (use) {
                EXPECT_LT(use->texture, scene.textures.size());
            }
    for (const Instance& instance : scene.instances) {
        EXPECT_LT(instance.mesh, scene.meshes.size());
        EXPECT_LT(instance.material, scene.materials.size());
    }
    // `pose` checks the indices of what moves.
    Scene posed = scene;
    for (const double seconds : {0.0, 0.3, animationSeconds(scene), 1e9}) {
        pose(posed, seconds);
        for (const Instance& instance : posed.instances)
            EXPECT_TRUE(isFinite(instance.worldFromModel));
        for (const Camera& camera : posed.cameras)
            EXPECT_TRUE(isFinite(camera.worldFromCamera));
        for (const Light& light : posed.lights)
            EXPECT_NEAR(glm::length(glm::dvec3(light.direction)), 1, 1e-6);
        if (!isAnimated(scene))
            break;
    }
}

Outcome attempt(const std::string& contents, bool isObj = false) {
    Outcome outcome;
    test::restartMostAllocatedBytes();
    const std::size_t before = test::allocatedBytes();
    try {
        const ImportedScene imported =
            isObj ? importObj(contents, "hostile.obj") : importGltf(contents, "hostile.gltf");
        outcome.loaded = true;
        outcome.mostBytes = test::mostAllocatedBytes() - before;
        expectWhole(imported.scene);
        for (const std::string& warning : imported.warnings)
            EXPECT_EQ(warning.find('\n'), std::string::npos) << warning;
    } catch (const InputError& error) {
        outcome.error = error.what();
        EXPECT_FALSE(outcome.error.empty());
        EXPECT_EQ(outcome.error.find('\n'), std::string::npos) << outcome.error;
        EXPECT_LT(outcome.error.size(), 1000u);
    }
    if (!outcome.loaded)
        outcome.mostBytes = test::mostAllocatedBytes() - before;
    return outcome;
}

/// A file with something of everything.
GltfFile richFile() {
    GltfFile file = test::squareFile();
    file.json["materials"] = {{{"name", "m"},
                               {"pbrMetallicRoughness",
                                {{"baseColorFactor", {1, 1, 1, 1}},
                                 {"baseColorTexture", {{"index", 0}, {"texCoord", 0}}},
                                 {"metallicFactor", 0.5}}},
                               {"alphaMode", "BLEND"}}};
    file.json["meshes"][0]["primitives"][0]["material"] = 0;
    file.json["textures"] = json::array({{{"source", 0}, {"sampler", 0}}});
    file.json["samplers"] = json::array({{{"wrapS", 33071}}});
    file.json["images"] = json::array({{{"bufferView", file.view("not a picture")}}});
    file.json["accessors"][0]["sparse"] = {
        {"count", 1},
        {"indices", {{"bufferView", file.view(std::string(1, '\2'))}, {"componentType", 5121}}},
        {"values", {{"bufferView", file.view(GltfFile::bytes(std::vector<glm::vec3>{{1, 1, 0}}))}}}};
    file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.5}}}}};
    file.json["extensionsUsed"] = {"KHR_lights_punctual"};
    file.json["extensions"]["KHR_lights_punctual"]["lights"] =
        json::array({{{"type", "spot"}, {"color", {1, 1, 1}}, {"spot", {{"outerConeAngle", 0.5}}}}});
    file.json["nodes"] = json::array();
    file.node({{"children", {1, 2, 3}}});
    file.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] =
        file.accessor(file.view(std::string(16, '\x77')), "VEC4", 5121, 4, 0, true);
    file.json["materials"][0]["normalTexture"] = {{"index", 0}, {"texCoord", 0}, {"scale", 2}};
    file.json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["extensions"] = {
        {"KHR_texture_transform", {{"offset", {0, 1}}, {"rotation", 1}, {"scale", {2, 2}}, {"texCoord", 0}}}};
    const int keys =
        file.accessor(file.view(GltfFile::bytes(std::vector<float>{0, 1, 2})), "SCALAR", 5126, 3);
    const int places = file.vec3s(std::vector<glm::vec3>(9, glm::vec3(1, 2, 3)));
    const int turns = file.accessor(
        file.view(GltfFile::bytes(std::vector<glm::vec4>(3, glm::vec4(0, 0, 1, 1)))), "VEC4", 5126, 3);
    file.json["animations"] = {{{"name", "a"},
                                {"samplers",
                                 {{{"input", keys}, {"output", places}, {"interpolation", "CUBICSPLINE"}},
                                  {{"input", keys}, {"output", turns}}}},
                                {"channels",
                                 {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
                                  {{"sampler", 1}, {"target", {{"node", 1}, {"path", "rotation"}}}}}}}};
    file.node({{"mesh", 0}, {"translation", {1, 2, 3}}, {"rotation", {0, 0, 0, 1}}, {"scale", {1, -1, 1}}});
    file.node({{"camera", 0}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    file.node({{"mesh", 0}, {"matrix", {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}}});
    file.json["scenes"] = json::array({{{"nodes", {0}}, {"name", "s"}}});
    file.json["scene"] = 0;
    return file;
}

const std::string richObj =
    "mtllib gone.mtl\no part\nv 0 0 0\nv 1 0 0.5\nv 1 1 -1e-3\nv 0 1 0\nv 0.5 0.5 2\nvt 0 0\nvt 1 1\nvn 0 0 "
    "1\n"
    "usemtl a\ns 1\nf 1/1/1 2/2/1 3/1/1 4/2/1\nusemtl b\ns 2\nf 1 2 5\nf 2//1 3//1 5//1\ng q\ns off\nf -1 -2 "
    "-3\n"
    "f 1 2 \\\n 3 5 4\nl 1 2\n";

TEST(Hostile, WholeFilesLoad) {
    EXPECT_TRUE(attempt(richFile().glb()).loaded) << attempt(richFile().glb()).error;
    EXPECT_TRUE(attempt(richFile().embedded()).loaded);
    EXPECT_TRUE(attempt(richObj, true).loaded) << attempt(richObj, true).error;
}

TEST(Hostile, CutOffAnywhereFilesAreRefusedOrLoad) {
    const std::string glb = richFile().glb();
    for (std::size_t length = 0; length < glb.size(); ++length)
        EXPECT_FALSE(attempt(glb.substr(0, length)).loaded) << length;
    const std::string text = richFile().embedded();
    for (std::size_t length = 0; length < text.size(); length += 3)
        EXPECT_FALSE(attempt(text.substr(0, length)).loaded) << length;
    for (std::size_t length = 0; length < richObj.size(); ++length)
        attempt(richObj.substr(0, length), true);
}

TEST(Hostile, FlippedBytesAreRefusedOrLoad) {
    Random random(2024);
    const std::array<std::string, 3> originals{richFile().glb(), richFile().embedded(), richObj};
    std::array<int, 3> loaded{};
    const int rounds = 1500;
    for (std::size_t kind = 0; kind < 3; ++kind)
        for (int round = 0; round < rounds; ++round) {
            std::string broken = originals[kind];
            for (std::uint64_t flips = 1 + random.below(4); flips > 0; --flips)
                broken[random.below(broken.size())] = static_cast<char>(random.bits());
            loaded[kind] += attempt(broken, kind == 2).loaded;
        }
    for (const int count : loaded) {
        // Some flips fall on names and numbers, others on what matters: both happen often.
        EXPECT_GT(count, rounds / 50);
        EXPECT_LT(count, rounds);
    }
}

/// Calls `visit` with every value below `value`.
void forEachPlace(const json& value, const std::string& pointer,
                  const std::function<void(const std::string&)>& visit) {
    if (value.is_object())
        for (const auto& [key, member] : value.items()) {
            const std::string place = fmt::format("{}/{}", pointer, key);
            visit(place);
            forEachPlace(member, place, visit);
        }
    else if (value.is_array())
        for (std::size_t i = 0; i < value.size(); ++i) {
            visit(fmt::format("{}/{}", pointer, i));
            forEachPlace(value[i], fmt::format("{}/{}", pointer, i), visit);
        }
}

TEST(Hostile, EveryValueOfAGltfFileMayBeMissingOrWrong) {
    const GltfFile original = richFile();
    const std::vector<json> wrong{
        nullptr, -1,   0,  7,      1e300,         4294967295u,    9007199254740993,
        0.5,     true, "", "5126", json::array(), json::object(), json::array({1, 2, 3})};
    int attempts = 0;
    int refused = 0;
    forEachPlace(original.json, "", [&](const std::string& pointer) {
        GltfFile without = original;
        const json::json_pointer place(pointer);
        const std::string& key = place.back();
        json& parent = without.json[place.parent_pointer()];
        if (parent.is_array())
            parent.erase(static_cast<std::size_t>(std::stoul(key)));
        else
            parent.erase(key);
        refused += !attempt(without.glb()).loaded;
        ++attempts;
        for (const json& value : wrong) {
            GltfFile replaced = original;
            replaced.json[place] = value;
            refused += !attempt(replaced.glb()).loaded;
            ++attempts;
        }
    });
    EXPECT_GT(attempts, 2000);
    EXPECT_GT(refused, attempts / 4);
}

/// One of many values that do harm, or any other value of the document.
json oddValue(Random& random, const json& document) {
    const std::vector<json> odd{nullptr,
                                -1,
                                0,
                                1,
                                2,
                                5123,
                                5126,
                                1e38,
                                -1e38,
                                1e-45,
                                0.5,
                                65535u,
                                4294967295u,
                                9007199254740992,
                                true,
                                "",
                                "VEC4",
                                "SCALAR",
                                "rotation",
                                "CUBICSPLINE",
                                json::array(),
                                json::object(),
                                json::array({0, 0, 0, 0})};
    if (random.below(3) > 0)
        return odd[random.below(odd.size())];
    std::vector<std::string> places;
    forEachPlace(document, "", [&](const std::string& place) { places.push_back(place); });
    return document[json::json_pointer(places[random.below(places.size())])];
}

TEST(Hostile, WrittenScenesWithBytesAndValuesChangedAreRefusedOrLoad) {
    const test::TemporaryFolder folder;
    Random random(4711);
    int attempts = 0;
    int loaded = 0;
    std::size_t most = 0;
    // QUINCUNX_FUZZ_SCENES asks for more than the suite has time for.
    const char* const asked = std::getenv("QUINCUNX_FUZZ_SCENES");
    const std::uint64_t scenes = asked ? std::strtoull(asked, nullptr, 10) : 12;
    const auto tryOne = [&](const std::string& contents) {
        const Outcome outcome = attempt(contents);
        ++attempts;
        loaded += outcome.loaded;
        most = std::max(most, outcome.mostBytes);
    };
    for (std::uint64_t seed = 0; seed < scenes; ++seed) {
        exportScene(test::randomScene(seed), folder / "scene.glb");
        const std::string binary = readFile(folder / "scene.glb", 1 << 24);
        exportScene(test::randomScene(seed), folder / "scene.gltf");
        const json document = json::parse(readFile(folder / "scene.gltf", 1 << 24));
        std::vector<std::string> places;
        forEachPlace(document, "", [&](const std::string& place) { places.push_back(place); });
        for (int round = 0; round < 25; ++round) {
            std::string broken = binary;
            for (std::uint64_t flips = 1 + random.below(6); flips > 0; --flips)
                broken[random.below(broken.size())] = static_cast<char>(random.bits());
            tryOne(broken);
            json changed = document;
            for (std::uint64_t changes = 1 + random.below(2); changes > 0; --changes)
                try {
                    const json value = oddValue(random, document);
                    changed[json::json_pointer(places[random.below(places.size())])] = value;
                } catch (const json::exception&) {
                    // The place went with an earlier change.
                }
            tryOne(changed.dump());
        }
    }
    EXPECT_EQ(attempts, static_cast<int>(50 * scenes));
    EXPECT_GT(loaded, attempts / 20);
    EXPECT_LT(loaded, attempts);
    // Zeros of which the file has no bytes may take 64 MiB; measured: 67.2 MB.
    EXPECT_LT(most, std::size_t{96} << 20);
}

TEST(Hostile, LyingHeadersOfBinaryFilesAreRefused) {
    const std::string glb = richFile().glb();
    for (const std::size_t offset : {4u, 8u, 12u, 16u})
        for (const std::uint32_t value : {0u, 1u, 3u, 0x7fffffffu, 0x80000000u, 0xfffffffcu, 0xffffffffu}) {
            std::string broken = glb;
            std::string bytes;
            GltfFile::put32(bytes, value);
            broken.replace(offset, 4, bytes);
            EXPECT_FALSE(attempt(broken).loaded) << offset << " " << value;
        }
    EXPECT_THAT(attempt("glTF").error, HasSubstr("cut off"));
    EXPECT_THAT(attempt(std::string("glTF\1\0\0\0", 8) + std::string(40, ' ')).error, HasSubstr("version 1"));
    EXPECT_FALSE(attempt("GLTF" + glb.substr(4)).loaded);
}

TEST(Hostile, DeepJsonNeedsNoDeepStack) {
    for (const char* open : {"[", "{\"a\":", "[{\"a\":"}) {
        std::string deep;
        for (int i = 0; i < 1'000'000; ++i)
            deep += open;
        EXPECT_THAT(attempt(deep).error, HasSubstr("nested"));
    }
    EXPECT_THAT(attempt("{\"a\":\"" + std::string(1000, '[') + "\"}").error, HasSubstr("asset"));
}

TEST(Hostile, HugeCountsCostNoMemory) {
    const auto withAccessor = [](const json& accessor) {
        GltfFile file = test::squareFile();
        for (const auto& [key, value] : accessor.items())
            file.json["accessors"][0][key] = value;
        return attempt(file.glb());
    };
    for (const std::uint64_t count :
         {std::uint64_t{1} << 24, std::uint64_t{1} << 31, (std::uint64_t{1} << 32) - 2,
          std::uint64_t{1} << 40, std::uint64_t{1} << 53, ~std::uint64_t{0}}) {
        const Outcome outcome = withAccessor({{"count", count}});
        EXPECT_FALSE(outcome.loaded);
        // Measured: 6 kB, nearly all of it the JSON.
        EXPECT_LT(outcome.mostBytes, std::size_t{1} << 20) << count;
    }
    for (const std::uint64_t count : {std::uint64_t{1} << 21, std::uint64_t{1} << 31}) {
        // Zeros that no bytes stand behind.
        GltfFile file = test::squareFile();
        file.json["accessors"][0]["count"] = count;
        file.json["accessors"][0].erase("bufferView");
        const Outcome outcome = attempt(file.glb());
        EXPECT_THAT(outcome.error, HasSubstr("more elements than its file has bytes"));
        EXPECT_LT(outcome.mostBytes, std::size_t{1} << 20);
    }
    for (const char* declared : {"536870912", "2147483647", "-536870912", "9223372036854775807"}) {
        const Outcome outcome = attempt(fmt::format("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {}\n", declared), true);
        EXPECT_FALSE(outcome.loaded);
        EXPECT_LT(outcome.mostBytes, std::size_t{1} << 20);
    }
}

TEST(Hostile, SharingDoesNotMultiplyMemory) {
    // 3000 meshes, each of the same 60 000 vertices as a strip with no normals, shifted by one byte of
    // indices.
    GltfFile file;
    const int positions = file.vec3s(std::vector<glm::vec3>(250, glm::vec3(1)));
    const int indexView = file.view(std::string(70'000, '\1'));
    for (std::size_t i = 0; i < 3000; ++i) {
        const int indices = file.accessor(indexView, "SCALAR", 5121, 60'000, i);
        file.node(
            {{"mesh",
              file.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", 5}})}});
    }
    const Outcome meshes = attempt(file.glb());
    EXPECT_THAT(meshes.error, HasSubstr("more geometry than a file of this size should"));
    // The allowance: 64 MiB, and 128 bytes for each byte of the file, plus the JSON. Measured: 111 MB.
    EXPECT_LT(meshes.mostBytes, (std::size_t{64} << 20) + 160 * file.glb().size());

    // A thousand nodes of a mesh of two thousand parts.
    GltfFile many = test::squareFile();
    json& primitives = many.json["meshes"][0]["primitives"];
    for (int i = 0; i < 11; ++i)
        for (std::size_t k = primitives.size(); k > 0; --k)
            primitives.push_back(json(primitives[k - 1]));
    many.json["nodes"] = json::array();
    for (int i = 0; i < 1000; ++i)
        many.node({{"mesh", 0}});
    const Outcome instances = attempt(many.glb());
    EXPECT_THAT(instances.error, HasSubstr("instances"));
    // 65 536 instances and one for each of the file's 151 000 bytes, of 120 bytes, in a vector that is being
    // copied into one of twice its size.
    EXPECT_LT(instances.mostBytes, std::size_t{64} << 20);
}

TEST(Hostile, ManyBuffersOfTheSameBytesAreReadOnce) {
    GltfFile file = test::squareFile();
    const std::string uri = "data:application/octet-stream;base64," + GltfFile::base64(file.binary);
    const std::string large(1 << 20, 'A');
    json whole = json::parse(file.text(uri));
    for (int i = 0; i < 200; ++i)
        whole["buffers"].push_back(
            {{"byteLength", 786'432}, {"uri", "data:;base64," + (i < 1 ? large : "")}});
    const Outcome outcome = attempt(whole.dump());
    EXPECT_TRUE(outcome.loaded) << outcome.error;
    // The text, its JSON, the bytes decoded and their names. Measured: 5.2 MB.
    EXPECT_LT(outcome.mostBytes, 8 * whole.dump().size());
}

TEST(Hostile, GarbageIsRefusedInOneLine) {
    Random random(99);
    for (int round = 0; round < 300; ++round) {
        std::string garbage(random.below(2000), '\0');
        for (char& c : garbage)
            c = static_cast<char>(round % 3 == 0 ? random.bits() : 32 + random.below(95));
        EXPECT_FALSE(attempt(garbage).loaded);
        EXPECT_FALSE(attempt(garbage, true).loaded);
        EXPECT_FALSE(attempt("glTF" + garbage).loaded);
        // Lines that begin well.
        std::string lines;
        for (const char* begin : {"v ", "vn ", "vt ", "f ", "usemtl ", "mtllib ", "s "})
            lines += begin + garbage.substr(0, random.below(garbage.size() + 1)) + "\n";
        attempt("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n" + lines, true);
    }
}

}  // namespace
}  // namespace quincunx
