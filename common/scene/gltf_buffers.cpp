#include "scene/gltf_buffers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "base/error.h"
#include "base/file.h"
#include "scene/import_formats.h"
#include "scene/import_support.h"

namespace quincunx {

namespace {

// Component types of glTF 2.0, section 3.6.2.2.
constexpr std::size_t typeByte = 5120;
constexpr std::size_t typeUnsignedByte = 5121;
constexpr std::size_t typeShort = 5122;
constexpr std::size_t typeUnsignedShort = 5123;
constexpr std::size_t typeUnsignedInt = 5125;
constexpr std::size_t typeFloat = 5126;

std::size_t sizeOfComponent(const JsonView& json) {
    switch (json.index()) {
        case typeByte:
        case typeUnsignedByte:
            return 1;
        case typeShort:
        case typeUnsignedShort:
            return 2;
        case typeUnsignedInt:
        case typeFloat:
            return 4;
    }
    json.fail("is not a component type of glTF 2.0");
}

template <typename T>
T load(const char* bytes) {
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

bool isIndexType(std::size_t type) {
    return type == typeUnsignedByte || type == typeUnsignedShort || type == typeUnsignedInt;
}

std::uint32_t littleEndian32(std::string_view bytes, std::size_t offset) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;)
        value = value << 8 | static_cast<unsigned char>(bytes[offset + i]);
    return value;
}

std::uint32_t unsignedAt(const char* bytes, std::size_t type) {
    if (type == typeUnsignedByte)
        return load<std::uint8_t>(bytes);
    if (type == typeUnsignedShort)
        return load<std::uint16_t>(bytes);
    return load<std::uint32_t>(bytes);
}

float floatAt(const char* bytes, std::size_t type, bool normalized) {
    switch (type) {
        case typeByte: {
            const auto value = static_cast<float>(load<std::int8_t>(bytes));
            return normalized ? std::max(value / 127, -1.0f) : value;
        }
        case typeUnsignedByte: {
            const auto value = static_cast<float>(load<std::uint8_t>(bytes));
            return normalized ? value / 255 : value;
        }
        case typeShort: {
            const auto value = static_cast<float>(load<std::int16_t>(bytes));
            return normalized ? std::max(value / 32767, -1.0f) : value;
        }
        case typeUnsignedShort: {
            const auto value = static_cast<float>(load<std::uint16_t>(bytes));
            return normalized ? value / 65535 : value;
        }
        case typeUnsignedInt:
            return static_cast<float>(load<std::uint32_t>(bytes));
        default:
            return load<float>(bytes);
    }
}

/// True if `count` ≥ 1 elements of `size` bytes, `stride` apart from `offset` on, lie within `length` bytes.
bool fits(std::size_t count, std::size_t size, std::size_t stride, std::size_t offset, std::size_t length) {
    if (offset > length || size > length - offset)
        return false;
    return count - 1 <= (length - offset - size) / stride;
}

std::string decodedBase64(std::string_view text, const JsonView& place) {
    std::string bytes;
    bytes.reserve(text.size() / 4 * 3 + 3);
    while (!text.empty() && text.back() == '=')
        text.remove_suffix(1);
    std::uint32_t bits = 0;
    int have = 0;
    for (const char c : text) {
        std::uint32_t digit = 0;
        if (c >= 'A' && c <= 'Z')
            digit = static_cast<std::uint32_t>(c - 'A');
        else if (c >= 'a' && c <= 'z')
            digit = static_cast<std::uint32_t>(c - 'a') + 26;
        else if (c >= '0' && c <= '9')
            digit = static_cast<std::uint32_t>(c - '0') + 52;
        else if (c == '+' || c == '-')
            digit = 62;
        else if (c == '/' || c == '_')
            digit = 63;
        else
            place.fail("holds something that is not base64");
        bits = bits << 6 | digit;
        have += 6;
        if (have >= 8) {
            have -= 8;
            bytes += static_cast<char>(bits >> have & 0xff);
        }
    }
    return bytes;
}

std::string percentDecoded(std::string_view text) {
    std::string decoded;
    const auto hex = [](char c) {
        if (c >= '0' && c <= '9')
            return c - '0';
        if (c >= 'a' && c <= 'f')
            return c - 'a' + 10;
        if (c >= 'A' && c <= 'F')
            return c - 'A' + 10;
        return -1;
    };
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] == '%' && i + 2 < text.size() && hex(text[i + 1]) >= 0 && hex(text[i + 2]) >= 0) {
            decoded += static_cast<char>(hex(text[i + 1]) * 16 + hex(text[i + 2]));
            i += 2;
        } else {
            decoded += text[i];
        }
    }
    return decoded;
}

}  // namespace

