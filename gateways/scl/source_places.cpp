// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/source_places.hpp"

#include "common/config/yaml.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::scl {
namespace {

constexpr int kLinesOfATag = 50;

/// Whether the tag that begins at `at` has the element's first attribute, as far as it stands on this line.
bool has_its_first_attribute(std::string_view line, std::size_t at, Element const& element) {
    auto const* const first = element.FirstAttribute();
    std::string_view const tag = line.substr(at, line.find('>', at) - at);
    if (first == nullptr || std::string_view{first->Value()}.find_first_of("&<>\"'\n") != std::string_view::npos) {
        return true;
    }
    std::size_t const name = tag.find(fmt::format("{}=", first->Name()));
    return name == std::string_view::npos ? tag.find('=') == std::string_view::npos
                                          : tag.substr(name).find(first->Value()) != std::string_view::npos;
}

} // namespace

std::string_view kind_name(Finding::Kind kind) {
    return kind == Finding::Kind::left_out ? "left_out" : kind == Finding::Kind::assumed ? "assumed" : "doubtful";
}

SourcePlaces::SourcePlaces(std::string name, std::string_view text)
    : source_{config::make_source(std::move(name), text)} {}

config::SourceMark SourcePlaces::line(int number) const {
    config::SourceMark mark{source_, number, 1};
    if (number >= 1 && static_cast<std::size_t>(number) <= source_->lines.size()) {
        std::size_t const first = source_->lines[static_cast<std::size_t>(number) - 1].find_first_not_of(" \t");
        mark.column = first == std::string::npos ? 1 : static_cast<int>(first) + 1;
    }
    return mark;
}

config::SourceMark SourcePlaces::of(Element const& element, char const* attribute) const {
    int const number = element.GetLineNum();
    if (number < 1 || static_cast<std::size_t>(number) > source_->lines.size()) {
        return line(number);
    }
    std::string_view const text = source_->lines[static_cast<std::size_t>(number) - 1];
    std::string const tag = fmt::format("<{}", element.Name());
    std::size_t at = text.find(tag), best = at;
    for (; at != std::string_view::npos; at = text.find(tag, at + 1)) {
        char const behind = at + tag.size() < text.size() ? text[at + tag.size()] : ' ';
        if ((behind == ' ' || behind == '>' || behind == '/' || behind == '\t') &&
            has_its_first_attribute(text, at, element)) {
            best = at;
            break;
        }
    }
    if (best == std::string_view::npos) {
        return line(number);
    }
    config::SourceMark mark{source_, number, static_cast<int>(best) + 1};
    if (attribute == nullptr) {
        return mark;
    }
    std::string const wanted = fmt::format("{}=", attribute);
    std::size_t from = best;
    for (int n = number; n < number + kLinesOfATag && static_cast<std::size_t>(n) <= source_->lines.size(); ++n) {
        std::string_view const row = source_->lines[static_cast<std::size_t>(n) - 1];
        std::size_t const end = std::min(row.find('>', from), row.size());
        std::size_t const found = row.find(wanted, from);
        if (found < end && (found == 0 || row[found - 1] == ' ' || row[found - 1] == '\t')) {
            return {source_, n, static_cast<int>(found) + 1};
        }
        if (end < row.size()) {
            break;
        }
        from = 0;
    }
    return mark;
}

void Findings::add(Finding::Kind kind, Element const& where, char const* attribute, What what) {
    if (all_.size() >= kMostFindings) {
        ++dropped_;
        return;
    }
    all_.push_back(
        {kind, places_.of(where, attribute), std::move(what.subject), std::move(what.text), std::move(what.remedy)});
}

} // namespace gridspace::scl
