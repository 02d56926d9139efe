#include "gl/executor.h"

#include "gl/calls.h"
#include "tests/common/gl/gl_test.h"

namespace quincunx::gl {
namespace {

using graph::Format;
using graph::FrameGraph;
using graph::PassContext;
using graph::Resource;
using test::messageOf;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;
using testing::StartsWith;
using testing::UnorderedElementsAre;

void clearTo(float red, float green = 0) {
    glClearColor(red, green, 0, 1);
    glClear(GL_COLOR_BUFFER_BIT);
}

/// One pass that clears one target.
FrameGraph clearing(int width, int height, float red, Format format = Format::rgba8) {
    FrameGraph graph;
    const Resource picture = graph.addResource({"picture", format, width, height});
    graph.addPass({"clear", {}, {picture}, [red](PassContext&) { clearTo(red); }});
    graph.addOutput(picture);
    return graph;
}

class ExecutorTest : public test::OnBackend {
  protected:
    ExecutorTest() {
        shaders_.write("cover.vert", test::coverVertexShader);
        shaders_.write("gradient.frag",
                       "#version 330 core\nout vec4 color;\nuniform vec2 size;\n"
                       "void main() { vec2 p = gl_FragCoord.xy / size;\n"
                       "  color = vec4(p, sin(p.x * 20.0) * exp(p.y), 1.0 / length(p)); }\n");
        shaders_.write("add.frag",
                       "#version 330 core\nout vec4 color;\nuniform sampler2D image;\n"
                       "void main() { color = texelFetch(image, ivec2(gl_FragCoord.xy), 0) + 1.0; }\n");
    }

