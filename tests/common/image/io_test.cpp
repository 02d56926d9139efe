#include "image/io.h"

#include <bit>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <limits>
#include <sstream>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "base/error.h"
#include "base/file.h"
#include "image/color.h"
#include "tests/common/image/pictures.h"

namespace quincunx {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class ImageIo : public testing::Test {
  protected:
    ImageIo() {
        std::string name = (fs::temp_directory_path() / "quincunx_image_XXXXXX").string();
        folder_ = mkdtemp(name.data());
    }
    ~ImageIo() override {
        std::error_code error;
        fs::permissions(folder_, fs::perms::owner_all, error);
        fs::remove_all(folder_, error);
    }

    fs::path path(const std::string& name) const { return folder_ / name; }

    fs::path write(const std::string& name, const std::string& bytes) const {
        std::ofstream(path(name), std::ios::binary) << bytes;
        return path(name);
    }

    std::size_t fileCount() const {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
    }

  private:
    fs::path folder_;
};

std::string bytesOf(const fs::path& file) {
    return readFile(file, 1 << 28);
}

std::string bigEndian(std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8)
        bytes += static_cast<char>(value >> shift & 255);
    return bytes;
}

std::string littleEndian(std::uint32_t value) {
    const std::string bytes = bigEndian(value);
    return {bytes.rbegin(), bytes.rend()};
}

/// CRC-32 of ISO/IEC 15948, annex D, bit by bit.
std::uint32_t crc(const std::string& bytes) {
    std::uint32_t value = 0xFFFFFFFF;
    for (const char c : bytes) {
        value ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit)
            value = (value & 1) != 0 ? value >> 1 ^ 0xEDB88320 : value >> 1;
    }
    return ~value;
}

std::string chunk(const std::string& type, const std::string& data) {
    return bigEndian(static_cast<std::uint32_t>(data.size())) + type + data + bigEndian(crc(type + data));
}

const std::string pngSignature = "\x89PNG\r\n\x1A\n";

std::string ihdr(std::uint32_t width, std::uint32_t height, char depth, char colourType) {
    return chunk("IHDR", bigEndian(width) + bigEndian(height) + depth + colourType + std::string(3, '\0'));
}

/// Deflate (RFC 1951) without compression, in a zlib stream (RFC 1950).
std::string stored(const std::string& data) {
    std::uint32_t a = 1;
    std::uint32_t b = 0;
    for (const char c : data) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    const auto length = static_cast<std::uint16_t>(data.size());
    std::string bytes = "\x78\x01\x01";
    for (const unsigned value : {static_cast<unsigned>(length), ~static_cast<unsigned>(length) & 0xFFFFU})
        bytes += {static_cast<char>(value & 255), static_cast<char>(value >> 8)};
    return bytes + data + bigEndian(b << 16 | a);
}

std::string png(std::uint32_t width, std::uint32_t height, char depth, char colourType,
                const std::string& filteredRows, const std::string& extraChunks = {}) {
    return pngSignature + ihdr(width, height, depth, colourType) + extraChunks +
           chunk("IDAT", stored(filteredRows)) + chunk("IEND", "");
}

/// A baseline JPEG whose single 8 × 8 block of grey is coded by hand: DC difference 0, then end of block.
std::string greyJpeg(std::uint16_t width, std::uint16_t height) {
    std::string bytes("\xFF\xD8", 2);
    bytes += std::string("\xFF\xDB\x00\x43\x00", 5) + std::string(64, '\x01');
    bytes += std::string("\xFF\xC0\x00\x0B\x08", 5);
    bytes += {static_cast<char>(height >> 8), static_cast<char>(height & 255)};
    bytes += {static_cast<char>(width >> 8), static_cast<char>(width & 255)};
    bytes += std::string("\x01\x01\x11\x00", 4);
    for (const char table : {'\x00', '\x10'}) {  // one code of one bit: symbol 0
        bytes += std::string("\xFF\xC4\x00\x14", 4) + table + '\x01' + std::string(15, '\0') + '\0';
    }
    bytes += std::string("\xFF\xDA\x00\x08\x01\x01\x00\x00\x3F\x00", 10);
    bytes += '\x3F';  // two bits 0, padded with 1
    return bytes + "\xFF\xD9";
}

