#include "scene/finish.h"

#include <utility>

namespace quincunx {

Material makeMaterial(std::string name, const Finish& finish) {
    Material result;
    result.name = std::move(name);
    result.baseColor = glm::vec4(finish.metallic > 0.5f ? finish.specular : finish.diffuse, 1);
    result.metallic = finish.metallic;
    result.roughness = finish.roughness;
    result.emission = finish.emission;
    result.ambient = finish.diffuse;
    result.diffuse = finish.diffuse;
    result.specular = finish.specular;
    result.shininess = finish.shininess;
    return result;
}

}  // namespace quincunx
