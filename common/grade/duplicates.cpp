#include "grade/duplicates.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <tuple>

#include <fmt/format.h>

namespace quincunx::grade {
namespace {

constexpr std::size_t window = 5;
constexpr std::size_t digitsOfHash = 8;
constexpr std::size_t leastShared = 12;
constexpr std::size_t mostPairs = 500;

bool isWordPart(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_';
}

/// Words and signs without comments.
std::vector<std::string> wordsOf(std::string_view text) {
    std::vector<std::string> words;
    for (std::size_t i = 0; i < text.size();) {
        const std::string_view rest = text.substr(i);
        if (rest.starts_with("//")) {
            i += std::min(rest.find('\n'), rest.size());
        } else if (rest.starts_with("/*")) {
            const std::size_t end = rest.find("*/", 2);
            i += end == std::string_view::npos ? rest.size() : end + 2;
        } else if (isWordPart(text[i])) {
            std::size_t end = i;
            while (end < text.size() && isWordPart(text[end]))
                ++end;
            words.emplace_back(text.substr(i, end - i));
            i = end;
        } else {
            if (static_cast<unsigned char>(text[i]) > ' ')
                words.emplace_back(1, text[i]);
            ++i;
        }
    }
    return words;
}

std::set<std::uint32_t> shinglesOf(std::string_view text,
                                   const std::set<std::string, std::less<>>& ownNames) {
    std::vector<std::string> words = wordsOf(text);
    for (std::string& word : words)
        if (ownNames.contains(word))
            word = "name";
    std::set<std::uint32_t> shingles;
    for (std::size_t i = 0; i + window <= words.size(); ++i) {
        std::uint32_t hash = 2166136261u;
        for (std::size_t k = 0; k < window; ++k)
            for (const char c : words[i + k] + ' ')
                hash = (hash ^ static_cast<unsigned char>(c)) * 16777619u;
        shingles.insert(hash);
    }
    return shingles;
}

/// Names declared in the text: words after a type.
std::set<std::string, std::less<>> declaredIn(std::string_view text) {
    static const std::set<std::string, std::less<>> types = {"float", "int",   "uint", "bool", "vec2",
                                                             "vec3",  "vec4",  "mat2", "mat3", "mat4",
                                                             "ivec2", "ivec3", "ivec4"};
    std::set<std::string, std::less<>> names;
    const std::vector<std::string> words = wordsOf(text);
    for (std::size_t i = 0; i + 1 < words.size(); ++i)
        if (types.contains(words[i]) && isWordPart(words[i + 1].front()))
            names.insert(words[i + 1]);
    return names;
}

std::vector<std::uint32_t> numbersOf(const std::string& text) {
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i + digitsOfHash <= text.size(); i += digitsOfHash)
        numbers.push_back(
            static_cast<std::uint32_t>(std::strtoul(text.substr(i, digitsOfHash).c_str(), nullptr, 16)));
    return numbers;
}

std::vector<int> bytesOf(const std::string& signature) {
    std::vector<int> bytes;
    for (std::size_t i = 0; i + 2 <= signature.size(); i += 2)
        bytes.push_back(static_cast<int>(std::strtol(signature.substr(i, 2).c_str(), nullptr, 16)) - 128);
    return bytes;
}

struct Difference {
    std::size_t record = 0;
    std::vector<int> values;
    double strength = 0;
};

/// Pictures that differ from the reference in the same places by the same amounts.
void findAlikeScreenshots(const std::vector<Record>& records, std::vector<Pair>& pairs) {
    std::vector<Difference> differences;
    for (std::size_t i = 0; i < records.size(); ++i)
        for (const Part& part : records[i].parts) {
            if (part.kind != "screenshot" || part.exact || part.signature.empty())
                continue;
            Difference difference{i, bytesOf(part.signature), 0};
            for (const int value : difference.values)
                difference.strength += value * value;
            // Less than a code's worth of difference everywhere says nothing.
            if (difference.strength > static_cast<double>(difference.values.size()))
                differences.push_back(std::move(difference));
        }
    std::sort(differences.begin(), differences.end(),
              [](const Difference& a, const Difference& b) { return a.strength < b.strength; });
    constexpr double alike = 0.01;  // of what differs from the reference, squared
    for (std::size_t i = 0; i < differences.size(); ++i)
        for (std::size_t j = i + 1;
             j < differences.size() && differences[j].strength < 1.25 * differences[i].strength; ++j) {
            if (differences[i].values.size() != differences[j].values.size() || pairs.size() >= mostPairs)
                continue;
            double apart = 0;
            for (std::size_t k = 0; k < differences[i].values.size(); ++k) {
                const double d = differences[i].values[k] - differences[j].values[k];
                apart += d * d;
            }
            if (apart < alike * differences[i].strength)
                pairs.push_back({std::min(differences[i].record, differences[j].record),
                                 std::max(differences[i].record, differences[j].record),
                                 "their screenshots differ from the reference in the same way"});
        }
}

void findAlikeShaders(const std::vector<Record>& records, std::vector<Pair>& pairs) {
    // Only those that share an uncommon shingle are compared.
    constexpr std::size_t common = 50;
    std::vector<std::vector<std::uint32_t>> shingles;
    std::map<std::uint32_t, std::vector<std::size_t>> owners;
    for (std::size_t i = 0; i < records.size(); ++i) {
        shingles.push_back(numbersOf(records[i].shaderTokens));
        for (const std::uint32_t shingle : shingles.back())
            owners[shingle].push_back(i);
    }
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> shared;
    for (const auto& [shingle, who] : owners)
        for (std::size_t a = 0; a < who.size() && who.size() <= common; ++a)
            for (std::size_t b = a + 1; b < who.size(); ++b)
                ++shared[{who[a], who[b]}];
    for (const auto& [pair, uncommon] : shared) {
        const auto& [a, b] = pair;
        std::vector<std::uint32_t> both;
        std::set_intersection(shingles[a].begin(), shingles[a].end(), shingles[b].begin(), shingles[b].end(),
                              std::back_inserter(both));
        const std::size_t all = shingles[a].size() + shingles[b].size() - both.size();
        if (both.size() >= leastShared && 10 * both.size() >= 8 * all && pairs.size() < mostPairs)
            pairs.push_back(
                {a, b,
                 fmt::format(
                     "their shaders share {} of {} pieces that are neither the handout's nor the solution's",
                     both.size(), all)});
    }
}

}  // namespace

std::string shaderTokens(std::string_view shader, const std::vector<std::string_view>& known) {
    std::set<std::string, std::less<>> names = declaredIn(shader);
    std::set<std::uint32_t> shingles = shinglesOf(shader, names);
    for (const std::string_view text : known) {
        for (const std::uint32_t shingle : shinglesOf(text, names))
            shingles.erase(shingle);
        for (const std::uint32_t shingle : shinglesOf(text, declaredIn(text)))
            shingles.erase(shingle);
    }
    constexpr std::size_t most = 4000;
    std::string text;
    for (const std::uint32_t shingle : shingles)
        if (text.size() < most * digitsOfHash)
            text += fmt::format("{:08x}", shingle);
    return text;
}

std::vector<Pair> findPairs(const std::vector<Record>& records) {
    std::vector<Pair> pairs;
    findAlikeScreenshots(records, pairs);
    findAlikeShaders(records, pairs);
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
        return std::tie(a.first, a.second, a.text) < std::tie(b.first, b.second, b.text);
    });
    return pairs;
}

}  // namespace quincunx::grade
