// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/dss_words.hpp"

#include <fmt/format.h>

namespace gridspace::opendss {
namespace {

constexpr std::string_view kOpening = "([{\"'";
constexpr std::string_view kClosing = ")]}\"'";

class Scanner {
  public:
    Scanner(std::string_view text, config::SourceMark start, config::Diagnostics& diagnostics)
        : text_{text}, start_{std::move(start)}, diagnostics_{diagnostics} {}

    std::vector<Word> words() {
        std::vector<Word> out;
        while (skip_separators()) {
            Word word = value();
            std::size_t const here = at_;
            skip_blanks();
            if (!word.enclosed && at_ < text_.size() && text_[at_] == '=') {
                ++at_;
                skip_blanks();
                std::string name = lower(word.value);
                word = at_end() ? Word{{}, {}, false, mark(at_)} : value();
                word.name = std::move(name);
            } else {
                at_ = here;
            }
            out.push_back(std::move(word));
        }
        return out;
    }

    std::vector<Word> items() {
        std::vector<Word> out;
        while (skip_separators()) {
            if (text_[at_] == '|') {
                out.push_back({{}, "|", false, mark(at_++)});
            } else {
                out.push_back(value("|"));
            }
        }
        return out;
    }

  private:
    [[nodiscard]] static bool blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }
    [[nodiscard]] bool comment() const { return text_[at_] == '!' || text_.substr(at_).starts_with("//"); }
    [[nodiscard]] bool at_end() const { return at_ >= text_.size() || comment(); }
    [[nodiscard]] config::SourceMark mark(std::size_t at) const {
        return {start_.source, start_.line, start_.column + static_cast<int>(at)};
    }
    void skip_blanks() {
        while (at_ < text_.size() && blank(text_[at_])) {
            ++at_;
        }
    }
    bool skip_separators() {
        while (at_ < text_.size() && (blank(text_[at_]) || text_[at_] == ',' || text_[at_] == '=')) {
            ++at_;
        }
        return !at_end();
    }

    Word value(std::string_view also_ends = {}) {
        std::size_t const kind = kOpening.find(text_[at_]);
        if (kind != std::string_view::npos) {
            return bracketed(text_[at_], kClosing[kind]);
        }
        std::size_t const begin = at_;
        while (at_ < text_.size() && !blank(text_[at_]) && text_[at_] != ',' && text_[at_] != '=' &&
               text_[at_] != '!' && also_ends.find(text_[at_]) == std::string_view::npos) {
            ++at_;
        }
        return {{}, std::string{text_.substr(begin, at_ - begin)}, false, mark(begin)};
    }

    Word bracketed(char open, char close) {
        std::size_t const begin = at_++;
        int depth = 1;
        for (; at_ < text_.size(); ++at_) {
            if (text_[at_] == close) { // first: a quote opens as it closes
                if (--depth == 0) {
                    Word word{{}, std::string{text_.substr(begin + 1, at_ - begin - 1)}, true, mark(begin + 1)};
                    ++at_;
                    return word;
                }
            } else if (text_[at_] == open) {
                ++depth;
            }
        }
        diagnostics_.error(mark(begin), fmt::format("'{}' is not closed on this line", open),
                           fmt::format("expected a '{}'", close));
        return {{}, std::string{text_.substr(begin + 1)}, true, mark(begin + 1)};
    }

    std::string_view text_;
    config::SourceMark start_;
    config::Diagnostics& diagnostics_;
    std::size_t at_{0};
};

} // namespace

std::string lower(std::string_view text) {
    std::string out{text};
    for (char& c : out) {
        c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    }
    return out;
}

std::vector<Word> words_of(std::string_view line, config::SourceMark const& start, config::Diagnostics& diagnostics) {
    return Scanner{line, start, diagnostics}.words();
}

std::vector<Word> items_of(Word const& list, config::Diagnostics& diagnostics) {
    return Scanner{list.value, list.where, diagnostics}.items();
}

} // namespace gridspace::opendss
