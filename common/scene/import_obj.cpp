#include <algorithm>
#include <atomic>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <unordered_map>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>
#include <tiny_obj_loader.h>

#include "base/error.h"
#include "base/file.h"
#include "base/interrupt.h"
#include "geometry/normals.h"
#include "geometry/polygon.h"
#include "image/io.h"
#include "scene/import_formats.h"
#include "scene/import_support.h"
#include "scene/placement.h"

namespace quincunx {

namespace {

/// Indices of a face's corner: from 0 up, `absent`, or, while a chunk does not know what lies before it,
/// `relative` + the index counted from the chunk's first element.
struct Corner {
    std::int32_t position;
    std::int32_t texcoord;
    std::int32_t normal;
};

constexpr std::int32_t absent = std::numeric_limits<std::int32_t>::min();
constexpr std::int32_t relative = -(1 << 30);
/// No file of `largestModelFile` bytes holds as many elements ("vt 0" and a line break are five bytes).
constexpr std::int64_t mostElements = std::int64_t{1} << 29;
static_assert(largestModelFile / 5 < static_cast<std::uintmax_t>(mostElements));

/// A line that changes what the faces after it are.
struct StateChange {
    enum class Kind { material, smoothing, library };
    Kind kind;
    std::uint32_t face;  ///< first face of the chunk that it holds for
    std::string_view name;
    std::uint32_t value = 0;  ///< smoothing group, or index of the material once it is known
};

/// Smoothing groups as the file numbers them; 0 is "off".
constexpr std::uint32_t smoothingOff = 0;
constexpr std::uint32_t smoothingNeverSaid = 0xffffffffu;

/// A run of whole lines, parsed on its own.
struct Chunk {
    std::string_view text;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec2> texcoords;
    std::vector<glm::vec3> normals;  ///< unit length, or (0,0,0): not usable
    std::vector<Corner> corners;
    std::vector<std::uint32_t> faceEnds;  ///< into `corners`
    std::vector<StateChange> changes;
    std::size_t triangles = 0;
    std::size_t degenerateFaces = 0;
    bool hasLines = false;
    bool hasPoints = false;
    bool hasCurves = false;
    std::size_t faultOffset = std::string_view::npos;
    std::string fault;

    // Filled when all chunks are known.
    std::size_t firstPosition = 0;
    std::size_t firstTexcoord = 0;
    std::size_t firstNormal = 0;
    std::size_t firstTriangle = 0;
    std::size_t firstFace = 0;
    std::uint32_t material = 0;
    std::uint32_t smoothing = smoothingNeverSaid;
};

bool isBlank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

/// Reads the words of one line. A backslash at a line's end continues the line.
class Line {
  public:
    Line(const char* begin, const char* end) : p_(begin), end_(end) {}

    const char* position() const { return p_; }

    void skipBlanks() {
        while (p_ != end_) {
            if (isBlank(*p_)) {
                ++p_;
            } else if (*p_ == '\\' && continues(p_)) {
                p_ = static_cast<const char*>(std::memchr(p_, '\n', static_cast<std::size_t>(end_ - p_))) + 1;
            } else {
                return;
            }
        }
    }

    bool atEnd() {
        skipBlanks();
        return p_ == end_ || *p_ == '#';
    }

    std::string_view word() {
        skipBlanks();
        const char* begin = p_;
        while (p_ != end_ && !isBlank(*p_) && *p_ != '\n')
            ++p_;
        return {begin, static_cast<std::size_t>(p_ - begin)};
    }

    std::string_view rest() {
        skipBlanks();
        const char* last = end_;
        while (last != p_ && isBlank(last[-1]))
            --last;
        return {p_, static_cast<std::size_t>(last - p_)};
    }

    /// The next number, correctly rounded; false if the next word is not a finite one.
    bool number(float& value) {
        skipBlanks();
        const char* begin = p_ != end_ && *p_ == '+' ? p_ + 1 : p_;
        const auto [stop, error] = std::from_chars(begin, end_, value);
        if (error == std::errc::result_out_of_range) {
            // Too large for a float, or so small that it is 0 or nearly so.
            double wide = 0;
            const auto [wideStop, wideError] = std::from_chars(begin, end_, wide);
            if (wideError == std::errc::result_out_of_range) {
                // Beyond double as well: only the sign of the exponent is left to tell.
                const std::string_view text(begin, static_cast<std::size_t>(stop - begin));
                const std::size_t exponent = text.find_first_of("eE");
                if (exponent == std::string_view::npos || exponent + 1 >= text.size() ||
                    text[exponent + 1] != '-')
                    return false;
                wide = 0;
            }
            value = static_cast<float>(wide);
        } else if (error != std::errc()) {
            return false;
        }
        p_ = stop;
        return std::isfinite(value) && endsWord();
    }