GltfContainer openGltf(std::string_view contents, const std::string& file) {
    if (!contents.starts_with("glTF"))
        return {contents, {}};
    const char* const remedy = "export or download the model again";
    if (contents.size() < 20)
        throw InputError("the binary glTF is cut off", file, remedy);
    const std::uint32_t version = littleEndian32(contents, 4);
    if (version != 2)
        throw InputError(fmt::format("binary glTF of version {}", version), file, "convert it to version 2");
    const std::size_t length = littleEndian32(contents, 8);
    if (length > contents.size())
        throw InputError(fmt::format("cut off: {} of {} bytes", contents.size(), length), file, remedy);
    const std::string_view whole = contents.substr(0, length);
    constexpr std::uint32_t jsonChunk = 0x4e4f534a;
    constexpr std::uint32_t binaryChunk = 0x004e4942;
    GltfContainer container;
    for (std::size_t offset = 12; offset + 8 <= whole.size();) {
        const std::size_t size = littleEndian32(whole, offset);
        const std::uint32_t kind = littleEndian32(whole, offset + 4);
        if (size > whole.size() - offset - 8)
            throw InputError("a chunk is longer than the file", file, remedy);
        const std::string_view chunk = whole.substr(offset + 8, size);
        if (offset == 12 && kind != jsonChunk)
            throw InputError("does not begin with a JSON chunk", file, remedy);
        if (kind == jsonChunk && offset == 12)
            container.json = chunk;
        else if (kind == binaryChunk && !container.binary)
            container.binary = chunk;
        offset += 8 + size;
    }
    return container;
}

GltfBuffers::GltfBuffers(const JsonView& root, std::optional<std::string_view> binary,
                         const std::filesystem::path& folder, std::size_t fileBytes)
    : root_(root),
      binary_(binary),
      folder_(folder),
      buffers_(root.countOf("buffers")),
      inputBytes_(fileBytes) {}

std::string GltfBuffers::resolve(const JsonView& place) const {
    const std::string uri = place.string();
    if (uri.starts_with("data:")) {
        const std::size_t comma = uri.find(',');
        if (comma == std::string::npos || !std::string_view(uri).substr(0, comma).ends_with(";base64"))
            place.fail("is a data URI that is not base64");
        return decodedBase64(std::string_view(uri).substr(comma + 1), place);
    }
    const auto path = pathBeside(folder_, percentDecoded(uri));
    if (!path)
        place.fail(fmt::format("names {}, which is not a file in the model's folder", printable(uri, 80)));
    return readFile(*path, largestModelFile);
}

void GltfBuffers::load(std::size_t index) {
    const JsonView json = root_.entry("buffers", index);
    Buffer& buffer = buffers_[index];
    if (buffer.loaded)
        return;
    const std::size_t declared = json.at("byteLength").index();
    if (const auto uri = json.find("uri")) {
        const auto [known, isNew] = bufferOfUri_.try_emplace(uri->string(), index);
        if (isNew) {
            buffer.storage = resolve(*uri);
            inputBytes_ += buffer.storage.size();
            if (inputBytes_ > 2 * largestModelFile)
                json.fail("makes the model larger than 4 GiB");
            buffer.bytes = buffer.storage;
        } else {
            buffer.bytes = buffers_[known->second].storage;
        }
    } else if (index == 0 && binary_) {
        buffer.bytes = *binary_;
    } else {
        json.fail("has no data");
    }
    if (declared > buffer.bytes.size())
        json.fail(fmt::format("is cut off: {} of {} bytes", buffer.bytes.size(), declared));
    buffer.bytes = buffer.bytes.substr(0, declared);
    buffer.loaded = true;
}

