// Archives that students, and people who are no students, hand in.

#include "grade/archive.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zip.h>

#include "base/check.h"
#include "base/random.h"

namespace quincunx::grade {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct NewEntry {
    std::string name;
    std::string bytes;
    unsigned mode = 0;  ///< of Unix; 0: not said
};

std::string zipped(const std::vector<NewEntry>& entries) {
    zip_error_t error;
    zip_source_t* const source = zip_source_buffer_create(nullptr, 0, 0, &error);
    zip_t* const archive = zip_open_from_source(source, ZIP_TRUNCATE, &error);
    QX_CHECK(archive != nullptr);
    zip_source_keep(source);
    for (const NewEntry& entry : entries) {
        const auto index = zip_file_add(archive, entry.name.c_str(),
                                        zip_source_buffer(archive, entry.bytes.data(), entry.bytes.size(), 0),
                                        ZIP_FL_ENC_UTF_8);
        QX_CHECK(index >= 0);
        if (entry.mode != 0)
            zip_file_set_external_attributes(archive, static_cast<zip_uint64_t>(index), 0, ZIP_OPSYS_UNIX,
                                             entry.mode << 16);
    }
    QX_CHECK(zip_close(archive) == 0);
    zip_source_open(source);
    zip_stat_t stat;
    zip_source_stat(source, &stat);
    std::string bytes(stat.size, '\0');
    zip_source_read(source, bytes.data(), bytes.size());
    zip_source_free(source);
    return bytes;
}

std::vector<std::string> namesOf(const Unpacked& unpacked) {
    std::vector<std::string> names;
    for (const UnpackedFile& file : unpacked.files)
        names.push_back(file.name);
    return names;
}

TEST(Archives, GiveTheirFilesWithFoldersAndArchivesInThem) {
    const Unpacked unpacked =
        unpack(zipped({{"a.png", "A"}, {"deep/b.frag", "B"}, {"inner.zip", zipped({{"c", "C"}})}}));
    EXPECT_THAT(namesOf(unpacked), ElementsAre("a.png", "deep/b.frag", "inner.zip/c"));
    EXPECT_EQ(unpacked.files[1].bytes, "B");
    EXPECT_THAT(unpacked.faults, IsEmpty());
}

TEST(Archives, AreNotLetOutOfTheirFolder) {
    for (const char* name :
         {"../up", "a/../../up", "/etc/passwd", "..\\up", "C:\\x", "a/..", "line\nbreak"}) {
        const Unpacked unpacked = unpack(zipped({{name, "x"}, {"good", "y"}}));
        EXPECT_THAT(namesOf(unpacked), ElementsAre("good")) << name;
        EXPECT_THAT(unpacked.faults, ElementsAre(HasSubstr("refused"))) << name;
    }
}

TEST(Archives, HoldNoLinksAndNoDevices) {
    const Unpacked unpacked =
        unpack(zipped({{"link", "/etc/passwd", 0120777}, {"pipe", "", 010644}, {"file", "x", 0100644}}));
    EXPECT_THAT(namesOf(unpacked), ElementsAre("file"));
    EXPECT_THAT(unpacked.faults, ElementsAre(HasSubstr("a link"), HasSubstr("no regular file")));
}

TEST(Archives, AreBoundedInRatioSizeCountAndDepth) {
    ArchiveLimits limits;
    limits.entryBytes = 3 << 20;
    limits.totalBytes = 4 << 20;
    limits.entries = 4;
    limits.depth = 1;
    std::string random(2 << 20, '\0');
    Random numbers(3);
    for (char& c : random)
        c = static_cast<char>(numbers.bits());
    // 2 MiB of zeros deflate a thousandfold.
    const Unpacked bomb = unpack(zipped({{"bomb", std::string(2 << 20, '\0')}}), limits);
    EXPECT_THAT(bomb.files, IsEmpty());
    EXPECT_THAT(bomb.faults, ElementsAre(HasSubstr("bytes out of")));
    EXPECT_THAT(unpack(zipped({{"large", random + random}}), limits).faults,
                ElementsAre(HasSubstr("unpacked")));
    EXPECT_THAT(namesOf(unpack(zipped({{"1", random}, {"2", random}, {"3", random}}), limits)),
                ElementsAre("1", "2"));
    EXPECT_THAT(unpack(zipped({{"1", ""}, {"2", ""}, {"3", ""}, {"4", ""}, {"5", ""}}), limits).faults,
                ElementsAre(HasSubstr("5 entries")));
    EXPECT_THAT(unpack(zipped({{"in", zipped({{"x", "x"}})}}), limits).faults,
                ElementsAre(HasSubstr("too deep")));
}

TEST(Archives, ThatAreDamagedAreFaultsAndNothingElse) {
    const std::string good =
        zipped({{"a", std::string(3000, 'a')}, {"b", "bbb"}, {"c.zip", zipped({{"d", "dd"}})}});
    Random random(11);
    std::size_t faults = 0;
    for (int i = 0; i < 600; ++i) {
        std::string bad = good.substr(0, i % 3 == 0 ? random.below(good.size()) : good.size());
        for (int k = 0; k < 1 + i % 5 && !bad.empty(); ++k)
            bad[random.below(bad.size())] = static_cast<char>(random.bits());
        const Unpacked unpacked = unpack(bad);
        faults += unpacked.faults.empty() ? 0 : 1;
        for (const UnpackedFile& file : unpacked.files)
            EXPECT_LE(file.bytes.size(), 1u << 20);
    }
    EXPECT_GE(faults, 300u);  // measured: 556
    EXPECT_THAT(unpack("").files, IsEmpty());
}

}  // namespace
}  // namespace quincunx::grade