    bool integer(std::int64_t& value) {
        if (p_ != end_ && *p_ == '+')
            ++p_;
        const auto [stop, error] = std::from_chars(p_, end_, value);
        p_ = stop;
        return error == std::errc();
    }

    bool take(char c) {
        if (p_ == end_ || *p_ != c)
            return false;
        ++p_;
        return true;
    }

    bool endsWord() const { return p_ == end_ || isBlank(*p_) || *p_ == '#' || *p_ == '\\' || *p_ == '\n'; }

  private:
    bool continues(const char* backslash) const {
        const char* p = backslash + 1;
        while (p != end_ && *p == '\r')
            ++p;
        return p != end_ && *p == '\n';
    }

    const char* p_;
    const char* end_;
};

/// The end of the line that starts at `begin`: its line break, past continued ones, or `end`.
const char* endOfLine(const char* begin, const char* end) {
    for (const char* p = begin;;) {
        p = static_cast<const char*>(std::memchr(p, '\n', static_cast<std::size_t>(end - p)));
        if (!p)
            return end;
        const char* before = p;
        while (before != begin && before[-1] == '\r')
            --before;
        if (before == begin || before[-1] != '\\')
            return p;
        ++p;
    }
}

glm::vec3 unitOrZero(const glm::vec3& v) {
    const glm::dvec3 wide(v);
    const double length = glm::length(wide);
    return length > 0 ? glm::vec3(wide / length) : glm::vec3(0);
}

class ChunkParser {
  public:
    explicit ChunkParser(Chunk& chunk) : chunk_(chunk) {}

    void parse() {
        const char* const end = chunk_.text.data() + chunk_.text.size();
        for (const char* p = chunk_.text.data(); p < end;) {
            const char* lineEnd = endOfLine(p, end);
            Line line(p, lineEnd);
            if (!parseLine(line)) {
                chunk_.faultOffset = static_cast<std::size_t>(p - chunk_.text.data());
                return;
            }
            p = lineEnd + 1;
        }
    }

  private:
    bool fail(std::string fault) {
        chunk_.fault = std::move(fault);
        return false;
    }

    bool parseLine(Line& line) {
        const std::string_view key = line.word();
        if (key.empty() || key[0] == '#')
            return true;
        if (key == "v")
            return parsePosition(line);
        if (key == "vn")
            return parseNormal(line);
        if (key == "vt")
            return parseTexcoord(line);
        if (key == "f")
            return parseFace(line);
        const auto face = static_cast<std::uint32_t>(chunk_.faceEnds.size());
        if (key == "usemtl")
            chunk_.changes.push_back({StateChange::Kind::material, face, line.rest()});
        else if (key == "mtllib")
            chunk_.changes.push_back({StateChange::Kind::library, face, line.rest()});
        else if (key == "s")
            chunk_.changes.push_back({StateChange::Kind::smoothing, face, {}, smoothingGroup(line)});
        else if (key == "l")
            chunk_.hasLines = true;
        else if (key == "p")
            chunk_.hasPoints = true;
        else if (key == "curv" || key == "curv2" || key == "surf")
            chunk_.hasCurves = true;
        return true;
    }

    static std::uint32_t smoothingGroup(Line& line) {
        line.skipBlanks();
        std::int64_t group = 0;
        if (!line.integer(group) || group < 0 || group >= smoothingNeverSaid)
            return smoothingOff;
        return static_cast<std::uint32_t>(group);
    }

    bool parsePosition(Line& line) {
        glm::vec3 p;
        if (!line.number(p.x) || !line.number(p.y) || !line.number(p.z))
            return fail("a vertex needs three finite numbers");
        chunk_.positions.push_back(p);
        return true;
    }

    bool parseNormal(Line& line) {
        glm::vec3 n;
        if (!line.number(n.x) || !line.number(n.y) || !line.number(n.z))
            n = glm::vec3(0);
        chunk_.normals.push_back(unitOrZero(n));
        return true;
    }

