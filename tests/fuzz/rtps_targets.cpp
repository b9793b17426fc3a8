// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/rtps_guard/gate.hpp"
#include "targets.hpp"

#include <algorithm>
#include <vector>

namespace gridspace::fuzz {

void rtps(std::uint8_t const* data, std::size_t size) {
    using namespace rtps_guard;
    for (Rules const rules : {Rules{true, false}, Rules{false, false}, Rules{true, true}}) {
        std::vector<std::uint8_t> octets{data, data + size};
        Examined const first = examine(octets, rules);
        for (std::size_t i = 0; i < size; ++i) {
            require(octets[i] == data[i] || octets[i] == 0, "something else than a parameter was changed");
        }
        require(first.octets <= size, "more than there is");
        if (first.refusal != Refusal::none) {
            continue;
        }
        Examined const second = examine({octets.data(), first.octets}, rules);
        require(second.refusal == Refusal::none && second.octets == first.octets && second.announced == first.announced,
                "what the library is given is judged otherwise");
        Gate gate{rules, 1};
        std::size_t messages = 0;
        gate.admit(octets, 0, [&](std::span<std::uint8_t const> message) {
            ++messages;
            std::vector<std::uint8_t> given{message.begin(), message.end()};
            Examined const third = examine(given, rules);
            require(third.refusal == Refusal::none && !third.has_fragments, "what the library is given is not sound");
        });
        require(first.has_fragments || messages <= 1, "one datagram became several");
    }
}

} // namespace gridspace::fuzz
