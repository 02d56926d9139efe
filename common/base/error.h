#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace quincunx {

/// What a program tells its caller through its exit status.
enum class ExitStatus : int {
    ok = 0,
    checkFellShort = 1,  ///< a measured figure missed its bound
    badInput = 2,        ///< wrong use, or a file that cannot be used
    notPossibleHere = 3  ///< the machine lacks a backend, a display, a device
};

/// The world did not deliver. `what()` is one line: "WHERE: WHAT; REMEDY", with empty parts left out.
class Error : public std::runtime_error {
  public:
    /// `what`: the fault itself. `where`: file, file:line, flag or object. `remedy`: what to do about it.
    explicit Error(std::string_view what, std::string_view where = {}, std::string_view remedy = {});
    virtual ExitStatus exitStatus() const { return ExitStatus::badInput; }
};

/// Wrong use of the program or a file that cannot be used.
class InputError : public Error {
  public:
    using Error::Error;
};

/// The machine cannot do it: no backend, no display, no memory on the device.
class EnvironmentError : public Error {
  public:
    using Error::Error;
    ExitStatus exitStatus() const override { return ExitStatus::notPossibleHere; }
};

/// The user asked to stop (Ctrl-C, SIGTERM); nothing is left half written.
class Interrupted : public Error {
  public:
    Interrupted() : Error("interrupted") {}
};

/// Writes a line to stderr. Never throws: where stderr is closed or full there is nobody to tell.
void say(const std::string& line) noexcept;

/// `text` fit for one line of an error message: control characters escaped, cut after `maxLength` bytes.
std::string printable(std::string_view text, std::size_t maxLength = 200);

}  // namespace quincunx
