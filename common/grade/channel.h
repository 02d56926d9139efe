#pragma once

#include <chrono>
#include <optional>
#include <string>

#include "lab/json.h"

namespace quincunx::grade {

/// What the program and the processes that handle submissions say to each other.
struct Message {
    std::string kind;
    Json header = Json::object();
    std::string blob;  ///< bytes, as the header describes
};

/// Writes the message to a pipe; false if nobody reads.
bool send(int pipe, const Message& message);

/// The next message; nothing at the end of the stream, when the time is up, or for bytes that are no message:
/// more than 8 MiB of header or 1 GiB of bytes, no JSON.
std::optional<Message> receive(int pipe, std::optional<std::chrono::steady_clock::time_point> deadline = {});

}  // namespace quincunx::grade
