#include "image/io.h"

#include <atomic>
#include <cstdlib>
#include <mutex>
#include <string_view>
#include <thread>

#include <dlfcn.h>
#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"
#include "base/file.h"
#include "base/paths.h"
#include "image/color.h"
#include "image/header.h"
#include "image/io/module.h"

namespace quincunx {
namespace fs = std::filesystem;

namespace {

using imageio::Depth;
using imageio::Format;

constexpr const char* moduleFile = "quincunx_image_io.so";
constexpr const char* moduleVariable = "QUINCUNX_IMAGE_IO";

std::atomic<const imageio::Table*> loadedTable = nullptr;

std::vector<fs::path> modulePlaces() {
    if (const char* named = std::getenv(moduleVariable); named != nullptr && *named != '\0')
        return {named};
    return {executablePath().parent_path() / QUINCUNX_MODULE_FROM_PROGRAMS / moduleFile,
            fs::path(QUINCUNX_MODULE_BUILT) / moduleFile, fs::path(QUINCUNX_MODULE_INSTALLED) / moduleFile};
}

fs::path findModule() {
    const std::vector<fs::path> places = modulePlaces();
    std::error_code error;
    for (const fs::path& place : places)
        if (fs::is_regular_file(place, error))
            return place;
    throw EnvironmentError("the module that reads and writes pictures is missing", places.front().string(),
                           fmt::format("build it, or set {} to the file", moduleVariable));
}

const imageio::Table* loadTable() {
    const fs::path file = findModule();
    void* module = dlopen(file.c_str(), RTLD_LAZY | RTLD_LOCAL);
    if (module == nullptr)
        throw EnvironmentError(printable(dlerror()), {}, "install OpenImageIO");
    const auto entry = reinterpret_cast<imageio::Entry>(dlsym(module, imageio::entryName));
    const imageio::Table* table = entry != nullptr ? entry() : nullptr;
    if (table == nullptr || table->version != imageio::tableVersion)
        throw EnvironmentError("belongs to another version of this program", file.string(), "build it again");
    return table;
}

/// The module's functions; loads it if need be, once.
const imageio::Table& table() {
    static std::mutex mutex;
    if (const imageio::Table* ready = loadedTable.load())
        return *ready;
    const std::scoped_lock lock(mutex);
    if (loadedTable.load() == nullptr)
        loadedTable = loadTable();
    return *loadedTable.load();
}

/// Bytes that a line of the note cannot hold as they are become %XX.
std::string escaped(std::string_view text, bool isKey) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if (byte < 0x20 || byte >= 0x7F || c == '%' || (isKey && c == '='))
            result += fmt::format("%{:02X}", byte);
        else
            result += c;
    }
    return result;
}

int hexDigit(char c) {
    if (c >= '0' && c <= '9')
        return c - '0';
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

std::string unescaped(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool isEscape =
            text[i] == '%' && i + 2 < text.size() && hexDigit(text[i + 1]) >= 0 && hexDigit(text[i + 2]) >= 0;
        if (isEscape) {
            result += static_cast<char>(hexDigit(text[i + 1]) * 16 + hexDigit(text[i + 2]));
            i += 2;
        } else {
            result += text[i];
        }
    }
    return result;
}

/// The metadata as lines `key=value`.
std::string noteFrom(const ImageMetadata& metadata, const fs::path& file) {
    constexpr std::size_t maxBytes = 4 << 20;  // libpng refuses to read text chunks of 8 MB
    std::string note;
    for (const auto& [key, value] : metadata)
        note += fmt::format("{}={}\n", escaped(key, true), escaped(value, false));
    if (note.size() > maxBytes)
        throw InputError(
            fmt::format("{} bytes of metadata, more than the {} a picture can hold", note.size(), maxBytes),
            file.string());
    return note;
}

ImageMetadata metadataFrom(std::string_view note) {
    ImageMetadata metadata;
    while (!note.empty()) {
        const std::size_t end = std::min(note.find('\n'), note.size());
        const std::string_view line = note.substr(0, end);
        note.remove_prefix(std::min(end + 1, note.size()));
        const std::size_t equals = line.find('=');
        if (equals != std::string_view::npos)
            metadata.emplace_back(unescaped(line.substr(0, equals)), unescaped(line.substr(equals + 1)));
    }
    return metadata;
}

struct Picture {
    imageio::Decoded decoded;
    Format format = Format::png;
};

/// `depthFor` chooses by the format.
template <typename DepthFor>
Picture decode(std::span<const std::byte> bytes, const std::string& name, DepthFor depthFor) {
    const imageio::Header header = imageio::readHeader(bytes, name);
    if (header.width < 1 || header.height < 1)
        throw InputError("the picture has no pixels", name);
    const bool tooLarge =
        header.width > maxImageSide || header.height > maxImageSide ||
        static_cast<std::uint64_t>(header.width) * static_cast<std::uint64_t>(header.height) > maxImagePixels;
    if (tooLarge)
        throw InputError(fmt::format("{} × {} pixels, more than the {} a side and {} in all allowed",
                                     header.width, header.height, maxImageSide, maxImagePixels),
                         name, "use a smaller picture");
    Picture picture;
    picture.format = header.format;
    std::string error;
    if (!table().decode(header.format, bytes, static_cast<int>(header.width), static_cast<int>(header.height),
                        depthFor(header.format), picture.decoded, error))
        throw InputError(printable(error), name, "the picture is damaged or of a kind that cannot be read");
    return picture;
}

