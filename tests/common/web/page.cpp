// Pages: what comes from files is text in them, and pictures and figures arrive as they were.

#include "web/page.h"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/file.h"
#include "image/color.h"
#include "image/compare.h"
#include "image/io.h"
#include "tests/support/temporary_folder.h"

namespace quincunx::web {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(Escaped, LeavesNothingThatHtmlUnderstands) {
    EXPECT_EQ(escaped("<script>alert('a & \"b\"')</script>"),
              "&lt;script&gt;alert(&#39;a &amp; &quot;b&quot;&#39;)&lt;/script&gt;");
    EXPECT_EQ(escaped("ꟻLIP ≤ ½ 𝄞\n"), "ꟻLIP ≤ ½ 𝄞\n");
}

TEST(Escaped, ReplacesWhatIsNoTextInHtml) {
    const std::string mark = "\uFFFD";
    EXPECT_EQ(escaped(std::string("a\0b\x1b", 4)), "a" + mark + "b" + mark);
    // Cut short, overlong, a surrogate, beyond U+10FFFF, a lone continuation (RFC 3629, section 4).
    for (const char* wrong : {"\xe2\x89", "\xc0\xaf", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\x80"}) {
        const std::string html = escaped(wrong);
        EXPECT_EQ(html.find(wrong), std::string::npos);
        EXPECT_THAT(html, testing::StartsWith(mark));
    }
}

TEST(InScript, HoldsNoEndOfTheScriptAndParsesToTheSame) {
    const Json json = {{"name", "</script><!-- \" \\ \u2028"}, {"value", 1e-300}};
    const std::string text = inScript(json);
    EXPECT_THAT(text, Not(HasSubstr("<")));
    EXPECT_EQ(Json::parse(text), json);
}

TEST(DataUri, IsBase64OfTheBytes) {
    const auto of = [](std::string_view text) {
        return dataUri("text/plain", {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
    };
    // RFC 4648, section 10.
    EXPECT_EQ(of(""), "data:text/plain;base64,");
    EXPECT_EQ(of("f"), "data:text/plain;base64,Zg==");
    EXPECT_EQ(of("fo"), "data:text/plain;base64,Zm8=");
    EXPECT_EQ(of("foobar"), "data:text/plain;base64,Zm9vYmFy");
}

TEST(FilledTemplate, EscapesWhatItIsFilledWith) {
    Json view = {{"title", "<img src=x onerror=alert(1)>"},
                 {"root", ""},
                 {"assets", "assets/"},
                 {"home", "\"><script>"},
                 {"path", "a'b"},
                 {"text", "</code></pre><script>alert(2)</script>"},
                 {"folder", "10_shading"},
                 {"heading", "&"}};
    const std::string page = filledTemplate("source", view);
    EXPECT_THAT(page, HasSubstr("<title>&lt;img src=x onerror=alert(1)&gt;</title>"));
    EXPECT_THAT(page, HasSubstr("href=\"&quot;&gt;&lt;script&gt;\""));
    EXPECT_THAT(page, HasSubstr("&lt;script&gt;alert(2)"));
    EXPECT_THAT(page, Not(HasSubstr("<script>alert")));
}

TEST(FilledTemplate, NamesATemplateThatIsNotThere) {
    EXPECT_THROW(filledTemplate("alchemy", {}), EnvironmentError);
}

Image8 noise(int width, int height, int channels) {
    Image8 picture(width, height, channels, Encoding::srgb);
    unsigned state = 1;
    for (std::uint8_t& code : picture.data)
        code = static_cast<std::uint8_t>((state = state * 1664525U + 1013904223U) >> 24);
    return picture;
}

TEST(PixelScript, HandsOverEveryPixel) {
    const Image8 picture = noise(7, 5, 4);
    const std::string script = pixelScript("a/b.js", picture);
    EXPECT_THAT(script, testing::StartsWith("quincunxPixels(\"a/b.js\", \"data:image/png;base64,"));
    EXPECT_EQ(withoutAlpha(picture).channels, 3);
    EXPECT_THAT(script, HasSubstr(dataUri("image/png", encodedPng(withoutAlpha(picture), "test"))));
}

TEST(Thumbnail, KeepsTheMeanLightAndTheShape) {
    const Image8 picture = noise(400, 200, 3);
    const Image8 small = thumbnail(picture, 100, 100);
    EXPECT_EQ(small.width, 100);
    EXPECT_EQ(small.height, 50);
    const auto mean = [](const Image8& image) {
        double sum = 0;
        for (const float value : toLinear(image).data)
            sum += value;
        return sum / static_cast<double>(image.data.size());
    };
    // Codes are rounded: half a code, of a slope of at most 1/115 a code where the curve is steepest at grey.
    EXPECT_NEAR(mean(small), mean(picture), 5e-4);
}

TEST(Thumbnail, OfSidesThatDoNotDivideIsEvenToo) {
    Image8 white(37, 23, 4, Encoding::srgb);
    std::fill(white.data.begin(), white.data.end(), std::uint8_t{200});
    const Image8 small = thumbnail(white, 10, 10);
    EXPECT_THAT(small.data, testing::Each(200));
    EXPECT_EQ(thumbnail(white, 100, 100).width, 37) << "small pictures are not enlarged";
}

TEST(EncodedJpeg, IsReadBackNearlyTheSame) {
    Image8 ramp(64, 64, 4, Encoding::srgb);
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            for (int c = 0; c < 4; ++c)
                ramp.pixel(x, y)[c] = static_cast<std::uint8_t>(c == 3 ? 255 : (x + (c == 0 ? y : 0)) * 2);
    const std::vector<unsigned char> bytes = encodedJpeg(ramp, 95, "test");
    const Image8 again = readImage8FromMemory(std::as_bytes(std::span(bytes)), "test");
    EXPECT_EQ(again.channels, 3);
    // A ramp is what JPEG does well: its error is of the order of a code.
    EXPECT_LT(rmse(withoutAlpha(ramp), again), 2.0 / 255);
    EXPECT_LT(encodedJpeg(ramp, 30, "test").size(), bytes.size());
}

TEST(Assets, AreCopiedWholeWithTheColoursOfTheMaps) {
    const test::TemporaryFolder folder;
    constexpr std::array<std::string_view, 2> scripts = {"d3.min.js", "compare.js"};
    copyAssets(folder.path(), scripts);
    for (const char* file :
         {"style.css", "theme.js", "d3.min.js", "licences.txt", "compare.js", "error_colours.js"})
        EXPECT_TRUE(std::filesystem::is_regular_file(folder / file)) << file;
    const std::string colours = readFile(folder / "error_colours.js", 1 << 16);
    EXPECT_THAT(colours, testing::StartsWith("window.quincunxErrorColours = [0,0,"));
    EXPECT_EQ(std::count(colours.begin(), colours.end(), ','), 3 * 256 - 1);
    EXPECT_FALSE(writeIfChanged(folder / "error_colours.js", colours));
    EXPECT_TRUE(writeIfChanged(folder / "error_colours.js", "x"));
}

}  // namespace
}  // namespace quincunx::web
