#include "graph/graph.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <tuple>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"

namespace quincunx::graph {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string messageOf(const std::function<void()>& action) {
    try {
        action();
    } catch (const InputError& error) {
        return error.what();
    }
    return "no InputError";
}

Resource image(FrameGraph& graph, const std::string& name, Format format = Format::rgba8, int width = 8,
               int height = 8) {
    return graph.addResource({name, format, width, height});
}

Pass pass(FrameGraph& graph, const std::string& name, std::vector<Resource> reads,
          std::vector<Resource> writes) {
    return graph.addPass({name, std::move(reads), std::move(writes), {}});
}

/// A graph without cycles whose passes are added in any order, with formats and sizes of a few kinds.
FrameGraph randomGraph(Random& random) {
    FrameGraph graph;
    const std::size_t passCount = 1 + random.below(24);
    const Format formats[] = {Format::rgba8, Format::rgba16f};
    std::vector<std::vector<Resource>> writes(passCount);
    std::vector<Resource> all;
    for (std::size_t p = 0; p < passCount; ++p) {
        const int size = random.below(4) == 0 ? 16 : 8;
        for (std::size_t i = 0, count = 1 + random.below(2); i < count; ++i) {
            writes[p].push_back(
                image(graph, fmt::format("r{}", all.size()), formats[random.below(2)], size, size));
            all.push_back(writes[p].back());
        }
    }
    std::vector<std::vector<Resource>> reads(passCount);
    for (std::size_t p = 1; p < passCount; ++p)
        for (std::size_t i = 0, count = random.below(4); i < count; ++i)
            reads[p].push_back(writes[random.below(p)][0]);
    std::vector<std::size_t> insertion(passCount);
    std::iota(insertion.begin(), insertion.end(), std::size_t{0});
    for (std::size_t i = passCount; i > 1; --i)
        std::swap(insertion[i - 1], insertion[random.below(i)]);
    for (const std::size_t p : insertion)
        pass(graph, fmt::format("p{}", p), reads[p], writes[p]);
    for (std::size_t i = 0, count = 1 + random.below(3); i < count; ++i)
        graph.addOutput(all[random.below(all.size())]);
    return graph;
}

bool uses(const std::vector<Resource>& list, std::size_t resource) {
    return std::find(list.begin(), list.end(), Resource{resource}) != list.end();
}

/// Which passes are needed, by repeating the definition until nothing is added.
std::vector<bool> neededByDefinition(const FrameGraph& graph) {
    std::vector<bool> needed(graph.passCount(), false);
    for (bool grown = true; grown;) {
        grown = false;
        for (std::size_t p = 0; p < graph.passCount(); ++p)
            for (const Resource made : graph.pass({p}).writes) {
                bool wanted = graph.isOutput(made);
                for (std::size_t q = 0; q < graph.passCount(); ++q)
                    wanted = wanted || (needed[q] && uses(graph.pass({q}).reads, made.index));
                if (wanted && !needed[p])
                    needed[p] = grown = true;
            }
    }
    return needed;
}

TEST(Graph, RunsExactlyTheNeededPassesEarliestReadyFirst) {
    Random random(1);
    std::size_t dropped = 0;
    for (int round = 0; round < 2000; ++round) {
        const FrameGraph graph = randomGraph(random);
        const Plan plan = graph.compile();
        const std::vector<bool> needed = neededByDefinition(graph);
        std::vector<bool> done(graph.passCount(), false);
        const auto isReady = [&](std::size_t p) {
            for (const Resource input : graph.pass({p}).reads)
                for (std::size_t q = 0; q < graph.passCount(); ++q)
                    if (!done[q] && uses(graph.pass({q}).writes, input.index))
                        return false;
            return true;
        };
        for (const Pass next : plan.order) {
            std::size_t expected = 0;
            while (done[expected] || !needed[expected] || !isReady(expected))
                ++expected;
            ASSERT_EQ(next.index, expected) << graph.describe();
            done[next.index] = true;
        }
        ASSERT_EQ(done, needed) << graph.describe();
        dropped += graph.passCount() - plan.order.size();
    }
    EXPECT_GT(dropped, 1000u) << "the random graphs must have passes to drop";
}

TEST(Graph, SharesTargetsOnlyBetweenEqualKindsThatDoNotOverlap) {
    Random random(2);
    std::size_t shared = 0;
    for (int round = 0; round < 2000; ++round) {
        const FrameGraph graph = randomGraph(random);
        const Plan plan = graph.compile();
        for (std::size_t r = 0; r < graph.resourceCount(); ++r) {
            const Plan::Lifetime& life = plan.lifetimes[r];
            std::vector<std::size_t> positions;
            for (std::size_t i = 0; i < plan.order.size(); ++i)
                if (uses(graph.pass(plan.order[i]).reads, r) || uses(graph.pass(plan.order[i]).writes, r))
                    positions.push_back(i);
            ASSERT_EQ(life.used, !positions.empty());
            if (!life.used)
                continue;
            ASSERT_EQ(life.first, positions.front());
            ASSERT_EQ(life.last, positions.back());
            ASSERT_LT(life.slot, plan.slotCount);
            for (std::size_t s = r + 1; s < graph.resourceCount(); ++s) {
                const Plan::Lifetime& other = plan.lifetimes[s];
                if (!other.used || other.slot != life.slot)
                    continue;
                ++shared;
                ASSERT_TRUE(life.last < other.first || other.last < life.first) << graph.describe();
                ASSERT_FALSE(graph.isOutput({r}) || graph.isOutput({s}));
                ASSERT_EQ(graph.resource({r}).format, graph.resource({s}).format);
                ASSERT_EQ(graph.resource({r}).width, graph.resource({s}).width);
                ASSERT_EQ(graph.resource({r}).height, graph.resource({s}).height);
            }
        }
    }
    EXPECT_GT(shared, 1000u) << "the random graphs must have targets to share";
}

TEST(Graph, UsesTheFewestTargets) {
    Random random(3);
    for (int round = 0; round < 2000; ++round) {
        const FrameGraph graph = randomGraph(random);
        const Plan plan = graph.compile();
        // Of intervals of one kind as many targets are needed as are alive at once at the worst moment.
        std::map<std::tuple<Format, int, int>, std::size_t> worst;
        std::size_t expected = 0;
        for (std::size_t moment = 0; moment < plan.order.size(); ++moment) {
            std::map<std::tuple<Format, int, int>, std::size_t> alive;
            for (std::size_t r = 0; r < graph.resourceCount(); ++r) {
                const Plan::Lifetime& life = plan.lifetimes[r];
                if (!life.used || graph.isOutput({r}) || life.first > moment || life.last < moment)
                    continue;
                const ResourceDescription& resource = graph.resource({r});
                const std::tuple kind(resource.format, resource.width, resource.height);
                worst[kind] = std::max(worst[kind], ++alive[kind]);
            }
        }
        for (const auto& [kind, count] : worst)
            expected += count;
        for (std::size_t r = 0; r < graph.resourceCount(); ++r)
            expected += graph.isOutput({r}) ? 1 : 0;
        ASSERT_EQ(plan.slotCount, expected) << graph.describe();
    }
}

TEST(Graph, KeepsTheOrderOfAddingWhereItMay) {
    FrameGraph graph;
    const Resource a = image(graph, "a");
    const Resource b = image(graph, "b");
    const Resource c = image(graph, "c");
    pass(graph, "last", {b, c}, {a});
    pass(graph, "first", {}, {c});
    pass(graph, "second", {}, {b});
    graph.addOutput(a);
    const Plan plan = graph.compile();
    EXPECT_THAT(plan.order, testing::ElementsAre(Pass{1}, Pass{2}, Pass{0}));
}

TEST(Graph, NeverReusesAnInputForAnOutputOfTheSamePass) {
    FrameGraph graph;
    const Resource ping = image(graph, "ping");
    const Resource pong = image(graph, "pong");
    const Resource third = image(graph, "third");
    const Resource out = image(graph, "out");
    pass(graph, "1", {}, {ping});
    pass(graph, "2", {ping}, {pong});
    pass(graph, "3", {pong}, {third});
    pass(graph, "4", {third}, {out});
    graph.addOutput(out);
    const Plan plan = graph.compile();
    EXPECT_NE(plan.lifetimes[ping.index].slot, plan.lifetimes[pong.index].slot);
    EXPECT_EQ(plan.lifetimes[ping.index].slot, plan.lifetimes[third.index].slot);
    EXPECT_EQ(plan.slotCount, 3u);
}

TEST(Graph, WithoutOutputsRunsNothing) {
    FrameGraph graph;
    pass(graph, "draw", {}, {image(graph, "picture")});
    const Plan plan = graph.compile();
    EXPECT_TRUE(plan.order.empty());
    EXPECT_EQ(plan.slotCount, 0u);
    EXPECT_FALSE(plan.lifetimes[0].used);
}

TEST(Graph, OrdersALongChainAddedBackwards) {
    constexpr std::size_t length = 20000;
    FrameGraph graph;
    std::vector<Resource> links;
    for (std::size_t i = 0; i < length; ++i)
        links.push_back(image(graph, fmt::format("r{}", i)));
    for (std::size_t i = length; i-- > 0;)
        pass(graph, fmt::format("p{}", i),
             i == 0 ? std::vector<Resource>() : std::vector<Resource>{links[i - 1]}, {links[i]});
    graph.addOutput(links.back());
    const Plan plan = graph.compile();
    ASSERT_EQ(plan.order.size(), length);
    for (std::size_t i = 0; i < length; ++i)
        ASSERT_EQ(plan.order[i].index, length - 1 - i);
    EXPECT_EQ(plan.slotCount, 3u);
}

TEST(GraphErrors, ACycleNamesItsPassesAndResourcesAndNoOthers) {
    FrameGraph graph;
    const Resource a = image(graph, "image a");
    const Resource b = image(graph, "image b");
    const Resource c = image(graph, "image c");
    pass(graph, "downstream", {b}, {c});
    pass(graph, "alpha", {b}, {a});
    pass(graph, "beta", {a}, {b});
    graph.addOutput(c);
    const std::string message = messageOf([&] { graph.compile(); });
    EXPECT_THAT(message, AllOf(HasSubstr("cycle"), HasSubstr("\"alpha\""), HasSubstr("\"beta\""),
                               HasSubstr("\"image a\""), HasSubstr("\"image b\"")));
    EXPECT_THAT(message, testing::Not(HasSubstr("downstream")));
    EXPECT_THAT(graph.describe(), HasSubstr("alpha: reads (image b) writes (image a)"));
}

TEST(GraphErrors, AResourceWrittenTwiceNamesBothPasses) {
    FrameGraph graph;
    const Resource a = image(graph, "shared");
    pass(graph, "one", {}, {a});
    pass(graph, "two", {}, {a});
    EXPECT_THAT(messageOf([&] { graph.compile(); }),
                AllOf(HasSubstr("\"one\""), HasSubstr("\"two\""), HasSubstr("\"shared\"")));
}

TEST(GraphErrors, ReadingWhatNobodyWritesNamesPassAndResource) {
    FrameGraph graph;
    pass(graph, "shade", {image(graph, "shadow map")}, {image(graph, "picture")});
    EXPECT_THAT(messageOf([&] { graph.compile(); }),
                AllOf(HasSubstr("\"shade\""), HasSubstr("\"shadow map\"")));
}

TEST(GraphErrors, AnOutputThatNobodyWritesIsNamed) {
    FrameGraph graph;
    graph.addOutput(image(graph, "picture"));
    EXPECT_THAT(messageOf([&] { graph.compile(); }), HasSubstr("\"picture\""));
}

TEST(GraphErrors, APassMayNotReadWhatItWrites) {
    FrameGraph graph;
    const Resource a = image(graph, "feedback");
    EXPECT_THAT(messageOf([&] { pass(graph, "blur", {a}, {a}); }),
                AllOf(HasSubstr("\"blur\""), HasSubstr("\"feedback\"")));
}

TEST(GraphErrors, TargetsOfAPassAreChecked) {
    FrameGraph graph;
    const Resource a = image(graph, "a");
    const Resource large = image(graph, "large", Format::rgba8, 9, 8);
    const Resource depth = image(graph, "depth", Format::depth24);
    const Resource depth2 = image(graph, "depth 2", Format::depth24Stencil8);
    EXPECT_THAT(messageOf([&] {
                    pass(graph, "p", {}, {a, large});
                }),
                AllOf(HasSubstr("\"p\""), HasSubstr("\"a\" 8×8"), HasSubstr("\"large\" 9×8")));
    EXPECT_THAT(messageOf([&] {
                    pass(graph, "p", {}, {depth, a, depth2});
                }),
                AllOf(HasSubstr("\"p\""), HasSubstr("two depth targets")));
    EXPECT_THAT(messageOf([&] { pass(graph, "p", {}, {a, a}); }), HasSubstr("twice"));
    EXPECT_THAT(messageOf([&] { pass(graph, "p", {}, {Resource{4}}); }), HasSubstr("resource 4 of 4"));
    EXPECT_THAT(messageOf([&] { pass(graph, "p", {Resource{99}}, {a}); }), HasSubstr("resource 99 of 4"));
    EXPECT_THAT(messageOf([&] { graph.addOutput(Resource{4}); }), HasSubstr("4"));
    EXPECT_EQ(graph.passCount(), 0u) << "a refused pass must leave no trace";
}

TEST(GraphErrors, ResourcesAreChecked) {
    FrameGraph graph;
    image(graph, "picture");
    EXPECT_THAT(messageOf([&] { image(graph, "picture"); }), HasSubstr("\"picture\""));
    EXPECT_THAT(messageOf([&] { image(graph, ""); }), HasSubstr("no name"));
    EXPECT_THAT(messageOf([&] { image(graph, "flat", Format::rgba8, 8, 0); }), HasSubstr("8×0"));
    EXPECT_THAT(messageOf([&] { image(graph, "flat", Format::rgba8, -3, 8); }), HasSubstr("-3×8"));
    EXPECT_EQ(graph.resourceCount(), 1u);
    EXPECT_EQ(image(graph, "flat").index, 1u) << "a refused name must stay free";
}

TEST(Graph, FindsResourcesByNameOrListsThem) {
    FrameGraph graph;
    const Resource depth = image(graph, "depth");
    image(graph, "picture");
    EXPECT_EQ(graph.find("depth"), depth);
    EXPECT_THAT(messageOf([&] { graph.find("dept"); }),
                AllOf(HasSubstr("\"dept\""), HasSubstr("depth, picture")));
}

TEST(Graph, DescribesItselfAndMarksWhatIsDropped) {
    FrameGraph graph;
    const Resource shadow = image(graph, "shadow map", Format::depth32f);
    const Resource picture = image(graph, "picture", Format::rgba8Srgb, 640, 480);
    const Resource depth = image(graph, "depth", Format::depth24, 640, 480);
    const Resource unused = image(graph, "unused");
    pass(graph, "shadow", {}, {shadow});
    pass(graph, "waste", {shadow}, {unused});
    pass(graph, "shade", {shadow}, {picture, depth});
    graph.addOutput(picture);
    EXPECT_EQ(graph.describe(),
              "shadow: writes (shadow map)\n"
              "waste: reads (shadow map) writes (unused) dropped, because nothing needs it\n"
              "shade: reads (shadow map) writes (picture, depth)\n");
    EXPECT_FALSE(graph.compile().lifetimes[unused.index].used);
}

TEST(Graph, GraphvizEscapesNames) {
    FrameGraph graph;
    const Resource odd = image(graph, "a \"b\" \\c");
    pass(graph, "draw", {}, {odd});
    graph.addOutput(odd);
    EXPECT_EQ(graph.graphviz(),
              "digraph frame {\n"
              "  rankdir=LR;\n"
              "  r0 [shape=ellipse, label=\"a \\\"b\\\" \\\\c\\nrgba8 8×8\", peripheries=2];\n"
              "  p0 [shape=box, label=\"draw\"];\n"
              "  p0 -> r0;\n"
              "}\n");
}

TEST(Graph, FormatsKnowTheirDepthAndSize) {
    EXPECT_TRUE(hasDepth(Format::depth24) && hasDepth(Format::depth32f) && hasDepth(Format::depth24Stencil8));
    EXPECT_FALSE(hasDepth(Format::rgba8Srgb) || hasDepth(Format::rgba32f) || hasDepth(Format::r32f));
    EXPECT_EQ(bytesPerTexel(Format::rgba8Srgb), 4u);
    EXPECT_EQ(bytesPerTexel(Format::rgba16f), 8u);
    EXPECT_EQ(bytesPerTexel(Format::rgba32f), 16u);
    EXPECT_EQ(bytesPerTexel(Format::r32f), 4u);
}

}  // namespace
}  // namespace quincunx::graph
