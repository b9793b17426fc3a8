// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/control_address.hpp"

#include <algorithm>
#include <charconv>

namespace gridspace::scl {

Element const* find_address(Element const& root, ControlPlace const& place, char const* kind) {
    Element const* const communication = child(root, "Communication");
    if (communication == nullptr) {
        return nullptr;
    }
    Element const* elsewhere = nullptr;
    for (Element const* net : children(*communication, "SubNetwork")) {
        for (Element const* connected : children(*net, "ConnectedAP")) {
            if (attribute(*connected, "iedName") != place.ied) {
                continue;
            }
            for (Element const* e : children(*connected, kind)) {
                if (attribute(*e, "ldInst") != place.ld_inst || attribute(*e, "cbName") != place.block) {
                    continue;
                }
                if (attribute(*connected, "apName") == place.access_point) {
                    return e;
                }
                elsewhere = elsewhere == nullptr ? e : elsewhere;
            }
        }
    }
    return elsewhere;
}

std::optional<unsigned> hexadecimal(std::string text) {
    if (text.starts_with("0x") || text.starts_with("0X")) {
        text.erase(0, 2);
    }
    unsigned value = 0;
    auto const [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    return ec == std::errc{} && end == text.data() + text.size() ? std::optional{value} : std::nullopt;
}

std::optional<iec61850::Mac> mac_of(std::string text) {
    if (text.size() == 12) {
        for (std::size_t at = 2; at < 17; at += 3) {
            text.insert(at, 1, '-');
        }
    }
    std::replace(text.begin(), text.end(), ' ', '-');
    return iec61850::Mac::parse(text);
}

} // namespace gridspace::scl
