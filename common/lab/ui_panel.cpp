#include "lab/ui_panel.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>
#include <imgui.h>

#include "base/paths.h"

namespace quincunx {
namespace {

constexpr float fontPoints = 15;
constexpr float marginPoints = 12;

const ImVec4 textColor(0.90f, 0.91f, 0.93f, 1);
const ImVec4 dimColor(0.58f, 0.61f, 0.66f, 1);
const ImVec4 faultColor(1.00f, 0.47f, 0.43f, 1);
const ImVec4 noticeColor(0.55f, 0.83f, 0.60f, 1);
const ImVec4 accentColor(0.36f, 0.60f, 0.94f, 1);

/// printf's format for a value of the knob and its unit.
std::string valueFormat(const Knob& knob, std::string_view conversion) {
    std::string format(conversion);
    if (!knob.unit().empty())
        format += ' ';
    for (const char c : knob.unit())
        format += c == '%' ? std::string("%%") : std::string(1, c);
    return format;
}

ImGuiSliderFlags sliderFlags(bool logarithmic) {
    const int flags = ImGuiSliderFlags_AlwaysClamp | ImGuiSliderFlags_NoRoundToFormat;
    return logarithmic ? flags | ImGuiSliderFlags_Logarithmic : flags;
}

bool drawControl(FloatKnob& knob) {
    float value = knob;
    const FloatKnob::Range& range = knob.range();
    const std::string format = valueFormat(knob, "%.4g");
    if (!ImGui::SliderFloat("##value", &value, range.min, range.max, format.c_str(),
                            sliderFlags(range.logarithmic)) ||
        !(value >= range.min && value <= range.max) || value == knob)
        return false;
    knob.set(value);
    return true;
}

bool drawControl(IntKnob& knob) {
    int value = knob;
    const IntKnob::Range& range = knob.range();
    const std::string format = valueFormat(knob, "%d");
    if (!ImGui::SliderInt("##value", &value, range.min, range.max, format.c_str(),
                          sliderFlags(range.logarithmic)) ||
        value < range.min || value > range.max || value == knob)
        return false;
    knob.set(value);
    return true;
}

bool drawControl(BoolKnob& knob) {
    bool value = knob;
    if (!ImGui::Checkbox("##value", &value))
        return false;
    knob.set(value);
    return true;
}

bool drawControl(ChoiceKnob& knob) {
    bool changed = false;
    if (!ImGui::BeginCombo("##value", knob.text().c_str()))
        return false;
    for (int i = 0; i < static_cast<int>(knob.options().size()); ++i) {
        const bool chosen = i == knob.index();
        if (ImGui::Selectable(knob.options()[static_cast<std::size_t>(i)].c_str(), chosen) && !chosen) {
            knob.set(i);
            changed = true;
        }
        if (chosen)
            ImGui::SetItemDefaultFocus();
    }
    ImGui::EndCombo();
    return changed;
}

bool drawControl(Knob& knob) {
    if (auto* number = dynamic_cast<FloatKnob*>(&knob))
        return drawControl(*number);
    if (auto* whole = dynamic_cast<IntKnob*>(&knob))
        return drawControl(*whole);
    if (auto* choice = dynamic_cast<ChoiceKnob*>(&knob))
        return drawControl(*choice);
    if (auto* onOff = dynamic_cast<BoolKnob*>(&knob))
        return drawControl(*onOff);
    ImGui::TextUnformatted(knob.text().c_str());
    return false;
}

void textWrapped(const ImVec4& color, const std::string& text) {
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::PushTextWrapPos(0);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void tooltip(const std::string& text, float points) {
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(300 * points);
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

/// The knob's name, its control, and a button that puts it back where it differs from its default.
bool drawKnob(Knob& knob, std::size_t index, float points) {
    bool changed = false;
    const bool differs = knob.text() != knob.defaultText();
    const float top = (PanelLayout::knobTop + PanelLayout::knobStep * static_cast<float>(index)) * points;
    ImGui::PushID(&knob);
    ImGui::SetCursorPos({marginPoints * points, top});
    ImGui::AlignTextToFramePadding();
    ImGui::PushStyleColor(ImGuiCol_Text, differs ? textColor : dimColor);
    ImGui::TextUnformatted(knob.name().c_str());
    ImGui::PopStyleColor();
    bool hovered = ImGui::IsItemHovered();

    ImGui::SetCursorPos({PanelLayout::knobLeft * points, top});
    ImGui::SetNextItemWidth(PanelLayout::knobWidth * points);
    ImGui::BeginDisabled(!knob.idle().empty());
    changed = drawControl(knob);
    ImGui::EndDisabled();
    const bool onControl = ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled);
    hovered = hovered || onControl;
    bool putBack = onControl && ImGui::IsMouseClicked(ImGuiMouseButton_Right);

    if (differs) {
        ImGui::SetCursorPos({PanelLayout::resetLeft * points, top});
        putBack = ImGui::Button("x", {PanelLayout::resetWidth * points, PanelLayout::knobHeight * points}) ||
                  putBack;
        if (ImGui::IsItemHovered())
            tooltip("Back to " + knob.defaultText(), points);
    }
    if (putBack) {
        changed = changed || differs;
        knob.reset();
    }
    if (hovered && !ImGui::IsAnyItemActive()) {
        std::string help = knob.help();
        if (!knob.idle().empty())
            help += "\nWithout effect: " + knob.idle();
        if (dynamic_cast<BoolKnob*>(&knob) == nullptr && dynamic_cast<ChoiceKnob*>(&knob) == nullptr)
            help += fmt::format("\n{}; Ctrl-click to type", knob.allowed());
        help += fmt::format("\nRight-click for the default, {}", knob.defaultText());
        tooltip(help, points);
    }
    ImGui::PopID();
    return changed;
}

void heading(const char* text) {
    ImGui::Spacing();
    ImGui::Spacing();
    ImGui::PushStyleColor(ImGuiCol_Text, accentColor);
    ImGui::TextUnformatted(text);
    ImGui::PopStyleColor();
    ImGui::Separator();
}

void drawFacts(const PanelText& text, float points) {
    for (const auto& [name, value] : text.facts) {
        ImGui::PushStyleColor(ImGuiCol_Text, dimColor);
        ImGui::TextUnformatted(name.c_str());
        ImGui::PopStyleColor();
        ImGui::SameLine(PanelLayout::knobLeft * points);
        ImGui::PushTextWrapPos(0);
        ImGui::TextUnformatted(value.c_str());
        ImGui::PopTextWrapPos();
    }
}

}  // namespace

void applyStyle(float pointsToScreen, float screenToPixels) {
    ImGuiStyle style;
    ImGui::StyleColorsDark(&style);
    style.WindowPadding = {marginPoints, marginPoints};
    style.FramePadding = {8, (PanelLayout::knobHeight - fontPoints) / 2};
    style.ItemSpacing = {8, PanelLayout::knobStep - PanelLayout::knobHeight};
    style.ItemInnerSpacing = {6, 4};
    style.ScrollbarSize = 10;
    style.GrabMinSize = 12;
    style.WindowRounding = 0;
    style.FrameRounding = 4;
    style.GrabRounding = 4;
    style.PopupRounding = 4;
    style.ScrollbarRounding = 5;
    style.WindowBorderSize = 0;
    style.PopupBorderSize = 1;
    style.ScaleAllSizes(pointsToScreen);

    const ImVec4 ground(0.105f, 0.113f, 0.130f, 1);
    const ImVec4 field(0.175f, 0.188f, 0.215f, 1);
    const ImVec4 fieldHovered(0.225f, 0.243f, 0.280f, 1);
    const ImVec4 fieldActive(0.260f, 0.284f, 0.330f, 1);
    const ImVec4 accentDim(0.30f, 0.50f, 0.80f, 1);
    ImVec4* colors = style.Colors;
    colors[ImGuiCol_Text] = textColor;
    colors[ImGuiCol_TextDisabled] = dimColor;
    colors[ImGuiCol_WindowBg] = ground;
    colors[ImGuiCol_PopupBg] = {0.130f, 0.140f, 0.162f, 0.98f};
    colors[ImGuiCol_Border] = {0.30f, 0.32f, 0.37f, 1};
    colors[ImGuiCol_FrameBg] = field;
    colors[ImGuiCol_FrameBgHovered] = fieldHovered;
    colors[ImGuiCol_FrameBgActive] = fieldActive;
    colors[ImGuiCol_SliderGrab] = accentDim;
    colors[ImGuiCol_SliderGrabActive] = accentColor;
    colors[ImGuiCol_CheckMark] = accentColor;
    colors[ImGuiCol_Button] = field;
    colors[ImGuiCol_ButtonHovered] = fieldHovered;
    colors[ImGuiCol_ButtonActive] = accentDim;
    colors[ImGuiCol_Header] = {0.22f, 0.33f, 0.50f, 1};
    colors[ImGuiCol_HeaderHovered] = {0.26f, 0.40f, 0.61f, 1};
    colors[ImGuiCol_HeaderActive] = accentDim;
    colors[ImGuiCol_Separator] = {0.22f, 0.24f, 0.28f, 1};
    colors[ImGuiCol_NavHighlight] = accentColor;
    ImGui::GetStyle() = style;

    // The glyphs are drawn at the size they have in pixels, and laid out in screen coordinates.
    ImGuiIO& io = ImGui::GetIO();
    io.Fonts->Clear();
    const float pixels = std::round(fontPoints * pointsToScreen * screenToPixels);
    static constexpr ImWchar glyphs[] = {0x20,   0xff,   0x370,  0x3ff,  0x2010, 0x2027,
                                         0x2190, 0x21ff, 0x2264, 0x2265, 0};
    io.Fonts->AddFontFromFileTTF(typefaceFile().c_str(), pixels, nullptr, glyphs);
    io.FontGlobalScale = 1 / screenToPixels;
}

PanelActions drawPanel(KnobSet& knobs, const PanelText& text, float pointsToScreen) {
    const float points = pointsToScreen;
    PanelActions actions;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float width = PanelLayout::width * points;
    ImGui::SetNextWindowPos({display.x - width, 0});
    ImGui::SetNextWindowSize({width, display.y});
    ImGui::Begin("panel", nullptr,
                 ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoCollapse |
                     ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoBringToFrontOnFocus);
    ImGui::SetWindowFontScale(1.2f);
    ImGui::TextUnformatted(text.title.c_str());
    ImGui::SetWindowFontScale(1);
    if (ImGui::IsItemHovered())
        tooltip(text.topic, points);
    ImGui::SameLine(ImGui::GetWindowContentRegionMax().x - 44 * points);
    actions.helpWanted = ImGui::Button("help", {44 * points, 0});
    heading("Knobs");

    std::size_t index = 0;
    for (Knob* knob : knobs.all())
        actions.knobsChanged = drawKnob(*knob, index++, points) || actions.knobsChanged;
    ImGui::SetCursorPosY((PanelLayout::knobTop + PanelLayout::knobStep * static_cast<float>(index)) * points);

    heading("Picture");
    drawFacts(text, points);
    heading("Camera");
    textWrapped(dimColor, text.camera);
    ImGui::End();
    return actions;
}

void drawInset(const InsetPicture& picture, float pictureWidth, float pointsToScreen) {
    const float margin = marginPoints * pointsToScreen;
    const float width = pictureWidth / 3;
    const float shape = static_cast<float>(picture.height) / static_cast<float>(picture.width);
    ImGui::SetNextWindowPos({margin, ImGui::GetIO().DisplaySize.y - margin}, ImGuiCond_Always, {0, 1});
    ImGui::SetNextWindowSize({width + 2 * margin, 0});
    ImGui::Begin("inset", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoInputs);
    ImGui::Image(reinterpret_cast<ImTextureID>(static_cast<std::uintptr_t>(picture.texture)),
                 {width, width * shape});
    textWrapped(dimColor, picture.caption);
    ImGui::End();
}

void drawMessages(const std::string& notice, const std::string& fault, bool onPanel, float pointsToScreen) {
    if (notice.empty() && fault.empty())
        return;
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    const float width = PanelLayout::width * pointsToScreen;
    ImGui::SetNextWindowPos({onPanel ? display.x - width : 0, display.y}, ImGuiCond_Always, {0, 1});
    ImGui::SetNextWindowSize({width, 0});
    ImGui::Begin("messages", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_NoInputs);
    if (!notice.empty())
        textWrapped(noticeColor, notice);
    if (!fault.empty())
        textWrapped(faultColor, fault);
    ImGui::End();
}

void drawHelp(std::span<const KeyHelp> keys, float pictureWidth, float pointsToScreen) {
    const ImVec2 display = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos({pictureWidth / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
    ImGui::SetNextWindowBgAlpha(0.94f);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 8 * pointsToScreen);
    ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {20 * pointsToScreen, 18 * pointsToScreen});
    ImGui::Begin("help", nullptr,
                 ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoSavedSettings |
                     ImGuiWindowFlags_AlwaysAutoResize);
    for (const KeyHelp& key : keys) {
        ImGui::PushStyleColor(ImGuiCol_Text, accentColor);
        ImGui::TextUnformatted(key.keys.c_str());
        ImGui::PopStyleColor();
        ImGui::SameLine(150 * pointsToScreen);
        ImGui::TextUnformatted(key.what.c_str());
    }
    ImGui::End();
    ImGui::PopStyleVar(2);
}

}  // namespace quincunx
