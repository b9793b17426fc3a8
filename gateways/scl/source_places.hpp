// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"
#include "gateways/scl/xml.hpp"

#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::scl {

/// What was noticed in an SCL file.
struct Finding {
    enum class Kind {
        left_out, ///< what stands there is not in the result
        assumed,  ///< the result has another value than the file, or one that the file does not say
        doubtful, ///< taken over as it stands, and probably not meant so
    };
    Kind kind{Kind::assumed};
    config::SourceMark where;
    std::string subject; ///< "IED1 gcb1": whose it is
    std::string text;    ///< what was found, and what became of it
    std::string remedy;  ///< what to do in the file; may be empty
};
[[nodiscard]] std::string_view kind_name(Finding::Kind kind);

/// Of a file of mistakes so many are kept.
inline constexpr std::size_t kMostFindings = 2000;

/// Lines and columns of elements: the parser knows lines only.
class SourcePlaces {
  public:
    SourcePlaces(std::string name, std::string_view text);

    /// Where an element begins, or the value of one of its attributes.
    [[nodiscard]] config::SourceMark of(Element const& element, char const* attribute = nullptr) const;
    [[nodiscard]] config::SourceMark line(int number) const;

  private:
    std::shared_ptr<config::SourceText const> source_;
};

/// Gathers findings.
class Findings {
  public:
    explicit Findings(SourcePlaces const& places) : places_{places} {}
    struct What {
        std::string subject, text, remedy{};
    };
    void add(Finding::Kind kind, Element const& where, char const* attribute, What what);
    void left_out(Element const& where, What what) { add(Finding::Kind::left_out, where, nullptr, std::move(what)); }
    void assumed(Element const& where, What what) { add(Finding::Kind::assumed, where, nullptr, std::move(what)); }
    void doubtful(Element const& where, What what) { add(Finding::Kind::doubtful, where, nullptr, std::move(what)); }

    [[nodiscard]] std::vector<Finding> const& all() const { return all_; }
    [[nodiscard]] std::size_t dropped() const { return dropped_; } ///< beyond kMostFindings

  private:
    SourcePlaces const& places_;
    std::vector<Finding> all_;
    std::size_t dropped_{0};
};

} // namespace gridspace::scl