GltfBuffers::View GltfBuffers::view(std::size_t index) {
    const JsonView json = root_.entry("bufferViews", index);
    const std::size_t buffer = json.at("buffer").index();
    if (buffer >= buffers_.size())
        json.fail(fmt::format("names buffer {}, which is not there", buffer));
    load(buffer);
    const std::string_view bytes = buffers_[buffer].bytes;
    const std::size_t offset = json.indexOr("byteOffset", 0);
    const std::size_t length = json.at("byteLength").index();
    if (offset > bytes.size() || length > bytes.size() - offset)
        json.fail("reaches beyond its buffer");
    const std::size_t stride = json.indexOr("byteStride", 0);
    if (stride > 252)
        json.fail("has a stride of more than 252 bytes");
    return {bytes.substr(offset, length), stride};
}

GltfBuffers::Accessor GltfBuffers::accessor(const JsonView& json) {
    Accessor a;
    a.count = json.at("count").index();
    if (a.count == 0)
        json.fail("has no elements");
    if (a.count > std::size_t{0xfffffffe})
        json.fail("has more than 2^32 elements");
    a.componentType = json.at("componentType").index();
    const std::size_t size = sizeOfComponent(json.at("componentType"));
    const std::string type = json.at("type").string();
    constexpr std::array<std::pair<std::string_view, std::size_t>, 4> types{
        {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}}};
    for (const auto& [name, components] : types)
        if (type == name)
            a.components = components;
    if (a.components == 0)
        json.fail("is of a type that is not read here");
    a.elementSize = a.components * size;
    a.normalized = json.booleanOr("normalized", false);
    a.offset = json.indexOr("byteOffset", 0);
    if (const auto viewIndex = json.optionalIndex("bufferView")) {
        a.view = view(*viewIndex);
        const std::size_t element = a.elementSize;
        if (a.view->stride == 0)
            a.view->stride = element;
        if (a.view->stride < element)
            json.fail("has elements that are wider than their stride");
        if (!fits(a.count, element, a.view->stride, a.offset, a.view->bytes.size()))
            json.fail("reaches beyond its buffer view");
    } else if (a.count > std::max(inputBytes_, std::size_t{1} << 20)) {
        // Nothing in the file stands behind these elements, which are all zero.
        json.fail("has more elements than its file has bytes");
    }
    return a;
}

template <typename T, typename Decode>
std::vector<T> GltfBuffers::read(const JsonView& json, const Accessor& a, const Decode& decode) {
    charge(a.count * sizeof(T), json);
    std::vector<T> out(a.count, T(0));
    if (a.view) {
        const char* const first = a.view->bytes.data() + a.offset;
        for (std::size_t i = 0; i < a.count; ++i)
            out[i] = decode(first + i * a.view->stride);
    }
    const auto sparse = json.find("sparse");
    if (!sparse)
        return out;
    const std::size_t count = sparse->at("count").index();
    if (count == 0 || count > a.count)
        sparse->fail("has a count that cannot be");
    const JsonView indices = sparse->at("indices");
    const JsonView values = sparse->at("values");
    const std::size_t indexType = indices.at("componentType").index();
    if (!isIndexType(indexType))
        indices.fail("has a component type that is not for indices");
    const std::size_t indexSize = sizeOfComponent(indices.at("componentType"));
    const std::size_t indexOffset = indices.indexOr("byteOffset", 0);
    const std::size_t valueOffset = values.indexOr("byteOffset", 0);
    const std::string_view indexBytes = view(indices.at("bufferView").index()).bytes;
    const std::string_view valueBytes = view(values.at("bufferView").index()).bytes;
    if (!fits(count, indexSize, indexSize, indexOffset, indexBytes.size()))
        indices.fail("reaches beyond its buffer view");
    if (!fits(count, a.elementSize, a.elementSize, valueOffset, valueBytes.size()))
        values.fail("reaches beyond its buffer view");
    for (std::size_t i = 0; i < count; ++i) {
        const std::uint32_t place = unsignedAt(indexBytes.data() + indexOffset + i * indexSize, indexType);
        if (place >= a.count)
            indices.fail(fmt::format("holds {}, of {} elements", place, a.count));
        out[place] = decode(valueBytes.data() + valueOffset + i * a.elementSize);
    }
    return out;
}