/// What the error says; empty if there was none. Fails the test unless it is an InputError of one line.
template <typename Work>
std::string inputError(Work work) {
    try {
        work();
    } catch (const InputError& e) {
        const std::string text = e.what();
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
        return text;
    }
    return {};
}

TEST_F(ImageIo, PngKeepsEveryCodeOfEveryChannelCount) {
    for (int channels = 1; channels <= 4; ++channels) {
        for (const Encoding encoding : {Encoding::srgb, Encoding::linear}) {
            Image8 image = noise8(61, 37, channels, static_cast<std::uint32_t>(channels));
            image.encoding = encoding;
            writeImage(path("a.png"), image);
            EXPECT_EQ(readImage8(path("a.png")), image)
                << channels << " channels, encoding " << static_cast<int>(encoding);
        }
    }
}

TEST_F(ImageIo, PngOfTransparentPixelsKeepsTheirColour) {
    Image8 image(2, 1, 4, Encoding::srgb);
    image.data = {200, 100, 50, 0, 9, 8, 7, 1};
    writeImage(path("a.png"), image);
    EXPECT_EQ(readImage8(path("a.png")).data, image.data);
}

TEST_F(ImageIo, ExrKeepsEveryBitOfEveryChannelCount) {
    for (int channels = 1; channels <= 4; ++channels) {
        Image image(53, 29, channels, Encoding::linear);
        NoiseSource source(7);
        for (float& value : image.data)
            value = std::bit_cast<float>(source.next());
        image.data[0] = std::numeric_limits<float>::infinity();
        image.data[1] = -0.0F;
        image.data[2] = std::numeric_limits<float>::denorm_min();
        image.data[3] = std::numeric_limits<float>::quiet_NaN();
        writeImage(path("a.exr"), image);
        const Image back = readImage(path("a.exr"));
        ASSERT_EQ(back.data.size(), image.data.size());
        EXPECT_EQ(back.encoding, Encoding::linear);
        EXPECT_EQ(std::memcmp(back.data.data(), image.data.data(), image.data.size() * sizeof(float)), 0)
            << channels << " channels";
    }
}

TEST_F(ImageIo, FloatsOfAPngAreItsCodesAndSayThatTheyAreEncoded) {
    Image8 image(256, 1, 1, Encoding::srgb);
    for (int code = 0; code < 256; ++code)
        image.data[static_cast<std::size_t>(code)] = static_cast<std::uint8_t>(code);
    writeImage(path("a.png"), image);
    const Image back = readImage(path("a.png"));
    EXPECT_EQ(back.encoding, Encoding::srgb);
    for (int code = 0; code < 256; ++code)
        EXPECT_EQ(back.data[static_cast<std::size_t>(code)], static_cast<float>(code) / 255) << code;
    EXPECT_EQ(toSrgb8(toLinear(back)), image);
}

TEST_F(ImageIo, ExrReadInEightBitsIsEncodedToSrgb) {
    const Image8 image = noise8(16, 16, 3, 3);
    writeImage(path("a.exr"), image);
    EXPECT_EQ(readImage(path("a.exr")), toLinear(image));
    EXPECT_EQ(readImage8(path("a.exr")), image);
}

TEST_F(ImageIo, FloatImageInAPngIsEncoded) {
    const Image8 codes = noise8(9, 5, 4, 11);
    writeImage(path("a.png"), toLinear(codes));
    EXPECT_EQ(readImage8(path("a.png")), codes);
}

TEST_F(ImageIo, SixteenBitPngKeepsItsBitsAsFloatsAndRoundsToEight) {
    std::string row(1, '\0');
    std::vector<std::uint16_t> values;
    for (int i = 0; i < 64; ++i) {
        values.push_back(static_cast<std::uint16_t>(i * 1040 + 13));
        row += {static_cast<char>(values.back() >> 8), static_cast<char>(values.back() & 255)};
    }
    write("a.png", png(64, 1, 16, 0, row));
    const Image floats = readImage(path("a.png"));
    const Image8 codes = readImage8(path("a.png"));
    ASSERT_EQ(floats.data.size(), 64U);
    for (std::size_t i = 0; i < 64; ++i) {
        EXPECT_EQ(floats.data[i], static_cast<float>(values[i] / 65535.0)) << i;
        EXPECT_EQ(codes.data[i], static_cast<int>(std::lround(values[i] / 257.0))) << i;
    }
}

