#include "grade/rubric.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "base/error.h"
#include "base/file.h"
#include "lab/json.h"

namespace quincunx::grade {
namespace {

constexpr std::uintmax_t maxRubricBytes = 1 << 20;
constexpr std::size_t maxProperties = 64;
constexpr std::array<std::string_view, 4> measureNames = {"flip", "ssim", "effect", "task"};

/// Limits of the whole picture. Another driver's edges and JPEG at quality 75 cost 0.02 to 0.05 of ꟻLIP and
/// up to 0.06 of SSIM; a picture of something else begins at 0.3 and below 0.5 (tests/bench/grading.cpp).
Property flipProperty(double points) {
    return {.name = "the picture as eyes compare it",
            .measure = Measure::flip,
            .without = {},
            .points = points,
            .full = 0.06,
            .none = 0.3};
}
Property ssimProperty(double points) {
    return {.name = "the picture's structure",
            .measure = Measure::ssim,
            .without = {},
            .points = points,
            .full = 0.92,
            .none = 0.5};
}

/// Limits of an effect: 1 is there as in the reference, 0 is missing altogether.
constexpr double effectFull = 0.85;
constexpr double effectNone = 0.25;

/// Switches turned over and choices changed to their neighbour: what a lab without an exercise of its own
/// has.
std::vector<Exercise::Effect> generalEffects(const KnobSet& knobs) {
    std::vector<Exercise::Effect> effects;
    for (const Knob* knob : knobs.all()) {
        if (const auto* toggle = dynamic_cast<const BoolKnob*>(knob))
            effects.push_back({fmt::format("--{}", knob->name()), {{knob->name(), *toggle ? "off" : "on"}}});
        if (const auto* choice = dynamic_cast<const ChoiceKnob*>(knob)) {
            const std::size_t next =
                (static_cast<std::size_t>(choice->index()) + 1) % choice->options().size();
            effects.push_back({fmt::format("--{}={}", knob->name(), choice->text()),
                               {{knob->name(), choice->options()[next]}}});
        }
    }
    return effects;
}

/// The rubric's own view of its file: JSON and TOML alike.
Json jsonOf(const toml::node& node) {
    if (const auto* table = node.as_table()) {
        Json json = Json::object();
        for (const auto& [key, value] : *table)
            json[std::string(key.str())] = jsonOf(value);
        return json;
    }
    if (const auto* array = node.as_array()) {
        Json json = Json::array();
        for (const toml::node& value : *array)
            json.push_back(jsonOf(value));
        return json;
    }
    if (const auto* text = node.as_string())
        return text->get();
    if (const auto* number = node.as_integer())
        return number->get();
    if (const auto* number = node.as_floating_point())
        return number->get();
    if (const auto* truth = node.as_boolean())
        return truth->get();
    throw InputError("dates have no meaning in a rubric");
}

Json parse(const std::filesystem::path& file) {
    const std::string text = readFile(file, maxRubricBytes);
    if (lowerCaseExtension(file) == ".json") {
        try {
            return Json::parse(text);
        } catch (const Json::exception& e) {
            throw InputError(printable(e.what()), file.string(), "write JSON, or TOML in a file *.toml");
        }
    }
    try {
        return jsonOf(toml::parse(text));
    } catch (const toml::parse_error& e) {
        throw InputError(printable(e.description()),
                         fmt::format("{}:{}", file.string(), e.source().begin.line),
                         "write TOML, or JSON in a file *.json");
    }
}

void requireFields(const Json& json, const std::set<std::string>& known, const std::string& where) {
    if (!json.is_object())
        throw InputError(fmt::format("{} is no table", where));
    for (const auto& [name, value] : json.items())
        if (!known.contains(name))
            throw InputError(fmt::format("{} has no field \"{}\"", where, printable(name, 40)), {},
                             "it has " + fmt::format("{}", fmt::join(known, ", ")));
}

/// A knob's value as text, whether it was written as text, number or truth.
std::string valueText(const Json& value) {
    if (value.is_string())
        return value.get<std::string>();
    if (value.is_boolean())
        return value.get<bool>() ? "on" : "off";
    if (value.is_number())
        return value.dump();
    throw InputError("a knob's value is neither text nor number");
}

/// Knobs and values, each tried on the lab.
KnobValues knobsOf(const Json& json, KnobSet& knobs) {
    KnobValues values;
    if (!json.is_object())
        throw InputError("knobs are no table");
    const KnobScope scope(knobs);
    for (const auto& [name, value] : json.items()) {
        Knob& knob = knobs.find(name);
        knob.parse(valueText(value));
        values.emplace_back(name, knob.text());
    }
    return values;
}

double numberOf(const Json& json, const char* field) {
    const double value = json.at(field).get<double>();
    if (!std::isfinite(value))
        throw InputError(fmt::format("{} is not finite", field));
    return value;
}

Property propertyOf(const Json& json, KnobSet& knobs) {
    requireFields(json, {"name", "measure", "points", "full", "none", "without"}, "a property");
    Property property;
    property.name = json.at("name").get<std::string>();
    const std::string measure = json.value("measure", "effect");
    const auto found = std::find(measureNames.begin(), measureNames.end(), measure);
    if (found == measureNames.end())
        throw InputError(fmt::format("there is no measure \"{}\"", printable(measure, 40)), {},
                         "choose from flip, ssim, effect, task");
    property.measure = static_cast<Measure>(found - measureNames.begin());
    const Property usual = property.measure == Measure::flip ? flipProperty(0)
                           : property.measure == Measure::ssim
                               ? ssimProperty(0)
                               : Property{.name = {}, .without = {}, .full = effectFull, .none = effectNone};
    property.full = json.contains("full") ? numberOf(json, "full") : usual.full;
    property.none = json.contains("none") ? numberOf(json, "none") : usual.none;
    property.points = numberOf(json, "points");
    if (json.contains("without"))
        property.without = knobsOf(json.at("without"), knobs);
    const bool lessIsBetter = property.measure == Measure::flip;
    if (property.full == property.none || (property.full < property.none) != lessIsBetter)
        throw InputError(fmt::format("\"{}\": full is no better than none", printable(property.name, 60)), {},
                         lessIsBetter ? "full is the smaller one" : "full is the larger one");
    if (!(property.points > 0 && property.points <= 1e6))
        throw InputError(fmt::format("\"{}\": {} points", printable(property.name, 60), property.points), {},
                         "give more than 0");
    if (property.measure == Measure::effect && property.without.empty())
        throw InputError(
            fmt::format("\"{}\" does not say which knobs take the effect away", printable(property.name, 60)),
            {}, "give without = { KNOB = \"VALUE\" }");
    return property;
}

void change(Rubric& rubric, const Json& json, const LabEntry& entry, Lab& lab) {
    requireFields(
        json, {"lab", "title", "size", "camera", "free", "knobs", "handling", "property", "shader_property"},
        "a rubric");
    if (json.contains("lab") && !entry.isCalled(json.at("lab").get<std::string>()))
        throw InputError(fmt::format("is for the lab {}", printable(json.at("lab").get<std::string>(), 40)),
                         {}, "name it with --lab");
    rubric.title = json.value("title", rubric.title);
    if (json.contains("size")) {
        const auto size = json.at("size").get<std::pair<int, int>>();
        constexpr int most = 4096;
        if (size.first < 16 || size.second < 16 || size.first > most || size.second > most)
            throw InputError("size is not 16 to 4096 pixels a side");
        rubric.size = size;
    }
    if (json.contains("camera")) {
        const std::string camera = json.at("camera").get<std::string>();
        if (camera != "task" && camera != "picture")
            throw InputError("camera is neither task nor picture");
        rubric.cameraIsFree = camera == "picture";
    }
    if (json.contains("free")) {
        rubric.freeKnobs = json.at("free").get<std::vector<std::string>>();
        for (const std::string& name : rubric.freeKnobs)
            lab.knobs().find(name);
    }
    if (json.contains("knobs"))
        for (const auto& [name, value] : knobsOf(json.at("knobs"), lab.knobs())) {
            std::erase_if(rubric.knobs, [&, &given = name](const auto& knob) { return knob.first == given; });
            rubric.knobs.emplace_back(name, value);
        }
    if (json.contains("handling"))
        for (const auto& [name, value] : json.at("handling").items()) {
            const std::optional<Handling> handling = parseHandling(name);
            const double most = value.get<double>();
            if (!handling || !(most >= 0 && most <= 1))
                throw InputError(
                    fmt::format("handling: {} = {}", printable(name, 40), most), {},
                    "name blank, bordered, cropped, shifted, scaled, mirrored, swapped-channels or "
                    "gamma, and a share from 0 to 1");
            rubric.most[static_cast<std::size_t>(*handling)] = most;
        }
    const auto properties = [&](const char* field, std::vector<Property>& target) {
        if (!json.contains(field))
            return;
        target.clear();
        for (const Json& property : json.at(field))
            target.push_back(propertyOf(property, lab.knobs()));
        if (target.empty() || target.size() > maxProperties)
            throw InputError(fmt::format("{} properties", target.size()), {}, "give 1 to 64");
    };
    properties("property", rubric.properties);
    properties("shader_property", rubric.shaderProperties);
}

Json jsonOf(const KnobValues& values) {
    Json json = Json::object();
    for (const auto& [name, value] : values)
        json[name] = value;
    return json;
}

}  // namespace

double Property::pointsFor(double figure) const {
    const double share = (figure - none) / (full - none);
    return share > 0 ? points * std::min(share, 1.0) : 0;
}

double Rubric::points() const {
    double sum = 0;
    for (const Property& property : properties)
        sum += property.points;
    return sum;
}

std::string Rubric::text() const {
    Json json{{"lab", lab},
              {"title", title},
              {"camera", cameraIsFree ? "picture" : "task"},
              {"free", freeKnobs},
              {"knobs", jsonOf(knobs)}};
    if (size)
        json["size"] = {size->first, size->second};
    for (int i = 0; i < handlingCount; ++i)
        json["handling"][std::string(handlingName(static_cast<Handling>(i)))] =
            most[static_cast<std::size_t>(i)];
    for (const auto* list : {&properties, &shaderProperties})
        for (const Property& property : *list)
            json[list == &properties ? "property" : "shader_property"].push_back(
                {{"name", property.name},
                 {"measure", measureNames[static_cast<std::size_t>(property.measure)]},
                 {"points", property.points},
                 {"full", property.full},
                 {"none", property.none},
                 {"without", jsonOf(property.without)}});
    return dump(json);
}

Rubric defaultRubric(const LabEntry& entry, Lab& lab) {
    constexpr double pictureShare = 20;  // each of ꟻLIP and SSIM
    constexpr double effectsShare = 60;
    const Exercise exercise = lab.exercise();
    Rubric rubric;
    rubric.lab = entry.folder();
    rubric.title = entry.folder();
    rubric.knobs = exercise.knobs;
    rubric.freeKnobs = exercise.freeKnobs;
    const std::vector<Exercise::Effect> effects =
        exercise.effects.empty() ? generalEffects(lab.knobs()) : exercise.effects;
    for (const Exercise::Effect& effect : effects)
        rubric.properties.push_back({.name = effect.name,
                                     .measure = effect.without.empty() ? Measure::task : Measure::effect,
                                     .without = effect.without,
                                     .points = effectsShare / static_cast<double>(effects.size()),
                                     .full = effectFull,
                                     .none = effectNone});
    rubric.properties.push_back(flipProperty(effects.empty() ? 50 : pictureShare));
    rubric.properties.push_back(ssimProperty(effects.empty() ? 50 : pictureShare));
    rubric.shaderProperties = {
        {.name = "the task", .measure = Measure::task, .without = {}, .points = 70, .full = 0.9, .none = 0.1},
        flipProperty(15),
        ssimProperty(15)};
    rubric.most.fill(1);
    const auto most = [&](Handling handling, double share) {
        rubric.most[static_cast<std::size_t>(handling)] = share;
    };
    most(Handling::blank, 0);
    most(Handling::bordered, 0.97);
    most(Handling::cropped, 0.98);
    most(Handling::shifted, 0.98);
    most(Handling::scaled, 0.97);
    most(Handling::gamma, 0.8);
    most(Handling::swappedChannels, 0.6);
    most(Handling::mirrored, 0.6);
    return rubric;
}

Rubric rubricFromText(const std::string& text, const LabEntry& entry, Lab& lab) {
    Rubric rubric = defaultRubric(entry, lab);
    change(rubric, Json::parse(text), entry, lab);
    return rubric;
}

Rubric readRubric(const std::filesystem::path& file, const LabEntry& entry, Lab& lab) {
    Rubric rubric = defaultRubric(entry, lab);
    const Json json = parse(file);
    try {
        change(rubric, json, entry, lab);
    } catch (const Json::exception& e) {
        throw InputError(printable(e.what(), 160), file.string(), "see the comment in the README's example");
    } catch (const InputError& e) {
        throw InputError(e.what(), file.string());
    }
    return rubric;
}

}  // namespace quincunx::grade
