#include "scene/fingerprint.h"

#include <functional>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "geometry/shapes.h"
#include "scene/still_life.h"

namespace quincunx {
namespace {

Scene someScene() {
    Scene scene = tessellate(makeStillLife(), 6);
    scene.textures.push_back({"paper", Image8(2, 2, 3, Encoding::srgb)});
    scene.cameras.emplace_back();
    return scene;
}

TEST(Fingerprint, IsTheSameForTheSameSceneWhateverItsNames) {
    Scene renamed = someScene();
    renamed.name = "another";
    renamed.meshes[0].name = "another";
    renamed.materials[0].name = "another";
    EXPECT_EQ(fingerprint(renamed), fingerprint(someScene()));
}

TEST(Fingerprint, TellsEveryChangeFromEveryOther) {
    const std::vector<std::function<void(Scene&)>> changes = {
        [](Scene&) {},
        [](Scene& s) { s.meshes[0].positions[3].y += 1e-6f; },
        [](Scene& s) { s.meshes[0].normals[3].y = -s.meshes[0].normals[3].y; },
        [](Scene& s) { s.meshes[0].texcoords[1].x += 0.5f; },
        [](Scene& s) { std::swap(s.meshes[0].indices[0], s.meshes[0].indices[1]); },
        [](Scene& s) { s.meshes[0].indices.resize(s.meshes[0].indices.size() - 3); },
        [](Scene& s) { s.meshes.pop_back(); },
        [](Scene& s) { s.materials[1].baseColor.a = 0.5f; },
        [](Scene& s) { s.materials[1].shininess += 1; },
        [](Scene& s) { s.materials[1].doubleSided = !s.materials[1].doubleSided; },
        [](Scene& s) { s.materials[1].transmission += 0.25f; },
        [](Scene& s) { s.materials[1].ior += 0.25f; },
        [](Scene& s) { s.environment = Environment{}; },
        [](Scene& s) { s.environment = Environment{Image(2, 1, 3, Encoding::linear)}; },
        [](Scene& s) {
            s.environment = Environment{Image(2, 1, 3, Encoding::linear), glm::vec3(0.5f)};
        },
        [](Scene& s) { s.materials[1].baseColorTexture = 0; },
        [](Scene& s) { s.materials[1].normalTexture = 0; },
        [](Scene& s) {
            s.materials[1].normalTexture = 0;
            s.materials[1].normalTexture->texcoordSet = 1;
        },
        [](Scene& s) {
            s.materials[1].emissionTexture = 0;
            s.materials[1].emissionTexture->textureFromTexcoord[2].x = 0.5f;
        },
        [](Scene& s) { s.materials[1].normalScale = 2; },
        [](Scene& s) { s.meshes[0].colors.assign(s.meshes[0].positions.size(), glm::vec4(1)); },
        [](Scene& s) { s.textures[0].mipmaps = Texture::Mipmaps::none; },
        [](Scene& s) { s.cameras[0].apertureRadius = 0.1f; },
        [](Scene& s) { s.textures[0].image.data[5] = 1; },
        [](Scene& s) { s.textures[0].wrapT = Texture::Wrap::clampToEdge; },
        [](Scene& s) { std::swap(s.instances[0].worldFromModel, s.instances[1].worldFromModel); },
        [](Scene& s) { s.instances[0].material = 1; },
        [](Scene& s) { s.lights[0].intensity *= 2; },
        [](Scene& s) { s.cameras[0].fovYRadians *= 2; },
        [](Scene& s) { s.ambientLight.x += 0.1f; },
    };
    std::set<std::uint64_t> seen;
    for (const auto& change : changes) {
        Scene scene = someScene();
        change(scene);
        seen.insert(fingerprint(scene));
    }
    EXPECT_EQ(seen.size(), changes.size());
}

}  // namespace
}  // namespace quincunx
