#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// Knobs: the settings of a lab. Declared once as a member of the lab, a knob is at the same time a flag
/// (`--bias=2`), a slider, an axis of sweeps, and a line in the picture's metadata.
namespace quincunx {

class KnobSet;

/// What all kinds of knobs share: a name, a value that can be written as text, and a line of help.
class Knob {
  public:
    Knob(KnobSet& owner, std::string name, std::string unit, std::string help);
    virtual ~Knob() = default;
    Knob(const Knob&) = delete;
    Knob& operator=(const Knob&) = delete;

    const std::string& name() const { return name_; }  ///< lower case, words joined by '-'
    const std::string& unit() const { return unit_; }  ///< empty: a plain number or a choice
    const std::string& help() const { return help_; }

    /// The value as text that `parse` reads back to the same value, bit for bit.
    virtual std::string text() const = 0;
    /// Sets the value; InputError naming the knob, the text and what is allowed.
    virtual void parse(std::string_view text) = 0;
    /// What is allowed, for help and errors: "0 … 10", "flat|gouraud|phong", "on|off".
    virtual std::string allowed() const = 0;
    virtual void reset() = 0;
    std::string defaultText() const { return defaultText_; }

    /// Says that the knob changes nothing at present, and why: "imported models keep their own triangles".
    /// It is then grey in the panel, and on the command line worth a warning.
    void setIdle(std::string why) { idle_ = std::move(why); }
    const std::string& idle() const { return idle_; }  ///< empty: the knob works

  protected:
    void rememberDefault() { defaultText_ = text(); }

  private:
    std::string name_;
    std::string unit_;
    std::string help_;
    std::string defaultText_;
    std::string idle_;
};

/// The knobs of one lab in the order of their declaration. Knobs outlive nothing: they belong to the lab.
class KnobSet {
  public:
    KnobSet() = default;
    KnobSet(const KnobSet&) = delete;
    KnobSet& operator=(const KnobSet&) = delete;

    const std::vector<Knob*>& all() const { return knobs_; }
    /// Throws InputError listing the names there are.
    Knob& find(std::string_view name) const;
    /// Names and values of all knobs.
    std::vector<std::pair<std::string, std::string>> values() const;
    void set(const std::vector<std::pair<std::string, std::string>>& values);

  private:
    friend class Knob;
    std::vector<Knob*> knobs_;
};

/// A number in a closed range. Not finite or out of range is an InputError, never clamped in silence.
template <typename Number>
class NumberKnob final : public Knob {
  public:
    struct Range {
        Number min = 0;
        Number max = 1;
        bool logarithmic = false;  ///< how a slider spreads it
    };
    NumberKnob(KnobSet& owner, std::string name, Number value, Range range, std::string unit,
               std::string help);
    operator Number() const { return value_; }  // NOLINT: a knob reads as its value
    void set(Number value);
    const Range& range() const { return range_; }
    std::string text() const override;
    void parse(std::string_view text) override;
    std::string allowed() const override;
    void reset() override { value_ = default_; }

  private:
    Number value_;
    Number default_;
    Range range_;
};
extern template class NumberKnob<float>;
extern template class NumberKnob<int>;
using FloatKnob = NumberKnob<float>;
using IntKnob = NumberKnob<int>;  ///< whole numbers

/// On or off.
class BoolKnob final : public Knob {
  public:
    BoolKnob(KnobSet& owner, std::string name, bool value, std::string help);
    operator bool() const { return value_; }  // NOLINT: a knob reads as its value
    void set(bool value) { value_ = value; }
    std::string text() const override { return value_ ? "on" : "off"; }
    void parse(std::string_view text) override;
    std::string allowed() const override { return "on|off"; }
    void reset() override { value_ = default_; }

  private:
    bool value_;
    bool default_;
};

/// One of a few named things. `index()` counts them from 0 in the order of `options`.
class ChoiceKnob final : public Knob {
  public:
    ChoiceKnob(KnobSet& owner, std::string name, std::vector<std::string> options, int value,
               std::string help);
    int index() const { return value_; }
    /// The chosen option as an enumeration whose values follow `options`.
    template <typename Enum>
    Enum as() const {
        return static_cast<Enum>(value_);
    }
    void set(int index);
    const std::vector<std::string>& options() const { return options_; }
    std::string text() const override { return options_[static_cast<std::size_t>(value_)]; }
    void parse(std::string_view text) override;
    std::string allowed() const override;
    void reset() override { value_ = default_; }

  private:
    std::vector<std::string> options_;
    int value_;
    int default_;
};

/// Words: the name of a file, say. What they mean the lab finds out when it draws; control characters and
/// texts over 4096 bytes are an InputError at once.
class TextKnob final : public Knob {
  public:
    /// `allowed`: for help and errors, as Knob::allowed.
    TextKnob(KnobSet& owner, std::string name, std::string value, std::string allowed, std::string help);
    const std::string& value() const { return value_; }
    void set(std::string value) { value_ = std::move(value); }
    std::string text() const override { return value_; }
    void parse(std::string_view text) override;
    std::string allowed() const override { return allowed_; }
    void reset() override { value_ = default_; }

  private:
    std::string value_;
    std::string default_;
    std::string allowed_;
};

/// Puts all knobs back to the values they had, at the end of a scope.
class KnobScope {
  public:
    explicit KnobScope(KnobSet& knobs) : knobs_(knobs), values_(knobs.values()) {}
    ~KnobScope() { knobs_.set(values_); }
    KnobScope(const KnobScope&) = delete;
    KnobScope& operator=(const KnobScope&) = delete;

  private:
    KnobSet& knobs_;
    std::vector<std::pair<std::string, std::string>> values_;
};

}  // namespace quincunx
