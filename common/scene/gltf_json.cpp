#include "scene/gltf_json.h"

#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "base/error.h"

namespace quincunx {

namespace {

constexpr std::size_t mostNesting = 128;
/// A value costs at least two bytes of text and up to a hundred of memory.
constexpr std::size_t mostValues = 4'000'000;

}  // namespace

nlohmann::json parseBoundedJson(std::string_view text, const std::string& file) {
    std::size_t depth = 0;
    std::size_t values = 1;
    bool inString = false;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (inString) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                inString = false;
        } else if (c == '"') {
            inString = true;
        } else if (c == '{' || c == '[') {
            ++values;
            if (++depth > mostNesting)
                throw InputError(fmt::format("JSON nested more than {} deep", mostNesting), file,
                                 "use a simpler model");
        } else if (c == '}' || c == ']') {
            if (depth > 0)
                --depth;
        } else if (c == ',') {
            ++values;
        }
    }
    if (values > mostValues)
        throw InputError(fmt::format("more than {} JSON values", mostValues), file, "use a simpler model");
    try {
        return nlohmann::json::parse(text);
    } catch (const nlohmann::json::exception& error) {
        std::string_view what = error.what();
        if (const std::size_t prefix = what.find("] "); prefix != std::string_view::npos)
            what.remove_prefix(prefix + 2);
        throw InputError(printable(what), file, "export the model again");
    }
}

void JsonView::fail(std::string_view fault) const {
    throw InputError(fault, place_.empty() ? *file_ : fmt::format("{}: {}", *file_, printable(place_)),
                     "export the model again");
}

std::optional<JsonView> JsonView::find(const char* key) const {
    if (!value_->is_object())
        fail("is not a JSON object");
    const auto member = value_->find(key);
    if (member == value_->end())
        return {};
    return JsonView(*member, *file_, place_.empty() ? key : fmt::format("{}.{}", place_, key));
}

JsonView JsonView::at(const char* key) const {
    const auto member = find(key);
    if (!member)
        fail(fmt::format("lacks \"{}\"", key));
    return *member;
}

std::size_t JsonView::size() const {
    if (!value_->is_array())
        fail("is not a JSON array");
    return value_->size();
}

JsonView JsonView::operator[](std::size_t index) const {
    if (index >= size())
        fail(fmt::format("has no entry {}", index));
    return JsonView((*value_)[index], *file_, fmt::format("{}[{}]", place_, index));
}

std::string JsonView::string() const {
    if (!value_->is_string())
        fail("is not a string");
    return value_->get<std::string>();
}

bool JsonView::boolean() const {
    if (!value_->is_boolean())
        fail("is not true or false");
    return value_->get<bool>();
}

double JsonView::number() const {
    if (!value_->is_number())
        fail("is not a number");
    const double number = value_->get<double>();
    if (!(std::abs(number) <= static_cast<double>(std::numeric_limits<float>::max())))
        fail("is not a finite number");
    return number;
}

std::size_t JsonView::index() const {
    const double number = value_->is_number() ? value_->get<double>() : -1;
    if (!(number >= 0 && number <= 0x1p53) || number != std::floor(number))
        fail("is not a whole number from 0 up");
    return static_cast<std::size_t>(number);
}

std::string JsonView::stringOr(const char* key, std::string_view otherwise) const {
    const auto member = find(key);
    return member ? member->string() : std::string(otherwise);
}

bool JsonView::booleanOr(const char* key, bool otherwise) const {
    const auto member = find(key);
    return member ? member->boolean() : otherwise;
}

double JsonView::numberOr(const char* key, double otherwise) const {
    const auto member = find(key);
    return member ? member->number() : otherwise;
}

std::size_t JsonView::indexOr(const char* key, std::size_t otherwise) const {
    const auto member = find(key);
    return member ? member->index() : otherwise;
}

std::optional<std::size_t> JsonView::optionalIndex(const char* key) const {
    const auto member = find(key);
    return member ? std::optional(member->index()) : std::nullopt;
}

JsonView JsonView::entry(const char* key, std::size_t index) const {
    const auto array = find(key);
    if (!array)
        fail(fmt::format("lacks \"{}\", which are referred to", key));
    return (*array)[index];
}

std::size_t JsonView::countOf(const char* key) const {
    const auto array = find(key);
    return array ? array->size() : 0;
}

}  // namespace quincunx
