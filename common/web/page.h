#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "image/image.h"

/// Pages that are read from disk: filled templates, the style sheet, the scripts and the pictures they use.
/// Nothing that such a page shows comes from anywhere else, and browsers keep scripts of files from reading
/// other files: whatever a script is to read is therefore in the page or in a script of its own.
namespace quincunx::web {

using Json = nlohmann::ordered_json;

/// The text with & < > " ' as references, so that it is text in HTML and inside quoted attributes. Control
/// characters that HTML forbids and bytes that are no UTF-8 become U+FFFD.
std::string escaped(std::string_view text);

/// Mustache template web/templates/NAME.mustache of the assets, filled with `view`. `{{name}}` is escaped as
/// `escaped` does, `{{{name}}}` is taken as it is and therefore never holds what came from a file; numbers,
/// `true` and `null` (false) work as Mustache has them; `{{> part}}` is web/templates/part.mustache.
/// EnvironmentError if a template is missing; a template with a mistake in it is an InputError naming it.
std::string filledTemplate(std::string_view name, const Json& view);

/// JSON to stand inside a <script type="application/json"> element: no text in it can end the element.
std::string inScript(const Json& json);

/// "data:image/png;base64,…"
std::string dataUri(std::string_view mediaType, std::span<const unsigned char> bytes);

/// A script that hands the lossless picture over to compare.js: file name without its folder → contents. A
/// page names it as `data-pixels` of an <img> whose `src` shows the same picture; compare.js loads it when
/// the pixels are asked for. `key` is the text that the page's `data-pixels` has.
std::string pixelScript(std::string_view key, const Image8& picture);

/// Mean of as many pixels as fall onto one of the smaller picture, in linear light; alpha is dropped. At most
/// `width` × `height` pixels, with the shape of the picture.
Image8 thumbnail(const Image8& picture, int width, int height);

/// Copies style.css, theme.js and the scripts named ("compare.js", "charts.js" …) into `folder`: with
/// compare.js comes error_colours.js, which pages name before it; "d3.min.js" is the chart library as the
/// machine has it, with its licence in licences.txt. Files that are the same already are left alone.
/// EnvironmentError naming the package where the library is missing.
void copyAssets(const std::filesystem::path& folder, std::span<const std::string_view> scripts);

/// Writes the file unless it holds just that already; true if it was written.
bool writeIfChanged(const std::filesystem::path& file, std::string_view contents);

}  // namespace quincunx::web
