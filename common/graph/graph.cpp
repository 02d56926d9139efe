#include "graph/graph.h"

#include <algorithm>
#include <limits>
#include <map>
#include <queue>
#include <tuple>

#include <fmt/format.h>

#include "base/check.h"
#include "base/error.h"

namespace quincunx::graph {
namespace {

constexpr std::size_t nobody = std::numeric_limits<std::size_t>::max();

InputError passFault(std::string_view pass, std::string_view what, std::string_view remedy) {
    return InputError(what, fmt::format("pass \"{}\"", pass), remedy);
}

/// Who writes each resource (`nobody`, or the first in the order of adding).
std::vector<std::size_t> writersOf(const FrameGraph& graph) {
    std::vector<std::size_t> writers(graph.resourceCount(), nobody);
    for (std::size_t p = 0; p < graph.passCount(); ++p)
        for (const Resource resource : graph.pass({p}).writes)
            if (writers[resource.index] == nobody)
                writers[resource.index] = p;
    return writers;
}

/// Which passes the outputs need.
std::vector<bool> neededPasses(const FrameGraph& graph, const std::vector<std::size_t>& writers) {
    std::vector<bool> needed(graph.passCount(), false);
    std::vector<std::size_t> open;
    const auto need = [&](Resource resource) {
        const std::size_t writer = writers[resource.index];
        if (writer != nobody && !needed[writer]) {
            needed[writer] = true;
            open.push_back(writer);
        }
    };
    for (std::size_t r = 0; r < graph.resourceCount(); ++r)
        if (graph.isOutput({r}))
            need({r});
    while (!open.empty()) {
        const std::size_t pass = open.back();
        open.pop_back();
        for (const Resource resource : graph.pass({pass}).reads)
            need(resource);
    }
    return needed;
}

void checkWriters(const FrameGraph& graph, const std::vector<std::size_t>& writers) {
    for (std::size_t p = 0; p < graph.passCount(); ++p) {
        const PassDescription& pass = graph.pass({p});
        for (const Resource resource : pass.writes)
            if (writers[resource.index] != p)
                throw passFault(
                    pass.name,
                    fmt::format("writes \"{}\", which pass \"{}\" writes already",
                                graph.resource(resource).name, graph.pass({writers[resource.index]}).name),
                    "give each its own resource");
        for (const Resource resource : pass.reads)
            if (writers[resource.index] == nobody)
                throw passFault(
                    pass.name,
                    fmt::format("reads \"{}\", which no pass writes", graph.resource(resource).name),
                    "add the pass that makes it");
    }
    for (std::size_t r = 0; r < graph.resourceCount(); ++r)
        if (graph.isOutput({r}) && writers[r] == nobody)
            throw InputError("is an output that no pass writes",
                             fmt::format("resource \"{}\"", graph.resource({r}).name),
                             "add the pass that makes it");
}

/// A cycle among passes that could not be ordered: from any of them, the writer of an input is again one of
/// them, so that walking back must come round.
[[noreturn]] void throwCycle(const FrameGraph& graph, const std::vector<std::size_t>& writers,
                             const std::vector<bool>& ordered) {
    const auto start = std::find(ordered.begin(), ordered.end(), false);
    std::vector<std::size_t> path;
    std::vector<Resource> through;
    std::vector<std::size_t> positionInPath(graph.passCount(), nobody);
    auto pass = static_cast<std::size_t>(start - ordered.begin());
    while (positionInPath[pass] == nobody) {
        positionInPath[pass] = path.size();
        path.push_back(pass);
        const auto& reads = graph.pass({pass}).reads;
        const auto blocked = std::find_if(
            reads.begin(), reads.end(), [&](Resource resource) { return !ordered[writers[resource.index]]; });
        QX_CHECK(blocked != reads.end());
        through.push_back(*blocked);
        pass = writers[blocked->index];
    }
    std::string text;
    for (std::size_t i = positionInPath[pass]; i < path.size(); ++i)
        text += fmt::format("{}pass \"{}\" reads \"{}\"", text.empty() ? "" : ", ",
                            graph.pass({path[i]}).name, graph.resource(through[i]).name);
    throw InputError(fmt::format("a cycle: {}, written by pass \"{}\"", text, graph.pass({pass}).name),
                     "frame graph", "a pass may only read what earlier passes make");
}

/// Topological order, always the earliest added pass that is ready (Kahn 1962 with a priority queue).
std::vector<std::size_t> orderPasses(const FrameGraph& graph, const std::vector<std::size_t>& writers) {
    const std::size_t count = graph.passCount();
    std::vector<std::size_t> waitsFor(count, 0);
    std::vector<std::vector<std::size_t>> readers(count);
    for (std::size_t p = 0; p < count; ++p)
        for (const Resource resource : graph.pass({p}).reads) {
            ++waitsFor[p];
            readers[writers[resource.index]].push_back(p);
        }
    std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> ready;
    for (std::size_t p = 0; p < count; ++p)
        if (waitsFor[p] == 0)
            ready.push(p);
    std::vector<std::size_t> order;
    std::vector<bool> ordered(count, false);
    while (!ready.empty()) {
        const std::size_t pass = ready.top();
        ready.pop();
        order.push_back(pass);
        ordered[pass] = true;
        for (const std::size_t reader : readers[pass])
            if (--waitsFor[reader] == 0)
                ready.push(reader);
    }
    if (order.size() != count)
        throwCycle(graph, writers, ordered);
    return order;
}

std::vector<Plan::Lifetime> lifetimesOf(const FrameGraph& graph, const std::vector<Pass>& order) {
    std::vector<Plan::Lifetime> lifetimes(graph.resourceCount());
    for (std::size_t position = 0; position < order.size(); ++position) {
        const PassDescription& pass = graph.pass(order[position]);
        for (const auto* resources : {&pass.writes, &pass.reads})
            for (const Resource resource : *resources) {
                Plan::Lifetime& lifetime = lifetimes[resource.index];
                if (!lifetime.used)
                    lifetime.first = position;
                lifetime.used = true;
                lifetime.last = position;
            }
    }
    return lifetimes;
}

/// Gives each used resource a slot: greedily in order of birth the most recently freed slot of its kind,
/// which is the least number of slots for intervals of one kind.
std::size_t assignSlots(const FrameGraph& graph, std::vector<Plan::Lifetime>& lifetimes) {
    using Kind = std::tuple<Format, int, int>;
    const auto kindOf = [&](std::size_t r) {
        const ResourceDescription& resource = graph.resource({r});
        return Kind(resource.format, resource.width, resource.height);
    };
    std::vector<std::size_t> births;
    for (std::size_t r = 0; r < lifetimes.size(); ++r)
        if (lifetimes[r].used)
            births.push_back(r);
    std::vector<std::size_t> deaths = births;
    std::stable_sort(births.begin(), births.end(),
                     [&](std::size_t a, std::size_t b) { return lifetimes[a].first < lifetimes[b].first; });
    std::stable_sort(deaths.begin(), deaths.end(),
                     [&](std::size_t a, std::size_t b) { return lifetimes[a].last < lifetimes[b].last; });
    std::map<Kind, std::vector<std::size_t>> freeSlots;
    std::size_t slotCount = 0;
    auto nextDeath = deaths.begin();
    for (const std::size_t r : births) {
        for (; lifetimes[*nextDeath].last < lifetimes[r].first; ++nextDeath)
            if (!graph.isOutput({*nextDeath}))
                freeSlots[kindOf(*nextDeath)].push_back(lifetimes[*nextDeath].slot);
        std::vector<std::size_t>& free = freeSlots[kindOf(r)];
        if (graph.isOutput({r}) || free.empty()) {
            lifetimes[r].slot = slotCount++;
        } else {
            lifetimes[r].slot = free.back();
            free.pop_back();
        }
    }
    return slotCount;
}

std::string listNames(const FrameGraph& graph, const std::vector<Resource>& resources) {
    std::string names;
    for (const Resource resource : resources)
        names += (names.empty() ? "" : ", ") + graph.resource(resource).name;
    return names;
}

/// `text` as Graphviz writes strings.
std::string asGraphvizString(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            result += '\\';
        if (c == '\n')
            result += "\\n";
        else
            result += c;
    }
    return result + "\"";
}

std::string_view formatName(Format format) {
    switch (format) {
        case Format::rgba8Srgb:
            return "rgba8Srgb";
        case Format::rgba8:
            return "rgba8";
        case Format::rgba16f:
            return "rgba16f";
        case Format::rgba32f:
            return "rgba32f";
        case Format::rg16f:
            return "rg16f";
        case Format::r32f:
            return "r32f";
        case Format::depth24:
            return "depth24";
        case Format::depth32f:
            return "depth32f";
        case Format::depth24Stencil8:
            return "depth24Stencil8";
    }
    return "?";
}

}  // namespace

