#include "scene/export_gltf.h"

#include <algorithm>
#include <cstring>
#include <fstream>
#include <functional>
#include <iterator>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include "base/error.h"
#include "scene/animation.h"
#include "scene/colonnade.h"
#include "scene/fingerprint.h"
#include "scene/import.h"
#include "scene/spaceship.h"
#include "scene/still_life.h"
#include "scene/town.h"
#include "tests/common/scene/random_scene.h"
#include "tests/support/temporary_folder.h"

namespace quincunx {
namespace {

using test::TemporaryFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

template <typename T>
bool sameBits(const std::vector<T>& a, const std::vector<T>& b) {
    static_assert(std::is_trivially_copyable_v<T>);
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

/// Names the first part that differs, where the fingerprints do not say which.
void expectSame(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.name, b.name);
    ASSERT_EQ(a.meshes.size(), b.meshes.size());
    for (std::size_t i = 0; i < a.meshes.size(); ++i) {
        const Mesh& m = a.meshes[i];
        const Mesh& n = b.meshes[i];
        EXPECT_EQ(m.name, n.name);
        EXPECT_TRUE(sameBits(m.positions, n.positions)) << "mesh " << i;
        EXPECT_TRUE(sameBits(m.normals, n.normals)) << "mesh " << i;
        EXPECT_TRUE(sameBits(m.texcoords, n.texcoords)) << "mesh " << i;
        EXPECT_TRUE(sameBits(m.texcoords1, n.texcoords1)) << "mesh " << i;
        EXPECT_TRUE(sameBits(m.tangents, n.tangents)) << "mesh " << i;
        EXPECT_TRUE(sameBits(m.colors, n.colors)) << "mesh " << i;
        EXPECT_TRUE(sameBits(m.indices, n.indices)) << "mesh " << i;
    }
    ASSERT_EQ(a.materials.size(), b.materials.size());
    for (std::size_t i = 0; i < a.materials.size(); ++i) {
        const Material& m = a.materials[i];
        const Material& n = b.materials[i];
        EXPECT_EQ(m.name, n.name);
        EXPECT_EQ(m.baseColor, n.baseColor);
        EXPECT_EQ(m.metallic, n.metallic);
        EXPECT_EQ(m.roughness, n.roughness);
        EXPECT_EQ(m.emission, n.emission) << "material " << i;
        EXPECT_EQ(m.normalScale, n.normalScale);
        EXPECT_EQ(m.occlusionStrength, n.occlusionStrength);
        EXPECT_EQ(m.alphaMode, n.alphaMode);
        EXPECT_EQ(m.alphaCutoff, n.alphaCutoff);
        EXPECT_EQ(m.doubleSided, n.doubleSided);
        EXPECT_EQ(m.transmission, n.transmission) << "material " << i;
        EXPECT_EQ(m.ior, n.ior) << "material " << i;
        for (auto use : {&Material::baseColorTexture, &Material::metallicRoughnessTexture,
                         &Material::normalTexture, &Material::occlusionTexture, &Material::emissionTexture})
            EXPECT_EQ(m.*use, n.*use) << "material " << i;
        EXPECT_EQ(m.ambient, n.ambient);
        EXPECT_EQ(m.diffuse, n.diffuse);
        EXPECT_EQ(m.specular, n.specular);
        EXPECT_EQ(m.shininess, n.shininess) << "material " << i;
    }
    ASSERT_EQ(a.textures.size(), b.textures.size());
    for (std::size_t i = 0; i < a.textures.size(); ++i) {
        EXPECT_EQ(a.textures[i].name, b.textures[i].name);
        EXPECT_EQ(a.textures[i].image, b.textures[i].image) << "texture " << i;
        EXPECT_EQ(a.textures[i].wrapS, b.textures[i].wrapS);
        EXPECT_EQ(a.textures[i].wrapT, b.textures[i].wrapT);
        EXPECT_EQ(a.textures[i].magnification, b.textures[i].magnification);
        EXPECT_EQ(a.textures[i].minification, b.textures[i].minification);
        EXPECT_EQ(a.textures[i].mipmaps, b.textures[i].mipmaps);
    }
    ASSERT_EQ(a.instances.size(), b.instances.size());
    for (std::size_t i = 0; i < a.instances.size(); ++i) {
        EXPECT_EQ(a.instances[i].name, b.instances[i].name);
        EXPECT_EQ(a.instances[i].mesh, b.instances[i].mesh) << "instance " << i;
        EXPECT_EQ(a.instances[i].material, b.instances[i].material) << "instance " << i;
        EXPECT_EQ(a.instances[i].worldFromModel, b.instances[i].worldFromModel) << "instance " << i;
    }
    ASSERT_EQ(a.lights.size(), b.lights.size());
    for (std::size_t i = 0; i < a.lights.size(); ++i) {
        EXPECT_EQ(a.lights[i].name, b.lights[i].name);
        EXPECT_EQ(a.lights[i].kind, b.lights[i].kind);
        EXPECT_EQ(a.lights[i].position, b.lights[i].position);
        EXPECT_EQ(a.lights[i].direction, b.lights[i].direction) << "light " << i;
        EXPECT_EQ(a.lights[i].color, b.lights[i].color);
        EXPECT_EQ(a.lights[i].intensity, b.lights[i].intensity);
        EXPECT_EQ(a.lights[i].range, b.lights[i].range);
        EXPECT_EQ(a.lights[i].innerConeRadians, b.lights[i].innerConeRadians);
        EXPECT_EQ(a.lights[i].outerConeRadians, b.lights[i].outerConeRadians);
    }
    ASSERT_EQ(a.cameras.size(), b.cameras.size());
    for (std::size_t i = 0; i < a.cameras.size(); ++i) {
        EXPECT_EQ(a.cameras[i].worldFromCamera, b.cameras[i].worldFromCamera) << "camera " << i;
        EXPECT_EQ(a.cameras[i].farDistance, b.cameras[i].farDistance);
        EXPECT_EQ(a.cameras[i].focusDistance, b.cameras[i].focusDistance);
    }
    ASSERT_EQ(a.nodes.size(), b.nodes.size());
    for (std::size_t i = 0; i < a.nodes.size(); ++i) {
        EXPECT_EQ(a.nodes[i].name, b.nodes[i].name);
        EXPECT_EQ(a.nodes[i].parent, b.nodes[i].parent);
        EXPECT_EQ(a.nodes[i].rotation, b.nodes[i].rotation) << "node " << i;
    }
    ASSERT_EQ(a.attachments.size(), b.attachments.size());
    ASSERT_EQ(a.animations.size(), b.animations.size());
    for (std::size_t i = 0; i < a.animations.size(); ++i) {
        EXPECT_EQ(a.animations[i].name, b.animations[i].name);
        EXPECT_EQ(a.animations[i].channels, b.animations[i].channels);
        ASSERT_EQ(a.animations[i].samplers.size(), b.animations[i].samplers.size());
        for (std::size_t s = 0; s < a.animations[i].samplers.size(); ++s) {
            EXPECT_TRUE(sameBits(a.animations[i].samplers[s].seconds, b.animations[i].samplers[s].seconds));
            EXPECT_TRUE(sameBits(a.animations[i].samplers[s].values, b.animations[i].samplers[s].values));
        }
    }
    ASSERT_EQ(a.environment.has_value(), b.environment.has_value());
    if (a.environment) {
        EXPECT_EQ(a.environment->panorama, b.environment->panorama);
        EXPECT_EQ(a.environment->tint, b.environment->tint);
    }
    EXPECT_EQ(fingerprint(a), fingerprint(b));
}

/// Written and read as .gltf or .glb.
Scene throughFile(const Scene& scene, const std::string& name) {
    const TemporaryFolder folder;
    exportScene(scene, folder / name);
    const ImportedScene imported = importScene(folder / name);
    const bool glass = std::any_of(scene.materials.begin(), scene.materials.end(),
                                   [](const Material& material) { return material.transmission > 0; });
    if (glass)
        EXPECT_THAT(imported.warnings, ElementsAre(HasSubstr("glass")));
    else
        EXPECT_THAT(imported.warnings, IsEmpty());
    return imported.scene;
}

std::string errorOf(const Scene& scene, const std::string& name = "x.glb") {
    const TemporaryFolder folder;
    try {
        exportScene(scene, folder / name);
    } catch (const InputError& error) {
        EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "nothing is left half written";
        return error.what();
    }
    return "no error";
}

Scene builtIn(int which) {
    switch (which) {
        case 0:
            return tessellate(makeStillLife(), 12);
        case 1:
            return tessellate(makeColonnade(), 12);
        case 2:
            return makeTown().scene;
        default:
            return makeSpaceship(12);
    }
}

TEST(ExportGltf, BuiltInScenesComeBackBitForBit) {
    for (int which = 0; which < 4; ++which) {
        SCOPED_TRACE(which);
        const Scene scene = builtIn(which);
        expectSame(scene, throughFile(scene, which % 2 == 0 ? "scene.glb" : "scene.gltf"));
    }
}

TEST(ExportGltf, RandomScenesComeBackBitForBit) {
    int animated = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        SCOPED_TRACE(seed);
        const Scene scene = test::randomScene(seed);
        Scene read = throughFile(scene, seed % 2 == 0 ? "scene.glb" : "scene.GLTF");
        expectSame(scene, read);
        if (!isAnimated(scene))
            continue;
        ++animated;
        Scene posed = scene;
        pose(posed, 0.7);
        pose(read, 0.7);
        EXPECT_EQ(fingerprint(posed), fingerprint(read));
        // What was posed is written at rest.
        expectSame(scene, throughFile(posed, "posed.glb"));
    }
    EXPECT_GT(animated, 50);
}

TEST(ExportGltf, WritesTheSameFileForTheSameScene) {
    const TemporaryFolder folder;
    const auto contents = [&](const char* name) {
        exportScene(test::randomScene(5), folder / name);
        std::ifstream stream(folder / name, std::ios::binary);
        return std::string(std::istreambuf_iterator<char>(stream), {});
    };
    EXPECT_EQ(contents("one.glb"), contents("two.glb"));
}

TEST(ExportGltf, AnIndependentReaderFindsTheSameCounts) {
    const TemporaryFolder folder;
    const auto check = [&](const Scene& scene, bool isBinary) {
        const std::string file = (folder / (isBinary ? "scene.glb" : "scene.gltf")).string();
        exportScene(scene, file);
        tinygltf::TinyGLTF reader;
        tinygltf::Model model;
        std::string error;
        std::string warning;
        const bool isRead = isBinary ? reader.LoadBinaryFromFile(&model, &error, &warning, file)
                                     : reader.LoadASCIIFromFile(&model, &error, &warning, file);
        ASSERT_TRUE(isRead) << error;
        EXPECT_EQ(error, "");
        EXPECT_EQ(warning, "");
        EXPECT_EQ(model.materials.size(), scene.materials.size());
        EXPECT_EQ(model.textures.size(), scene.textures.size());
        EXPECT_EQ(model.cameras.size(), scene.cameras.size());
        EXPECT_EQ(model.lights.size(), scene.lights.size());
        EXPECT_EQ(model.animations.size(), scene.animations.size());
        EXPECT_EQ(model.nodes.size(),
                  scene.nodes.size() + scene.instances.size() + scene.lights.size() + scene.cameras.size());
        std::size_t triangles = 0;
        for (const tinygltf::Node& node : model.nodes)
            if (node.mesh >= 0)
                for (const tinygltf::Primitive& part :
                     model.meshes[static_cast<std::size_t>(node.mesh)].primitives)
                    triangles += model.accessors[static_cast<std::size_t>(part.indices)].count / 3;
        EXPECT_EQ(triangles, scene.triangleCount());
        for (std::size_t i = 0; i < scene.textures.size(); ++i) {
            EXPECT_EQ(model.images[i].width, scene.textures[i].image.width);
            EXPECT_EQ(model.images[i].height, scene.textures[i].image.height);
        }
    };
    for (int which = 0; which < 4; ++which)
        check(builtIn(which), which % 2 == 0);
    for (std::uint64_t seed = 0; seed < 40; ++seed)
        check(test::randomScene(seed), seed % 2 == 0);
}

TEST(ExportGltf, LeavesOutWhatNothingShows) {
    Scene scene = tessellate(makeStillLife(), 6);
    const Scene whole = scene;
    scene.textures.push_back({"unused", Image8(2, 2, 3, Encoding::srgb)});
    scene.meshes.push_back(scene.meshes[0]);
    scene.meshes.emplace_back();
    scene.instances.push_back({"empty", scene.meshes.size() - 1, 0, glm::mat4(1)});
    scene.nodes.resize(3);
    EXPECT_EQ(fingerprint(throughFile(scene, "x.gltf")), fingerprint(whole));
}

TEST(ExportGltf, WhatCannotBeWrittenIsOneLineAndNoFile) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const Scene good = test::randomScene(3);
    const auto broken = [&](const std::function<void(Scene&)>& change) {
        Scene scene = tessellate(makeStillLife(), 6);
        scene.cameras.resize(1);
        change(scene);
        return errorOf(scene);
    };
    EXPECT_THAT(broken([](Scene& s) { s.instances.clear(); }), HasSubstr("without triangles"));
    EXPECT_THAT(broken([&](Scene& s) { s.instances[2].worldFromModel[3].x = nan; }),
                HasSubstr("instance 2 of the scene has a number that is not finite"));
    EXPECT_THAT(broken([](Scene& s) { s.instances[1].worldFromModel[0].w = 1; }),
                HasSubstr("instance 1 of the scene is placed by a matrix whose last row"));
    EXPECT_THAT(broken([&](Scene& s) { s.meshes[0].positions[0].y = nan; }), HasSubstr("mesh 0"));
    EXPECT_THAT(broken([&](Scene& s) { s.materials[0].roughness = nan; }), HasSubstr("material 0"));
    EXPECT_THAT(broken([&](Scene& s) { s.materials[0].emission.x = nan; }), HasSubstr("material 0"));
    EXPECT_THAT(broken([&](Scene& s) { s.lights[0].direction.x = nan; }), HasSubstr("light 0"));
    EXPECT_THAT(broken([&](Scene& s) { s.lights[0].position.x = nan; }), HasSubstr("light 0"));
    EXPECT_THAT(broken([&](Scene& s) { s.cameras[0].worldFromCamera[3].y = nan; }), HasSubstr("camera 0"));
    EXPECT_THAT(broken([&](Scene& s) { s.ambientLight.y = nan; }), HasSubstr("the ambient light"));
    EXPECT_THAT(broken([](Scene& s) {
                    s.textures.emplace_back();
                    s.materials[0].baseColorTexture = TextureUse(0);
                }),
                HasSubstr("texture 0 of the scene has no pixels"));
    EXPECT_THAT(errorOf(good, "scene.obj"), HasSubstr("not a kind of model that can be written"));
    EXPECT_THROW(exportScene(good, "/proc/no folder/scene.glb"), InputError);
}

TEST(ExportGltf, NamesOfAnyBytesAreWritten) {
    Scene scene = tessellate(makeStillLife(), 6);
    scene.materials[0].name = "quote \" backslash \\ snowman \xe2\x98\x83";
    scene.materials[1].name = "not UTF-8: \xff\xfe";
    scene.instances[0].name = "line\nbreak";
    const Scene read = throughFile(scene, "x.gltf");
    EXPECT_EQ(read.materials[0].name, scene.materials[0].name);
    EXPECT_THAT(read.materials[1].name, HasSubstr("not UTF-8"));
    EXPECT_EQ(read.instances[0].name, "line\\nbreak");
    EXPECT_EQ(fingerprint(read), fingerprint(scene));
}

}  // namespace
}  // namespace quincunx
