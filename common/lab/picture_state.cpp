#include "lab/picture_state.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

#include <fmt/format.h>
#include <glm/gtc/matrix_access.hpp>

#include "base/error.h"
#include "base/file.h"
#include "image/io.h"
#include "lab/json.h"

namespace quincunx {
namespace {

constexpr std::uintmax_t maxStateBytes = 1 << 20;

Json toJson(const Camera& camera) {
    Json columns = Json::array();
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row)
            columns.push_back(camera.worldFromCamera[column][row]);
    // JSON has no infinity: a camera without a far plane leaves the far distance out, and a lens that is
    // focused at infinity the focus.
    Json json{
        {"world_from_camera", columns}, {"fov_y_radians", camera.fovYRadians}, {"near", camera.nearDistance}};
    if (std::isfinite(camera.farDistance))
        json["far"] = camera.farDistance;
    json["aperture_radius"] = camera.apertureRadius;
    if (std::isfinite(camera.focusDistance))
        json["focus_distance"] = camera.focusDistance;
    return json;
}

/// A whole number in [min, max].
template <typename Integer>
Integer parseInteger(const Json& json, const char* key, Integer min, Integer max) {
    const Json& value = json.at(key);
    const bool fits = value.is_number_unsigned()
                          ? value.get<std::uint64_t>() <= static_cast<std::uint64_t>(max) &&
                                value.get<std::uint64_t>() >= static_cast<std::uint64_t>(min)
                          : false;
    if (!fits)
        throw InputError(fmt::format("{} is not a whole number from {} to {}", key, min, max));
    return value.get<Integer>();
}

/// A number that float can hold.
float parseFloat(const Json& json) {
    const double value = json.get<double>();
    if (!(std::abs(value) <= std::numeric_limits<float>::max()))
        throw InputError("a number of the camera is too large");
    return static_cast<float>(value);
}

/// True if the upper 3×3 block is a rotation but for the rounding of its entries to float, and the last row
/// (0,0,0,1): entries within 2^-24 of a rotation's move the products of columns by 2 √3 2^-24 at most, and
/// what made them may have rounded as often again.
bool isRigid(const glm::mat4& m) {
    constexpr double tolerance = 4 * 1.7320508 * 0x1p-24;
    const glm::dmat3 rotation(m);
    const glm::dmat3 product = glm::transpose(rotation) * rotation;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
            if (!(std::abs(product[i][j] - (i == j ? 1 : 0)) <= tolerance))
                return false;
    return glm::determinant(rotation) > 0 && glm::row(m, 3) == glm::vec4(0, 0, 0, 1);
}

/// Sixteen hexadecimal digits; 0 for none.
std::uint64_t parseFingerprint(const std::string& digits) {
    std::uint64_t value = 0;
    const char* const end = digits.data() + digits.size();
    const auto [stop, error] = std::from_chars(digits.data(), end, value, 16);
    if (!digits.empty() && (error != std::errc() || stop != end))
        throw InputError("model_fingerprint is not a hexadecimal number");
    return value;
}

Camera parseCamera(const Json& json) {
    Camera camera;
    const Json& columns = json.at("world_from_camera");
    if (!columns.is_array() || columns.size() != 16)
        throw InputError("world_from_camera is not a list of 16 numbers");
    for (int i = 0; i < 16; ++i)
        camera.worldFromCamera[i / 4][i % 4] = parseFloat(columns[static_cast<std::size_t>(i)]);
    camera.fovYRadians = parseFloat(json.at("fov_y_radians"));
    camera.nearDistance = parseFloat(json.at("near"));
    camera.farDistance =
        json.contains("far") ? parseFloat(json.at("far")) : std::numeric_limits<float>::infinity();
    // Records of cameras without a lens have neither.
    if (json.contains("aperture_radius")) {
        camera.apertureRadius = parseFloat(json.at("aperture_radius"));
        camera.focusDistance = json.contains("focus_distance") ? parseFloat(json.at("focus_distance"))
                                                               : std::numeric_limits<float>::infinity();
    }
    const bool sane = camera.apertureRadius >= 0 && camera.focusDistance > 0 && camera.fovYRadians > 0 &&
                      camera.fovYRadians < std::numbers::pi_v<float> && isRigid(camera.worldFromCamera) &&
                      camera.nearDistance > 0 && camera.farDistance > camera.nearDistance;
    if (!sane)
        throw InputError("the camera's frame, angle or distances make no sense");
    return camera;
}

}  // namespace

std::string toJson(const PictureState& state) {
    Json knobs = Json::object();
    for (const auto& [name, value] : state.knobs)
        knobs[name] = value;
    Json json{{"lab", state.lab}, {"model", state.model}};
    // In digits, since readers of JSON may keep no more than 53 bits of a number.
    if (state.modelFingerprint != 0)
        json["model_fingerprint"] = fmt::format("{:016x}", state.modelFingerprint);
    json.update(Json{{"renderer", state.renderer},
                     {"width", state.frame.width},
                     {"height", state.frame.height},
                     {"time_seconds", state.frame.timeSeconds},
                     {"seed", state.frame.seed},
                     {"camera", toJson(state.frame.camera)},
                     {"knobs", knobs}});
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

PictureState parsePictureState(std::string_view text, std::string_view where) {
    try {
        const Json json = Json::parse(text);
        PictureState state;
        state.lab = json.at("lab").get<std::string>();
        state.model = json.value("model", "");
        state.modelFingerprint = parseFingerprint(json.value("model_fingerprint", ""));
        state.renderer = json.value("renderer", "");
        state.frame.width = parseInteger(json, "width", 1, maxPictureSide);
        state.frame.height = parseInteger(json, "height", 1, maxPictureSide);
        state.frame.timeSeconds = json.value("time_seconds", 0.0);
        state.frame.seed =
            parseInteger(json, "seed", std::uint64_t{0}, std::numeric_limits<std::uint64_t>::max());
        state.frame.camera = parseCamera(json.at("camera"));
        for (const auto& [name, value] : json.at("knobs").items())
            state.knobs.emplace_back(name, value.get<std::string>());
        if (!std::isfinite(state.frame.timeSeconds))
            throw InputError("the time is not finite");
        return state;
    } catch (const Json::exception& e) {
        throw InputError(fmt::format("is no record of a picture ({})", printable(e.what(), 120)), where,
                         "make one with run --record FILE");
    } catch (const InputError& e) {
        throw InputError(e.what(), where, "make a new one with run --record FILE");
    }
}

PictureState readPictureState(const std::filesystem::path& file) {
    const std::string extension = lowerCaseExtension(file);
    if (extension == ".png" || extension == ".exr") {
        for (const auto& [key, value] : readMetadata(file))
            if (key == pictureStateKey)
                return parsePictureState(value, file.string());
        throw InputError("the picture holds no record of how it was made", file.string(),
                         "name a PNG that this program wrote, or a file from run --record");
    }
    return parsePictureState(readFile(file, maxStateBytes), file.string());
}

}  // namespace quincunx
