#include "image/header.h"

#include <charconv>
#include <optional>
#include <string_view>

#include "base/error.h"

namespace quincunx::imageio {
namespace {

/// Reads numbers and strings at a position that moves on; none past the end.
class Reader {
  public:
    explicit Reader(std::string_view bytes) : bytes_(bytes) {}

    std::size_t left() const { return bytes_.size(); }

    std::optional<std::string_view> take(std::size_t count) {
        if (count > bytes_.size())
            return {};
        const std::string_view taken = bytes_.substr(0, count);
        bytes_.remove_prefix(count);
        return taken;
    }

    std::optional<std::uint32_t> bigEndian(std::size_t count) { return number(count, true); }
    std::optional<std::uint32_t> littleEndian(std::size_t count) { return number(count, false); }

    /// Up to `end`, which is skipped.
    std::optional<std::string_view> until(char end) {
        const std::size_t length = bytes_.find(end);
        if (length == std::string_view::npos)
            return {};
        const std::string_view taken = bytes_.substr(0, length);
        bytes_.remove_prefix(length + 1);
        return taken;
    }

  private:
    std::optional<std::uint32_t> number(std::size_t count, bool bigEndian) {
        const std::optional<std::string_view> digits = take(count);
        if (!digits)
            return {};
        std::uint32_t value = 0;
        for (std::size_t i = 0; i < count; ++i)
            value = value << 8 | static_cast<unsigned char>((*digits)[bigEndian ? i : count - 1 - i]);
        return value;
    }

