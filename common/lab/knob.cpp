#include "lab/knob.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "base/check.h"
#include "base/error.h"

namespace quincunx {
namespace {

InputError refused(const Knob& knob, std::string_view text) {
    return InputError(
        fmt::format("\"{}\" is not a value", printable(text, 40)), "--" + knob.name(),
        fmt::format("give {}{}{}", knob.allowed(), knob.unit().empty() ? "" : " ", knob.unit()));
}

template <typename Number>
Number parseNumber(const Knob& knob, std::string_view text, Number min, Number max) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    // A NaN fails both comparisons.
    if (error != std::errc{} || end != text.data() + text.size() || !(value >= min && value <= max))
        throw refused(knob, text);
    return value;
}

}  // namespace

Knob::Knob(KnobSet& owner, std::string name, std::string unit, std::string help)
    : name_(std::move(name)), unit_(std::move(unit)), help_(std::move(help)) {
    QX_CHECK(std::none_of(owner.knobs_.begin(), owner.knobs_.end(),
                          [&](const Knob* other) { return other->name() == name_; }));
    owner.knobs_.push_back(this);
}

Knob& KnobSet::find(std::string_view name) const {
    for (Knob* knob : knobs_)
        if (knob->name() == name)
            return *knob;
    std::vector<std::string> names;
    for (const Knob* knob : knobs_)
        names.push_back(knob->name());
    throw InputError(fmt::format("there is no knob \"{}\"", printable(name, 40)), {},
                     fmt::format("choose from {}", fmt::join(names, ", ")));
}

std::vector<std::pair<std::string, std::string>> KnobSet::values() const {
    std::vector<std::pair<std::string, std::string>> result;
    for (const Knob* knob : knobs_)
        result.emplace_back(knob->name(), knob->text());
    return result;
}

void KnobSet::set(const std::vector<std::pair<std::string, std::string>>& values) {
    for (const auto& [name, value] : values)
        find(name).parse(value);
}

template <typename Number>
NumberKnob<Number>::NumberKnob(KnobSet& owner, std::string name, Number value, Range range, std::string unit,
                               std::string help)
    : Knob(owner, std::move(name), std::move(unit), std::move(help)),
      value_(value),
      default_(value),
      range_(range) {
    QX_CHECK(value >= range.min && value <= range.max);
    rememberDefault();
}

template <typename Number>
void NumberKnob<Number>::set(Number value) {
    QX_CHECK(value >= range_.min && value <= range_.max);
    value_ = value;
}

template <typename Number>
std::string NumberKnob<Number>::text() const {
    return fmt::format("{}", value_);
}

template <typename Number>
void NumberKnob<Number>::parse(std::string_view text) {
    value_ = parseNumber(*this, text, range_.min, range_.max);
}

template <typename Number>
std::string NumberKnob<Number>::allowed() const {
    return fmt::format("{} … {}", range_.min, range_.max);
}

template class NumberKnob<float>;
template class NumberKnob<int>;

BoolKnob::BoolKnob(KnobSet& owner, std::string name, bool value, std::string help)
    : Knob(owner, std::move(name), {}, std::move(help)), value_(value), default_(value) {
    rememberDefault();
}

void BoolKnob::parse(std::string_view text) {
    if (text == "on" || text == "true" || text == "1")
        value_ = true;
    else if (text == "off" || text == "false" || text == "0")
        value_ = false;
    else
        throw refused(*this, text);
}

ChoiceKnob::ChoiceKnob(KnobSet& owner, std::string name, std::vector<std::string> options, int value,
                       std::string help)
    : Knob(owner, std::move(name), {}, std::move(help)),
      options_(std::move(options)),
      value_(value),
      default_(value) {
    QX_CHECK(value >= 0 && static_cast<std::size_t>(value) < options_.size());
    rememberDefault();
}

void ChoiceKnob::set(int index) {
    QX_CHECK(index >= 0 && static_cast<std::size_t>(index) < options_.size());
    value_ = index;
}

void ChoiceKnob::parse(std::string_view text) {
    const auto found = std::find(options_.begin(), options_.end(), text);
    if (found == options_.end())
        throw refused(*this, text);
    value_ = static_cast<int>(found - options_.begin());
}

std::string ChoiceKnob::allowed() const {
    return fmt::format("{}", fmt::join(options_, "|"));
}

TextKnob::TextKnob(KnobSet& owner, std::string name, std::string value, std::string allowed, std::string help)
    : Knob(owner, std::move(name), {}, std::move(help)),
      value_(std::move(value)),
      default_(value_),
      allowed_(std::move(allowed)) {
    rememberDefault();
}

void TextKnob::parse(std::string_view text) {
    constexpr std::size_t longest = 4096;
    const bool hasControl =
        std::any_of(text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < 32; });
    if (text.size() > longest || hasControl)
        throw refused(*this, text);
    value_ = text;
}

}  // namespace quincunx
