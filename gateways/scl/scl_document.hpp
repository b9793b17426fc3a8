// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/scl/source_places.hpp"

#include <memory>

namespace gridspace::scl {

/// The largest file that is read: real stations have some tens of MB.
inline constexpr std::size_t kLargestFile = 256U << 20U;

/// An SCL file as elements. Fails, with file:line:column, when it is no XML or no SCL.
class Document {
  public:
    [[nodiscard]] static Result<Document> parse(std::string const& text, std::string const& name);

    [[nodiscard]] Element const& root() const { return *xml_->RootElement(); }
    [[nodiscard]] SourcePlaces const& places() const { return *places_; }

  private:
    Document() = default;
    std::unique_ptr<tinyxml2::XMLDocument> xml_;
    std::unique_ptr<SourcePlaces> places_;
};

/// What is wrong with the file as a whole and does not keep it from being read: its namespace.
void check_root(Document const& document, Findings& findings);

} // namespace gridspace::scl
