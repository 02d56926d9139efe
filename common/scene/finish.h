#pragma once

#include <string>

#include "scene/scene.h"

namespace quincunx {

/// What a surface without textures looks like, in the numbers of both shading models. Colours are linear RGB.
struct Finish {
    glm::vec3 diffuse;
    glm::vec3 specular{0.04f};
    float shininess = 20;
    float metallic = 0;
    float roughness = 0.5f;
    glm::vec3 emission{0};
};

/// The ambient colour is the diffuse one; the base colour is the diffuse one, or a metal's specular one.
Material makeMaterial(std::string name, const Finish& finish);

}  // namespace quincunx
