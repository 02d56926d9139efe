#pragma once

#include <cstdio>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

namespace quincunx {

/// The usual table, then one line a routine with the ratio.
class RatioReporter : public benchmark::ConsoleReporter {
  public:
    void ReportRuns(const std::vector<Run>& runs) override {
        ConsoleReporter::ReportRuns(runs);
        for (const Run& run : runs) {
            const bool median = run.run_type == Run::RT_Aggregate && run.aggregate_name == "median";
            if (run.error_occurred || (run.run_type == Run::RT_Aggregate && !median))
                continue;
            const std::string name = run.run_name.function_name;
            const auto perItem = 1e9 / run.counters.at("items_per_second");
            (name.ends_with("/naive") ? times_[name.substr(0, name.find('/'))].first
                                      : times_[name.substr(0, name.find('/'))].second) = perItem;
        }
    }

    void printRatios() const {
        std::printf("\n%-24s %10s %10s %8s\n", "routine", "naive ns", "stable ns", "ratio");
        for (const auto& [routine, time] : times_)
            std::printf("%-24s %10.2f %10.2f %7.2fx\n", routine.c_str(), time.first, time.second,
                        time.second / time.first);
    }

  private:
    std::map<std::string, std::pair<double, double>> times_;
};

}  // namespace quincunx
