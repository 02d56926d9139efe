// A lab is measured again when what it shows may have changed, and only then.

#include "atlas/fingerprint.h"

#include <chrono>
#include <filesystem>

#include <gtest/gtest.h>

#include "lab/knob.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::atlas {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

class Fingerprint : public testing::Test {
  protected:
    Fingerprint() {
        for (const char* file :
             {"labs/10_shading/lab.cpp", "labs/10_shading/README.md", "labs/12_other/lab.cpp",
              "common/math/vector.h", "common/atlas/pages.cpp", "shaders/lib/phong.glsl",
              "shaders/labs/10_shading/flat.vert", "shaders/labs/12_other/a.frag", "web/style.css"})
            write(file, "as it was");
        folder_.file("program", "machine code");
        fs::last_write_time(program_, fs::file_time_type::clock::now());
    }
    /// An hour before the program was made.
    void write(const std::string& file, const std::string& contents) {
        fs::last_write_time(folder_.file(file, contents), fs::file_time_type::clock::now() - 1h);
    }
    std::string now() const { return labFingerprint("10_shading", knobs_, folder_.path(), program_); }

    const test::TemporaryFolder folder_;
    const fs::path program_ = folder_ / "program";
    KnobSet knobs_;
    IntKnob tessellation_{knobs_, "tessellation", 32, {3, 512, true}, "", "How fine"};
};

TEST_F(Fingerprint, StaysTheSame) {
    EXPECT_EQ(now(), now());
    EXPECT_EQ(now().size(), 16U);
}

TEST_F(Fingerprint, ChangesWithTheLabsCodeWhatItIsBuiltOnAndItsShaders) {
    for (const char* file : {"labs/10_shading/lab.cpp", "common/math/vector.h", "shaders/lib/phong.glsl",
                             "shaders/labs/10_shading/flat.vert"}) {
        const std::string before = now();
        write(file, "changed");
        EXPECT_NE(now(), before) << file;
    }
    const std::string before = now();
    write("labs/10_shading/new.cpp", "");
    EXPECT_NE(now(), before);
}

TEST_F(Fingerprint, DoesNotChangeWithOtherLabsTextsAndPages) {
    const std::string before = now();
    for (const char* file : {"labs/10_shading/README.md", "labs/12_other/lab.cpp",
                             "shaders/labs/12_other/a.frag", "common/atlas/pages.cpp", "web/style.css"})
        write(file, "changed");
    folder_.file("program", "linked again");
    EXPECT_EQ(now(), before);
}

TEST_F(Fingerprint, ChangesWithTheKnobs) {
    const std::string before = now();
    const BoolKnob mirror(knobs_, "mirror", false, "Mirrors it");
    EXPECT_NE(now(), before);
}

TEST_F(Fingerprint, IsThatOfTheProgramWhereItIsOlderThanItsSources) {
    write("labs/10_shading/lab.cpp", "changed");
    const std::string built = now();
    fs::last_write_time(folder_ / "labs/10_shading/lab.cpp", fs::file_time_type::clock::now() + 1h);
    const std::string edited = now();
    EXPECT_NE(edited, built);
    folder_.file("labs/10_shading/lab.cpp", "edited again, not yet built");
    fs::last_write_time(folder_ / "labs/10_shading/lab.cpp", fs::file_time_type::clock::now() + 1h);
    EXPECT_EQ(now(), edited);
    folder_.file("program", "other machine code");
    EXPECT_NE(now(), edited);
}

TEST_F(Fingerprint, IsThatOfTheProgramWhereThereAreNoSources) {
    fs::remove_all(folder_ / "labs");
    fs::remove_all(folder_ / "common");
    const std::string before = now();
    folder_.file("program", "other machine code");
    EXPECT_NE(now(), before);
}

TEST(Digest, KeepsPiecesApart) {
    EXPECT_NE(Digest().add("ab").add("c").value(), Digest().add("a").add("bc").value());
    EXPECT_NE(Digest().add("").value(), Digest().value());
}

}  // namespace
}  // namespace quincunx::atlas
