// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/common/relay_events.hpp"

#include <array>
#include <utility>

namespace gridspace::relay {

std::string block_names(BlockReasons reasons) {
    static constexpr std::array<std::pair<Block, std::string_view>, 10> kNames{{{kFilling, "filling"},
                                                                                {kFromLost, "from_lost"},
                                                                                {kToLost, "to_lost"},
                                                                                {kFromQuality, "from_quality"},
                                                                                {kToQuality, "to_quality"},
                                                                                {kFromTest, "from_test"},
                                                                                {kToTest, "to_test"},
                                                                                {kFromSynch, "from_synch"},
                                                                                {kToSynch, "to_synch"},
                                                                                {kOutOfService, "out_of_service"}}};
    std::string out;
    for (auto const& [bit, name] : kNames) {
        if ((reasons & bit) != 0) {
            out += out.empty() ? "" : ", ";
            out += name;
        }
    }
    return out;
}

std::string_view name_of(RelayEvent::Kind kind) {
    switch (kind) {
    case RelayEvent::Kind::pickup:
        return "pickup";
    case RelayEvent::Kind::dropout:
        return "dropout";
    case RelayEvent::Kind::trip:
        return "trip";
    case RelayEvent::Kind::withheld:
        return "withheld";
    case RelayEvent::Kind::released:
        return "released";
    case RelayEvent::Kind::reset:
        return "reset";
    case RelayEvent::Kind::block:
        return "block";
    case RelayEvent::Kind::unblock:
        return "unblock";
    case RelayEvent::Kind::window_emptied:
        return "window_emptied";
    }
    return "?";
}

std::string phase_names(std::uint8_t phases) {
    std::string out;
    for (unsigned p = 0; p < 3; ++p) {
        if ((phases & (1U << p)) != 0) {
            out += static_cast<char>('a' + p);
        }
    }
    return out;
}

} // namespace gridspace::relay
