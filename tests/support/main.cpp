#include <cstdio>
#include <cstdlib>

#include <gtest/gtest.h>

namespace {

/// Writes double(float(x)) over neighbours, as numeric code does; g++ 12 with SLP vectorisation drops the
/// rounding.
__attribute__((noinline)) void roundNeighbours(double* values) {
    values[0] = static_cast<double>(static_cast<float>(values[0]));
    values[1] = static_cast<double>(static_cast<float>(values[1]));
}

__attribute__((noinline)) double multiplyAdd(double a, double b, double c) {
    return a * b + c;
}

/// True if this binary rounds as written: conversions to float are kept, products and sums round apart.
bool roundsAsWritten() {
    for (int i = 0; i < 1000; i += 2) {
        double values[2] = {0.1 + i, 1.1 + i};
        roundNeighbours(values);
        const volatile float first = static_cast<float>(0.1 + i);
        const volatile float second = static_cast<float>(1.1 + i);
        if (values[0] != first || values[1] != second)
            return false;
    }
    const double x = 1 + 0x1p-30;
    const volatile double product = x * x;
    return multiplyAdd(x, x, -product) == 0;
}

}  // namespace

int main(int argc, char** argv) {
    if (!roundsAsWritten()) {
        std::fputs("the compiler changes roundings: build with -ffp-contract=off -fno-tree-slp-vectorize\n",
                   stderr);
        return 3;
    }
    // Tests draw small pictures, several tests at a time: threads of llvmpipe cost them more than they bring.
    setenv("LP_NUM_THREADS", "0", 0);
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
