// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/control_address.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::scl {

namespace {

std::string key(char const* kind, std::string const& ied, std::string const& ld, std::string const& block) {
    return fmt::format("{}\n{}\n{}\n{}", kind, ied, ld, block);
}

} // namespace

Addresses::Addresses(Element const& root) {
    Element const* const communication = child(root, "Communication");
    if (communication == nullptr) {
        return;
    }
    for (Element const* net : children(*communication, "SubNetwork")) {
        for (Element const* connected : children(*net, "ConnectedAP")) {
            for (char const* kind : {"GSE", "SMV"}) {
                for (Element const* e : children(*connected, kind)) {
                    by_block_[key(kind, attribute(*connected, "iedName"), attribute(*e, "ldInst"),
                                  attribute(*e, "cbName"))]
                        .emplace_back(attribute(*connected, "apName"), e);
                }
            }
        }
    }
}

Element const* Addresses::find(ControlPlace const& place, char const* kind) const {
    auto const found = by_block_.find(key(kind, place.ied, place.ld_inst, place.block));
    if (found == by_block_.end()) {
        return nullptr;
    }
    for (auto const& [point, e] : found->second) {
        if (point == place.access_point) {
            return e;
        }
    }
    return found->second.front().second;
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
