#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace quincunx {

/// Parses JSON from a stranger. Before anything is built, nesting and the number of values are held against
/// limits that no sensible scene reaches. Throws InputError naming `file`.
nlohmann::json parseBoundedJson(std::string_view text, const std::string& file);

/// A value in a JSON document together with its place, so that whatever is wrong with it can be named. All
/// members throw InputError if the value is not what is asked for. Views need the document and the file's
/// name to outlive them.
class JsonView {
  public:
    JsonView(const nlohmann::json& value, const std::string& file, std::string place = "")
        : value_(&value), file_(&file), place_(std::move(place)) {}

    [[noreturn]] void fail(std::string_view fault) const;

    /// The member `key` of an object.
    JsonView at(const char* key) const;
    std::optional<JsonView> find(const char* key) const;
    bool has(const char* key) const { return find(key).has_value(); }

    /// Entries of an array.
    std::size_t size() const;
    JsonView operator[](std::size_t index) const;

    bool isObject() const { return value_->is_object(); }
    std::string string() const;
    bool boolean() const;
    /// Finite as a float.
    double number() const;
    /// An integer from 0 to 2^53.
    std::size_t index() const;

    std::string stringOr(const char* key, std::string_view otherwise) const;
    bool booleanOr(const char* key, bool otherwise) const;
    double numberOr(const char* key, double otherwise) const;
    std::size_t indexOr(const char* key, std::size_t otherwise) const;
    std::optional<std::size_t> optionalIndex(const char* key) const;

    /// The member `key` as exactly N numbers, if there is one.
    template <std::size_t N>
    std::optional<std::array<double, N>> numbers(const char* key) const {
        const auto array = find(key);
        if (!array)
            return {};
        if (array->size() != N)
            array->fail("has the wrong number of entries");
        std::array<double, N> values;
        for (std::size_t i = 0; i < N; ++i)
            values[i] = (*array)[i].number();
        return values;
    }

    /// The entry `index` of the array `key` of this object, as other parts of a glTF file refer to it.
    JsonView entry(const char* key, std::size_t index) const;
    std::size_t countOf(const char* key) const;

  private:
    const nlohmann::json* value_;
    const std::string* file_;
    std::string place_;
};

}  // namespace quincunx
