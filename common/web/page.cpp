#include "web/page.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <kainjow/mustache.hpp>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"
#include "base/paths.h"
#include "image/color.h"
#include "image/compare.h"
#include "image/io.h"

namespace quincunx::web {
namespace {

namespace fs = std::filesystem;
using kainjow::mustache::data;
using kainjow::mustache::mustache;

constexpr std::uintmax_t mostTemplateBytes = 1 << 20;
constexpr std::uintmax_t mostAssetBytes = 8 << 20;
constexpr std::string_view replacement = "\uFFFD";
constexpr std::string_view chartLibrary = "d3.min.js";

/// Length in bytes of the UTF-8 character that starts at `text[at]`; 0 if there is none (RFC 3629, section
/// 4).
std::size_t utf8Length(std::string_view text, std::size_t at) {
    const auto byte = [&](std::size_t i) {
        return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u;
    };
    const unsigned first = byte(0);
    if (first < 0x80)
        return 1;
    const std::size_t length = first < 0xC2 ? 0 : first < 0xE0 ? 2 : first < 0xF0 ? 3 : first < 0xF5 ? 4 : 0;
    for (std::size_t i = 1; i < length; ++i)
        if ((byte(i) & 0xC0) != 0x80)
            return 0;
    const unsigned second = byte(1);
    const bool outOfRange = (first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
                            (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F);
    return outOfRange ? 0 : length;
}

/// Numbers as JSON writes them; null is false, so that sections of it are left out.
data toMustache(const Json& json) {
    if (json.is_object()) {
        data object(data::type::object);
        for (const auto& [key, value] : json.items())
            object.set(key, toMustache(value));
        return object;
    }
    if (json.is_array()) {
        data list(data::type::list);
        for (const Json& element : json)
            list.push_back(toMustache(element));
        return list;
    }
    if (json.is_string())
        return data(json.get<std::string>());
    if (json.is_boolean() || json.is_null())
        return data(json.is_boolean() && json.get<bool>());
    return data(json.dump());
}

fs::path templateFile(std::string_view name) {
    return asset(fmt::format("web/templates/{}.mustache", name));
}

/// The template's text; the parts that it and they name are added to `view`.
std::string readTemplate(std::string_view name, data& view) {
    const std::string text = readFile(templateFile(name), mostTemplateBytes);
    for (std::size_t at = text.find("{{>"); at != std::string::npos; at = text.find("{{>", at + 1)) {
        const std::size_t start = text.find_first_not_of(' ', at + 3);
        const std::string part = text.substr(start, text.find_first_of(" }", start) - start);
        if (view.get(part) != nullptr)
            continue;
        view.set(part, data(false));  // so that a part that names itself ends
        const std::string partText = readTemplate(part, view);
        view.set(part, data(kainjow::mustache::partial([partText] { return partText; })));
    }
    return text;
}

/// Opaque: what is seen, without what lies under it.
Image8 withoutAlpha(const Image8& picture) {
    if (picture.channels == 1 || picture.channels == 3)
        return picture;
    Image8 opaque(picture.width, picture.height, picture.channels - 1, picture.encoding);
    for (int y = 0; y < picture.height; ++y)
        for (int x = 0; x < picture.width; ++x)
            std::copy_n(picture.pixel(x, y), opaque.channels, opaque.pixel(x, y));
    return opaque;
}

/// The colours of errorMap, for the maps that compare.js computes.
std::string errorColourScript() {
    Image ramp(256, 1, 1, Encoding::linear);
    for (int i = 0; i < ramp.width; ++i)
        *ramp.pixel(i, 0) = static_cast<float>(i) / 255;
    return fmt::format("window.quincunxErrorColours = [{}];\n", fmt::join(errorMap(ramp).data, ","));
}

void copyText(const fs::path& from, const fs::path& to) {
    writeIfChanged(to, readFile(from, mostAssetBytes));
}

}  // namespace

std::string escaped(std::string_view text) {
    std::string html;
    html.reserve(text.size() + text.size() / 8);
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = utf8Length(text, at);
        const auto c = static_cast<unsigned char>(text[at]);
        if (length == 0 || (c < 0x20 && c != '\n' && c != '\t' && c != '\r') || c == 0x7F)
            html += replacement;
        else if (length > 1)
            html += text.substr(at, length);
        else if (c == '&')
            html += "&amp;";
        else if (c == '<')
            html += "&lt;";
        else if (c == '>')
            html += "&gt;";
        else if (c == '"')
            html += "&quot;";
        else if (c == '\'')
            html += "&#39;";
        else
            html += text[at];
        at += std::max<std::size_t>(length, 1);
    }
    return html;
}

std::string filledTemplate(std::string_view name, const Json& view) {
    data filled = toMustache(view);
    mustache page(readTemplate(name, filled));
    page.set_custom_escape([](const std::string& text) { return escaped(text); });
    if (!page.is_valid())
        throw InputError(printable(page.error_message()), templateFile(name).string(),
                         "correct the template");
    return page.render(filled);
}

std::string inScript(const Json& json) {
    const std::string text = json.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::string safe;
    safe.reserve(text.size());
    for (const char c : text)
        if (c == '<')
            safe += "\\u003c";
        else
            safe += c;
    return safe;
}

std::string dataUri(std::string_view mediaType, std::span<const unsigned char> bytes) {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string uri = fmt::format("data:{};base64,", mediaType);
    uri.reserve(uri.size() + (bytes.size() + 2) / 3 * 4);
    for (std::size_t at = 0; at < bytes.size(); at += 3) {
        const std::size_t count = std::min<std::size_t>(3, bytes.size() - at);
        std::uint32_t bits = 0;
        for (std::size_t i = 0; i < 3; ++i)
            bits = bits << 8 | (i < count ? bytes[at + i] : 0u);
        for (std::size_t i = 0; i < 4; ++i)
            uri += i <= count ? digits[bits >> (18 - 6 * i) & 63] : '=';
    }
    return uri;
}

std::string pixelScript(std::string_view key, const Image8& picture) {
    return fmt::format("quincunxPixels({}, \"{}\");\n", Json(key).dump(),
                       dataUri("image/png", encodedPng(withoutAlpha(picture), std::string(key))));
}

Image8 thumbnail(const Image8& picture, int width, int height) {
    QX_CHECK(picture.width > 0 && picture.height > 0 && width > 0 && height > 0);
    const double shrink = std::max(
        {1.0, static_cast<double>(picture.width) / width, static_cast<double>(picture.height) / height});
    const auto side = [&](int pixels) { return std::max(1, static_cast<int>(std::lround(pixels / shrink))); };
    const int colours = picture.channels < 3 ? 1 : 3;
    const Image linear = toLinear(picture);
    Image small(side(picture.width), side(picture.height), colours, Encoding::linear);
    const double stepX = static_cast<double>(picture.width) / small.width;
    const double stepY = static_cast<double>(picture.height) / small.height;
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x) {
            std::array<double, 3> sum{};
            const double left = x * stepX;
            const double top = y * stepY;
            const double right = std::min<double>(picture.width, left + stepX);
            const double bottom = std::min<double>(picture.height, top + stepY);
            for (int v = static_cast<int>(top); v < bottom; ++v)
                for (int u = static_cast<int>(left); u < right; ++u) {
                    const double area = (std::min(right, u + 1.0) - std::max<double>(left, u)) *
                                        (std::min(bottom, v + 1.0) - std::max<double>(top, v));
                    for (int c = 0; c < colours; ++c)
                        sum[static_cast<std::size_t>(c)] += area * linear.pixel(u, v)[c];
                }
            for (int c = 0; c < colours; ++c)
                small.pixel(x, y)[c] =
                    static_cast<float>(sum[static_cast<std::size_t>(c)] / ((right - left) * (bottom - top)));
        }
    return toSrgb8(small);
}

void copyAssets(const fs::path& folder, std::span<const std::string_view> scripts) {
    for (const char* file : {"style.css", "theme.js"})
        copyText(asset(fmt::format("web/{}", file)), folder / file);
    for (const std::string_view script : scripts) {
        if (script != chartLibrary)
            copyText(asset(fmt::format("web/{}", script)), folder / script);
        if (script == "compare.js")
            writeIfChanged(folder / "error_colours.js", errorColourScript());
        if (script != chartLibrary)
            continue;
        const fs::path installed = fs::path("/usr/share/javascript/d3") / chartLibrary;
        std::error_code error;
        if (!fs::is_regular_file(installed, error))
            throw EnvironmentError("the chart library is not installed", installed.string(),
                                   "install the package libjs-d3");
        copyText(installed, folder / chartLibrary);
        copyText(asset("web/licences.txt"), folder / "licences.txt");
    }
}

bool writeIfChanged(const fs::path& file, std::string_view contents) {
    std::error_code error;
    if (fs::is_regular_file(file, error) && fs::file_size(file, error) == contents.size() && !error &&
        readFile(file, contents.size()) == contents)
        return false;
    writeFile(file, contents);
    return true;
}

}  // namespace quincunx::web
