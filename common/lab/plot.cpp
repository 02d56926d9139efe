#include "lab/plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/wait.h>

#include "base/error.h"
#include "base/file.h"
#include "base/interrupt.h"

namespace quincunx {
namespace {

/// `text` as a single-quoted gnuplot string.
std::string gnuplotString(std::string_view text) {
    std::string result = "'";
    for (const char c : text)
        result += c == '\'' ? "''" : std::string(1, c == '\n' ? ' ' : c);
    return result + "'";
}

/// Two lines as a double-quoted gnuplot string.
std::string gnuplotLines(std::string_view first, std::string_view second) {
    const auto escaped = [](std::string_view line) {
        std::string text;
        for (const char c : line) {
            if (c == '"' || c == '\\')
                text += '\\';
            text += c == '\n' ? ' ' : c == '`' ? '\'' : c;  // gnuplot runs what stands between backquotes
        }
        return text;
    };
    return fmt::format("\"{}\\n{}\"", escaped(first), escaped(second));
}

/// Numbers at 2 and 5 in each decade, for an axis of few decades.
std::string finerTics(char axis, double low, double high) {
    constexpr double fewDecades = 100;
    if (high / low > fewDecades)
        return "";
    std::vector<std::string> places;
    const int firstDecade = static_cast<int>(std::floor(std::log10(low)));
    const int lastDecade = static_cast<int>(std::floor(std::log10(high)));
    for (int decade = firstDecade; decade <= lastDecade; ++decade)
        for (const int digit : {2, 5})
            if (const double place = digit * std::pow(10.0, decade); place >= low && place <= high)
                places.push_back(fmt::format("{:g}", place));
    return places.empty() ? "" : fmt::format("set {}tics add ({})\n", axis, fmt::join(places, ", "));
}

/// `text` as one double-quoted word of inline data.
std::string dataWord(std::string_view text) {
    std::string result = "\"";
    for (const char c : text)
        result += c == '"' || c == '\n' ? ' ' : c;
    return result + "\"";
}

/// True if every point has the same value of its knob number `index`.
bool isConstant(const SweepResult& result, std::size_t index) {
    return std::all_of(result.points.begin(), result.points.end(), [&](const SweepPoint& point) {
        return point.knobs[index] == result.points.front().knobs[index];
    });
}

/// How many knobs two points have different values of.
std::size_t changedKnobs(const SweepPoint& a, const SweepPoint& b) {
    std::size_t changed = 0;
    for (std::size_t i = 0; i < a.knobs.size(); ++i)
        changed += a.knobs[i] != b.knobs[i] ? 1 : 0;
    return changed;
}

/// The values of the knobs that vary, but for the first, whose value is the colour.
std::string labelOf(const SweepResult& result, const SweepPoint& point) {
    std::vector<std::string> values;
    for (std::size_t i = 1; i < point.knobs.size(); ++i)
        if (!isConstant(result, i))
            values.push_back(point.knobs[i].second);
    return fmt::format("{}", fmt::join(values, " "));
}

/// What the labels' numbers are, and the knobs that stay the same.
std::string legend(const SweepResult& result) {
    std::vector<std::string> varying;
    std::vector<std::string> constant;
    const KnobValues& knobs = result.points.front().knobs;
    for (std::size_t i = 1; i < knobs.size(); ++i)
        if (isConstant(result, i))
            constant.push_back(fmt::format("{}={}", knobs[i].first, knobs[i].second));
        else
            varying.push_back(knobs[i].first);
    std::string text;
    if (!varying.empty())
        text = fmt::format("at the points: {}", fmt::join(varying, ", "));
    if (!constant.empty())
        text += fmt::format("{}{}", text.empty() ? "" : "; ", fmt::join(constant, ", "));
    return text;
}

/// Zero errors have no place on a logarithmic axis: they are drawn a decade below the smallest other one.
double floorOfErrors(const SweepResult& result) {
    double smallest = std::numeric_limits<double>::infinity();
    for (const SweepPoint& point : result.points)
        if (point.sample.error > 0)
            smallest = std::min(smallest, point.sample.error);
    return std::isfinite(smallest) ? smallest / 10 : 1e-12;
}

std::string script(const SweepResult& result, const std::filesystem::path& output) {
    constexpr std::array colours = {"#0b6fb8", "#d1661b", "#2b8a57", "#8a4fb0", "#b8860b", "#b3364b"};
    const double floor = floorOfErrors(result);
    std::vector<std::string> series;
    for (const SweepPoint& point : result.points)
        if (std::find(series.begin(), series.end(), point.knobs.front().second) == series.end())
            series.push_back(point.knobs.front().second);

    const auto row = [&](const SweepPoint& point) {
        return fmt::format("{:.9g} {:.9g} {}\n", point.sample.seconds * 1e3,
                           std::max(point.sample.error, floor), dataWord(labelOf(result, point)));
    };
    std::string text = "set encoding utf8\n";
    std::vector<std::string> plots;

    std::vector<SweepPoint> front;
    std::copy_if(result.points.begin(), result.points.end(), std::back_inserter(front),
                 [](const SweepPoint& point) { return point.pareto; });
    std::sort(front.begin(), front.end(),
              [](const SweepPoint& a, const SweepPoint& b) { return a.sample.seconds < b.sample.seconds; });
    text += "$front << EOD\n";
    for (const SweepPoint& point : front)
        text += row(point);
    text += "EOD\n";
    plots.emplace_back("$front using 1:2 with lines lw 9 lc rgb '#e6d58a' title 'Pareto front'");

    for (std::size_t i = 0; i < series.size(); ++i) {
        text += fmt::format("$series{} << EOD\n", i);
        const SweepPoint* last = nullptr;
        for (const SweepPoint& point : result.points) {
            if (point.knobs.front().second != series[i])
                continue;
            if (last != nullptr && changedKnobs(*last, point) > 1)
                text += "\n";  // another line of the same colour
            text += row(point);
            last = &point;
        }
        text += "EOD\n";
        const char* colour = colours[i % colours.size()];
        plots.push_back(
            fmt::format("$series{} using 1:2 with linespoints lw 2 pt 7 ps 0.7 lc rgb '{}' title {}", i,
                        colour, gnuplotString(series[i])));
        plots.push_back(fmt::format(
            "$series{} using 1:2:3 with labels left offset 0.6,0.5 font ',10' tc rgb '{}' notitle", i,
            colour));
    }
    std::pair<double, double> times{std::numeric_limits<double>::infinity(), 0};
    std::pair<double, double> errors = times;
    for (const SweepPoint& point : result.points) {
        const double milliseconds = point.sample.seconds * 1e3;
        const double error = std::max(point.sample.error, floor);
        times = {std::min(times.first, milliseconds), std::max(times.second, milliseconds)};
        errors = {std::min(errors.first, error), std::max(errors.second, error)};
    }
    const std::string unit = result.errorUnit.empty() ? "" : fmt::format(" ({})", result.errorUnit);
    const std::pair<double, double> xRange{times.first / 1.5, times.second * 2.2};
    const std::pair<double, double> yRange{errors.first / 1.6, errors.second * 2.0};
    text += fmt::format(
        "set terminal svg size 960,640 dynamic noenhanced font 'DejaVu Sans,13' background '#ffffff'\n"
        "set output {}\n"
        "set title {} font ',15'\n"
        "set xlabel 'time (ms)'\n"
        "set ylabel {}\n"
        "set label {} at screen 0.99,0.015 right font ',9' tc rgb '#666666'\n"
        "set label {} at screen 0.01,0.015 left font ',9' tc rgb '#666666'\n"
        "set logscale xy\nset format x '%g'\nset format y '%g'\n"
        "set xrange [{:g}:{:g}]\nset yrange [{:g}:{:g}]\n"
        "{}{}"
        "set grid lc rgb '#dddddd'\nset border 3 lc rgb '#444444'\nset tics nomirror\n"
        "set key outside top right title {} font ',11'\nset bmargin 4.5\n"
        "plot {}\n",
        gnuplotString(output.string()), gnuplotString(fmt::format("{}: {}", result.lab, result.title)),
        gnuplotLines(fmt::format("{}{}", result.metric, unit), fmt::format("against {}", result.reference)),
        gnuplotString(fmt::format("measured on {}", result.renderer)), gnuplotString(legend(result)),
        xRange.first, xRange.second, yRange.first, yRange.second, finerTics('x', xRange.first, xRange.second),
        finerTics('y', yRange.first, yRange.second), gnuplotString(result.points.front().knobs.front().first),
        fmt::join(plots, ", \\\n"));
    return text;
}

}  // namespace

void writePlotSvg(const SweepResult& result, const std::filesystem::path& file) {
    writeAtomically(file, [&](const std::filesystem::path& temporary) {
        std::FILE* gnuplot = popen("exec gnuplot 2>/dev/null", "w");
        if (gnuplot == nullptr)
            throw EnvironmentError("gnuplot cannot be started", {}, "install gnuplot-nox");
        const std::string text = script(result, temporary);
        std::fwrite(text.data(), 1, text.size(), gnuplot);
        const int status = pclose(gnuplot);
        throwIfInterrupted();
        std::error_code error;
        if (WIFEXITED(status) && WEXITSTATUS(status) == 127)
            throw EnvironmentError("gnuplot is missing", {}, "install gnuplot-nox");
        if (status != 0 || std::filesystem::file_size(temporary, error) == 0 || error)
            throw InputError("gnuplot could not write the plot", file.string(),
                             "choose another place with --out");
    });
}

}  // namespace quincunx