    bool parseTexcoord(Line& line) {
        glm::vec2 t;
        if (!line.number(t.x))
            t.x = 0;
        if (!line.number(t.y))
            t.y = 0;
        chunk_.texcoords.push_back({t.x, 1 - t.y});
        return true;
    }

    /// One index of a corner. An empty one is absent.
    bool parseIndex(Line& line, std::size_t countHere, std::int32_t& index) {
        index = absent;
        std::int64_t written = 0;
        if (!line.integer(written))
            return false;
        if (written == 0 || written > mostElements || written < -mostElements)
            return false;
        if (written > 0)
            index = static_cast<std::int32_t>(written - 1);
        else
            index = relative + static_cast<std::int32_t>(static_cast<std::int64_t>(countHere) + written);
        return true;
    }

    bool parseFace(Line& line) {
        const std::size_t first = chunk_.corners.size();
        while (!line.atEnd()) {
            Corner corner{absent, absent, absent};
            bool good = parseIndex(line, chunk_.positions.size(), corner.position);
            if (good && line.take('/')) {
                if (line.take('/')) {
                    if (!line.endsWord())
                        good = parseIndex(line, chunk_.normals.size(), corner.normal);
                } else if (!line.endsWord()) {
                    good = parseIndex(line, chunk_.texcoords.size(), corner.texcoord);
                    if (good && line.take('/') && !line.endsWord())
                        good = parseIndex(line, chunk_.normals.size(), corner.normal);
                }
            }
            if (!good || !line.endsWord())
                return fail("a face's corner is not an index that can be used (indices count from 1)");
            chunk_.corners.push_back(corner);
        }
        const std::size_t count = chunk_.corners.size() - first;
        if (count < 3) {
            chunk_.corners.resize(first);
            ++chunk_.degenerateFaces;
            return true;
        }
        chunk_.triangles += count - 2;
        chunk_.faceEnds.push_back(static_cast<std::uint32_t>(chunk_.corners.size()));
        return true;
    }

    Chunk& chunk_;
};

/// About `count` runs of whole lines.
std::vector<Chunk> splitLines(std::string_view text) {
    constexpr std::size_t wanted = 1 << 20;
    std::vector<Chunk> chunks;
    const char* const end = text.data() + text.size();
    for (const char* begin = text.data(); begin < end;) {
        const char* stop = end;
        if (static_cast<std::size_t>(end - begin) > wanted) {
            stop = endOfLine(begin + wanted, end);
            // A continued line may have begun before the place that was looked at.
            while (stop != end && stop[-1] == '\\')
                stop = endOfLine(stop + 1, end);
        }
        chunks.emplace_back();
        chunks.back().text = {begin, static_cast<std::size_t>(stop - begin)};
        begin = stop == end ? end : stop + 1;
    }
    return chunks;
}

template <typename T>
std::vector<T> concatenated(std::vector<Chunk>& chunks, std::vector<T> Chunk::*part,
                            std::size_t Chunk::*first, std::size_t total) {
    std::vector<T> all(total);
    tbb::parallel_for(std::size_t{0}, chunks.size(), [&](std::size_t i) {
        std::vector<T>& own = chunks[i].*part;
        std::copy(own.begin(), own.end(), all.begin() + static_cast<std::ptrdiff_t>(chunks[i].*first));
        std::vector<T>().swap(own);
    });
    return all;
}

/// What a triangle's face said about it.
struct TriangleState {
    std::uint32_t material;
    std::uint32_t smoothing;
    std::uint32_t face;
};

class ObjReader {
  public:
    ObjReader(std::string contents, const std::filesystem::path& file)
        : contents_(std::move(contents)), file_(file), folder_(file.parent_path()) {}

    ImportedScene read() {
        parse();
        gatherStates();
        makeTriangles();
        makeMissingNormals();
        buildMeshes();
        fillMaterials();
        scene_.name = file_.stem().string();
        return {std::move(scene_), warnings_.lines()};
    }

  private:
    [[noreturn]] void fail(std::string_view fault, std::size_t offset) const {
        const auto line =
            1 + std::count(contents_.begin(), contents_.begin() + static_cast<std::ptrdiff_t>(offset), '\n');
        throw InputError(fault, fmt::format("{}:{}", printable(file_.string()), line), "repair the line");
    }

