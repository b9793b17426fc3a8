// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/octets.hpp"

#include <optional>
#include <span>
#include <string_view>

namespace gridspace::rtps_guard {

/// Why a datagram is kept from the library.
enum class Refusal : std::uint8_t {
    none,
    not_rtps,    ///< shorter than a header, another magic, another major version, no GUID prefix
    submessage,  ///< its length reaches beyond the datagram, or is not a multiple of four within it
    kind,        ///< one that nobody sends here: security without security, statistics out of place
    content,     ///< its numbers contradict each other, or the octets that are there
    parameters,  ///< a damaged parameter list
    identity,    ///< it announces or removes somebody else than who sends it
    stranger,    ///< not a word of it is an announcement, and nobody has announced who sends it
    crowd,       ///< one participant more than there is room for
    unprotected, ///< on a secured bus: neither protected, nor what comes before protection
    farewell,    ///< on a secured bus: of a participant, which is never protected
    count_
};
[[nodiscard]] std::string_view to_string(Refusal refusal);

struct Examined {
    Refusal refusal{Refusal::none};
    std::size_t octets{0};                 ///< what the library is given: without Fast DDS's statistics at the end
    GuidPrefix source{};                   ///< of the header
    std::array<GuidPrefix, 8> announced{}; ///< participants that announce themselves: several of one process may
    std::size_t announced_count{0};
    bool has_fragments{false}; ///< of samples: the library is given what they come to (bus/rtps_guard/fragments.hpp)
};

struct Rules {
    bool speaks_for_itself{true}; ///< false with a discovery server, which announces others
    /// With DDS Security the library takes words without protection from anybody under a member's name, all but
    /// samples. Then only announcements and handshakes may come so; what is protected it judges itself.
    bool secured{false};
};

inline constexpr std::uint32_t kLongestSample = 16U << 20U; ///< octets, of a sample that comes in fragments

/// Whether a datagram is an RTPS message (DDSI-RTPS 2.2, clauses 8.3 and 9.4) that Fast DDS 2.9 can read without harm.
/// Its assertions are live in Debian's build, and it believes lengths. Pure. May turn parameters into padding
/// (bus/rtps_guard/parameter_guard.hpp), and nothing else.
[[nodiscard]] Examined examine(std::span<std::uint8_t> datagram, Rules rules = {});

} // namespace gridspace::rtps_guard
