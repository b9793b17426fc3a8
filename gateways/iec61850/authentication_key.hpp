// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/crypto/message_code.hpp"

#include <limits>
#include <optional>
#include <string_view>
#include <vector>

namespace gridspace::iec61850 {

/// The registry of IEC 61850-90-5 and IEC 62351-6:2020.
enum class CodeAlgorithm : std::uint8_t {
    hmac_sha256_80 = 1,
    hmac_sha256_128 = 2,
    hmac_sha256_256 = 3,
    aes_gmac_64 = 4,
    aes_gmac_128 = 5,
};
/// Octets of the code on the wire: the first ones of what is computed.
[[nodiscard]] std::size_t code_octets(CodeAlgorithm algorithm) noexcept;
[[nodiscard]] crypto::CodeKind code_kind(CodeAlgorithm algorithm) noexcept;

/// A key and when it is used, as a file of keys says.
struct KeyEntry {
    std::uint32_t id{0};
    std::vector<std::uint8_t> secret;
    std::int64_t from_ns{std::numeric_limits<std::int64_t>::min()}; ///< UTC
    std::int64_t until_ns{std::numeric_limits<std::int64_t>::max()};
};

/// Reads a file of keys: a line for each, `ID SECRET [from=TIME] [until=TIME]`. ID: 1 to 4294967295. SECRET:
/// hexadecimal. TIME: seconds of simulated time, or UTC like 2026-11-24T05:00:00Z. `#` begins a comment. Errors name
/// `file` and the line, never a secret. `start_utc_ns`: when simulated time is 0; nothing: not known, as in real time,
/// and such a TIME is an error.
[[nodiscard]] Result<std::vector<KeyEntry>> parse_keys(std::string_view text, std::string_view file,
                                                       std::optional<std::int64_t> start_utc_ns);

/// The keys of a stream, ready for use. A sender uses the one that became valid last; a receiver takes each that is
/// valid, so two keys overlap for as long as their times do.
class KeyRing {
  public:
    struct Key {
        std::uint32_t id{0};
        std::int64_t from_ns{0}, until_ns{0};
        crypto::MessageCode code;
        [[nodiscard]] bool valid(std::int64_t utc_ns) const noexcept { return from_ns <= utc_ns && utc_ns < until_ns; }
    };

    [[nodiscard]] static Result<KeyRing> create(crypto::CodeKind kind, std::vector<KeyEntry> const& entries);

    [[nodiscard]] Key* find(std::uint32_t id) noexcept;
    [[nodiscard]] Key* to_send_with(std::int64_t utc_ns) noexcept;
    /// When the next key becomes valid; nothing: none will.
    [[nodiscard]] std::int64_t next_change_ns(std::int64_t utc_ns) const noexcept;

  private:
    std::vector<Key> keys_; ///< in the order of from_ns
};

} // namespace gridspace::iec61850
