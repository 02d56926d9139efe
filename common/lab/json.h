#pragma once

#include <string>

#include <nlohmann/json.hpp>

/// JSON as all verbs print it: fields in the order in which they are written.
namespace quincunx {

using Json = nlohmann::ordered_json;

/// Indented, ending with a new line. Text that is no UTF-8 is replaced; numbers that are not finite are null.
inline std::string dump(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace quincunx
