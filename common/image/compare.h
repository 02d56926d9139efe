#pragma once

#include <optional>
#include <string_view>

#include "image/image.h"

/// How far two pictures are apart. The pictures must have the same width, height and encoding (InputError
/// naming both otherwise). Values count as 0…1, codes as code/255. A grey picture beside one in colour counts
/// as R = G = B, a missing alpha as 1. No result is NaN.
namespace quincunx {

enum class Metric { rmse, psnr, ssim, flip };

/// "rmse", "psnr", "ssim", "flip".
std::string_view metricName(Metric metric);

/// Inverse of `metricName`; nothing if there is no such metric.
std::optional<Metric> parseMetric(std::string_view name);

/// True for PSNR and SSIM.
bool higherIsBetter(Metric metric);

/// Root of the mean squared difference of all channels, of the encoded values. 8 bits: exact but for the last
/// root. Floats: summed in double; infinity if any value of either picture is NaN or infinite.
double rmse(const Image8& reference, const Image8& test);
double rmse(const Image& reference, const Image& test);

/// 10 · log10(1 / rmse²) in dB; infinity for equal pictures.
double psnr(const Image8& reference, const Image8& test);

/// Mean structural similarity, −1…1, 1 for equal pictures. Wang, Bovik, Sheikh, Simoncelli: Image Quality
/// Assessment, IEEE TIP 13(4), 2004, eq. 13 to 15: Gaussian window of 11 × 11 with σ = 1.5, K1 = 0.01, K2 =
/// 0.03, on the luma of BT.601 of the encoded values without rounding; the mean runs over windows that lie
/// inside the picture. Alpha is left out. InputError for pictures of less than 11 × 11 pixels.
double ssim(const Image8& reference, const Image8& test);

/// What the eye's resolution is held against.
struct FlipSettings {
    /// Pixels per degree of visual angle. Default: a screen 0.7 m wide with 3840 pixels, seen from 0.7 m.
    double pixelsPerDegree = 3840 * 3.14159265358979323846 / 180;
};

/// Mean LDR-FLIP, 0 (equal) … 1. Andersson, Nilsson, Akenine-Möller, Oskarsson, Åström, Fairchild: FLIP: A
/// Difference Evaluator for Alternating Images, PACM CGIT 3(2), 2020, with its erratum (division by 116).
/// Pictures are continued past their borders by their border pixels, and alpha is left out. Symmetric in the
/// pictures.
///
/// Float32; within 1e-6 of the same in double (tests/common/image/flip_test.cpp), the same bits on any number
/// of threads. Float pictures are decoded to linear and clamped to 0…1; a pixel that has a NaN in either
/// picture counts as 0 for its neighbours and has error 1 itself.
double flip(const Image8& reference, const Image8& test, const FlipSettings& settings = {});
double flip(const Image& reference, const Image& test, const FlipSettings& settings = {});

/// One channel: the FLIP error of each pixel, 0…1.
Image flipMap(const Image8& reference, const Image8& test, const FlipSettings& settings = {});
Image flipMap(const Image& reference, const Image& test, const FlipSettings& settings = {});

struct Comparison {
    double value = 0;  ///< of the whole picture
    Image perPixel;  ///< one channel, 0 where the pictures agree, at most 1: RMSE and PSNR: root of the mean
                     ///< squared difference of the channels; SSIM: (1 − SSIM) / 2; FLIP: its map
};

Comparison compareImages(const Image8& reference, const Image8& test, Metric metric);

/// One channel: the root of the mean squared difference of the channels of each pixel, infinite where a value
/// is not finite. What `rmse` sums up.
Image differenceMap(const Image& reference, const Image& test);

/// The map as colours for people: 0 black, through violet, red and orange to light yellow at `maximum` and
/// above; NaN is cyan. CIELAB lightness rises evenly, so that it reads in grey too.
Image8 errorMap(const Image& perPixel, float maximum = 1);

}  // namespace quincunx