    void parse() {
        if (contents_.find('\n') == std::string::npos)
            std::replace(contents_.begin(), contents_.end(), '\r', '\n');
        chunks_ = splitLines(contents_);
        tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
            throwIfInterrupted();
            ChunkParser(chunks_[i]).parse();
        });
        std::size_t positions = 0;
        std::size_t texcoords = 0;
        std::size_t normals = 0;
        std::size_t degenerate = 0;
        std::size_t faces = 0;
        bool lines = false;
        bool points = false;
        bool curves = false;
        for (Chunk& chunk : chunks_) {
            if (chunk.faultOffset != std::string_view::npos)
                fail(chunk.fault,
                     static_cast<std::size_t>(chunk.text.data() - contents_.data()) + chunk.faultOffset);
            chunk.firstPosition = positions;
            chunk.firstTexcoord = texcoords;
            chunk.firstNormal = normals;
            chunk.firstTriangle = triangles_;
            chunk.firstFace = faces;
            positions += chunk.positions.size();
            texcoords += chunk.texcoords.size();
            normals += chunk.normals.size();
            triangles_ += chunk.triangles;
            faces += chunk.faceEnds.size();
            degenerate += chunk.degenerateFaces;
            lines |= chunk.hasLines;
            points |= chunk.hasPoints;
            curves |= chunk.hasCurves;
        }
        if (triangles_ == 0)
            throw InputError("holds no triangles", printable(file_.string()), "use a model with faces");
        if (degenerate > 0)
            warnings_.add("faces of fewer than three corners are not drawn");
        if (lines)
            warnings_.add("lines are not drawn");
        if (points)
            warnings_.add("points are not drawn");
        if (curves)
            warnings_.add("curves and curved surfaces are not drawn");
        positions_ = concatenated(chunks_, &Chunk::positions, &Chunk::firstPosition, positions);
        texcoords_ = concatenated(chunks_, &Chunk::texcoords, &Chunk::firstTexcoord, texcoords);
        normals_ = concatenated(chunks_, &Chunk::normals, &Chunk::firstNormal, normals);
    }

    /// Reads the material libraries, and finds the material and smoothing group that each chunk starts with.
    void gatherStates() {
        for (const Chunk& chunk : chunks_)
            for (const StateChange& change : chunk.changes)
                if (change.kind == StateChange::Kind::library)
                    readLibrary(change.name);
        std::uint32_t material = noMaterial;
        std::uint32_t smoothing = smoothingNeverSaid;
        for (Chunk& chunk : chunks_) {
            chunk.material = material;
            chunk.smoothing = smoothing;
            for (StateChange& change : chunk.changes) {
                if (change.kind == StateChange::Kind::material)
                    change.value = material = materialNamed(change.name);
                else if (change.kind == StateChange::Kind::smoothing)
                    smoothing = change.value;
            }
        }
    }

    static constexpr std::uint32_t noMaterial = 0xffffffffu;

    void readLibrary(std::string_view names) {
        // Names may hold blanks; the whole rest of the line is tried first.
        std::vector<std::string_view> candidates{names};
        Line line(names.data(), names.data() + names.size());
        for (std::string_view word = line.word(); !word.empty() && word != names; word = line.word())
            candidates.push_back(word);
        if (librariesRead_.contains(std::string(names)))
            return;
        librariesRead_.insert(std::string(names));
        if (librariesRead_.size() > mostLibraries)
            throw InputError(fmt::format("more than {} material libraries", mostLibraries),
                             printable(file_.string()), "join them into one");
        bool found = false;
        for (std::size_t i = 0; i < candidates.size() && i <= mostLibraries; ++i) {
            const auto path = pathBeside(folder_, candidates[i]);
            std::error_code error;
            if (!path || !std::filesystem::is_regular_file(*path, error))
                continue;
            found = true;
            if (!libraryFilesRead_.insert(path->string()).second)
                continue;
            readMaterials(readFile(*path, largestLibrary));
            if (i == 0)
                break;
        }
        if (!found)
            warnings_.add(fmt::format("drawn without the material library {}: it is not beside the model",
                                      printable(names, 80)));
    }

