#include "math/expansion.h"

#include <cmath>

#include "base/check.h"

namespace quincunx {
namespace {

struct Two {
    double high;
    double low;
};

/// a + b, exactly (Knuth).
Two twoSum(double a, double b) {
    const double sum = a + b;
    const double rounded = sum - a;
    return {sum, (a - (sum - rounded)) + (b - rounded)};
}

/// a + b, exactly, for |a| ≥ |b| (Dekker).
Two fastTwoSum(double a, double b) {
    const double sum = a + b;
    return {sum, b - (sum - a)};
}

Two twoProduct(double a, double b) {
    const double product = a * b;
    return {product, std::fma(a, b, -product)};
}

/// Merges two expansions by magnitude and adds them up without rounding (Shewchuk's FAST-EXPANSION-SUM needs
/// strongly non-overlapping input; summing by growing magnitude with TWO-SUM and keeping every error does
/// not).
std::size_t addPart(double* parts, std::size_t size, double term) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const Two next = twoSum(term, parts[i]);
        term = next.high;
        if (next.low != 0)
            parts[kept++] = next.low;
    }
    if (term != 0)
        parts[kept++] = term;
    return kept;
}

}  // namespace

Expansion Expansion::difference(double a, double b) {
    const Two d = twoSum(a, -b);
    Expansion result;
    if (d.low != 0)
        result.parts_[result.size_++] = d.low;
    if (d.high != 0)
        result.parts_[result.size_++] = d.high;
    return result;
}

Expansion Expansion::product(double a, double b) {
    const Two p = twoProduct(a, b);
    Expansion result;
    if (p.low != 0)
        result.parts_[result.size_++] = p.low;
    if (p.high != 0)
        result.parts_[result.size_++] = p.high;
    return result;
}

Expansion Expansion::operator-() const {
    Expansion result;
    result.size_ = size_;
    for (std::size_t i = 0; i < size_; ++i)
        result.parts_[i] = -parts_[i];
    return result;
}

void Expansion::assignCompressed(std::span<double> parts) {
    // Shewchuk's COMPRESS: downwards, then upwards, gathering bits into the larger part each time.
    size_ = 0;
    if (parts.empty())
        return;
    double carried = parts.back();
    std::size_t bottom = parts.size() - 1;
    for (std::size_t i = parts.size() - 1; i-- > 0;) {
        const Two next = fastTwoSum(carried, parts[i]);
        carried = next.high;
        if (next.low != 0) {
            parts[bottom--] = carried;
            carried = next.low;
        }
    }
    parts[bottom] = carried;
    carried = parts[bottom];
    for (std::size_t i = bottom + 1; i < parts.size(); ++i) {
        const Two next = fastTwoSum(parts[i], carried);
        carried = next.high;
        if (next.low != 0) {
            QX_CHECK(size_ + 1 < capacity);
            parts_[size_++] = next.low;
        }
    }
    if (carried != 0)
        parts_[size_++] = carried;
}

Expansion operator+(const Expansion& a, const Expansion& b) {
    std::array<double, 2 * Expansion::capacity> sum;
    std::size_t size = a.size_;
    for (std::size_t i = 0; i < size; ++i)
        sum[i] = a.parts_[i];
    for (std::size_t i = 0; i < b.size_; ++i)
        size = addPart(sum.data(), size, b.parts_[i]);
    Expansion result;
    result.assignCompressed({sum.data(), size});
    return result;
}

Expansion operator*(const Expansion& a, const Expansion& b) {
    const Expansion& longer = a.size_ < b.size_ ? b : a;
    const Expansion& shorter = a.size_ < b.size_ ? a : b;
    Expansion result;
    std::array<double, 3 * Expansion::capacity> sum;
    for (std::size_t i = 0; i < shorter.size_; ++i) {
        std::size_t size = result.size_;
        for (std::size_t j = 0; j < size; ++j)
            sum[j] = result.parts_[j];
        for (std::size_t j = 0; j < longer.size_; ++j) {
            const Two p = twoProduct(longer.parts_[j], shorter.parts_[i]);
            if (p.low != 0)
                size = addPart(sum.data(), size, p.low);
            size = addPart(sum.data(), size, p.high);
        }
        result.assignCompressed({sum.data(), size});
    }
    return result;
}

double Expansion::approximate() const {
    double sum = 0;
    for (std::size_t i = 0; i < size_; ++i)
        sum += parts_[i];
    return sum;
}

Quad Expansion::toQuad() const {
    Quad sum = 0;
    for (std::size_t i = 0; i < size_; ++i)
        sum += parts_[i];
    return sum;
}

}  // namespace quincunx
