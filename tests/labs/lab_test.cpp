#include "tests/labs/lab_test.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "image/compare.h"
#include "image/io.h"
#include "lab/timing_limit.h"

namespace quincunx::test {

namespace fs = std::filesystem;

double largestDifference(const Image& a, const Image& b) {
    EXPECT_EQ(a.data.size(), b.data.size());
    double largest = 0;
    for (std::size_t i = 0; i < std::min(a.data.size(), b.data.size()); ++i)
        largest = std::max(largest, std::abs(static_cast<double>(a.data[i]) - b.data[i]));
    return largest;
}

bool isFinite(const Image& image) {
    return std::all_of(image.data.begin(), image.data.end(),
                       [](float value) { return std::isfinite(value); });
}

std::string nameOfBackend(const testing::TestParamInfo<gl::Backend>& info) {
    return std::string(gl::backendName(info.param));
}

void expectAnswersHold(Lab& lab, Studio& studio, const std::vector<int>& numbers) {
    const TimingLimit once;
    std::vector<int> answered;
    for (const Question& question : lab.questions()) {
        answered.push_back(question.number);
        EXPECT_FALSE(question.asked.empty()) << question.number;
        EXPECT_FALSE(question.answer.empty()) << question.number;
        int bounded = 0;
        for (const Measurement& figure : question.measure(studio)) {
            EXPECT_TRUE(figure.pass()) << question.number << ": " << figure.name << " = " << figure.value;
            bounded += figure.bound ? 1 : 0;
        }
        EXPECT_GE(bounded, 2) << question.number;
    }
    EXPECT_EQ(answered, numbers);
}

void expectStressHolds(Lab& lab, std::uint64_t inputs) {
    const std::vector<HardCase> cases = lab.hardCases();
    EXPECT_FALSE(cases.empty());
    for (const HardCase& hardCase : cases) {
        const HardCaseFigures figures = hardCase.run(inputs, 7);
        EXPECT_TRUE(hardCase.holds(figures))
            << hardCase.routine << ": " << hardCase.hardInput << " at " << figures.worstInput;
        EXPECT_TRUE(figures.naiveFailures > 0 || figures.naiveError > hardCase.bound)
            << hardCase.routine << ": " << hardCase.hardInput << " is not hard";
        EXPECT_GE(figures.inputs, inputs);
    }
}

void expectGolden(const Image8& picture, const std::string& labFolder, const std::string& name,
                  double limit) {
    const fs::path file = fs::path(QUINCUNX_SOURCE_DIR) / "data/golden" / labFolder / (name + ".png");
    if (std::getenv("QUINCUNX_WRITE_GOLDENS") != nullptr)
        writeImage(file, picture);
    EXPECT_LE(compareImages(readImage8(file), picture, Metric::flip).value, limit) << file;
}

void expectSameBitsOnBothBackends(const std::vector<MakeLab>& makers, const std::vector<Size>& sizes) {
    const auto drawAll = [&](gl::Backend backend) {
        Studio studio(backend);
        std::vector<Image8> pictures;
        for (const MakeLab& make : makers) {
            const std::unique_ptr<Lab> lab = make();
            for (const Size size : sizes)
                pictures.push_back(studio.picture(*lab, studio.frame(*lab, size.width, size.height)));
        }
        return pictures;
    };
    const std::vector<Image8> osmesa = drawAll(gl::Backend::osmesa);
    const std::vector<Image8> egl = drawAll(gl::Backend::egl);
    for (std::size_t i = 0; i < osmesa.size(); ++i)
        EXPECT_EQ(osmesa[i], egl[i]) << "lab " << i / sizes.size() << " of the list, " << osmesa[i].width
                                     << "x" << osmesa[i].height;
}

}  // namespace quincunx::test