TEST_F(ImageIo, PaletteOfAPngIsLookedUp) {
    const std::string palette = chunk("PLTE", std::string("\x0A\x14\x1E\xC8\xB4\xA0", 6));
    write("a.png", png(2, 1, 8, 3, std::string("\x00\x01\x00", 3), palette));
    const Image8 image = readImage8(path("a.png"));
    EXPECT_EQ(image.channels, 3);
    EXPECT_EQ(image.data, (std::vector<std::uint8_t>{200, 180, 160, 10, 20, 30}));
}

TEST_F(ImageIo, JpegIsReadAsSrgb) {
    write("a.jpg", greyJpeg(8, 8));
    const Image8 image = readImage8(path("a.jpg"));
    EXPECT_EQ(image.width, 8);
    EXPECT_EQ(image.channels, 1);
    EXPECT_EQ(image.encoding, Encoding::srgb);
    EXPECT_EQ(image.data, std::vector<std::uint8_t>(64, 128));
}

TEST_F(ImageIo, RadianceIsReadAsLinear) {
    // RGBE: mantissa/256 · 2^(exponent − 128)
    std::string bytes = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n";
    bytes += std::string("\x80\x40\x20\x81\x80\x80\x80\x84", 8);
    write("a.hdr", bytes);
    const Image image = readImage(path("a.hdr"));
    EXPECT_EQ(image.encoding, Encoding::linear);
    ASSERT_EQ(image.data.size(), 6U);
    // Decoders may add half a unit of the mantissa (Ward's own does): 2^-8 of 1.
    const std::vector<float> expected = {1, 0.5F, 0.25F, 8, 8, 8};
    for (std::size_t i = 0; i < 6; ++i)
        EXPECT_NEAR(image.data[i], expected[i], expected[i < 3 ? 0 : 3] / 256) << i;
}

TEST_F(ImageIo, MemoryAndFileGiveTheSamePicture) {
    const Image8 image = noise8(20, 10, 3, 5);
    writeImage(path("a.png"), image);
    const std::string bytes = bytesOf(path("a.png"));
    EXPECT_EQ(readImage8FromMemory(std::as_bytes(std::span(bytes)), "texture 3"), image);
    const std::string half = bytes.substr(0, bytes.size() / 2);
    EXPECT_THAT(inputError([&] { readImage8FromMemory(std::as_bytes(std::span(half)), "texture 3"); }),
                HasSubstr("texture 3"));
}

TEST_F(ImageIo, MetadataOfAnyBytesComesBack) {
    std::string allBytes;
    for (int i = 0; i < 256; ++i)
        allBytes += static_cast<char>(i);
    const ImageMetadata metadata = {{"lab", "10_shading"},
                                    {"knobs", R"({"shininess": 32, "name": "ä\n\"%41=", "list": [1, 2]})"},
                                    {"", "empty key"},
                                    {"empty value", ""},
                                    {"twice", "1"},
                                    {"twice", "2"},
                                    {"a=b\n%", "=\r\n%3D%"},
                                    {allBytes, allBytes},
                                    {"long", std::string(300000, 'x')}};
    writeImage(path("a.png"), noise8(4, 4, 3, 1), metadata);
    writeImage(path("a.exr"), Image(4, 4, 3, Encoding::linear), metadata);
    EXPECT_EQ(readMetadata(path("a.png")), metadata);
    EXPECT_EQ(readMetadata(path("a.exr")), metadata);
    writeImage(path("b.png"), noise8(4, 4, 3, 1));
    EXPECT_TRUE(readMetadata(path("b.png")).empty());
}

TEST_F(ImageIo, TooMuchMetadataIsAnError) {
    const std::string text(5 << 20, 'x');
    EXPECT_THAT(inputError([&] {
                    writeImage(path("a.png"), noise8(4, 4, 3, 1), {{"k", text}});
                }),
                HasSubstr("metadata"));
    EXPECT_EQ(fileCount(), 0U);
}