    std::string_view bytes_;
};

using MaybeHeader = std::optional<Header>;  ///< nothing if the file ends early

MaybeHeader readPng(Reader reader) {
    reader.take(8);
    Header header{Format::png, 0, 0};
    bool first = true;
    while (true) {
        const auto length = reader.bigEndian(4);
        const auto type = reader.take(4);
        if (!length || !type)
            return {};
        if (first) {
            Reader fields = reader;
            const auto width = fields.bigEndian(4);
            const auto height = fields.bigEndian(4);
            if (*type != "IHDR" || !width || !height)
                return {};
            header.width = *width;
            header.height = *height;
            first = false;
        }
        if (!reader.take(*length) || !reader.take(4))
            return {};
        if (*type == "IEND")
            return header;
    }
}

/// Start-of-frame markers: C0…CF without DHT (C4), JPG (C8) and DAC (CC).
bool isStartOfFrame(unsigned marker) {
    return marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
}

MaybeHeader readJpeg(Reader reader) {
    reader.take(2);
    std::optional<Header> header;
    while (true) {
        if (!reader.until('\xFF'))
            return {};
        auto marker = reader.bigEndian(1);
        while (marker && *marker == 0xFF)
            marker = reader.bigEndian(1);
        if (!marker)
            return {};
        if (*marker == 0xD9)
            return header;
        const bool standsAlone = *marker == 0x00 || *marker == 0x01 || (*marker >= 0xD0 && *marker <= 0xD8);
        if (standsAlone)
            continue;
        const auto length = reader.bigEndian(2);
        if (!length || *length < 2)
            return {};
        Reader fields = reader;
        if (!reader.take(*length - 2))
            return {};
        if (isStartOfFrame(*marker)) {
            fields.take(1);
            const auto height = fields.bigEndian(2);
            const auto width = fields.bigEndian(2);
            if (!width || !height)
                return {};
            header = Header{Format::jpeg, *width, *height};
        }
    }
}

/// RFC 9649: the canvas of an extended file, or the frame of a simple one, lossy (RFC 6386) or lossless.
MaybeHeader readWebp(Reader reader) {
    reader.take(4);
    const auto length = reader.littleEndian(4);
    if (!length || *length > reader.left() || !reader.take(4))
        return {};
    const auto chunk = reader.take(4);
    const auto chunkLength = reader.littleEndian(4);
    if (!chunk || !chunkLength || *chunkLength > reader.left())
        return {};
    Header header{Format::webp, 0, 0};
    if (*chunk == "VP8X") {
        const bool hasFlags = reader.take(4).has_value();
        const auto width = reader.littleEndian(3);
        const auto height = reader.littleEndian(3);
        if (!hasFlags || !width || !height)
            return {};
        header.width = std::int64_t{*width} + 1;
        header.height = std::int64_t{*height} + 1;
        return header;
    }
    constexpr std::uint32_t side = 0x3FFF;  // 14 bits
    if (*chunk == "VP8L") {
        const bool signature = reader.take(1).has_value();
        const auto sizes = reader.littleEndian(4);
        if (!signature || !sizes)
            return {};
        header.width = std::int64_t{*sizes & side} + 1;
        header.height = std::int64_t{*sizes >> 14 & side} + 1;
        return header;
    }
    const bool frameTag = reader.take(6).has_value();
    const auto width = reader.littleEndian(2);
    const auto height = reader.littleEndian(2);
    if (*chunk != "VP8 " || !frameTag || !width || !height)
        return {};
    header.width = *width & side;
    header.height = *height & side;
    return header;
}

MaybeHeader readExr(Reader reader, const std::string& name) {
    reader.take(8);
    std::optional<Header> header;
    while (true) {
        const auto attribute = reader.until('\0');
        if (!attribute)
            return {};
        if (attribute->empty())
            return header;
        const auto type = reader.until('\0');
        const auto length = reader.littleEndian(4);
        if (!type || !length)
            return {};
        const auto value = reader.take(*length);
        if (!value)
            return {};
        Reader fields(*value);
        if (*attribute == "dataWindow" && *type == "box2i" && *length == 16) {
            const auto coordinate = [&] {
                return static_cast<std::int64_t>(static_cast<std::int32_t>(*fields.littleEndian(4)));
            };
            const std::int64_t left = coordinate();
            const std::int64_t top = coordinate();
            const std::int64_t right = coordinate();
            const std::int64_t bottom = coordinate();
            header = Header{Format::exr, right - left + 1, bottom - top + 1};
        }
        if (*attribute == "tiles" && *length >= 8) {
            constexpr std::uint64_t maxTilePixels = 1ULL << 24;
            const std::uint64_t tileWidth = *fields.littleEndian(4);
            const std::uint64_t tileHeight = *fields.littleEndian(4);
            if (tileWidth * tileHeight > maxTilePixels)
                throw InputError("the tiles of the EXR are too large", name);
        }
    }
}

MaybeHeader readHdr(Reader reader) {
    while (true) {
        const auto line = reader.until('\n');
        if (!line)
            return {};
        if (line->size() < 6 || ((*line)[0] != '-' && (*line)[0] != '+') || (*line)[2] != ' ')
            continue;
        // "-Y 480 +X 640", or any other signs and order
        Header header{Format::hdr, 0, 0};
        Reader words(*line);
        const auto readAxis = [&](std::string_view axis, std::string_view digits) {
            std::int64_t value = 0;
            std::from_chars(digits.data(), digits.data() + digits.size(), value);
            (axis[1] == 'X' ? header.width : header.height) = value;
        };
        const auto firstAxis = words.until(' ');
        const auto firstLength = words.until(' ');
        const auto secondAxis = words.until(' ');
        const auto secondLength = words.take(words.left());
        if (!firstAxis || !firstLength || !secondAxis || secondAxis->size() < 2)
            return {};
        readAxis(*firstAxis, *firstLength);
        readAxis(*secondAxis, *secondLength);
        return header;
    }
}

}  // namespace

Header readHeader(std::span<const std::byte> bytes, const std::string& name) {
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    MaybeHeader header;
    if (text.starts_with("\x89PNG\r\n\x1A\n"))
        header = readPng(Reader(text));
    else if (text.starts_with("\xFF\xD8\xFF"))
        header = readJpeg(Reader(text));
    else if (text.starts_with("RIFF") && text.substr(0, 12).ends_with("WEBP"))
        header = readWebp(Reader(text));
    else if (text.starts_with("\x76\x2F\x31\x01"))
        header = readExr(Reader(text), name);
    else if (text.starts_with("#?RADIANCE") || text.starts_with("#?RGBE"))
        header = readHdr(Reader(text));
    else
        throw InputError(text.empty() ? "empty" : "not a PNG, JPEG, WebP, EXR or HDR picture", name);
    if (!header)
        throw InputError("the picture is damaged or ends early", name);
    return *header;
}

}  // namespace quincunx::imageio
