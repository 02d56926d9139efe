// A made class with known defects, graded by the program: what each kind scores beside what it may, and how
// long a class of screenshots takes beside ꟻLIP alone on as many. Exits with 1 if a kind is out of its
// limits.
//
//     bench_grading                  208 submissions of two labs at 320×180; 300 at 1280×720
//     bench_grading --quick          the first part alone

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <unistd.h>

#include "base/file.h"
#include "base/paths.h"
#include "base/random.h"
#include "grade/alignment.h"
#include "grade/grade.h"
#include "grade/handout.h"
#include "image/compare.h"
#include "image/io.h"
#include "lab/picture_state.h"
#include "lab/studio.h"
#include "lab/verbs.h"
#include "labs/all_labs.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;
using Edit = std::function<Image8(const Image8&, std::uint64_t seed)>;

struct Kind {
    std::string name;
    int count = 0;
    double least = 0;
    double most = 100;
    KnobValues knobs;
    Edit edit;
    bool record = true;    ///< keeps the picture's record
    bool handout = false;  ///< drawn with the handout's shader
};

Image8 noisy(Image8 image, std::uint64_t seed) {
    Random random(seed);
    for (std::uint8_t& code : image.data)
        code =
            static_cast<std::uint8_t>(std::clamp<int>(code + static_cast<int>(random.below(5)) - 2, 0, 255));
    return image;
}

/// Edges as other samples would have them: a third of a pixel's neighbour.
Image8 otherSamples(const Image8& image, std::uint64_t seed) {
    Image8 result = noisy(image, seed);
    for (int y = 0; y < image.height; ++y)
        for (int x = 1; x < image.width; ++x)
            for (int c = 0; c < image.channels; ++c)
                result.pixel(x, y)[c] =
                    static_cast<std::uint8_t>((2 * image.pixel(x, y)[c] + image.pixel(x - 1, y)[c]) / 3);
    return result;
}

Edit power(double exponent) {
    return [exponent](Image8 image, std::uint64_t) {
        for (std::uint8_t& code : image.data)
            code = static_cast<std::uint8_t>(std::lround(255 * std::pow(code / 255.0, exponent)));
        return image;
    };
}

Image8 swapped(Image8 image, std::uint64_t) {
    for (std::size_t i = 0; i < image.data.size(); i += 3)
        std::swap(image.data[i], image.data[i + 2]);
    return image;
}

Image8 mirrored(const Image8& image, std::uint64_t) {
    Image8 result = image;
    for (int y = 0; y < image.height; ++y)
        std::copy_n(image.pixel(0, image.height - 1 - y), 3 * image.width, result.pixel(0, y));
    return result;
}

Image8 bordered(const Image8& image, std::uint64_t seed) {
    Image8 window(image.width + 4, image.height + 27, 3, image.encoding);
    Random random(seed);
    for (std::size_t i = 0; i < window.data.size(); ++i)
        window.data[i] = static_cast<std::uint8_t>(210 + random.below(30));
    for (int y = 0; y < image.height; ++y)
        std::copy_n(image.pixel(0, y), 3 * image.width, window.pixel(2, y + 25));
    return window;
}

Image8 blank(Image8 image, std::uint64_t seed) {
    std::fill(image.data.begin(), image.data.end(), static_cast<std::uint8_t>(seed * 16));
    return image;
}

Image8 offByOne(const Image8& image, std::uint64_t seed) {
    return grade::cropped(image, static_cast<int>(seed % 2), 1 - static_cast<int>(seed % 2), image.width - 1,
                          image.height - 1);
}

/// Kinds that any lab's pictures may be of.
std::vector<Kind> generalKinds() {
    const auto same = [](const Image8& image, std::uint64_t) { return image; };
    constexpr int each = 7;
    return {{"correct", each, 95, 100, {}, same},
            {"correct, without a record", each, 95, 100, {}, same, false},
            {"correct, another driver's rounding", each, 95, 100, {}, noisy},
            {"correct, another driver's edges", each, 95, 100, {}, otherSamples},
            {"copy of a correct one", each, 95, 100, {}, same},
            {"encoded twice (gamma 1/2.2)", each, 0, 80, {}, power(1 / 2.2)},
            {"never encoded (gamma 2.2)", each, 0, 80, {}, power(2.2)},
            {"swapped channels", each, 0, 60, {}, swapped},
            {"mirrored", each, 0, 60, {}, mirrored},
            {"off-by-one crop", each, 0, 98, {}, offByOne},
            {"in a window", each, 0, 97, {}, bordered},
            {"half the size",
             each,
             0,
             97,
             {},
             [](const Image8& image, std::uint64_t) {
                 return grade::resized(image, image.width / 2, image.height / 2);
             }},
            {"blank", each, 0, 0, {}, blank}};
}

struct MadeClass {
    const LabEntry& entry;
    fs::path folder;
    std::map<std::string, const Kind*> kinds;  ///< by student
};

