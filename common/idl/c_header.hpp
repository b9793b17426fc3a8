// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/native_layout.hpp"

#include <set>
#include <string>

namespace gridspace::idl {

/// Structs of C, and of C++, for types of IDL, as NativeLayout lays them out. "a::b::Name" becomes a_b_Name.
class CHeader {
  public:
    /// With all that it is made of, once.
    void add(NativeLayout const& layout);
    /// The header; `origin` says in its first line where it comes from.
    [[nodiscard]] std::string text(std::string_view origin) const;

  private:
    void add(NativeLayout const& layout, std::size_t type);
    std::set<std::string> known_;
    std::string declarations_, type_names_;
};

} // namespace gridspace::idl
