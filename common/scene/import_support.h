#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scene/scene.h"

/// What the importers share.
namespace quincunx {

/// Lines for the user, each once, and not more of them than one wants to read.
class Warnings {
  public:
    /// Takes one line; a repeated one is dropped.
    void add(std::string line);
    /// All lines, with the number of those left out at the end.
    std::vector<std::string> lines() const;

  private:
    static constexpr std::size_t most = 50;
    std::vector<std::string> lines_;
    std::set<std::string> seen_;
    std::size_t leftOut_ = 0;
};

/// `name`, as written in a file, as a path in `folder` or below; nothing if it is absolute, climbs out with
/// "..", or holds a scheme or a NUL. Backslashes count as separators.
std::optional<std::filesystem::path> pathBeside(const std::filesystem::path& folder, std::string_view name);

/// Decodes each picture once, and only so much in all that a file of tiny pictures of huge size does no harm.
/// Pictures that cannot be had become warnings.
class TextureShelf {
  public:
    TextureShelf(Scene& scene, Warnings& warnings) : scene_(scene), warnings_(warnings) {}

    /// The texture made of the picture `key`, with the name and the ways of looking it up of `like`; its
    /// numbers stand for what `encoding` says, if it says something. `read` decodes the picture, and throws
    /// InputError if it cannot.
    template <typename Read>
    std::optional<std::size_t> texture(const std::string& key, const Texture& like,
                                       std::optional<Encoding> encoding, const Read& read) {
        const Place place{key,          like.wrapS, like.wrapT, like.magnification, like.minification,
                          like.mipmaps, encoding};
        const auto known = places_.find(place);
        if (known != places_.end())
            return known->second;
        return places_[place] = shelve(place, like, [&] { return Image8(read()); });
    }
    /// The same, filtered as by default.
    template <typename Read>
    std::optional<std::size_t> texture(const std::string& key, Texture::Wrap wrapS, Texture::Wrap wrapT,
                                       const Read& read) {
        Texture like;
        like.name = key;
        like.wrapS = wrapS;
        like.wrapT = wrapT;
        return texture(key, like, std::nullopt, read);
    }

  private:
    struct Place {
        std::string key;
        Texture::Wrap wrapS;
        Texture::Wrap wrapT;
        Texture::Filter magnification;
        Texture::Filter minification;
        Texture::Mipmaps mipmaps;
        std::optional<Encoding> encoding;
        auto operator<=>(const Place&) const = default;
    };
    std::optional<std::size_t> shelve(const Place& place, const Texture& like,
                                      const std::function<Image8()>& read);

    Scene& scene_;
    Warnings& warnings_;
    std::map<Place, std::optional<std::size_t>> places_;
    std::map<std::string, std::optional<std::size_t>> firstOfPicture_;  ///< key → texture
    std::size_t bytesLeft_ = std::size_t{2} << 30;
};

/// The exponent n of the Blinn–Phong lobe that is as wide as a microfacet lobe of the given glTF roughness
/// (alpha = roughness²): n = 2/alpha² - 2 (Walter et al., "Microfacet models for refraction through rough
/// surfaces", EGSR 2007, section 5.2, for the Beckmann distribution; Karis 2013 uses the same with GGX), in
/// 0 … 1e5.
float shininessFromRoughness(float roughness);

/// The inverse of `shininessFromRoughness`, in 0 … 1.
float roughnessFromShininess(float shininess);

/// Fills the Phong numbers from the metallic–roughness numbers: dielectrics reflect 4 % head-on, metals
/// their base colour (glTF 2.0, appendix B.2).
void fillPhongFromMetallicRoughness(Material& material);

}  // namespace quincunx
