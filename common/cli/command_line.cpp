#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <limits>
#include <new>
#include <system_error>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "atlas/atlas.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "grade/verbs.h"
#include "grade/worker.h"
#include "lab/picture_state.h"
#include "lab/verbs.h"

namespace quincunx {
namespace {

constexpr int interruptedStatus = 130;  // 128 + SIGINT, as shells have it

constexpr std::array verbs = {"list",    "run",  "ask",   "sweep", "plan",   "stress",
                              "compare", "deck", "atlas", "grade", "handout"};

/// The program calls itself so, for each job of `grade`.
constexpr std::string_view workerVerb = "grade-worker";

const char* about =
    "Computer-graphics labs that measure what they teach.\n"
    "A LAB is named by number, name or both: 10, shading, 10_shading.";

/// The lab that the words name, so that its knobs become flags before they are parsed. Null if none is named.
const LabEntry* mentionedLab(std::span<const LabEntry> labs, const std::vector<std::string>& words) {
    for (const std::string& word : words)
        for (const LabEntry& entry : labs)
            if (entry.isCalled(word))
                return &entry;
    return nullptr;
}

/// The lab that shows files as `plan` wants them; null if there is none.
const LabEntry* labForFiles(std::span<const LabEntry> labs) {
    const auto found = std::find_if(labs.rbegin(), labs.rend(),
                                    [](const LabEntry& entry) { return entry.make()->plansFiles(); });
    return found == labs.rend() ? nullptr : &*found;
}

/// Whether `plan` is asked for a file: whatever ends as one that can be imported, or lies in a folder.
bool namesModel(std::string_view word) {
    const std::string extension = lowerCaseExtension(std::filesystem::path(word));
    return extension == ".gltf" || extension == ".glb" || extension == ".obj" ||
           word.find('/') != std::string_view::npos;
}

/// Each knob as a flag; what is given is set at once, and noted in `given`.
void addKnobs(CLI::App& command, KnobSet& knobs, KnobValues& given) {
    for (Knob* knob : knobs.all())
        command
            .add_option_function<std::string>(
                "--" + knob->name(),
                [knob, &given](const std::string& text) {
                    knob->parse(text);
                    given.emplace_back(knob->name(), knob->text());
                },
                knob->help())
            ->type_name(knob->allowed() + (knob->unit().empty() ? "" : " " + knob->unit()))
            ->default_str(knob->defaultText())
            ->group("Knobs");
}

/// `--mirror` alone means `--mirror=on`, whatever word comes next but a value.
void completeSwitches(std::vector<std::string>& words, const KnobSet& knobs) {
    static constexpr std::array<std::string_view, 6> values = {"on", "off", "true", "false", "1", "0"};
    for (std::size_t i = 0; i < words.size(); ++i)
        for (const Knob* knob : knobs.all()) {
            const bool bare =
                dynamic_cast<const BoolKnob*>(knob) != nullptr && words[i] == "--" + knob->name();
            const bool valued =
                i + 1 < words.size() && std::find(values.begin(), values.end(), words[i + 1]) != values.end();
            if (bare && !valued)
                words[i] += "=on";
        }
}

/// A number in [min, max]; InputError naming the flag otherwise, also for NaN.
template <typename Number>
Number parseNumber(std::string_view flag, std::string_view text, Number min, Number max) {
    Number value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !(value >= min && value <= max))
        throw InputError(fmt::format("\"{}\" is not a value", printable(text, 40)), flag,
                         fmt::format("give {} … {}", min, max));
    return value;
}

/// A flag that takes a number.
template <typename Number, typename Target>
CLI::Option* addNumber(CLI::App& command, const std::string& flag, Target& target, Number min, Number max,
                       const std::string& help) {
    return command.add_option_function<std::string>(
        flag,
        [flag, min, max, &target](const std::string& text) { target = parseNumber(flag, text, min, max); },
        help);
}

constexpr std::uint64_t maxSeed = std::numeric_limits<std::uint64_t>::max();
constexpr double maxDouble = std::numeric_limits<double>::max();

void parseSize(std::string_view text, DrawOptions& options) {
    const std::size_t x = text.find('x');
    const auto side = [](std::string_view digits) {
        return parseNumber("--size", digits, 1, maxPictureSide);
    };
    if (x == std::string_view::npos)
        throw InputError(fmt::format("\"{}\" is no size", printable(text, 40)), "--size",
                         "give WxH in pixels");
    options.width = side(text.substr(0, x));
    options.height = side(text.substr(x + 1));
}

void addBackend(CLI::App& command, gl::Backend& backend, bool window) {
    command
        .add_option_function<std::string>(
            "--backend", [&backend](const std::string& name) { backend = gl::parseBackend(name); },
            "Where to draw")
        ->type_name(window ? "auto|osmesa|egl|window" : "auto|osmesa|egl")
        ->default_str("auto");
}

void addFrame(CLI::App& command, DrawOptions& options) {
    command
        .add_option_function<std::string>(
            "--size", [&options](const std::string& text) { parseSize(text, options); },
            "Size of the picture")
        ->type_name("WxH");
    addNumber(command, "--seed", options.seed, std::uint64_t{0}, maxSeed, "Of all random numbers")
        ->type_name("N");
}

/// Inserts the verb `run` where the program of a single lab is given none.
std::vector<std::string> withVerb(std::vector<std::string> words) {
    const bool given =
        !words.empty() && (words.front() == workerVerb || words.front() == "--version" ||
                           std::find(verbs.begin(), verbs.end(), words.front()) != verbs.end());
    if (!given)
        words.insert(words.begin(), "run");
    return words;
}

/// `only`: the lab of a program of its own; null for the program with all labs.
int dispatch(std::vector<std::string> words, std::span<const LabEntry> labs, const LabEntry* only) {
    if (!words.empty() && words.front() == workerVerb)
        return grade::runWorker(labs);
    CLI::App app(about, only != nullptr ? only->folder() : "quincunx");
    app.set_version_flag("--version", "quincunx " QUINCUNX_VERSION);
    app.require_subcommand(0, 1);

    const LabEntry* mentioned = only != nullptr ? only : mentionedLab(labs, words);
    if (mentioned == nullptr && !words.empty() && words.front() == "plan" &&
        std::any_of(words.begin() + 1, words.end(), namesModel))
        mentioned = labForFiles(labs);
    const std::unique_ptr<Lab> lab = mentioned != nullptr ? mentioned->make() : nullptr;
    std::string labName;
    ExitStatus status = ExitStatus::ok;

    KnobValues given;
    const auto labVerb = [&](const char* verb, const char* help, bool withKnobs = true) {
        CLI::App* command = app.add_subcommand(verb, help);
        if (only == nullptr)
            command->add_option("LAB", labName, "Number, name or both")->required();
        if (lab && withKnobs)
            addKnobs(*command, lab->knobs(), given);
        if (!lab)
            command->allow_extras();  // the unknown lab is the error to tell, not its flags
        return command;
    };
    // Reports an unknown lab, and words after a known one that another lab's name had hidden.
    const auto chosen = [&]() -> const LabEntry& {
        if (only != nullptr)
            return *only;
        const LabEntry& entry = findLab(labs, labName);
        if (&entry != mentioned)
            throw InputError(
                fmt::format("two labs are named, {} and {}", mentioned->folder(), entry.folder()), {},
                "name the lab right after the verb");
        return entry;
    };
    bool listJson = false;
    CLI::App* listCommand = app.add_subcommand("list", "The labs, their topics and their questions");
    listCommand->add_flag("--json", listJson, "Machine-readable");
    listCommand->callback([&] { list(labs, listJson); });

    RunOptions runOptions;
    CLI::App* runCommand = labVerb("run", "Draw a lab: in a window or, without a display, into out/");
    addBackend(*runCommand, runOptions.draw.backend, true);
    addFrame(*runCommand, runOptions.draw);
    runCommand->add_option("--out", runOptions.draw.out, "Draw offscreen into this PNG or EXR")
        ->type_name("FILE");
    runCommand->add_option("--model", runOptions.draw.model, "Draw this OBJ, glTF or GLB file")
        ->type_name("FILE");
    runCommand->add_option("--record", runOptions.record, "Write all that the picture depends on")
        ->type_name("FILE");
    runCommand
        ->add_option("--replay", runOptions.replay, "Draw what a record, or the record in a PNG, describes")
        ->type_name("FILE");
    runCommand->add_flag("--json", runOptions.draw.json, "Machine-readable");
    runCommand->callback([&] {
        const LabEntry& entry = chosen();
        runOptions.knobs = given;
        run(*lab, entry, runOptions);
    });

    int question = 0;
    DrawOptions askOptions;
    CLI::App* askCommand =
        app.add_subcommand("ask", "Answer an exam question, with the figures that prove it");
    addNumber(*askCommand, "QUESTION", question, 1, std::numeric_limits<int>::max(), "Its number")
        ->required()
        ->type_name("N");
    addBackend(*askCommand, askOptions.backend, false);
    askCommand->add_flag("--json", askOptions.json, "Machine-readable");
    askCommand->callback([&] { status = ask(labs, question, askOptions); });

    SweepOptions sweepOptions;
    CLI::App* sweepCommand = labVerb("sweep", "Error against time: table, CSV and SVG");
    addBackend(*sweepCommand, sweepOptions.draw.backend, false);
    addFrame(*sweepCommand, sweepOptions.draw);
    sweepCommand->add_option("--sweep", sweepOptions.only, "Only this one")->type_name("NAME");
    sweepCommand->add_option("--out", sweepOptions.draw.out, "Folder for CSV and SVG")
        ->type_name("FOLDER")
        ->default_str("out");
    std::optional<double> budgetMs;
    addNumber(*sweepCommand, "--budget-ms", budgetMs, 0.0, maxDouble,
              "Pick the most accurate setting within this time")
        ->type_name("MS");
    addNumber(*sweepCommand, "--max-error", sweepOptions.maxError, 0.0, maxDouble,
              "Pick the fastest setting within this error")
        ->type_name("E");
    sweepCommand->add_flag("--json", sweepOptions.draw.json, "Machine-readable");
    sweepCommand->callback([&] {
        const LabEntry& entry = chosen();
        if (budgetMs)
            sweepOptions.budgetSeconds = *budgetMs / 1e3;
        status = sweep(*lab, entry, sweepOptions);
    });

    PlanOptions planOptions;
    std::string planned;
    CLI::App* planCommand =
        app.add_subcommand("plan", "Which effects a frame calls for, why, and what each costs it");
    CLI::Option* const target =
        planCommand->add_option("TARGET", planned, "A lab, or an OBJ, glTF or GLB file");
    if (only == nullptr)
        target->required();
    if (lab)
        addKnobs(*planCommand, lab->knobs(), given);
    else
        planCommand->allow_extras();
    addBackend(*planCommand, planOptions.draw.backend, false);
    addFrame(*planCommand, planOptions.draw);
    planCommand->add_option("--model", planOptions.draw.model, "The lab draws this file")->type_name("FILE");
    planCommand->add_flag("--graph", planOptions.graph, "Print the frame's graph for Graphviz instead");
    planCommand
        ->add_option("--frames", planOptions.frames,
                     "Frames that each variant is timed over; without it as many as take some seconds in all")
        ->check(CLI::Range(1, 10000));
    planCommand->add_flag("--json", planOptions.draw.json, "Machine-readable");
    planCommand->callback([&] {
        if (planOptions.graph && planOptions.draw.json)
            throw InputError("are two forms of one answer", "--graph and --json", "leave one out");
        if (namesModel(planned)) {
            if (!lab || !lab->plansFiles())
                throw InputError("no lab here plans files", printable(planned, 60), "name a lab");
            planOptions.draw.model = planned;
        } else if (only != nullptr && !planned.empty()) {
            throw InputError(fmt::format("\"{}\" is no OBJ, glTF or GLB file", printable(planned, 60)),
                             "plan", "name one, or nothing");
        } else {
            labName = planned;
            chosen();
        }
        plan(*lab, *mentioned, planOptions);
    });

    StressOptions stressOptions;
    CLI::App* stressCommand = labVerb("stress", "Hard cases: naive error, stable error, bound", false);
    stressCommand->add_flag("--full", stressOptions.full, "A million inputs a routine");
    stressCommand->add_option("--seed", stressOptions.seed, "Of the inputs")
        ->type_name("N")
        ->default_str("1");
    stressCommand->add_flag("--json", stressOptions.json, "Machine-readable");
    stressCommand->callback([&] {
        const LabEntry& entry = chosen();
        status = stress(*lab, entry, stressOptions);
    });

    CompareOptions compareOptions;
    CLI::App* compareCommand = app.add_subcommand("compare", "One figure for two pictures, and an error map");
    compareCommand->add_option("A", compareOptions.first, "Reference picture")->required();
    compareCommand->add_option("B", compareOptions.second, "Test picture")->required();
    compareCommand
        ->add_option_function<std::string>(
            "--metric",
            [&](const std::string& name) {
                const std::optional<Metric> metric = parseMetric(name);
                if (!metric)
                    throw InputError(fmt::format("there is no metric \"{}\"", printable(name, 40)),
                                     "--metric", "choose from rmse, psnr, ssim, flip");
                compareOptions.metric = *metric;
            },
            "Which figure")
        ->type_name("rmse|psnr|ssim|flip")
        ->default_str("flip");
    compareCommand->add_option("--out", compareOptions.out, "Write the error map here")->type_name("FILE");
    addNumber(*compareCommand, "--max-error", compareOptions.maxError, 0.0, maxDouble,
              "Exit with 1 when it is exceeded")
        ->type_name("E");
    compareCommand->add_flag("--json", compareOptions.json, "Machine-readable");
    compareCommand->callback([&] { status = compare(compareOptions); });

    DeckOptions deckOptions;
    CLI::App* deckCommand = app.add_subcommand("deck", "The questions as cards that Anki imports");
    if (only == nullptr)
        deckCommand->add_option("--labs", deckOptions.labs, "Only these, with commas between")
            ->delimiter(',')
            ->type_name("LAB,…")
            ->default_str("all");
    addBackend(*deckCommand, deckOptions.backend, false);
    deckCommand->add_option("--out", deckOptions.out, "Folder for the cards and their pictures")
        ->type_name("FOLDER")
        ->default_str("out/deck");
    deckCommand->add_flag("--json", deckOptions.json, "Machine-readable");
    deckCommand->callback([&] { status = deck(labs, deckOptions); });

    AtlasOptions atlasOptions;
    CLI::App* atlasCommand =
        app.add_subcommand("atlas", "Everything that the labs show and measure, as pages to open from disk");
    if (only == nullptr)
        atlasCommand->add_option("--labs", atlasOptions.labs, "Only these, with commas between")
            ->delimiter(',')
            ->type_name("LAB,…")
            ->default_str("all");
    addBackend(*atlasCommand, atlasOptions.backend, false);
    atlasCommand->add_option("--out", atlasOptions.out, "Folder for the pages")
        ->type_name("FOLDER")
        ->default_str("out/atlas");
    atlasCommand->add_flag("--full", atlasOptions.full,
                           "More values of each knob, sweeps at full size, more hard inputs");
    atlasCommand->add_flag("--json", atlasOptions.json, "Machine-readable");
    atlasCommand->callback([&] { status = makeAtlas(labs, atlasOptions); });

    GradeOptions gradeOptions;
    CLI::App* gradeCommand =
        app.add_subcommand("grade", "Score what a class handed in: tables, report, LMS files");
    gradeCommand->add_option(
        "SUBMISSIONS", gradeOptions.places,
        "A folder or ZIP, one file or folder a student; with --merge, folders of shards");
    if (only == nullptr)
        gradeCommand->add_option("--lab", gradeOptions.lab, "What the class worked on")->type_name("LAB");
    else
        gradeOptions.lab = only->folder();
    gradeCommand->add_option("--rubric", gradeOptions.grade.rubric, "Points and limits, TOML or JSON")
        ->type_name("FILE")
        ->default_str("the lab's own");
    gradeCommand->add_option("--out", gradeOptions.grade.out, "Where the grades go")
        ->type_name("FOLDER")
        ->default_str("out/grade");
    addNumber(*gradeCommand, "--jobs", gradeOptions.grade.jobs, 1, 1024, "Submissions at a time")
        ->type_name("N")
        ->default_str("one a processor");
    addNumber(*gradeCommand, "--seconds", gradeOptions.grade.secondsEach, 1, 3600,
              "Of processor time that a submission may take")
        ->type_name("S")
        ->default_str("60");
    addBackend(*gradeCommand, gradeOptions.grade.backend, false);
    gradeCommand->add_flag("--anonymous", gradeOptions.grade.anonymous, "Names in lms/ and journal/ only");
    gradeCommand->add_flag("--merge", gradeOptions.merge, "Make the outputs of shards that are done");
    gradeCommand->add_flag("--json", gradeOptions.json, "Machine-readable");
    gradeCommand->callback([&] { gradeSubmissions(labs, gradeOptions); });

    HandoutOptions handoutOptions;
    CLI::App* handoutCommand =
        labVerb("handout", "A student's starter: the lab's shader without the part to write", false);
    handoutCommand->add_option("--out", handoutOptions.out, "Where it goes")
        ->type_name("FOLDER")
        ->default_str("out/handout/LAB");
    handoutCommand->add_flag("--json", handoutOptions.json, "Machine-readable");
    handoutCommand->callback([&] {
        const LabEntry& entry = chosen();
        handout(entry, handoutOptions);
    });

    try {
        if (lab)
            completeSwitches(words, lab->knobs());
        std::reverse(words.begin(), words.end());
        app.parse(words);
        if (app.get_subcommands().empty())
            throw InputError("no verb given", {}, "see --help");
    } catch (const CLI::CallForHelp&) {
        print(app.help());
    } catch (const CLI::CallForAllHelp&) {
        print(app.help("", CLI::AppFormatMode::All));
    } catch (const CLI::CallForVersion&) {
        print("quincunx " QUINCUNX_VERSION "\n");
    } catch (const CLI::ParseError& e) {
        throw InputError(printable(e.what()), {}, "see --help");
    }
    return static_cast<int>(status);
}

int guarded(const std::function<int()>& program) {
    handleInterrupts();
    try {
        const int status = program();
        print({});
        return status;
    } catch (const Interrupted& e) {
        say(fmt::format("quincunx: {}", e.what()));
        return interruptedStatus;
    } catch (const Error& e) {
        say(fmt::format("quincunx: {}", e.what()));
        return static_cast<int>(e.exitStatus());
    } catch (const std::system_error& e) {
        say(fmt::format("quincunx: {}", printable(e.what())));
        return static_cast<int>(ExitStatus::notPossibleHere);
    } catch (const std::bad_alloc&) {
        say("quincunx: not enough memory; use a smaller picture or model");
        return static_cast<int>(ExitStatus::notPossibleHere);
    }
}

}  // namespace

int runCommandLine(int argc, const char* const* argv, std::span<const LabEntry> labs) {
    return guarded([&] { return dispatch({argv + 1, argv + argc}, labs, nullptr); });
}

int runCommandLine(int argc, const char* const* argv, const LabEntry& lab) {
    return guarded([&] { return dispatch(withVerb({argv + 1, argv + argc}), {&lab, 1}, &lab); });
}

}  // namespace quincunx
