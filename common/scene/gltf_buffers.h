#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/glm.hpp>

#include "scene/gltf_json.h"

namespace quincunx {

/// The two parts of a glTF file: its JSON, and the binary chunk of a .glb.
struct GltfContainer {
    std::string_view json;
    std::optional<std::string_view> binary;
};

/// Takes a .glb apart, checking every length against what is there; other contents are all JSON.
GltfContainer openGltf(std::string_view contents, const std::string& file);

/// Hands out the buffers' bytes and the accessors' numbers of a glTF document. Every offset, length, stride
/// and count is checked, without overflow, against what is there before anything is read or allocated.
class GltfBuffers {
  public:
    /// Both must outlive this. `fileBytes`: size of the whole file.
    GltfBuffers(const JsonView& root, std::optional<std::string_view> binary,
                const std::filesystem::path& folder, std::size_t fileBytes);

    struct View {
        std::string_view bytes;
        std::size_t stride = 0;  ///< 0: packed
    };
    View view(std::size_t index);

    /// The bytes of a data: URI, or of a file beside the model.
    std::string resolve(const JsonView& uri) const;

    /// The accessor's elements as floats, integers as they are or, if normalized, mapped to 0 … 1 or -1 … 1.
    /// The reference is good until this object goes.
    const std::vector<glm::vec2>& vec2s(const JsonView& reference);
    const std::vector<glm::vec3>& vec3s(const JsonView& reference);
    const std::vector<glm::vec4>& vec4s(const JsonView& reference);
    /// RGB or RGBA, 0 … 1 (glTF 2.0, section 3.7.2.1); RGB is opaque, integers are normalized whether they
    /// say so or not, and what is not a number is 1.
    const std::vector<glm::vec4>& colors(const JsonView& reference);
    std::vector<float> scalars(const JsonView& reference);
    std::vector<std::uint32_t> indices(const JsonView& reference);
    std::size_t components(const JsonView& reference);

    /// Bytes that may still be made of this file; `charge` is an InputError when they run out, so that
    /// accessors that share bytes do not multiply them without end.
    void charge(std::size_t bytes, const JsonView& place);

  private:
    struct Accessor {
        std::size_t count = 0;
        std::size_t componentType = 0;
        std::size_t components = 0;
        std::size_t elementSize = 0;  ///< bytes
        bool normalized = false;
        std::optional<View> view;
        std::size_t offset = 0;
    };
    Accessor accessor(const JsonView& json);
    /// All elements, sparse ones put in; `decode` makes one from its bytes.
    template <typename T, typename Decode>
    std::vector<T> read(const JsonView& json, const Accessor& a, const Decode& decode);
    template <int N>
    const std::vector<glm::vec<N, float>>& cached(
        const JsonView& reference, std::map<std::size_t, std::vector<glm::vec<N, float>>>& cache);
    void load(std::size_t buffer);

    struct Buffer {
        bool loaded = false;
        std::string storage;
        std::string_view bytes;
    };

    JsonView root_;
    std::optional<std::string_view> binary_;
    std::filesystem::path folder_;
    std::vector<Buffer> buffers_;
    std::map<std::string, std::size_t> bufferOfUri_;
    std::size_t inputBytes_;
    std::size_t made_ = 0;
    std::map<std::size_t, std::vector<glm::vec2>> vec2s_;
    std::map<std::size_t, std::vector<glm::vec3>> vec3s_;
    std::map<std::size_t, std::vector<glm::vec4>> vec4s_;
    std::map<std::size_t, std::vector<glm::vec4>> colors_;
};

}  // namespace quincunx
