#pragma once

#include <cstdint>
#include <string>

namespace quincunx::grade {

/// What a process that handles a submission may use.
struct ProcessLimits {
    int cpuSeconds = 60;  ///< of all threads, beyond what was used when the limits begin
    std::uint64_t memoryBytes = std::uint64_t{3} << 30;  ///< beyond what is mapped when the limits begin
};

/// Sets the limits of this process: CPU time, memory, no core file, no file written. Under AddressSanitizer,
/// which reserves all addresses there are, memory stays as it is. EnvironmentError if the system refuses.
void limitProcess(const ProcessLimits& limits);

/// From here on no thread of this process opens a file or a socket, starts a program or a process, or signals
/// another: each such call fails with EPERM (seccomp; an allow list of what computing, threads and the pipes
/// that are open need). EnvironmentError if the kernel has no such filter.
void closeSandbox();

}  // namespace quincunx::grade