TEST_F(ImageIo, TheSamePictureGivesTheSameBytes) {
    const Image8 image = noise8(40, 30, 3, 9);
    for (const char* name : {"a.png", "a.exr"}) {
        writeImage(path(name), image, {{"k", "v"}});
        const std::string first = bytesOf(path(name));
        writeImage(path(name), image, {{"k", "v"}});
        EXPECT_EQ(bytesOf(path(name)), first) << name;
    }
}

TEST_F(ImageIo, EveryTruncationIsAnErrorThatNamesTheFile) {
    writeImage(path("whole.png"), noise8(24, 16, 3, 1), {{"k", "v"}});
    writeImage(path("whole.exr"), toLinear(noise8(24, 40, 3, 1)), {{"k", "v"}});
    write("whole.jpg", greyJpeg(8, 8));
    write("whole.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + std::string(16, '\x80'));
    for (const char* extension : {".png", ".exr", ".jpg", ".hdr"}) {
        const std::string bytes = bytesOf(path(std::string("whole") + extension));
        const fs::path cut = path(std::string("cut") + extension);
        const std::size_t step = bytes.size() / 80 + 1;
        for (std::size_t length = 0; length < bytes.size(); length += length < 40 ? 1 : step) {
            write(cut.filename().string(), bytes.substr(0, length));
            EXPECT_THAT(inputError([&] { readImage(cut); }), HasSubstr(cut.string()))
                << extension << " cut to " << length << " of " << bytes.size();
        }
        write(cut.filename().string(), bytes.substr(0, bytes.size() - 1));
        EXPECT_THAT(inputError([&] { readImage(cut); }), HasSubstr(cut.string())) << extension;
    }
}

TEST_F(ImageIo, DamagedPngPrintsNothing) {
    writeImage(path("a.png"), noise8(12, 8, 3, 1));
    std::string bytes = bytesOf(path("a.png"));
    bytes[bytes.size() - 30] ^= 1;
    testing::internal::CaptureStderr();
    const std::string error =
        inputError([&] { readImageFromMemory(std::as_bytes(std::span(bytes)), "broken"); });
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
    EXPECT_THAT(error, HasSubstr("broken: IDAT"));
}

TEST_F(ImageIo, EveryFlippedByteGivesAPictureOrAnInputError) {
    writeImage(path("whole.png"), noise8(12, 8, 3, 1), {{"k", "v"}});
    writeImage(path("whole.exr"), toLinear(noise8(12, 8, 3, 1)), {{"k", "v"}});
    write("whole.jpg", greyJpeg(8, 8));
    write("whole.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n" + std::string(16, '\x80'));
    for (const char* extension : {".png", ".exr", ".jpg", ".hdr"}) {
        const std::string bytes = bytesOf(path(std::string("whole") + extension));
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            constexpr int flips[] = {0x01, 0x80, 0xFF};
            std::string broken = bytes;
            broken[i] = static_cast<char>(broken[i] ^ flips[i % 3]);
            inputError([&] { readImageFromMemory(std::as_bytes(std::span(broken)), "broken"); });
        }
    }
}

TEST_F(ImageIo, HugeDeclaredSizesAreRefusedBeforeAllocation) {
    const std::uint32_t huge = 0x7FFFFFFF;
    write("a.png", pngSignature + ihdr(huge, huge, 8, 2) + chunk("IDAT", "x") + chunk("IEND", ""));
    write("b.png", png(32769, 1, 8, 0, std::string(32770, '\0')));
    write("c.png", pngSignature + ihdr(32768, 32768, 8, 0) + chunk("IDAT", "x") + chunk("IEND", ""));
    write("d.jpg", greyJpeg(65535, 65535));
    write("e.hdr", "#?RADIANCE\n\n-Y 2000000000 +X 2000000000\n" + std::string(64, '\x01'));
    writeImage(path("f.exr"), Image(4, 4, 3, Encoding::linear));
    std::string exr = bytesOf(path("f.exr"));
    const std::size_t window = exr.find("dataWindow") + 11 + 6 + 4;
    exr.replace(
        window, 16,
        littleEndian(0x80000000) + littleEndian(0x80000000) + littleEndian(huge) + littleEndian(huge));
    write("f.exr", exr);
    for (const char* name : {"a.png", "b.png", "c.png", "d.jpg", "e.hdr", "f.exr"}) {
        EXPECT_THAT(inputError([&] { readImage8(path(name)); }), HasSubstr("pixels, more than")) << name;
        EXPECT_THAT(inputError([&] { readMetadata(path(name)); }), HasSubstr(name)) << name;
    }
    struct rusage usage {};
    getrusage(RUSAGE_SELF, &usage);
    EXPECT_LT(usage.ru_maxrss, 1 << 20)
        << "kB";  // 120 MB measured without sanitizers; the pictures claim 10 GB up
}

