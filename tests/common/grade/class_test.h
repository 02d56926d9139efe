#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "base/file.h"
#include "grade/grade.h"
#include "image/io.h"
#include "lab/picture_state.h"
#include "lab/studio.h"
#include "lab/verbs.h"
#include "labs/all_labs.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::grade::test {

/// A class of one lab in a folder, graded by the built program's workers.
class ClassTest : public testing::Test {
  public:
    /// The records by student.
    static std::map<std::string, Record> recordsOf(const Options& options) {
        std::map<std::string, Record> records;
        for (const auto& entry : std::filesystem::directory_iterator(options.out / "journal"))
            if (entry.path().filename() != "class.json") {
                const Record record = parseRecord(readFile(entry.path(), 1 << 24), entry.path().string());
                records[record.student] = record;
            }
        return records;
    }

  protected:
    explicit ClassTest(const char* lab = "shading") : entry_(findLab(allLabs(), lab)) {}

    Options options(const char* out = "out") const {
        Options options;
        options.submissions = folder_ / "class";
        options.out = folder_ / out;
        options.jobs = 2;
        options.backend = gl::Backend::osmesa;
        options.worker = {QUINCUNX_PROGRAM, "grade-worker"};
        return options;
    }

    /// A picture as `run` writes it.
    void submit(const std::string& name, const KnobValues& knobs, bool withRecord = true, int width = 96,
                int height = 64) {
        const KnobScope scope(lab_->knobs());
        for (const auto& [knob, value] : knobs)
            lab_->knobs().find(knob).parse(value);
        PictureState state;
        state.lab = entry_.folder();
        state.knobs = lab_->knobs().values();
        state.frame = studio_.frame(*lab_, width, height);
        if (camera_)
            state.frame.camera = *camera_;
        const Image8 picture = studio_.picture(*lab_, state.frame);
        ImageMetadata metadata;
        if (withRecord)
            metadata.emplace_back(pictureStateKey, toJson(state));
        writeImage(folder_ / ("class/" + name), picture, metadata);
    }
    void submitText(const std::string& name, const std::string& text) { folder_.file("class/" + name, text); }

    /// All that a call left but the journal: names and bytes.
    static std::map<std::string, std::string> outputsOf(const std::filesystem::path& out) {
        std::map<std::string, std::string> files;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(out))
            if (entry.is_regular_file() && entry.path().string().find("/journal/") == std::string::npos)
                files[entry.path().lexically_relative(out).string()] = readFile(entry.path(), 1 << 26);
        return files;
    }

    const LabEntry& entry_;
    std::unique_ptr<Lab> lab_ = entry_.make();
    Studio studio_{gl::Backend::osmesa};
    std::optional<Camera> camera_;
    quincunx::test::TemporaryFolder folder_;
};

}  // namespace quincunx::grade::test
