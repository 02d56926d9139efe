#include "image/io/module.h"

#include <cstdlib>
#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <dlfcn.h>

namespace quincunx::imageio {
namespace {

constexpr const char* noteName = "Quincunx";

const char* name(Format format) {
    switch (format) {
        case Format::png:
            return "png";
        case Format::jpeg:
            return "jpeg";
        case Format::webp:
            return "webp";
        case Format::exr:
            return "openexr";
        case Format::hdr:
            return "hdr";
    }
    return "";
}

bool fail(std::string& error, std::string text) {
    error = text.empty() ? "cannot be decoded" : std::move(text);
    return false;
}

/// `work()`, with whatever is thrown turned into text.
template <typename Work>
bool guarded(std::string& error, Work work) {
    try {
        return work();
    } catch (const std::bad_alloc&) {
        return fail(error, "not enough memory");
    } catch (const std::exception& e) {
        return fail(error, e.what());
    } catch (...) {
        return fail(error, "the decoder failed");
    }
}

template <typename Channel>
bool readPixels(OIIO::ImageInput& input, Encoding encoding, BasicImage<Channel>& image) {
    const OIIO::ImageSpec& spec = input.spec();
    image = BasicImage<Channel>(spec.width, spec.height, spec.nchannels, encoding);
    return input.read_image(0, 0, 0, spec.nchannels, OIIO::BaseTypeFromC<Channel>::value, image.data.data());
}

/// Codes of the file divided by the largest: OpenImageIO multiplies by a rounded 1/255 instead.
template <typename Code>
bool readFractions(OIIO::ImageInput& input, Encoding encoding, Image& image) {
    BasicImage<Code> codes;
    if (!readPixels(input, encoding, codes))
        return false;
    image = Image(codes.width, codes.height, codes.channels, encoding);
    for (std::size_t i = 0; i < codes.data.size(); ++i)
        image.data[i] = static_cast<float>(codes.data[i]) / std::numeric_limits<Code>::max();
    return true;
}

bool readFloats(OIIO::ImageInput& input, Encoding encoding, Image& image) {
    if (input.spec().format == OIIO::TypeUInt8)
        return readFractions<std::uint8_t>(input, encoding, image);
    if (input.spec().format == OIIO::TypeUInt16)
        return readFractions<std::uint16_t>(input, encoding, image);
    return readPixels(input, encoding, image);
}

/// What libpng last complained of in this thread.
thread_local std::string pngComplaint;

using PngHandler = void (*)(void* png, const char* message);

[[noreturn]] void stopPng(void* png, const char* message) {
    pngComplaint = message;
    using Jump = void (*)(void*, int);
    static const auto jump = reinterpret_cast<Jump>(dlsym(RTLD_NEXT, "png_longjmp"));
    jump(png, 1);
    std::abort();
}

void ignorePngWarning(void*, const char*) {}

bool decode(Format format, std::span<const std::byte> bytes, int width, int height, Depth depth,
            Decoded& result, std::string& error) {
    return guarded(error, [&] {
        pngComplaint.clear();
        const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::create(name(format));
        if (!input)
            return fail(error, OIIO::geterror());
        OIIO::Filesystem::IOMemReader reader(bytes.data(), bytes.size());
        if (!input->set_ioproxy(&reader))
            return fail(error, "this OpenImageIO cannot read the format from memory");
        OIIO::ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1);
        OIIO::ImageSpec spec;
        if (!input->open("", spec, config))
            return fail(error, input->geterror());
        if (spec.width != width || spec.height != height || spec.depth > 1)
            return fail(error, "the header contradicts itself");
        if (spec.nchannels < 1 || spec.nchannels > 4)
            return fail(error, std::to_string(spec.nchannels) + " channels; 1 to 4 can be read");
        result.note = spec.get_string_attribute(noteName);
        const bool linear = format == Format::exr || format == Format::hdr ||
                            spec.get_string_attribute("oiio:ColorSpace") == "Linear";
        const Encoding encoding = linear ? Encoding::linear : Encoding::srgb;
        const bool read =
            depth == Depth::none || (depth == Depth::bits8 ? readPixels(*input, encoding, result.codes)
                                                           : readFloats(*input, encoding, result.values));
        return read ||
               fail(error, format == Format::png && !pngComplaint.empty() ? pngComplaint : input->geterror());
    });
}

template <typename Channel>
bool encode(const char* format, OIIO::ImageSpec spec, const BasicImage<Channel>& image,
            const std::string& note, std::vector<unsigned char>& bytes, std::string& error) {
    return guarded(error, [&] {
        const std::unique_ptr<OIIO::ImageOutput> output = OIIO::ImageOutput::create(format);
        if (!output)
            return fail(error, OIIO::geterror());
        bytes.clear();
        OIIO::Filesystem::IOVecOutput writer(bytes);
        if (!output->set_ioproxy(&writer))
            return fail(error, "this OpenImageIO cannot write the format to memory");
        if (!note.empty())
            spec.attribute(noteName, note);
        const bool written = output->open("", spec) && output->write_image(spec.format, image.data.data());
        return (written && output->close()) || fail(error, output->geterror());
    });
}

bool encodePng(const Image8& image, const std::string& note, std::vector<unsigned char>& bytes,
               std::string& error) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeUInt8);
    spec.attribute("oiio:UnassociatedAlpha", 1);
    spec.attribute("oiio:ColorSpace", image.encoding == Encoding::srgb ? "sRGB" : "Linear");
    return encode("png", std::move(spec), image, note, bytes, error);
}