TEST_F(ImageIo, PicturesWithoutPixelsAreErrors) {
    write("a.png", pngSignature + ihdr(0, 5, 8, 2) + chunk("IEND", ""));
    write("b.hdr", "#?RADIANCE\n\n-Y 0 +X 0\n");
    for (const char* name : {"a.png", "b.hdr"})
        EXPECT_THAT(inputError([&] { readImage(path(name)); }), HasSubstr("no pixels")) << name;
}

TEST_F(ImageIo, WhatIsNoPictureIsAnError) {
    write("text.png", "a picture says more than a thousand words\n");
    write("empty.png", "");
    fs::create_directory(path("folder.png"));
    EXPECT_THAT(inputError([&] { readImage(path("text.png")); }), HasSubstr("not a PNG"));
    EXPECT_THAT(inputError([&] { readImage(path("empty.png")); }), HasSubstr("empty"));
    EXPECT_THAT(inputError([&] { readImage(path("folder.png")); }), HasSubstr("not a regular file"));
    EXPECT_THAT(inputError([&] { readImage(path("none.png")); }), HasSubstr("no such file"));
    EXPECT_THAT(inputError([&] { readImage("/dev/zero"); }), HasSubstr("/dev/zero"));
}

TEST_F(ImageIo, TheNameDoesNotDecideTheKind) {
    const Image8 image = noise8(6, 6, 3, 2);
    writeImage(path("a.png"), image);
    fs::rename(path("a.png"), path("a.exr"));
    EXPECT_EQ(readImage8(path("a.exr")), image);
}

TEST_F(ImageIo, OtherExtensionsAreNotWritten) {
    for (const char* name : {"a.jpg", "a", "a.png.txt"})
        EXPECT_THAT(inputError([&] { writeImage(path(name), noise8(2, 2, 3, 1)); }), HasSubstr(name));
    EXPECT_EQ(fileCount(), 0U);
    writeImage(path("A.PNG"), noise8(2, 2, 3, 1));
    EXPECT_EQ(fileCount(), 1U);
}

TEST_F(ImageIo, AFolderThatCannotBeWrittenIsAnError) {
    write("file", "");
    EXPECT_THAT(inputError([&] { writeImage(path("file") / "a.png", noise8(2, 2, 3, 1)); }),
                HasSubstr("file"));
    if (geteuid() == 0) {  // root may write anywhere but to /proc
        EXPECT_NE(inputError([&] { writeImage("/proc/a.png", noise8(2, 2, 3, 1)); }), "");
    } else {
        fs::create_directory(path("closed"));
        fs::permissions(path("closed"), fs::perms::owner_read | fs::perms::owner_exec);
        EXPECT_NE(inputError([&] { writeImage(path("closed") / "a.png", noise8(2, 2, 3, 1)); }), "");
    }
}

