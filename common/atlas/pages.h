#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "lab/json.h"

/// Results as pages: what the store holds, put into the templates of web/templates.
namespace quincunx::atlas {

/// What all pages tell of a lab; each part as its verb prints it with --json.
struct LabResults {
    std::string folder;  ///< "10_shading"
    std::string name;    ///< "shading"
    std::string topic;
    int number = 0;
    Json picture;                 ///< survey.cpp
    std::vector<Json> knobs;      ///< survey.cpp
    std::vector<Json> sweeps;     ///< `sweep`, with the pictures of its points
    Json stress;                  ///< `stress`
    Json plan;                    ///< `plan`
    std::vector<Json> questions;  ///< `ask`
};

/// One object, and back; what `fromJson` cannot understand is an InputError naming `where`.
Json toJson(const LabResults& results);
LabResults labResultsFrom(const Json& json, const std::string& where);

/// Where the pages go, and where they find what they show of the tree.
struct Site {
    std::filesystem::path folder;
    std::filesystem::path sources;  ///< the tree with labs/NN_topic/README.md and shaders/
};

/// The lab's page, and the pages of the sources it tells people to read. Files that would stay the same are
/// left alone. Returns how many were written.
int writeLabPage(const Site& site, const LabResults& lab);
/// The index, and the pages of the questions, of stability and of cost.
int writeCommonPages(const Site& site, std::span<const LabResults> labs);

}  // namespace quincunx::atlas