bool encodeExr(const Image& image, const std::string& note, std::vector<unsigned char>& bytes,
               std::string& error) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeFloat);
    if (image.channels == 2)
        spec.channelnames = {"Y", "A"};
    spec.attribute("oiio:ColorSpace", "Linear");
    spec.attribute("compression", "zip");
    // The same picture is the same file: no time of writing.
    spec.attribute("DateTime", "1970:01:01 00:00:00");
    return encode("openexr", std::move(spec), image, note, bytes, error);
}

bool encodeJpeg(const Image8& image, int quality, std::vector<unsigned char>& bytes, std::string& error) {
    OIIO::ImageSpec spec(image.width, image.height, image.channels, OIIO::TypeUInt8);
    spec.attribute("compression", "jpeg:" + std::to_string(quality));
    spec.attribute("oiio:ColorSpace", image.encoding == Encoding::srgb ? "sRGB" : "Linear");
    return encode("jpeg", std::move(spec), image, {}, bytes, error);
}

}  // namespace
}  // namespace quincunx::imageio

// The error handler that OpenImageIO 2.4 gives to libpng returns, whereupon libpng prints to stderr. As this
// module comes before its dependencies in the order that symbols are looked up, OpenImageIO calls this
// function instead of libpng's.
extern "C" __attribute__((visibility("default"))) void png_set_error_fn(void* png, void* errorPointer,
                                                                        quincunx::imageio::PngHandler,
                                                                        quincunx::imageio::PngHandler) {
    using namespace quincunx::imageio;
    using Set = void (*)(void*, void*, PngHandler, PngHandler);
    static const auto set = reinterpret_cast<Set>(dlsym(RTLD_NEXT, "png_set_error_fn"));
    set(png, errorPointer, &stopPng, &ignorePngWarning);
}

extern "C" __attribute__((visibility("default"))) const quincunx::imageio::Table* quincunxImageIo() {
    static const quincunx::imageio::Table table = [] {
        OIIO::attribute("threads", 1);
        OIIO::attribute("exr_threads", -1);
        OIIO::attribute("limits:channels", 64);
        return quincunx::imageio::Table{quincunx::imageio::tableVersion, quincunx::imageio::decode,
                                        quincunx::imageio::encodePng, quincunx::imageio::encodeExr,
                                        quincunx::imageio::encodeJpeg};
    }();
    return &table;
}
