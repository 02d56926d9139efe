#include "scene/import_support.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "base/error.h"

namespace quincunx {

void Warnings::add(std::string line) {
    if (seen_.contains(line))
        return;
    if (lines_.size() >= most) {
        ++leftOut_;
        return;
    }
    seen_.insert(line);
    lines_.push_back(std::move(line));
}

std::vector<std::string> Warnings::lines() const {
    std::vector<std::string> all = lines_;
    if (leftOut_ > 0)
        all.push_back(fmt::format("and {} more warnings", leftOut_));
    return all;
}

std::optional<std::filesystem::path> pathBeside(const std::filesystem::path& folder, std::string_view name) {
    if (name.empty() || name.find('\0') != std::string_view::npos || name.find(':') != std::string_view::npos)
        return {};
    std::string text(name);
    std::replace(text.begin(), text.end(), '\\', '/');
    const std::filesystem::path relative = std::filesystem::path(text).lexically_normal();
    if (relative.empty() || relative.is_absolute() || *relative.begin() == "..")
        return {};
    return folder / relative;
}

std::optional<std::size_t> TextureShelf::shelve(const Place& place, const Texture& like,
                                                const std::function<Image8()>& read) {
    Texture texture = like;
    if (bytesLeft_ == 0) {
        warnings_.add("textures past 2 GiB are not read");
        return {};
    }
    // The same picture looked up in another way is decoded only once.
    if (const auto same = firstOfPicture_.find(place.key); same != firstOfPicture_.end()) {
        if (!same->second)
            return {};
        texture.image = scene_.textures[*same->second].image;
    } else {
        auto& first = firstOfPicture_[place.key];
        try {
            texture.image = read();
        } catch (const InputError& error) {
            warnings_.add(fmt::format("drawn without a texture: {}", error.what()));
            return {};
        }
        first = scene_.textures.size();
    }
    if (place.encoding)
        texture.image.encoding = *place.encoding;
    bytesLeft_ -= std::min(bytesLeft_, texture.image.data.size());
    scene_.textures.push_back(std::move(texture));
    return scene_.textures.size() - 1;
}

float shininessFromRoughness(float roughness) {
    const double alpha = static_cast<double>(roughness) * static_cast<double>(roughness);
    const double exponent = alpha > 0 ? 2 / (alpha * alpha) - 2 : 1e5;
    return static_cast<float>(std::clamp(exponent, 0.0, 1e5));
}

float roughnessFromShininess(float shininess) {
    const double alpha = std::sqrt(2 / (std::max(static_cast<double>(shininess), 0.0) + 2));
    return static_cast<float>(std::sqrt(alpha));
}

void fillPhongFromMetallicRoughness(Material& material) {
    const glm::vec3 base(material.baseColor);
    material.diffuse = base * (1 - material.metallic);
    material.specular = glm::mix(glm::vec3(0.04f), base, material.metallic);
    material.ambient = base;
    material.shininess = shininessFromRoughness(material.roughness);
}

}  // namespace quincunx
