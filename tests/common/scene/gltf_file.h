#pragma once

#include <cstdint>
#include <cstring>
#include <initializer_list>
#include <string>
#include <vector>

#include <glm/glm.hpp>
#include <nlohmann/json.hpp>

namespace quincunx::test {

/// A glTF file under construction: tests write what they read.
struct GltfFile {
    nlohmann::json json;
    std::string binary;

    GltfFile() { json["asset"]["version"] = "2.0"; }

    template <typename T>
    static std::string bytes(const std::vector<T>& values) {
        return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
    }

    /// Appends bytes, aligned to 4; returns the new buffer view.
    int view(const std::string& content, int stride = 0) {
        binary.resize((binary.size() + 3) / 4 * 4);
        nlohmann::json view{{"buffer", 0}, {"byteOffset", binary.size()}, {"byteLength", content.size()}};
        if (stride > 0)
            view["byteStride"] = stride;
        binary += content;
        json["bufferViews"].push_back(view);
        return static_cast<int>(json["bufferViews"].size()) - 1;
    }

    int accessor(int view, const char* type, int componentType, std::size_t count, std::size_t offset = 0,
                 bool normalized = false) {
        nlohmann::json accessor{
            {"bufferView", view}, {"type", type}, {"componentType", componentType}, {"count", count}};
        if (offset > 0)
            accessor["byteOffset"] = offset;
        if (normalized)
            accessor["normalized"] = true;
        json["accessors"].push_back(accessor);
        return static_cast<int>(json["accessors"].size()) - 1;
    }

    int vec3s(const std::vector<glm::vec3>& values) {
        return accessor(view(bytes(values)), "VEC3", 5126, values.size());
    }
    int vec2s(const std::vector<glm::vec2>& values) {
        return accessor(view(bytes(values)), "VEC2", 5126, values.size());
    }
    template <typename T>
    int indices(const std::vector<T>& values) {
        const int type = sizeof(T) == 1 ? 5121 : sizeof(T) == 2 ? 5123 : 5125;
        return accessor(view(bytes(values)), "SCALAR", type, values.size());
    }

    /// A mesh of one primitive.
    int mesh(const nlohmann::json& primitive) {
        json["meshes"].push_back({{"primitives", nlohmann::json::array({primitive})}});
        return static_cast<int>(json["meshes"].size()) - 1;
    }

    int node(const nlohmann::json& node) {
        json["nodes"].push_back(node);
        return static_cast<int>(json["nodes"].size()) - 1;
    }

    /// The JSON with `buffers` told where the bytes are; nothing: in the binary chunk.
    std::string text(const std::string& uri) const {
        nlohmann::json whole = json;
        if (!binary.empty()) {
            whole["buffers"][0]["byteLength"] = binary.size();
            if (!uri.empty())
                whole["buffers"][0]["uri"] = uri;
        }
        return whole.dump();
    }

    std::string embedded() const { return text("data:application/octet-stream;base64," + base64(binary)); }

    std::string glb() const {
        std::string jsonChunk = text("");
        jsonChunk.resize((jsonChunk.size() + 3) / 4 * 4, ' ');
        std::string binaryChunk = binary;
        binaryChunk.resize((binaryChunk.size() + 3) / 4 * 4);
        std::string file = "glTF";
        put32(file, 2);
        put32(file, static_cast<std::uint32_t>(12 + 8 + jsonChunk.size() + 8 + binaryChunk.size()));
        put32(file, static_cast<std::uint32_t>(jsonChunk.size()));
        file += "JSON" + jsonChunk;
        put32(file, static_cast<std::uint32_t>(binaryChunk.size()));
        file += std::string("BIN\0", 4) + binaryChunk;
        return file;
    }

    static void put32(std::string& out, std::uint32_t value) {
        for (int i = 0; i < 4; ++i)
            out += static_cast<char>(value >> 8 * i & 0xff);
    }

    static std::string base64(const std::string& bytes) {
        const char* const digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
        std::string text;
        for (std::size_t i = 0; i < bytes.size(); i += 3) {
            std::uint32_t bits = 0;
            for (std::size_t k = 0; k < 3; ++k)
                bits = bits << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
            for (std::size_t k = 0; k < 4; ++k)
                text += i + k <= bytes.size() ? digits[bits >> (18 - 6 * k) & 63] : '=';
        }
        return text;
    }
};

/// A quadrilateral in the plane z = 0, as two triangles of shared vertices.
struct Square {
    std::vector<glm::vec3> positions{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    std::vector<glm::vec3> normals{4, glm::vec3(0, 0, 1)};
    std::vector<glm::vec2> texcoords{{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    std::vector<std::uint32_t> indices{0, 1, 2, 0, 2, 3};
};

/// A scene of that square with all attributes, in one node.
inline GltfFile squareFile() {
    GltfFile file;
    const Square square;
    const int positions = file.vec3s(square.positions);
    const int normals = file.vec3s(square.normals);
    const int texcoords = file.vec2s(square.texcoords);
    const int indices = file.indices(square.indices);
    const int mesh =
        file.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", texcoords}}},
                   {"indices", indices}});
    file.node({{"mesh", mesh}});
    return file;
}

}  // namespace quincunx::test
