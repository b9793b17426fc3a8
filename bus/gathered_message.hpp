// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace gridspace::bus {

/// An RTPS message as Fast DDS sends it, taken apart as far as one needs to know to make one of several.
struct MessageParts {
    bool mergeable{false};                                         ///< only kinds that need not be alone in a message
    std::span<std::uint8_t const> header, submessages, statistics; ///< the last one ends it, and may be empty
    bool directed{false};                                          ///< has an INFO_DST; all of them name `destination`
    std::array<std::uint8_t, 12> destination{};                    ///< a GUID prefix
};
/// `message`: must outlive what is returned.
[[nodiscard]] MessageParts parts_of(std::span<std::uint8_t const> message);

/// Several messages of one sender to one destination, as one (DDSI-RTPS 2.2, clause 8.3.4). Its memory is kept for the
/// next one.
class GatheredMessage {
  public:
    [[nodiscard]] bool empty() const { return octets_.empty(); }
    /// Whether `parts` may follow what is there, and it has no more than `longest` octets then.
    [[nodiscard]] bool takes(MessageParts const& parts, std::size_t longest) const;
    void add(MessageParts const& parts);
    /// What is there, as a message that may be added to another; valid until the next add() or clear().
    [[nodiscard]] MessageParts parts() const;
    /// The message to send; after it only clear().
    [[nodiscard]] std::span<std::uint8_t const> finish();
    void clear();

  private:
    std::vector<std::uint8_t> octets_; ///< without `statistics_`
    std::vector<std::uint8_t> statistics_;
    bool directed_{false};
    std::array<std::uint8_t, 12> destination_{};
};

} // namespace gridspace::bus