    void readMaterials(const std::string& text) {
        std::istringstream stream(text);
        std::string warning;
        std::string error;
        std::vector<tinyobj::material_t> materials;
        std::map<std::string, int> indices;
        tinyobj::LoadMtl(&indices, &materials, &stream, &warning, &error);
        // tinyobjloader does not tell an ambient colour that is black from one that is not given.
        std::set<std::string> withAmbient;
        std::string name;
        const char* const end = text.data() + text.size();
        for (const char* p = text.data(); p < end;) {
            const char* const lineEnd = std::find(p, end, '\n');
            Line line(p, lineEnd);
            const std::string_view key = line.word();
            if (key == "newmtl")
                name = line.rest();
            else if (key == "Ka")
                withAmbient.insert(name);
            p = lineEnd == end ? end : lineEnd + 1;
        }
        for (const tinyobj::material_t& material : materials) {
            if (material.name.empty())
                continue;
            std::string trimmed = material.name.substr(0, material.name.find_last_not_of(" \t\r") + 1);
            trimmed.erase(0, trimmed.find_first_not_of(" \t"));
            if (materialIndices_.try_emplace(trimmed, static_cast<std::uint32_t>(library_.size())).second) {
                library_.push_back(material);
                hasAmbient_.push_back(withAmbient.contains(trimmed));
            }
        }
    }

    std::uint32_t materialNamed(std::string_view name) {
        const auto found = materialIndices_.find(std::string(name));
        if (found != materialIndices_.end())
            return found->second;
        warnings_.add(
            fmt::format("drawn with a default material: {} is in no material library", printable(name, 80)));
        return noMaterial;
    }

    /// Resolves the corners of all faces, and cuts the faces into triangles.
    void makeTriangles() {
        corners_.resize(3 * triangles_);
        states_.resize(triangles_);
        std::vector<std::size_t> badCorner(chunks_.size(), std::string_view::npos);
        std::atomic<bool> normalsMissing{false};
        std::atomic<bool> tangled{false};
        tbb::parallel_for(std::size_t{0}, chunks_.size(), [&](std::size_t i) {
            throwIfInterrupted();
            Chunk& chunk = chunks_[i];
            std::uint32_t material = chunk.material;
            std::uint32_t smoothing = chunk.smoothing;
            std::size_t change = 0;
            std::size_t triangle = chunk.firstTriangle;
            std::uint32_t begin = 0;
            bool missing = false;
            std::vector<glm::vec3> polygon;
            std::vector<std::uint32_t> cut;
            for (std::uint32_t face = 0; face < chunk.faceEnds.size(); ++face) {
                for (; change < chunk.changes.size() && chunk.changes[change].face <= face; ++change) {
                    const StateChange& now = chunk.changes[change];
                    if (now.kind == StateChange::Kind::material)
                        material = now.value;
                    else if (now.kind == StateChange::Kind::smoothing)
                        smoothing = now.value;
                }
                const std::uint32_t end = chunk.faceEnds[face];
                for (std::uint32_t c = begin; c < end; ++c) {
                    Corner& corner = chunk.corners[c];
                    if (!resolve(corner.position, chunk.firstPosition, positions_.size()) ||
                        !resolve(corner.texcoord, chunk.firstTexcoord, texcoords_.size()) ||
                        !resolve(corner.normal, chunk.firstNormal, normals_.size())) {
                        badCorner[i] = face;
                        return;
                    }
                    if (corner.normal != absent &&
                        normals_[static_cast<std::size_t>(corner.normal)] == glm::vec3(0))
                        corner.normal = absent;
                    missing |= corner.normal == absent;
                }
                const std::uint32_t count = end - begin;
                const TriangleState state{material, smoothing,
                                          static_cast<std::uint32_t>(chunk.firstFace + face)};
                if (count == 3) {
                    std::copy_n(&chunk.corners[begin], 3, &corners_[3 * triangle]);
                } else {
                    polygon.resize(count);
                    cut.resize(3 * (count - 2));
                    for (std::uint32_t c = 0; c < count; ++c)
                        polygon[c] = positions_[static_cast<std::size_t>(chunk.corners[begin + c].position)];
                    if (!triangulatePolygon(polygon, cut))
                        tangled = true;
                    for (std::size_t c = 0; c < cut.size(); ++c)
                        corners_[3 * triangle + c] = chunk.corners[begin + cut[c]];
                }
                for (std::uint32_t t = 0; t < count - 2; ++t)
                    states_[triangle++] = state;
                begin = end;
            }
            if (missing)
                normalsMissing = true;
        });
        for (std::size_t i = 0; i < chunks_.size(); ++i)
            if (badCorner[i] != std::string_view::npos)
                fail("a face names a vertex, texture coordinate or normal that is not there",
                     offsetOfFace(chunks_[i], badCorner[i]));
        if (tangled)
            warnings_.add("polygons that cross themselves or have no area are cut up as they come");
        normalsMissing_ = normalsMissing;
        chunks_ = {};
    }