template <int N>
const std::vector<glm::vec<N, float>>& GltfBuffers::cached(
    const JsonView& reference, std::map<std::size_t, std::vector<glm::vec<N, float>>>& cache) {
    const std::size_t index = reference.index();
    const auto known = cache.find(index);
    if (known != cache.end())
        return known->second;
    const JsonView json = root_.entry("accessors", index);
    const Accessor a = accessor(json);
    if (a.components != N)
        json.fail(fmt::format("does not have {} components", N));
    if (a.componentType == typeUnsignedInt)
        json.fail("has components that are not for vertices");
    const std::size_t component = a.elementSize / N;
    return cache[index] = read<glm::vec<N, float>>(json, a, [&](const char* bytes) {
               glm::vec<N, float> value;
               for (int c = 0; c < N; ++c)
                   value[c] = floatAt(bytes + static_cast<std::size_t>(c) * component, a.componentType,
                                      a.normalized);
               return value;
           });
}

const std::vector<glm::vec2>& GltfBuffers::vec2s(const JsonView& reference) {
    return cached<2>(reference, vec2s_);
}

const std::vector<glm::vec3>& GltfBuffers::vec3s(const JsonView& reference) {
    return cached<3>(reference, vec3s_);
}

const std::vector<glm::vec4>& GltfBuffers::vec4s(const JsonView& reference) {
    return cached<4>(reference, vec4s_);
}

const std::vector<glm::vec4>& GltfBuffers::colors(const JsonView& reference) {
    const std::size_t index = reference.index();
    const auto known = colors_.find(index);
    if (known != colors_.end())
        return known->second;
    const JsonView json = root_.entry("accessors", index);
    const Accessor a = accessor(json);
    if (a.components != 3 && a.components != 4)
        json.fail("does not have 3 or 4 components");
    if (a.componentType == typeUnsignedInt)
        json.fail("has components that are not for vertices");
    const std::size_t component = a.elementSize / a.components;
    return colors_[index] = read<glm::vec4>(json, a, [&](const char* bytes) {
               glm::vec4 color(1);
               for (std::size_t c = 0; c < a.components; ++c) {
                   const float value = floatAt(bytes + c * component, a.componentType, true);
                   color[static_cast<int>(c)] = std::isnan(value) ? 1 : std::clamp(value, 0.0f, 1.0f);
               }
               return color;
           });
}

std::vector<float> GltfBuffers::scalars(const JsonView& reference) {
    const JsonView json = root_.entry("accessors", reference.index());
    const Accessor a = accessor(json);
    if (a.components != 1)
        json.fail("does not have 1 component");
    return read<float>(json, a,
                       [&](const char* bytes) { return floatAt(bytes, a.componentType, a.normalized); });
}

std::vector<std::uint32_t> GltfBuffers::indices(const JsonView& reference) {
    const JsonView json = root_.entry("accessors", reference.index());
    const Accessor a = accessor(json);
    if (a.components != 1)
        json.fail("is not a list of indices");
    if (!isIndexType(a.componentType))
        json.fail("has a component type that is not for indices");
    return read<std::uint32_t>(json, a,
                               [&](const char* bytes) { return unsignedAt(bytes, a.componentType); });
}

std::size_t GltfBuffers::components(const JsonView& reference) {
    return accessor(root_.entry("accessors", reference.index())).components;
}

void GltfBuffers::charge(std::size_t bytes, const JsonView& place) {
    // An index of one byte can become a whole vertex of three triangles of a strip: 3 × 36 bytes; or of one
    // triangle, with all attributes: 76 bytes, and 28 while they are gathered.
    constexpr std::size_t mostPerByte = 128;
    constexpr std::size_t always = std::size_t{64} << 20;
    made_ += bytes;
    if (made_ > always + mostPerByte * inputBytes_)
        place.fail("makes more geometry than a file of this size should");
}

}  // namespace quincunx