bool holdsFloats(Format format) {
    return format == Format::exr || format == Format::hdr;
}

std::string contents(const fs::path& file) {
    return readFile(file, maxImageFileBytes);
}

std::span<const std::byte> bytesOf(const std::string& text) {
    return std::as_bytes(std::span(text.data(), text.size()));
}

template <typename Channel>
void checkWritable(const BasicImage<Channel>& image) {
    QX_CHECK_GE(image.channels, 1);
    QX_CHECK_LE(image.channels, 4);
    QX_CHECK_GE(image.width, 1);
    QX_CHECK_GE(image.height, 1);
    QX_CHECK_EQ(image.data.size(), image.pixelCount() * static_cast<std::size_t>(image.channels));
}

[[noreturn]] void refuseExtension(const fs::path& file) {
    throw InputError("pictures are written as .png or .exr", file.string(), "name one of these");
}

using Encode = bool(std::vector<unsigned char>& bytes, std::string& error);

void writeEncoded(const fs::path& file, const std::function<Encode>& encode) {
    std::vector<unsigned char> bytes;
    std::string error;
    if (!encode(bytes, error))
        throw InputError(printable(error), file.string());
    writeFile(file, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

void writePng(const fs::path& file, const Image8& image, const std::string& note) {
    writeEncoded(file, [&](std::vector<unsigned char>& bytes, std::string& error) {
        return table().encodePng(image, note, bytes, error);
    });
}

void writeExr(const fs::path& file, const Image& image, const std::string& note) {
    writeEncoded(file, [&](std::vector<unsigned char>& bytes, std::string& error) {
        return table().encodeExr(image, note, bytes, error);
    });
}

}  // namespace

Image8 readImage8FromMemory(std::span<const std::byte> bytes, const std::string& name) {
    Picture picture = decode(
        bytes, name, [](Format format) { return holdsFloats(format) ? Depth::float32 : Depth::bits8; });
    return holdsFloats(picture.format) ? toSrgb8(picture.decoded.values) : std::move(picture.decoded.codes);
}

Image readImageFromMemory(std::span<const std::byte> bytes, const std::string& name) {
    return std::move(decode(bytes, name, [](Format) { return Depth::float32; }).decoded.values);
}

Image8 readImage8(const fs::path& file) {
    return readImage8FromMemory(bytesOf(contents(file)), file.string());
}

Image readImage(const fs::path& file) {
    return readImageFromMemory(bytesOf(contents(file)), file.string());
}

ImageKind imageKindOf(const fs::path& file) {
    const std::string extension = lowerCaseExtension(file);
    if (extension == ".png")
        return ImageKind::png;
    if (extension == ".exr")
        return ImageKind::exr;
    refuseExtension(file);
}

void writeImage(const fs::path& file, const Image8& image, const ImageMetadata& metadata) {
    checkWritable(image);
    if (imageKindOf(file) == ImageKind::png)
        writePng(file, image, noteFrom(metadata, file));
    else
        writeExr(file, toLinear(image), noteFrom(metadata, file));
}

void writeImage(const fs::path& file, const Image& image, const ImageMetadata& metadata) {
    checkWritable(image);
    if (imageKindOf(file) == ImageKind::png)
        writePng(file, toSrgb8(image), noteFrom(metadata, file));
    else if (image.encoding == Encoding::linear)
        writeExr(file, image, noteFrom(metadata, file));
    else
        writeExr(file, toLinear(image), noteFrom(metadata, file));
}

std::vector<unsigned char> encodedPng(const Image8& image, const std::string& name) {
    checkWritable(image);
    std::vector<unsigned char> bytes;
    std::string error;
    if (!table().encodePng(image, {}, bytes, error))
        throw InputError(printable(error), name);
    return bytes;
}

std::vector<unsigned char> encodedJpeg(const Image8& image, int quality, const std::string& name) {
    checkWritable(image);
    QX_CHECK(quality >= 1 && quality <= 100);
    const int colours = image.channels < 3 ? 1 : 3;
    Image8 opaque(image.width, image.height, colours, image.encoding);
    for (std::size_t i = 0; i < image.pixelCount(); ++i)
        std::copy_n(image.data.begin() + static_cast<std::ptrdiff_t>(i * image.channels), colours,
                    opaque.data.begin() + static_cast<std::ptrdiff_t>(i * colours));
    std::vector<unsigned char> bytes;
    std::string error;
    if (!table().encodeJpeg(opaque, quality, bytes, error))
        throw InputError(printable(error), name);
    return bytes;
}

ImageMetadata readMetadataFromMemory(std::span<const std::byte> bytes, const std::string& name) {
    return metadataFrom(decode(bytes, name, [](Format) { return Depth::none; }).decoded.note);
}

ImageMetadata readMetadata(const fs::path& file) {
    const std::string bytes = contents(file);
    return readMetadataFromMemory(bytesOf(bytes), file.string());
}

void preloadImageIo() {
    // glibc runs the thread_local destructors of the thread that calls exit() before all others: the loading
    // is over before the destructors of what it loads.
    static std::once_flag once;
    thread_local std::jthread loading;
    std::call_once(once, [] {
        loading = std::jthread([] {
            try {
                table();
            } catch (const Error&) {
                // the read or write that needs the module throws the same
            }
        });
    });
}

bool imageIoLoaded() {
    return loadedTable.load() != nullptr;
}

}  // namespace quincunx
