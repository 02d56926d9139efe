#include "grade/channel.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include <poll.h>
#include <unistd.h>

namespace quincunx::grade {
namespace {

struct Lengths {
    std::uint64_t magic = 0x51434e58;
    std::uint64_t header = 0;
    std::uint64_t blob = 0;
};

constexpr std::uint64_t maxHeader = std::uint64_t{8} << 20;
constexpr std::uint64_t maxBlob = std::uint64_t{1} << 30;
constexpr std::size_t chunk = 1 << 20;

bool writeAll(int pipe, const char* from, std::size_t count) {
    while (count > 0) {
        const ssize_t written = write(pipe, from, count);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            return false;
        from += written;
        count -= static_cast<std::size_t>(written);
    }
    return true;
}

using Deadline = std::optional<std::chrono::steady_clock::time_point>;

bool readAll(int pipe, char* to, std::size_t count, const Deadline& deadline) {
    while (count > 0) {
        if (deadline) {
            const auto left =
                std::chrono::ceil<std::chrono::milliseconds>(*deadline - std::chrono::steady_clock::now());
            pollfd stream{pipe, POLLIN, 0};
            const int ready = poll(&stream, 1, static_cast<int>(std::max<std::int64_t>(left.count(), 0)));
            if (ready < 0 && errno == EINTR)
                continue;
            if (ready <= 0)
                return false;
        }
        const ssize_t got = read(pipe, to, count);
        if (got < 0 && errno == EINTR)
            continue;
        if (got <= 0)
            return false;
        to += got;
        count -= static_cast<std::size_t>(got);
    }
    return true;
}

/// Grows as bytes come: a length that is a lie allocates little.
bool readText(int pipe, std::string& text, std::uint64_t count, const Deadline& deadline) {
    while (text.size() < count) {
        const std::size_t before = text.size();
        text.resize(before + std::min<std::uint64_t>(std::max(chunk, before), count - before));
        if (!readAll(pipe, text.data() + before, text.size() - before, deadline))
            return false;
    }
    return true;
}

}  // namespace

bool send(int pipe, const Message& message) {
    Json header = message.header;
    header["kind"] = message.kind;
    const std::string text = header.dump(-1, ' ', false, Json::error_handler_t::replace);
    const Lengths lengths{.header = text.size(), .blob = message.blob.size()};
    return text.size() <= maxHeader && message.blob.size() <= maxBlob &&
           writeAll(pipe, reinterpret_cast<const char*>(&lengths), sizeof lengths) &&
           writeAll(pipe, text.data(), text.size()) &&
           writeAll(pipe, message.blob.data(), message.blob.size());
}

std::optional<Message> receive(int pipe, Deadline deadline) {
    Lengths lengths;
    if (!readAll(pipe, reinterpret_cast<char*>(&lengths), sizeof lengths, deadline) ||
        lengths.magic != Lengths{}.magic || lengths.header > maxHeader || lengths.blob > maxBlob)
        return {};
    std::string text;
    Message message;
    if (!readText(pipe, text, lengths.header, deadline) ||
        !readText(pipe, message.blob, lengths.blob, deadline))
        return {};
    message.header = Json::parse(text, nullptr, false);
    if (!message.header.is_object() || !message.header.contains("kind") ||
        !message.header["kind"].is_string())
        return {};
    message.kind = message.header["kind"].get<std::string>();
    return message;
}

}  // namespace quincunx::grade
