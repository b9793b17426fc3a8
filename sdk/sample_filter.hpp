// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/native_layout.hpp"
#include "common/program/declaration.hpp"

#include <string>
#include <vector>

namespace gridspace::sdk {

/// Which samples of a topic a program wants, by texts in them (`only` of its description).
class SampleFilter {
  public:
    /// Fails when the type has no text of that name. What has no value in `values` filters nothing.
    [[nodiscard]] static Result<SampleFilter> create(idl::NativeLayout const& layout,
                                                     std::vector<program::Topic::Only> const& only,
                                                     program::Values const& values);

    /// `sample`: a struct of the layout.
    [[nodiscard]] bool admits(void const* sample) const;

  private:
    struct Member {
        std::size_t offset;
        std::vector<std::string> accepted;
    };
    std::vector<Member> members_;
};

} // namespace gridspace::sdk