bool hasDepth(Format format) {
    return format == Format::depth24 || format == Format::depth32f || format == Format::depth24Stencil8;
}

std::size_t bytesPerTexel(Format format) {
    switch (format) {
        case Format::rgba32f:
            return 16;
        case Format::rgba16f:
            return 8;
        default:
            return 4;
    }
}

Resource FrameGraph::addResource(ResourceDescription description) {
    const std::string where = fmt::format("resource \"{}\"", description.name);
    if (description.name.empty())
        throw InputError("has no name", where, "give it one");
    if (description.width < 1 || description.height < 1)
        throw InputError(fmt::format("{}×{} texels", description.width, description.height), where,
                         "give it at least 1×1");
    if (!resourceByName_.emplace(description.name, resources_.size()).second)
        throw InputError("there is another of this name", where, "choose a different name");
    resources_.push_back(std::move(description));
    isOutput_.push_back(false);
    return {resources_.size() - 1};
}

Pass FrameGraph::addPass(PassDescription description) {
    const Resource* depth = nullptr;
    const Resource* first = nullptr;
    for (const auto* resources : {&description.reads, &description.writes})
        for (const Resource resource : *resources)
            if (resource.index >= resources_.size())
                throw passFault(description.name,
                                fmt::format("uses resource {} of {}", resource.index, resources_.size()),
                                "use a handle of this graph's addResource");
    for (const Resource& target : description.writes) {
        const ResourceDescription& resource = resources_[target.index];
        if (std::count(description.writes.begin(), description.writes.end(), target) > 1)
            throw passFault(description.name, fmt::format("writes \"{}\" twice", resource.name),
                            "name it once");
        if (std::find(description.reads.begin(), description.reads.end(), target) != description.reads.end())
            throw passFault(description.name, fmt::format("reads and writes \"{}\"", resource.name),
                            "write to a resource of its own");
        if (hasDepth(resource.format)) {
            if (depth != nullptr)
                throw passFault(description.name,
                                fmt::format("has two depth targets, \"{}\" and \"{}\"",
                                            resources_[depth->index].name, resource.name),
                                "keep one");
            depth = &target;
        }
        if (first == nullptr)
            first = &target;
        const ResourceDescription& other = resources_[first->index];
        if (resource.width != other.width || resource.height != other.height)
            throw passFault(
                description.name,
                fmt::format("has targets of different sizes, \"{}\" {}×{} and \"{}\" {}×{}", other.name,
                            other.width, other.height, resource.name, resource.width, resource.height),
                "give them one size");
    }
    passes_.push_back(std::move(description));
    return {passes_.size() - 1};
}

