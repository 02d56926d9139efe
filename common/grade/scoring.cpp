#include "grade/scoring.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>

#include <fmt/format.h>

#include "image/compare.h"

namespace quincunx::grade {
namespace {

constexpr int visibleCodes = 6;
constexpr double leastArea = 1e-3;

bool differs(const std::uint8_t* a, const std::uint8_t* b) {
    return std::abs(a[0] - b[0]) >= visibleCodes || std::abs(a[1] - b[1]) >= visibleCodes ||
           std::abs(a[2] - b[2]) >= visibleCodes;
}

std::uint64_t squaredDistance(const std::uint8_t* a, const std::uint8_t* b) {
    std::uint64_t sum = 0;
    for (int c = 0; c < 3; ++c)
        sum += static_cast<std::uint64_t>((a[c] - b[c]) * (a[c] - b[c]));
    return sum;
}

/// Where in the picture the errors are: "upper left", "middle" …, by the centre of their weight.
std::string placeOf(const Image& errors) {
    double sum = 0;
    double x = 0;
    double y = 0;
    for (int row = 0; row < errors.height; ++row)
        for (int column = 0; column < errors.width; ++column) {
            const double e = static_cast<double>(*errors.pixel(column, row));
            sum += e;
            x += e * column;
            y += e * row;
        }
    if (!(sum > 0))
        return "nowhere";
    const auto third = [](double place, int size) {
        return std::clamp(static_cast<int>(3 * place / size), 0, 2);
    };
    constexpr std::array<const char*, 9> names = {"the upper left", "the upper middle", "the upper right",
                                                  "the left",       "the middle",       "the right",
                                                  "the lower left", "the lower middle", "the lower right"};
    return names[static_cast<std::size_t>(3 * third(y / sum, errors.height) + third(x / sum, errors.width))];
}

std::string reasonFor(const Property& property, double figure, const Image& errors) {
    const auto limits = [&] {
        return fmt::format("{:.3f}; {:.3f} has all points, {:.3f} none", figure, property.full,
                           property.none);
    };
    switch (property.measure) {
        case Measure::flip:
            return fmt::format("mean FLIP error {}; most of it is in {} of the picture", limits(),
                               placeOf(errors));
        case Measure::ssim:
            return fmt::format("structural similarity {}", limits());
        case Measure::effect:
        case Measure::task:
            return fmt::format("{}: share that is right {}",
                               figure <= 0.1   ? "missing, or wrong where it should be"
                               : figure <= 0.5 ? "mostly missing or in the wrong place"
                                               : "not quite as it should be",
                               limits());
    }
    return {};
}

/// SSIM on pictures whose shorter side is brought to about 256 pixels first, as its authors do (their program
/// ssim.m): the window then has the size at which people judged. Pictures below 11 × 11 count by their ꟻLIP.
double similarity(const Image8& reference, const Image8& submitted, double flip) {
    constexpr int window = 11;
    constexpr int judged = 256;
    const int shorter = std::min(reference.width, reference.height);
    if (shorter < window)
        return 1 - flip;
    const int factor = std::max(1, (shorter + judged / 2) / judged);
    const auto reduced = [factor](const Image8& image) {
        return resized(image, image.width / factor, image.height / factor);
    };
    return ssim(reduced(reference), reduced(submitted));
}

void measure(Result& result, const std::vector<Property>& properties, const std::vector<Image8>& without) {
    result.errors = flipMap(result.reference, result.submitted);
    double sum = 0;
    for (const float error : result.errors.data)
        sum += static_cast<double>(error);
    const double flip = sum / static_cast<double>(result.errors.data.size());
    for (std::size_t i = 0; i < properties.size(); ++i) {
        const Property& property = properties[i];
        Score score{.name = property.name, .figure = 0, .points = 0, .of = property.points, .reason = {}};
        std::optional<double> figure;
        if (property.measure == Measure::flip)
            figure = flip;
        else if (property.measure == Measure::ssim)
            figure = similarity(result.reference, result.submitted, flip);
        else if (!without[i].data.empty())
            figure = effectShare(result.reference, without[i], result.submitted);
        if (figure) {
            score.figure = *figure;
            score.points = property.pointsFor(*figure);
            if (score.points < score.of)
                score.reason = reasonFor(property, *figure, result.errors);
        } else {
            score.of = 0;
            result.remarks.push_back(
                fmt::format("{}: cannot be seen in this picture; its points are not counted", property.name));
        }
        result.scores.push_back(std::move(score));
    }
}

}  // namespace

double Result::of() const {
    double sum = 0;
    for (const Score& score : scores)
        sum += score.of;
    return sum;
}

double Result::points() const {
    double sum = 0;
    for (const Score& score : scores)
        sum += score.points;
    double share = 1;
    for (const Limit& limit : limits)
        share = std::min(share, limit.share);
    return std::min(sum, share * of());
}

double effectArea(const Image8& with, const Image8& without) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < with.data.size(); i += 3)
        count += differs(with.data.data() + i, without.data.data() + i) ? 1 : 0;
    return static_cast<double>(count) / static_cast<double>(with.pixelCount());
}

std::optional<double> effectShare(const Image8& with, const Image8& without, const Image8& picture) {
    QX_CHECK_EQ(with.data.size(), without.data.size());
    QX_CHECK_EQ(with.data.size(), picture.data.size());
    std::uint64_t whole = 0;
    std::uint64_t missing = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < with.data.size(); i += 3) {
        const std::uint8_t* const a = with.data.data() + i;
        const std::uint8_t* const b = without.data.data() + i;
        if (!differs(a, b))
            continue;
        ++count;
        whole += squaredDistance(a, b);
        missing += squaredDistance(a, picture.data.data() + i);
    }
    if (static_cast<double>(count) < leastArea * static_cast<double>(with.pixelCount()) || whole == 0)
        return {};
    return 1 - static_cast<double>(missing) / static_cast<double>(whole);
}

Result scoreScreenshot(const Reference& reference, const Image8& submitted, const Rubric& rubric) {
    Alignment alignment = align(reference.picture, submitted);
    Result result;
    for (const Finding& finding : alignment.findings) {
        const double share = rubric.most[static_cast<std::size_t>(finding.handling)];
        if (share < 1)
            result.limits.push_back({share, fmt::format("{} (at most {:.0f}%)", finding.text, 100 * share)});
        else
            result.remarks.push_back(finding.text);
    }
    result.reference = std::move(alignment.reference);
    result.submitted = std::move(alignment.submitted);
    std::vector<Image8> without;
    for (const Image8& picture : reference.without)
        without.push_back(picture.data.empty() ? Image8{}
                                               : cropped(rgbOf(picture), alignment.left, alignment.top,
                                                         result.reference.width, result.reference.height));
    measure(result, rubric.properties, without);
    return result;
}

Result scoreDrawn(const Reference& reference, const Image8& submitted,
                  const std::vector<Property>& properties) {
    Result result;
    result.reference = rgbOf(reference.picture);
    result.submitted = rgbOf(submitted);
    std::vector<Image8> without;
    for (const Image8& picture : reference.without)
        without.push_back(picture.data.empty() ? Image8{} : rgbOf(picture));
    measure(result, properties, without);
    return result;
}

}  // namespace quincunx::grade