void makePictures(MadeClass& made, const std::vector<Kind>& kinds, int width, int height) {
    const std::unique_ptr<Lab> lab = made.entry.make();
    Studio studio(gl::Backend::osmesa);
    const Exercise exercise = lab->exercise();
    gl::keepShadersInMemory();
    int student = 0;
    for (const Kind& kind : kinds) {
        const std::string solution = grade::solutionOf(exercise);
        if (kind.handout) {
            gl::replaceKeptShader(exercise.shader, grade::handoutOf(solution, exercise.shader).text);
            studio.executor().programs().reloadChanged();
        }
        const KnobScope scope(lab->knobs());
        lab->knobs().set(kind.knobs);
        PictureState state;
        state.lab = made.entry.folder();
        state.knobs = lab->knobs().values();
        state.frame = studio.frame(*lab, width, height);
        const Image8 picture = grade::rgbOf(studio.picture(*lab, state.frame));
        for (int i = 0; i < kind.count; ++i) {
            const std::string name = fmt::format("s{:04}", student++);
            ImageMetadata metadata;
            if (kind.record)
                metadata.emplace_back(pictureStateKey, toJson(state));
            writeImage(made.folder / (name + ".png"), kind.edit(picture, static_cast<std::uint64_t>(i + 1)),
                       metadata);
            made.kinds[name] = &kind;
        }
        if (kind.handout) {
            gl::replaceKeptShader(exercise.shader, solution);
            studio.executor().programs().reloadChanged();
        }
    }
}

grade::Options optionsFor(const MadeClass& made, const fs::path& out) {
    grade::Options options;
    options.submissions = made.folder;
    options.out = out;
    options.worker = {(executablePath().parent_path() / "quincunx").string(), "grade-worker"};
    return options;
}

bool printTable(const MadeClass& made, const fs::path& out) {
    struct Found {
        int count = 0;
        double least = std::numeric_limits<double>::infinity();
        double most = 0;
        double sum = 0;
    };
    std::map<const Kind*, Found> found;
    for (const auto& [student, kind] : made.kinds) {
        grade::Submission submission;
        submission.student = student;
        const fs::path file = out / "journal" / (submission.key() + ".json");
        const double points = grade::parseRecord(readFile(file, 1 << 24), file.string()).points(100);
        Found& one = found[kind];
        ++one.count;
        one.least = std::min(one.least, points);
        one.most = std::max(one.most, points);
        one.sum += points;
    }
    std::vector<std::pair<const Kind*, Found>> rows(found.begin(), found.end());
    std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    bool good = true;
    std::printf("%s\n  %-38s %6s %7s %7s %7s   %s\n", made.entry.folder().c_str(), "kind", "number", "least",
                "mean", "most", "allowed");
    for (const auto& [kind, one] : rows) {
        const bool holds = one.least >= kind->least - 1e-9 && one.most <= kind->most + 1e-9;
        good = good && holds;
        std::printf("  %-38s %6d %7.1f %7.1f %7.1f   %.0f … %.0f%s\n", kind->name.c_str(), one.count,
                    one.least, one.sum / one.count, one.most, kind->least, kind->most,
                    holds ? "" : "   OUT OF ITS LIMITS");
    }
    return good;
}

double secondsOf(const std::function<void()>& work) {
    const auto start = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool gradeKinds(const char* lab, std::vector<Kind> kinds, const fs::path& root) {
    for (Kind& kind : generalKinds())
        kinds.push_back(std::move(kind));
    MadeClass made{findLab(allLabs(), lab), root / lab, {}};
    makePictures(made, kinds, 320, 180);
    const fs::path out = root / (std::string(lab) + "_out");
    grade::gradeClass(made.entry, optionsFor(made, out));
    return printTable(made, out);
}

/// Pictures of half a dozen kinds, at full size.
void timeClass(const fs::path& root) {
    constexpr int count = 300;
    MadeClass made{findLab(allLabs(), "shading"), root / "large", {}};
    const auto same = [](const Image8& image, std::uint64_t) { return image; };
    const std::vector<Kind> kinds = {{"correct", count / 6, 95, 100, {}, same},
                                     {"another driver", count / 6, 95, 100, {}, noisy},
                                     {"no highlights", count / 6, 0, 80, {{"specular", "off"}}, noisy},
                                     {"wrong light", count / 6, 0, 80, {{"light-turn", "60"}}, noisy},
                                     {"gamma", count / 6, 0, 80, {}, power(1 / 2.2)},
                                     {"crop", count / 6, 0, 98, {}, offByOne}};
    makePictures(made, kinds, 1280, 720);
    const double all =
        secondsOf([&] { grade::gradeClass(made.entry, optionsFor(made, root / "large_out")); });
    const Image8 first = readImage8(made.folder / "s0000.png");
    const Image8 second = noisy(first, 1);
    const double flips = secondsOf([&] {
                             for (int i = 0; i < count / 10; ++i)
                                 flip(first, second);
                         }) *
                         10;
    std::printf(
        "\n%d screenshots of 1280×720: %.1f s; FLIP alone on as many, all processors on each: %.1f s; ratio "
        "%.1f\n",
        count, all, flips, all / flips);
}

int runBenchmark(bool quick) {
    const fs::path root = fs::temp_directory_path() / fmt::format("quincunx_bench_grading_{}", getpid());
    const auto same = [](const Image8& image, std::uint64_t) { return image; };
    bool good = gradeKinds("shading",
                           {{"no highlights", 7, 0, 80, {{"specular", "off"}}, same},
                            {"no diffuse light", 7, 0, 80, {{"diffuse", "off"}}, same},
                            {"wrong light", 7, 0, 80, {{"light-turn", "60"}}, same}},
                           root);
    good = gradeKinds("shadow_maps",
                      {{"no shadows", 7, 0, 70, {}, same, true, true},
                       {"wrong light", 7, 0, 70, {{"light-turn", "60"}}, same}},
                      root) &&
           good;
    if (!quick)
        timeClass(root);
    fs::remove_all(root);
    return good ? 0 : 1;
}

}  // namespace
}  // namespace quincunx

int main(int argc, char** argv) {
    try {
        return quincunx::runBenchmark(argc > 1 && std::string(argv[1]) == "--quick");
    } catch (const quincunx::Error& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return static_cast<int>(e.exitStatus());
    }
}
