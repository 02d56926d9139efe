#include "passes/labels.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <imgui.h>

#include "base/check.h"
#include "base/paths.h"

namespace quincunx {
namespace {

struct Corner {
    glm::vec2 pixels;  ///< from the top left
    glm::vec2 texcoord;
    glm::vec4 color;
};

void addQuad(std::vector<Corner>& corners, glm::vec2 low, glm::vec2 high, glm::vec2 texLow, glm::vec2 texHigh,
             glm::vec4 color) {
    const Corner a{low, texLow, color};
    const Corner b{{high.x, low.y}, {texHigh.x, texLow.y}, color};
    const Corner c{high, texHigh, color};
    const Corner d{{low.x, high.y}, {texLow.x, texHigh.y}, color};
    corners.insert(corners.end(), {a, b, c, a, c, d});
}

glm::vec2 anchorShare(Labels::Anchor anchor) {
    using Anchor = Labels::Anchor;
    switch (anchor) {
        case Anchor::topLeft:
            return {0, 0};
        case Anchor::topRight:
            return {1, 0};
        case Anchor::bottomLeft:
            return {0, 1};
        case Anchor::bottomRight:
            return {1, 1};
        case Anchor::center:
            return {0.5f, 0.5f};
        case Anchor::topCenter:
            return {0.5f, 0};
        case Anchor::bottomCenter:
            return {0.5f, 1};
    }
    return {0, 0};
}

/// The next code point of UTF-8; what is malformed counts as U+FFFD, a byte at a time.
ImWchar nextCodePoint(const std::string& words, std::size_t& at) {
    const auto byte = [&](std::size_t i) {
        return i < words.size() ? static_cast<unsigned>(static_cast<unsigned char>(words[i])) : 0u;
    };
    const unsigned first = byte(at);
    const auto follows = [&](std::size_t i) { return (byte(at + i) & 0xC0u) == 0x80u; };
    if (first < 0x80) {
        ++at;
        return static_cast<ImWchar>(first);
    }
    if ((first & 0xE0u) == 0xC0u && follows(1)) {
        const unsigned code = ((first & 0x1Fu) << 6) | (byte(at + 1) & 0x3Fu);
        at += 2;
        return static_cast<ImWchar>(code);
    }
    if ((first & 0xF0u) == 0xE0u && follows(1) && follows(2)) {
        const unsigned code =
            ((first & 0x0Fu) << 12) | ((byte(at + 1) & 0x3Fu) << 6) | (byte(at + 2) & 0x3Fu);
        at += 3;
        return static_cast<ImWchar>(code);
    }
    ++at;
    return 0xFFFD;
}

}  // namespace

/// The typeface at one size: Dear ImGui's atlas, which needs no window and no context.
struct Labels::Font {
    ImFontAtlas atlas;
    ImFont* face = nullptr;
    std::optional<gl::Texture2D> texture;
    Image8 pixels;

    explicit Font(int sizePixels) {
        static constexpr ImWchar glyphs[] = {0x20,   0xff,   0x2b0,  0x3ff,  0x1d00, 0x1d7f, 0x2010, 0x209f,
                                             0x2190, 0x21ff, 0x2200, 0x22ff, 0x25a0, 0x25ff, 0};
        atlas.Flags |= ImFontAtlasFlags_NoMouseCursors;
        ImFontConfig config;
        config.OversampleH = 1;
        config.OversampleV = 1;
        config.PixelSnapH = true;
        face =
            atlas.AddFontFromFileTTF(typefaceFile().c_str(), static_cast<float>(sizePixels), &config, glyphs);
        QX_CHECK(face != nullptr);
        unsigned char* alpha = nullptr;
        int width = 0;
        int height = 0;
        atlas.GetTexDataAsAlpha8(&alpha, &width, &height);
        pixels = Image8(width, height, 1, Encoding::linear);
        std::copy_n(alpha, pixels.data.size(), pixels.data.begin());
    }

