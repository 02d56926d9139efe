#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What a lab's README says, as far as its page shows it.
namespace quincunx::atlas {

/// A line of Markdown as HTML: `code`, **bold**, *stress*, \| and [text](target). All else is text, and
/// escaped. `link` turns a target into what the page links to; empty: the link's text alone.
std::string inlineHtml(std::string_view markdown, const std::function<std::string(const std::string&)>& link);

struct Readme {
    std::string intro;                                       ///< first paragraph, Markdown
    std::vector<std::string> reading;                        ///< items of "Read, in this order", Markdown
    std::vector<std::pair<std::string, std::string>> tries;  ///< rows of "Try": do, see; Markdown
};

/// Takes apart the text of a README.md; what is not there is empty.
Readme parseReadme(std::string_view text);

/// All targets of links in a line of Markdown.
std::vector<std::string> linkTargets(std::string_view markdown);

}  // namespace quincunx::atlas