void FrameGraph::addOutput(Resource resource) {
    if (resource.index >= resources_.size())
        throw InputError(fmt::format("output {} of {} resources", resource.index, resources_.size()),
                         "frame graph", "use a handle of this graph's addResource");
    isOutput_[resource.index] = true;
}

Plan FrameGraph::compile() const {
    const std::vector<std::size_t> writers = writersOf(*this);
    checkWriters(*this, writers);
    const std::vector<bool> needed = neededPasses(*this, writers);
    Plan plan;
    for (const std::size_t pass : orderPasses(*this, writers))
        if (needed[pass])
            plan.order.push_back({pass});
    plan.lifetimes = lifetimesOf(*this, plan.order);
    plan.slotCount = assignSlots(*this, plan.lifetimes);
    return plan;
}

const ResourceDescription& FrameGraph::resource(Resource handle) const {
    QX_CHECK_LT(handle.index, resources_.size());
    return resources_[handle.index];
}

const PassDescription& FrameGraph::pass(Pass handle) const {
    QX_CHECK_LT(handle.index, passes_.size());
    return passes_[handle.index];
}

bool FrameGraph::isOutput(Resource handle) const {
    QX_CHECK_LT(handle.index, resources_.size());
    return isOutput_[handle.index];
}

Resource FrameGraph::find(std::string_view name) const {
    const auto found = resourceByName_.find(name);
    if (found != resourceByName_.end())
        return {found->second};
    std::string names;
    for (const ResourceDescription& resource : resources_)
        names += (names.empty() ? "" : ", ") + resource.name;
    throw InputError(fmt::format("no resource \"{}\"", printable(name, 60)), "frame graph",
                     names.empty() ? "it has none" : "there are: " + names);
}

std::string FrameGraph::describe() const {
    const std::vector<bool> needed = neededPasses(*this, writersOf(*this));
    std::string text;
    for (std::size_t p = 0; p < passes_.size(); ++p) {
        text += passes_[p].name + ":";
        if (!passes_[p].reads.empty())
            text += fmt::format(" reads ({})", listNames(*this, passes_[p].reads));
        if (!passes_[p].writes.empty())
            text += fmt::format(" writes ({})", listNames(*this, passes_[p].writes));
        text += needed[p] ? "\n" : " dropped, because nothing needs it\n";
    }
    return text;
}

std::string FrameGraph::graphviz() const {
    const std::vector<bool> needed = neededPasses(*this, writersOf(*this));
    std::string text = "digraph frame {\n  rankdir=LR;\n";
    for (std::size_t r = 0; r < resources_.size(); ++r) {
        const ResourceDescription& resource = resources_[r];
        text += fmt::format(
            "  r{} [shape=ellipse, label={}{}];\n", r,
            asGraphvizString(fmt::format("{}\n{} {}×{}", resource.name, formatName(resource.format),
                                         resource.width, resource.height)),
            isOutput_[r] ? ", peripheries=2" : "");
    }
    for (std::size_t p = 0; p < passes_.size(); ++p) {
        text += fmt::format("  p{} [shape=box, label={}{}];\n", p, asGraphvizString(passes_[p].name),
                            needed[p] ? "" : ", style=dashed");
        for (const Resource resource : passes_[p].reads)
            text += fmt::format("  r{} -> p{};\n", resource.index, p);
        for (const Resource resource : passes_[p].writes)
            text += fmt::format("  p{} -> r{};\n", p, resource.index);
    }
    return text + "}\n";
}

}  // namespace quincunx::graph
