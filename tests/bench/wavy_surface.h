#pragma once

#include <filesystem>

namespace quincunx::bench {

/// A file with an OBJ of a wavy surface of a million triangles, for the life of the object.
class WavySurface {
  public:
    explicit WavySurface(bool withNormalsAndTexcoords);
    ~WavySurface();
    WavySurface(const WavySurface&) = delete;
    WavySurface& operator=(const WavySurface&) = delete;
    const std::filesystem::path& path() const { return path_; }

    static constexpr std::size_t triangleCount = 2u * 708 * 708;

  private:
    std::filesystem::path path_;
};

/// The peer: tinyobjloader's parse of the file, and nothing else.
void parseByTinyobj(const std::filesystem::path& path);

}  // namespace quincunx::bench
