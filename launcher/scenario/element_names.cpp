// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/element_names.hpp"

#include "common/text.hpp"
#include "sim/network/network.hpp"

#include <optional>

namespace gridspace::launcher {
namespace {

using sim::Network;

/// Calls visit(kind, elements) for each kind that agents and settings can name.
template <class Visit>
void for_each_named_kind(Network const& network, Visit const& visit) {
    sim::for_each_kind(network, [&]<class T>(std::vector<T> const& elements) {
        if (!T::kKind.prefix.empty()) {
            visit(T::kKind, elements);
        }
    });
}

template <class T>
std::optional<std::string> quantity_of(T const& element, std::string_view quantity) {
    if constexpr (requires { element.bus.name; }) {
        if (quantity == "bus") {
            return element.bus.name;
        }
    }
    if constexpr (requires { element.capacity_kwh; }) {
        if (quantity == "capacity_kwh") {
            return shortest(element.capacity_kwh);
        }
    }
    if constexpr (requires { element.p_kw; }) {
        if (quantity == "p_kw") {
            return shortest(element.p_kw);
        }
    }
    return std::nullopt;
}

} // namespace

std::vector<std::string> element_kinds() {
    std::vector<std::string> out;
    for_each_named_kind({}, [&](sim::Kind const& kind, auto const&) { out.emplace_back(kind.prefix); });
    return out;
}

std::string title_of_kind(std::string_view name) {
    std::string title{name};
    for_each_named_kind({}, [&](sim::Kind const& kind, auto const&) {
        if (kind.prefix == name) {
            title = kind.word;
        }
    });
    return title;
}

std::optional<std::vector<std::string>> element_names(Network const& network, std::string_view name) {
    std::optional<std::vector<std::string>> out;
    for_each_named_kind(network, [&](sim::Kind const& kind, auto const& elements) {
        if (kind.prefix == name) {
            out.emplace();
            for (auto const& element : elements) {
                out->push_back(element.name.name);
            }
        }
    });
    return out;
}

std::optional<std::string> element_quantity(Network const& network, std::string_view name, std::string_view element,
                                            std::string_view quantity) {
    std::optional<std::string> out;
    for_each_named_kind(network, [&](sim::Kind const& kind, auto const& elements) {
        auto const* found = kind.prefix == name ? sim::find(elements, element) : nullptr;
        if (found != nullptr) {
            out = quantity_of(*found, quantity);
        }
    });
    return out;
}

} // namespace gridspace::launcher
