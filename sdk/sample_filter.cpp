// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/sample_filter.hpp"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>

namespace gridspace::sdk {

Result<SampleFilter> SampleFilter::create(idl::NativeLayout const& layout,
                                          std::vector<program::Topic::Only> const& only,
                                          program::Values const& values) {
    SampleFilter out;
    for (auto const& [member, is] : only) {
        auto const offset = layout.offset_of(member, idl::Kind::string);
        if (!offset) {
            return fail(ExitCode::usage,
                        fmt::format("`only` names '{}', and {} has no text of that name", member, layout.root().name));
        }
        if (auto accepted = program::expand(is, values); !accepted.empty()) {
            out.members_.push_back({*offset, std::move(accepted)});
        }
    }
    return out;
}

bool SampleFilter::admits(void const* sample) const {
    return std::ranges::all_of(members_, [&](Member const& member) {
        char const* text = nullptr;
        std::memcpy(static_cast<void*>(&text), static_cast<std::byte const*>(sample) + member.offset, sizeof text);
        return std::ranges::find(member.accepted, text == nullptr ? "" : text) != member.accepted.end();
    });
}

} // namespace gridspace::sdk