    test::ShaderFolder shaders_;
};

/// The gradient drawn by a backend as float, so that no rounding hides a difference.
Image gradient(Backend backend) {
    const auto context = createOffscreenContext(backend);
    Executor executor;
    FrameGraph graph;
    const Resource picture = graph.addResource({"gradient", Format::rgba32f, 200, 133});
    graph.addPass({"draw", {}, {picture}, [](PassContext& pass) {
                       const Program& program = pass.programs().get(
                           {.label = "gradient", .vertex = "cover.vert", .fragment = "gradient.frag"});
                       program.use();
                       program.set("size", glm::vec2(200, 133));
                       test::cover();
                   }});
    graph.addOutput(picture);
    executor.run(graph);
    return readPixels(executor.output(picture));
}

TEST_P(ExecutorTest, DrawsTheSameBitsOnBothBackends) {
    context_.reset();
    const Image here = gradient(GetParam());
    EXPECT_EQ(here, gradient(GetParam() == Backend::egl ? Backend::osmesa : Backend::egl));
    EXPECT_NEAR(here.pixel(50, 0)[0], 50.5 / 200, 1e-6) << "and the picture is the gradient";
    EXPECT_NEAR(here.pixel(50, 0)[1], 132.5 / 133, 1e-6);
}

TEST_P(ExecutorTest, APassReadsWhatAnEarlierOneDrew) {
    Executor executor;
    FrameGraph graph;
    const Resource first = graph.addResource({"first", Format::rgba32f, 4, 4});
    const Resource second = graph.addResource({"second", Format::rgba32f, 4, 4});
    const Resource third = graph.addResource({"third", Format::rgba32f, 4, 4});
    const auto addOne = [](Resource from) {
        return [from](PassContext& pass) {
            const Program& program =
                pass.programs().get({.label = "add", .vertex = "cover.vert", .fragment = "add.frag"});
            program.use();
            program.set("image", 0);
            pass.texture(from).bind(0);
            test::cover();
        };
    };
    graph.addPass({"3", {second}, {third}, addOne(second)});
    graph.addPass({"2", {first}, {second}, addOne(first)});
    graph.addPass({"1", {}, {first}, [](PassContext&) { clearTo(5, 7); }});
    graph.addOutput(third);
    for (int frame = 0; frame < 3; ++frame) {
        executor.run(graph);
        const Image image = readPixels(executor.output(third));
        EXPECT_THAT(std::vector(image.data.begin(), image.data.begin() + 4), ElementsAre(7, 9, 2, 3));
    }
    EXPECT_EQ(executor.programs().size(), 1u);
}

TEST_P(ExecutorTest, AFrameOfOnePassNeedsThreeCallsBesidesItsOwn) {
    Executor executor;
    const FrameGraph graph = clearing(8, 8, 0.5f);
    executor.run(graph);
    const CallRecorder recorder;
    executor.run(graph);
    EXPECT_THAT(recorder.calls(),
                UnorderedElementsAre(Pair("glBindFramebuffer", 1u), Pair("glViewport", 1u),
                                     Pair("glEnable", 1u), Pair("glClearColor", 1u), Pair("glClear", 1u)));
}

TEST_P(ExecutorTest, DroppedPassesCostNothing) {
    Executor executor;
    FrameGraph graph = clearing(8, 8, 0.5f);
    const Resource unused = graph.addResource({"unused", Format::rgba32f, 4096, 4096});
    graph.addPass({"waste", {}, {unused}, [](PassContext&) { FAIL() << "nobody reads this"; }});
    executor.run(graph);
    EXPECT_EQ(executor.targetBytes(), 8u * 8 * 4);
}

TEST_P(ExecutorTest, SrgbTargetsAreEncodedAndOthersAreNot) {
    Executor executor;
    FrameGraph graph;
    const Resource encoded = graph.addResource({"encoded", Format::rgba8Srgb, 2, 2});
    const Resource plain = graph.addResource({"plain", Format::rgba8, 2, 2});
    const Resource again = graph.addResource({"again", Format::rgba8Srgb, 2, 2});
    for (const Resource target : {encoded, plain, again}) {
        graph.addPass(
            {"clear " + graph.resource(target).name, {}, {target}, [](PassContext&) { clearTo(0.25f); }});
        graph.addOutput(target);
    }
    executor.run(graph);
    // 0.25 is encoded as 0.5371: 137.0 of 255; as it is, 63.75.
    EXPECT_EQ(readPixels8(executor.output(encoded)).data[0], 137);
    EXPECT_EQ(readPixels8(executor.output(plain)).data[0], 64);
    EXPECT_EQ(readPixels8(executor.output(again)).data[0], 137);
}

TEST_P(ExecutorTest, SeveralTargetsAndDepthAreBoundInOrder) {
    Executor executor;
    FrameGraph graph;
    const Resource depth = graph.addResource({"depth", Format::depth32f, 3, 5});
    const Resource a = graph.addResource({"a", Format::rgba32f, 3, 5});
    const Resource b = graph.addResource({"b", Format::rgba8, 3, 5});
    graph.addPass({"draw", {}, {a, depth, b}, [](PassContext&) {
                       const float first[] = {1, 2, 3, 4};
                       const float second[] = {0.2f, 0.4f, 0.6f, 1};
                       const float far = 0.25f;
                       glClearBufferfv(GL_COLOR, 0, first);
                       glClearBufferfv(GL_COLOR, 1, second);
                       glClearBufferfv(GL_DEPTH, 0, &far);
                   }});
    for (const Resource resource : {a, b, depth})
        graph.addOutput(resource);
    executor.run(graph);
    EXPECT_EQ(readPixels(executor.output(a)).data[2], 3);
    EXPECT_EQ(readPixels8(executor.output(b)).data[1], 102);
    EXPECT_EQ(readPixels(executor.output(depth)).data[14], 0.25f);
}

TEST_P(ExecutorTest, EveryFormatCanBeDrawnInto) {
    Executor executor;
    for (const Format format : {Format::rgba8Srgb, Format::rgba8, Format::rgba16f, Format::rgba32f,
                                Format::r32f, Format::depth24, Format::depth32f, Format::depth24Stencil8}) {
        const FrameGraph graph = clearing(4, 4, 1, format);
        EXPECT_NO_THROW(executor.run(graph));
        EXPECT_EQ(executor.output(Resource{0}).internalFormat(), internalFormat(format));
    }
}

TEST_P(ExecutorTest, TargetsAreKeptFromFrameToFrame) {
    Executor executor;
    const FrameGraph graph = clearing(8, 8, 0.5f);
    executor.run(graph);
    const GLuint name = executor.output(Resource{0}).get();
    for (int i = 0; i < 20; ++i) {
        executor.run(clearing(8, 8, 0.25f));
        EXPECT_EQ(executor.output(Resource{0}).get(), name);
    }
    EXPECT_EQ(readPixels8(executor.output(Resource{0})).data[0], 64);
}

TEST_P(ExecutorTest, TargetsOfAnOldSizeAreFreed) {
    Executor executor;
    executor.run(clearing(64, 64, 0.5f));
    for (int side = 65; side < 100; ++side)
        executor.run(clearing(side, side, 0.5f));
    // At most the targets of the last nine frames.
    EXPECT_LE(executor.targetBytes(), 9u * 99 * 99 * 4);
    for (int i = 0; i < 20; ++i)
        executor.run(clearing(10, 10, 0.5f));
    EXPECT_EQ(executor.targetBytes(), 10u * 10 * 4);
}

TEST_P(ExecutorTest, GraphsThatAlternateKeepTheirTargets) {
    Executor executor;
    const FrameGraph small = clearing(8, 8, 0.5f);
    const FrameGraph large = clearing(16, 16, 0.5f);
    executor.run(small);
    executor.run(large);
    const CallRecorder recorder;
    for (int i = 0; i < 20; ++i) {
        executor.run(small);
        executor.run(large);
    }
    EXPECT_EQ(recorder.calls().count("glTexImage2D"), 0u);
    EXPECT_EQ(recorder.calls().count("glGenFramebuffers"), 0u);
}

TEST_P(ExecutorTest, ErrorsNameThePassAndKeepTheirKind) {
    Executor executor;
    const auto run = [&](std::function<void(PassContext&)> execute) {
        FrameGraph graph;
        const Resource picture = graph.addResource({"picture", Format::rgba8, 4, 4});
        graph.addPass({"shade", {}, {picture}, std::move(execute)});
        graph.addOutput(picture);
        executor.run(graph);
    };
    EXPECT_THAT(messageOf<GlError>([&] { run([](PassContext&) { glEnable(0x1234); }); }),
                StartsWith("pass \"shade\": glEnable: GL_INVALID_ENUM"));
    EXPECT_THAT(messageOf<ShaderError>([&] {
                    run([](PassContext& pass) {
                        pass.programs().get({.label = "x", .vertex = "none.vert", .fragment = "none.frag"});
                    });
                }),
                StartsWith("pass \"shade\": shaders/none.vert: no such file"));
    EXPECT_EQ(messageOf<InputError>([&] { run([](PassContext&) { throw InputError("odd", "file"); }); }),
              "pass \"shade\": file: odd");
    EXPECT_EQ(messageOf<EnvironmentError>([&] { run([](PassContext&) { throw EnvironmentError("no"); }); }),
              "pass \"shade\": no");
    EXPECT_EQ(messageOf<Interrupted>([&] { run([](PassContext&) { throw Interrupted(); }); }), "interrupted");
    EXPECT_THAT(messageOf<InputError>([&] { run({}); }), HasSubstr("\"shade\""));
    executor.run(clearing(4, 4, 0.2f));
    EXPECT_EQ(readPixels8(executor.output(Resource{0})).data[0], 51) << "an executor survives errors";
}

TEST_P(ExecutorTest, ATargetBeyondTheDriversLimitIsRefusedByName) {
    Executor executor;
    EXPECT_THAT(messageOf<InputError>([&] { executor.run(clearing(1 << 24, 4, 0.5f)); }),
                HasSubstr("\"picture\""));
}

TEST_P(ExecutorTest, APassMaySeeOnlyWhatItDeclared) {
    Executor executor;
    FrameGraph graph = clearing(4, 4, 0.5f);
    const Resource other = graph.addResource({"other", Format::rgba8, 4, 4});
    graph.addPass({"peek", {}, {other}, [](PassContext& pass) { pass.texture(Resource{0}); }});
    graph.addOutput(other);
    EXPECT_DEATH(executor.run(graph), "reads");
}

QX_ON_BOTH_BACKENDS(ExecutorTest);

}  // namespace
}  // namespace quincunx::gl