    static bool resolve(std::int32_t& index, std::size_t first, std::size_t count) {
        if (index == absent)
            return true;
        std::int64_t resolved = index;
        if (index < 0)
            resolved = static_cast<std::int64_t>(index) - relative + static_cast<std::int64_t>(first);
        if (resolved < 0 || resolved >= static_cast<std::int64_t>(count))
            return false;
        index = static_cast<std::int32_t>(resolved);
        return true;
    }

    /// Where face number `face` of a chunk is written.
    std::size_t offsetOfFace(const Chunk& chunk, std::size_t face) const {
        const char* const end = chunk.text.data() + chunk.text.size();
        std::size_t seen = 0;
        for (const char* p = chunk.text.data(); p < end;) {
            const char* const lineEnd = endOfLine(p, end);
            Line line(p, lineEnd);
            if (line.word() == "f") {
                std::size_t corners = 0;
                for (; !line.atEnd(); line.word())
                    ++corners;
                if (corners >= 3 && seen++ == face)
                    return static_cast<std::size_t>(p - contents_.data());
            }
            p = lineEnd + 1;
        }
        return static_cast<std::size_t>(chunk.text.data() - contents_.data());
    }

    void makeMissingNormals() {
        contents_ = {};
        if (!normalsMissing_)
            return;
        bool anyFlat = false;
        bool severalGroups = false;
        std::uint32_t firstGroup = smoothingOff;
        for (const TriangleState& state : states_) {
            if (state.smoothing == smoothingOff)
                anyFlat = true;
            else if (firstGroup == smoothingOff)
                firstGroup = state.smoothing;
            else if (state.smoothing != firstGroup)
                severalGroups = true;
        }
        // Flat faces have one normal each. Others have one a position, or, if there are several smoothing
        // groups, one for each position in each group: those pairs are counted by sorting them.
        const std::size_t flatCount = anyFlat ? std::size_t{states_.back().face} + 1 : 0;
        std::size_t smoothCount = positions_.size();
        std::vector<std::uint64_t> pairs;
        const auto pairOf = [&](std::size_t corner) {
            return std::uint64_t{states_[corner / 3].smoothing} << 32 |
                   static_cast<std::uint32_t>(corners_[corner].position);
        };
        if (severalGroups) {
            for (std::size_t c = 0; c < corners_.size(); ++c)
                if (corners_[c].normal == absent && states_[c / 3].smoothing != smoothingOff)
                    pairs.push_back(pairOf(c));
            tbb::parallel_sort(pairs.begin(), pairs.end());
            pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
            smoothCount = pairs.size();
        }
        std::vector<std::uint32_t> positionIndices(corners_.size());
        std::vector<std::uint32_t> groups(corners_.size(), noGroup);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, corners_.size(), 8192), [&](const auto& range) {
            for (std::size_t c = range.begin(); c != range.end(); ++c) {
                positionIndices[c] = static_cast<std::uint32_t>(corners_[c].position);
                if (corners_[c].normal != absent)
                    continue;
                const TriangleState& state = states_[c / 3];
                if (state.smoothing == smoothingOff)
                    groups[c] = static_cast<std::uint32_t>(smoothCount + state.face);
                else if (severalGroups)
                    groups[c] = static_cast<std::uint32_t>(
                        std::lower_bound(pairs.begin(), pairs.end(), pairOf(c)) - pairs.begin());
                else
                    groups[c] = positionIndices[c];
                corners_[c].normal = static_cast<std::int32_t>(normals_.size() + groups[c]);
            }
        });
        const std::size_t groupCount = smoothCount + flatCount;
        const std::vector<glm::vec3> made = smoothNormals(positions_, positionIndices, groups, groupCount);
        normals_.insert(normals_.end(), made.begin(), made.end());
    }

    /// One mesh a material, in the order of the materials' first use.
    void buildMeshes() {
        std::vector<std::uint32_t> order;                          // materials as used
        std::unordered_map<std::uint32_t, std::uint32_t> placeOf;  // material → place in `order`
        std::vector<std::size_t> counts;
        std::uint32_t last = noMaterial;
        std::uint32_t place = 0;
        std::vector<std::uint32_t> places(triangles_);
        for (std::size_t t = 0; t < triangles_; ++t) {
            if (t == 0 || states_[t].material != last) {
                last = states_[t].material;
                const auto [entry, isNew] =
                    placeOf.try_emplace(last, static_cast<std::uint32_t>(order.size()));
                if (isNew) {
                    order.push_back(last);
                    counts.push_back(0);
                }
                place = entry->second;
            }
            places[t] = place;
            ++counts[place];
        }
        materialsUsed_ = order;
        std::vector<std::size_t> starts(order.size() + 1, 0);
        for (std::size_t i = 0; i < order.size(); ++i)
            starts[i + 1] = starts[i] + counts[i];
        std::vector<std::uint32_t> sorted;
        if (order.size() > 1) {
            sorted.resize(triangles_);
            std::vector<std::size_t> next(starts.begin(), starts.end() - 1);
            for (std::size_t t = 0; t < triangles_; ++t)
                sorted[next[places[t]]++] = static_cast<std::uint32_t>(t);
        }
        std::vector<std::uint32_t> newestVertex(positions_.size(), noVertex);
        for (std::size_t i = 0; i < order.size(); ++i) {
            throwIfInterrupted();
            scene_.meshes.push_back(buildMesh(sorted, starts[i], starts[i + 1], newestVertex));
            scene_.instances.push_back({"", i, i, glm::mat4(1)});
        }
    }

    static constexpr std::uint32_t noVertex = 0xffffffffu;

    /// Joins equal corners: each position keeps a list of the vertices made from it, newest first, of which
    /// only so many are looked at that a position used with ever new normals costs no more than others.
    Mesh buildMesh(const std::vector<std::uint32_t>& sorted, std::size_t begin, std::size_t end,
                   std::vector<std::uint32_t>& newestVertex) {
        constexpr int mostLooks = 32;
        struct Vertex {
            Corner corner;
            std::uint32_t older;
        };
        std::vector<Vertex> vertices;
        Mesh mesh;
        mesh.indices.resize(3 * (end - begin));
        bool anyTexcoord = false;
        for (std::size_t i = 0; i < end - begin; ++i) {
            const std::size_t t = sorted.empty() ? begin + i : sorted[begin + i];
            for (std::size_t k = 0; k < 3; ++k) {
                const Corner& corner = corners_[3 * t + k];
                std::uint32_t& newest = newestVertex[static_cast<std::size_t>(corner.position)];
                std::uint32_t vertex = newest;
                for (int looks = 0; vertex != noVertex; vertex = vertices[vertex].older) {
                    const Corner& other = vertices[vertex].corner;
                    if (other.texcoord == corner.texcoord && other.normal == corner.normal)
                        break;
                    if (++looks == mostLooks) {
                        vertex = noVertex;
                        break;
                    }
                }
                if (vertex == noVertex) {
                    vertex = static_cast<std::uint32_t>(vertices.size());
                    vertices.push_back({corner, newest});
                    newest = vertex;
                    anyTexcoord |= corner.texcoord != absent;
                }
                mesh.indices[3 * i + k] = vertex;
            }
        }
        mesh.positions.resize(vertices.size());
        mesh.normals.resize(vertices.size());
        mesh.texcoords.resize(anyTexcoord ? vertices.size() : 0);
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices.size(), 8192), [&](const auto& range) {
            for (std::size_t v = range.begin(); v != range.end(); ++v) {
                const Corner& corner = vertices[v].corner;
                mesh.positions[v] = positions_[static_cast<std::size_t>(corner.position)];
                mesh.normals[v] = normals_[static_cast<std::size_t>(corner.normal)];
                if (anyTexcoord && corner.texcoord != absent)
                    mesh.texcoords[v] = texcoords_[static_cast<std::size_t>(corner.texcoord)];
                newestVertex[static_cast<std::size_t>(corner.position)] = noVertex;
            }
        });
        return mesh;
    }

    void fillMaterials() {
        TextureShelf shelf(scene_, warnings_);
        for (std::size_t i = 0; i < materialsUsed_.size(); ++i) {
            Material material;
            material.name = "default";
            material.doubleSided = true;
            if (materialsUsed_[i] != noMaterial)
                fillMaterial(material, materialsUsed_[i], shelf);
            scene_.meshes[i].name = material.name;
            scene_.instances[i].name = material.name;
            scene_.materials.push_back(std::move(material));
        }
    }

    static float finite(float value, float low, float high, float otherwise) {
        return std::isfinite(value) ? std::clamp(value, low, high) : otherwise;
    }

    static glm::vec3 color(const float (&c)[3]) {
        constexpr float most = 1e6f;
        return {finite(c[0], 0, most, 0), finite(c[1], 0, most, 0), finite(c[2], 0, most, 0)};
    }

    void fillMaterial(Material& material, std::uint32_t index, TextureShelf& shelf) {
        const tinyobj::material_t& source = library_[index];
        material.name = printable(source.name.substr(0, source.name.find_last_not_of(" \t\r") + 1));
        material.diffuse = color(source.diffuse);
        material.specular = color(source.specular);
        material.ambient = hasAmbient_[index] ? color(source.ambient) : material.diffuse;
        material.emission = color(source.emission);
        material.shininess = finite(source.shininess, 0, 1e5f, 32);
        const float opacity = finite(source.dissolve, 0, 1, 1);
        material.baseColor = glm::vec4(material.diffuse, opacity);
        if (opacity < 1) {
            material.alphaMode = Material::AlphaMode::blend;
            warnings_.add("blended surfaces are drawn opaque");
        }
        // 1 is what tinyobjloader gives where the file says nothing.
        if (const float ior = finite(source.ior, 0, static_cast<float>(mostIor), 1); ior > 1)
            material.ior = ior;
        // Of the illumination models these are glass (4, 9) and refraction (6, 7).
        if (source.illum == 4 || source.illum == 6 || source.illum == 7 || source.illum == 9) {
            const glm::vec3 filter = glm::min(color(source.transmittance), glm::vec3(1));
            material.transmission = 1;
            if (filter != glm::vec3(0))
                material.baseColor = glm::vec4(filter, opacity);
            else if (opacity < 1 && opacity > 0)
                material.transmission = 1 - opacity;
            warnings_.add("glass is drawn opaque: light goes through it where paths are traced");
        }
        material.metallic = finite(source.metallic, 0, 1, 0);
        // 0 is what tinyobjloader gives where the file says nothing.
        const float roughness = finite(source.roughness, 0, 1, 0);
        material.roughness = roughness > 0 ? roughness : roughnessFromShininess(material.shininess);
        if (!source.diffuse_texname.empty()) {
            const Texture::Wrap wrap =
                source.diffuse_texopt.clamp ? Texture::Wrap::clampToEdge : Texture::Wrap::repeat;
            const std::string& name = source.diffuse_texname;
            material.baseColorTexture = shelf.texture(name, wrap, wrap, [&] {
                const auto path = pathBeside(folder_, name);
                if (!path)
                    throw InputError("not a name of a file beside the model", printable(name));
                return readImage8(*path);
            });
        }
        for (const auto& [texture, what] :
             {std::pair{&source.bump_texname, "bump maps"}, std::pair{&source.normal_texname, "normal maps"},
              std::pair{&source.specular_texname, "specular maps"},
              std::pair{&source.alpha_texname, "opacity maps"},
              std::pair{&source.displacement_texname, "displacement maps"},
              std::pair{&source.reflection_texname, "reflection maps"},
              std::pair{&source.emissive_texname, "emission maps"}})
            if (!texture->empty())
                warnings_.add(fmt::format("{} are not drawn", what));
    }

    static constexpr std::size_t mostLibraries = 1000;
    static constexpr std::uintmax_t largestLibrary = std::uintmax_t{64} << 20;

    std::string contents_;
    std::filesystem::path file_;
    std::filesystem::path folder_;
    Warnings warnings_;
    Scene scene_;

    std::vector<Chunk> chunks_;
    std::vector<glm::vec3> positions_;
    std::vector<glm::vec2> texcoords_;
    std::vector<glm::vec3> normals_;
    std::size_t triangles_ = 0;
    std::vector<Corner> corners_;  ///< three a triangle
    std::vector<TriangleState> states_;
    bool normalsMissing_ = false;

    std::set<std::string> librariesRead_;
    std::set<std::string> libraryFilesRead_;
    std::vector<tinyobj::material_t> library_;
    std::vector<bool> hasAmbient_;
    std::unordered_map<std::string, std::uint32_t> materialIndices_;
    std::vector<std::uint32_t> materialsUsed_;
};

}  // namespace

ImportedScene importObj(std::string contents, const std::filesystem::path& file) {
    return ObjReader(std::move(contents), file).read();
}

}  // namespace quincunx
