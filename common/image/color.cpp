#include "image/color.h"

#include <bit>
#include <cmath>
#include <utility>

namespace quincunx {
namespace {

double encode(double linear) {
    return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

double decode(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

/// `value` in [0, 1]; NaN gives 0.
float clampToUnit(float value) {
    return value > 0 ? (value < 1 ? value : 1.0F) : 0.0F;
}

std::uint8_t roundToCode(float value) {
    // Not negative, so that cutting off rounds. NOLINTNEXTLINE(bugprone-incorrect-roundings)
    return static_cast<std::uint8_t>(255 * static_cast<double>(clampToUnit(value)) + 0.5);
}

/// Finds codes without a logarithm. Floats from 2^-13 to 1 fall into buckets of 1/128 octave, each narrower
/// than a code, so that one comparison with the next threshold finishes the search. Below 2^-13 the code is
/// 0: 255 · 12.92 / 2^13 < 0.5.
class CodeTable {
  public:
    CodeTable() {
        for (int code = 1; code < 256; ++code) {
            const double exact = decode((code - 0.5) / 255);
            float threshold = static_cast<float>(exact);
            if (threshold < exact)
                threshold = std::nextafter(threshold, 2.0F);
            thresholds_[code] = threshold;
        }
        thresholds_[256] = 2;
        int code = 0;
        for (std::uint32_t bucket = 0; bucket < bucketCount; ++bucket) {
            const float lowest = std::bit_cast<float>((bucket << bucketShift) + lowestBits);
            while (thresholds_[code + 1] <= lowest)
                ++code;
            codes_[bucket] = static_cast<std::uint8_t>(code);
        }
    }

    std::uint8_t operator()(float linear) const {
        if (!(linear >= lowestFloat))
            return 0;
        if (linear >= 1)
            return 255;
        const int code = codes_[(std::bit_cast<std::uint32_t>(linear) - lowestBits) >> bucketShift];
        return static_cast<std::uint8_t>(code + (linear >= thresholds_[code + 1] ? 1 : 0));
    }

  private:
    static constexpr float lowestFloat = 0x1p-13F;
    static constexpr std::uint32_t lowestBits = std::bit_cast<std::uint32_t>(lowestFloat);
    static constexpr std::uint32_t bucketShift = 16;
    static constexpr std::uint32_t bucketCount =
        (std::bit_cast<std::uint32_t>(1.0F) - lowestBits) >> bucketShift;

    std::array<float, 257> thresholds_{};
    std::array<std::uint8_t, bucketCount> codes_{};
};

bool isAlpha(int channel, int channels) {
    return channels % 2 == 0 && channel == channels - 1;
}

/// `to[i] = convert(from[i], is it alpha?)` over all channels of all pixels.
template <typename From, typename To, typename Convert>
void convertChannels(const std::vector<From>& from, std::vector<To>& to, int channels, Convert convert) {
    const std::size_t step = static_cast<std::size_t>(channels);
    for (int channel = 0; channel < channels; ++channel) {
        const bool alpha = isAlpha(channel, channels);
        for (std::size_t i = static_cast<std::size_t>(channel); i < from.size(); i += step)
            to[i] = convert(from[i], alpha);
    }
}

}  // namespace

float srgbFromLinear(float linear) {
    return static_cast<float>(encode(clampToUnit(linear)));
}

float linearFromSrgb(float encoded) {
    return static_cast<float>(decode(clampToUnit(encoded)));
}

std::uint8_t srgbCode(float linear) {
    static const CodeTable table;
    return table(linear);
}

const std::array<float, 256>& linearOfCode() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> values{};
        for (int code = 0; code < 256; ++code)
            values[code] = static_cast<float>(decode(code / 255.0));
        return values;
    }();
    return table;
}

Image toLinear(const Image8& image) {
    Image result(image.width, image.height, image.channels, Encoding::linear);
    const bool curved = image.encoding == Encoding::srgb;
    const std::array<float, 256>& linear = linearOfCode();
    convertChannels(image.data, result.data, image.channels, [&](std::uint8_t code, bool alpha) {
        return curved && !alpha ? linear[code] : static_cast<float>(code) / 255;
    });
    return result;
}

Image toLinear(Image image) {
    if (image.encoding == Encoding::linear)
        return image;
    convertChannels(image.data, image.data, image.channels,
                    [](float value, bool alpha) { return alpha ? value : linearFromSrgb(value); });
    image.encoding = Encoding::linear;
    return image;
}

Image8 toSrgb8(const Image& image) {
    Image8 result(image.width, image.height, image.channels, Encoding::srgb);
    const bool encoded = image.encoding == Encoding::srgb;
    convertChannels(image.data, result.data, image.channels, [&](float value, bool alpha) {
        return encoded || alpha ? roundToCode(value) : srgbCode(value);
    });
    return result;
}

}  // namespace quincunx