    /// Calls `place(glyph, pen)` for every glyph, the pen being at the top left of its line.
    template <typename Place>
    glm::vec2 layOut(const std::string& words, const Place& place) const {
        glm::vec2 pen(0);
        float widest = 0;
        for (std::size_t at = 0; at < words.size();) {
            const ImWchar code = nextCodePoint(words, at);
            if (code == '\n') {
                pen = {0, pen.y + face->FontSize};
                continue;
            }
            const ImFontGlyph* glyph = face->FindGlyph(code);
            if (glyph == nullptr)
                continue;
            place(*glyph, pen);
            pen.x += glyph->AdvanceX;
            widest = std::max(widest, pen.x);
        }
        return {widest, pen.y + face->FontSize};
    }
};

struct Labels::Device {
    gl::Buffer corners;
    gl::VertexArray vertexArray;
};

Labels::Labels() = default;
Labels::~Labels() = default;
Labels::Labels(Labels&&) noexcept = default;
Labels& Labels::operator=(Labels&&) noexcept = default;

void Labels::clear() {
    items_.clear();
}

void Labels::text(std::string words, glm::vec2 positionPixels, const Style& style) {
    if (!words.empty())
        items_.push_back({std::move(words), positionPixels, {}, style});
}

void Labels::plate(glm::vec2 topLeftPixels, glm::vec2 sizePixels, glm::vec4 color) {
    items_.push_back({{}, topLeftPixels, sizePixels, {.color = color}});
}

Labels::Font& Labels::font(float sizePixels) {
    const int size = static_cast<int>(std::lround(std::clamp(sizePixels, 4.0f, 128.0f)));
    std::unique_ptr<Font>& font = fonts_[size];
    if (!font)
        font = std::make_unique<Font>(size);
    return *font;
}

glm::vec2 Labels::extent(const std::string& words, float sizePixels) {
    return font(sizePixels).layOut(words, [](const ImFontGlyph&, glm::vec2) {});
}

void Labels::draw(graph::PassContext& context, glm::vec2 viewportPixels) {
    if (items_.empty())
        return;
    const gl::Program& program = context.programs().get(
        {.label = "labels", .vertex = "passes/labels.vert", .fragment = "passes/labels.frag"});
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    // Runs of items with one atlas are drawn together; the order of adding is kept.
    std::vector<Corner> corners;
    Font* current = nullptr;
    const auto flush = [&] {
        if (corners.empty())
            return;
        const auto bytes = std::as_bytes(std::span(corners));
        if (!device_) {
            device_ = std::make_unique<Device>(Device{
                gl::Buffer("labels", GL_ARRAY_BUFFER, bytes, GL_DYNAMIC_DRAW), gl::VertexArray("labels")});
            constexpr GLsizei stride = sizeof(Corner);
            device_->vertexArray.attribute(device_->corners, {0, 2, GL_FLOAT, false, stride, 0});
            device_->vertexArray.attribute(device_->corners,
                                           {1, 2, GL_FLOAT, false, stride, offsetof(Corner, texcoord)});
            device_->vertexArray.attribute(device_->corners,
                                           {2, 4, GL_FLOAT, false, stride, offsetof(Corner, color)});
        } else {
            device_->corners.upload(bytes);
        }
        if (!current->texture) {
            current->texture.emplace("typeface", current->pixels);
            current->texture->setFilter(GL_LINEAR, GL_LINEAR);
            current->texture->setWrap(GL_CLAMP_TO_EDGE, GL_CLAMP_TO_EDGE);
        }
        // A unit of its own, so that the materials' textures stay bound.
        constexpr int unit = 2;
        program.use();
        program.set("viewportPixels", viewportPixels);
        program.set("typeface", unit);
        current->texture->bind(unit);
        device_->vertexArray.bind();
        glDrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(corners.size()));
        corners.clear();
    };
    for (const Item& item : items_) {
        Font& wanted = item.words.empty() && current != nullptr ? *current : font(item.style.sizePixels);
        if (&wanted != current) {
            flush();
            current = &wanted;
        }
        const glm::vec2 white(wanted.atlas.TexUvWhitePixel.x, wanted.atlas.TexUvWhitePixel.y);
        if (item.words.empty()) {
            addQuad(corners, item.position, item.position + item.size, white, white, item.style.color);
            continue;
        }
        const glm::vec2 size = wanted.layOut(item.words, [](const ImFontGlyph&, glm::vec2) {});
        const glm::vec2 topLeft = glm::round(item.position - anchorShare(item.style.anchor) * size);
        if (item.style.backing.a > 0) {
            const glm::vec2 margin(std::round(0.35f * wanted.face->FontSize),
                                   std::round(0.15f * wanted.face->FontSize));
            addQuad(corners, topLeft - margin, topLeft + size + margin, white, white, item.style.backing);
        }
        wanted.layOut(item.words, [&](const ImFontGlyph& glyph, glm::vec2 pen) {
            const glm::vec2 origin = topLeft + glm::round(pen);
            addQuad(corners, origin + glm::vec2(glyph.X0, glyph.Y0), origin + glm::vec2(glyph.X1, glyph.Y1),
                    {glyph.U0, glyph.V0}, {glyph.U1, glyph.V1}, item.style.color);
        });
    }
    flush();
    glDisable(GL_BLEND);
}

std::optional<glm::vec2> pixelOf(glm::vec3 world, const glm::mat4& clipFromWorld, glm::vec2 viewportPixels) {
    const glm::vec4 clip = clipFromWorld * glm::vec4(world, 1);
    if (!(clip.w > 0) || clip.z < -clip.w)
        return std::nullopt;
    const glm::vec2 ndc = glm::vec2(clip) / clip.w;
    return viewportPixels * glm::vec2(0.5f + 0.5f * ndc.x, 0.5f - 0.5f * ndc.y);
}

}  // namespace quincunx
