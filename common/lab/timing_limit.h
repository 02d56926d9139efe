#pragma once

namespace quincunx {

/// While one lives, Studio::time draws each frame once, without warming up: for tests, which hold labs to
/// what they count and not to how long it takes.
class TimingLimit {
  public:
    TimingLimit();
    ~TimingLimit();
    TimingLimit(const TimingLimit&) = delete;
    TimingLimit& operator=(const TimingLimit&) = delete;
};

}  // namespace quincunx