TEST_F(ImageIo, AFullDiskIsAnErrorAndLeavesTheOldFile) {
    const Image8 old = noise8(4, 4, 3, 1);
    writeImage(path("a.png"), old);
    const auto writeWithoutSpace = [&] {
        // The limit on file sizes stands for the full disk: write() fails in the same way.
        std::signal(SIGXFSZ, SIG_IGN);
        struct rlimit before {};
        getrlimit(RLIMIT_FSIZE, &before);
        struct rlimit small = before;
        small.rlim_cur = 4096;
        setrlimit(RLIMIT_FSIZE, &small);
        const std::string error = inputError([&] { writeImage(path("a.png"), noise8(200, 200, 3, 1)); });
        setrlimit(RLIMIT_FSIZE, &before);
        return error;
    };
    EXPECT_THAT(writeWithoutSpace(), HasSubstr("a.png"));
    EXPECT_EQ(fileCount(), 1U);
    EXPECT_EQ(readImage8(path("a.png")), old);
}

constexpr const char* freshVariable = "QUINCUNX_TEST_FRESH";

/// True in a process where `freshRun` runs the current test: one that has not loaded the module yet.
bool isFreshProcess() {
    return std::getenv(freshVariable) != nullptr;
}

/// Exit status of the current test in a process of its own, which finds `value` in `freshVariable`.
int freshRun(const std::string& value = "1") {
    const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
    const std::string filter = fmt::format("--gtest_filter={}.{}", test.test_suite_name(), test.name());
    const pid_t child = fork();
    if (child == 0) {
        setenv(freshVariable, value.c_str(), 1);
        execl("/proc/self/exe", "test", filter.c_str(), nullptr);
        _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void readOnePicture() {
    const std::string bytes = greyJpeg(8, 8);
    readImage8FromMemory(std::as_bytes(std::span(bytes)), "a");
}

TEST(ImageIoModule, IsNotLoadedBeforeTheFirstPicture) {
    if (!isFreshProcess()) {
        EXPECT_EQ(freshRun(), 0);
        return;
    }
    const auto isMapped = [] {
        std::ifstream maps("/proc/self/maps");
        const std::string text{std::istreambuf_iterator<char>(maps), {}};
        return text.find("libOpenImageIO") != std::string::npos;
    };
    EXPECT_FALSE(imageIoLoaded());
    EXPECT_FALSE(isMapped());
    readOnePicture();
    EXPECT_TRUE(imageIoLoaded());
    EXPECT_TRUE(isMapped());
}

TEST(ImageIoModule, LoadsOnAnotherThreadAndIsThenThere) {
    if (!isFreshProcess()) {
        EXPECT_EQ(freshRun(), 0);
        return;
    }
    EXPECT_FALSE(imageIoLoaded());
    preloadImageIo();
    preloadImageIo();
    for (int i = 0; i < 6000 && !imageIoLoaded(); ++i)
        usleep(10000);
    EXPECT_TRUE(imageIoLoaded());
    readOnePicture();
}

TEST(ImageIoModule, AnExitWhileLoadingIsClean) {
    if (!isFreshProcess()) {
        for (int milliseconds = 0; milliseconds < 150; milliseconds += 50)
            EXPECT_EQ(freshRun(std::to_string(milliseconds)), 0) << milliseconds;
        return;
    }
    preloadImageIo();
    usleep(static_cast<useconds_t>(1000 * std::atoi(std::getenv(freshVariable))));
    std::exit(0);
}

TEST(ImageIoModule, MissingIsAnEnvironmentErrorThatNamesIt) {
    if (!isFreshProcess()) {
        EXPECT_EQ(freshRun(), 0);
        return;
    }
    setenv("QUINCUNX_IMAGE_IO", "/nowhere/module.so", 1);
    preloadImageIo();
    try {
        readOnePicture();
        FAIL() << "nothing thrown";
    } catch (const EnvironmentError& e) {
        EXPECT_THAT(e.what(), HasSubstr("/nowhere/module.so"));
    }
}

TEST(ImageIoModule, ADamagedOneIsAnEnvironmentError) {
    if (!isFreshProcess()) {
        EXPECT_EQ(freshRun(), 0);
        return;
    }
    const fs::path file = fs::temp_directory_path() / fmt::format("quincunx_damaged_{}.so", getpid());
    std::ofstream(file) << "\x7F"
                        << "ELF and nothing more";
    setenv("QUINCUNX_IMAGE_IO", file.c_str(), 1);
    EXPECT_THROW(readOnePicture(), EnvironmentError);
    fs::remove(file);
}

}  // namespace
}  // namespace quincunx
