// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/idl/idl_model.hpp"

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::idl {

/// Finds the key in samples of a keyed struct type, for tools that pass samples on and were not compiled for them.
class KeyFinder {
  public:
    /// `type`: of the model, which must outlive this.
    KeyFinder(Model const& model, std::size_t type);

    /// The members of the key in big-endian CDR without a header, as DDS hashes them (DDSI-RTPS 9.6.3.8). Fails when
    /// the sample is not of the type, or the key has hundreds of members: then nothing is said to belong to it.
    [[nodiscard]] Result<std::vector<std::byte>> key_of(std::span<std::byte const> cdr) const;
    /// Whether every key of the type fits into 16 octets: it then is the hash as it is; others by MD5.
    [[nodiscard]] bool is_short() const { return is_short_; }
    /// Whether the leaf or sequence at this path of a sample belongs to the key.
    [[nodiscard]] bool covers(std::string_view path) const;

  private:
    Model const& model_;
    std::size_t type_;
    std::vector<std::string> members_; ///< paths of the key's members ("bus", "pos.x")
    bool is_known_{false}, is_short_{false};
};

} // namespace gridspace::idl
