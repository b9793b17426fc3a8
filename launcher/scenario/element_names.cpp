// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/element_names.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <tuple>
#include <type_traits>
#include <utility>

namespace gridspace::launcher {
namespace {

using sim::Network;

/// A kind by its name, and what is known of each of its elements.
struct Kind {
    std::string_view name, title;
    std::vector<std::string> (*names)(Network const&);
    std::optional<std::string> (*quantity)(Network const&, std::string_view element, std::string_view quantity);
};

template <auto Member>
std::vector<std::string> names_of(Network const& network) {
    std::vector<std::string> out;
    for (auto const& element : network.*Member) {
        out.push_back(element.name.name);
    }
    return out;
}

template <auto Member>
std::optional<std::string> quantity_of(Network const& network, std::string_view name, std::string_view quantity) {
    auto const* element = sim::find(network.*Member, name);
    if (element == nullptr) {
        return std::nullopt;
    }
    if constexpr (requires { element->bus.name; }) {
        if (quantity == "bus") {
            return element->bus.name;
        }
    }
    if constexpr (requires { element->capacity_kwh; }) {
        if (quantity == "capacity_kwh") {
            return shortest(element->capacity_kwh);
        }
    }
    if constexpr (requires { element->p_kw; }) {
        if (quantity == "p_kw") {
            return shortest(element->p_kw);
        }
    }
    return std::nullopt;
}

template <auto Member>
constexpr Kind kind(std::string_view name, std::string_view title) {
    return {name, title, names_of<Member>, quantity_of<Member>};
}

/// One that lies at one bus says itself what it is called.
template <auto Member>
constexpr Kind one_port() {
    using Elements = std::remove_cvref_t<decltype(std::declval<Network const&>().*Member)>;
    return kind<Member>(Elements::value_type::kKind.prefix, Elements::value_type::kKind.word);
}

template <std::size_t... I>
constexpr auto all_kinds(std::index_sequence<I...>) {
    return std::array{
        kind<&Network::buses>("bus", "bus"),
        kind<&Network::sources>("source", "source"),
        kind<&Network::lines>("line", "line"),
        kind<&Network::transformers>("transformer", "transformer"),
        kind<&Network::breakers>("breaker", "breaker"),
        kind<&Network::cts>("ct", "current transformer"),
        kind<&Network::vts>("vt", "voltage transformer"),
        kind<&Network::machines>("machine", "machine"),
        kind<&Network::generators>("generator", "generator"),
        one_port<std::get<I>(sim::kOnePorts)>()...,
    };
}

constexpr auto kKinds = all_kinds(std::make_index_sequence<std::tuple_size_v<decltype(sim::kOnePorts)>>{});

Kind const* find_kind(std::string_view name) {
    auto const found = std::find_if(kKinds.begin(), kKinds.end(), [&](Kind const& k) { return k.name == name; });
    return found == kKinds.end() ? nullptr : &*found;
}

} // namespace

std::vector<std::string> element_kinds() {
    std::vector<std::string> out;
    for (Kind const& one : kKinds) {
        out.emplace_back(one.name);
    }
    return out;
}

std::string title_of_kind(std::string_view name) {
    Kind const* found = find_kind(name);
    return std::string{found == nullptr ? name : found->title};
}

std::optional<std::vector<std::string>> element_names(Network const& network, std::string_view name) {
    Kind const* found = find_kind(name);
    return found == nullptr ? std::nullopt : std::optional{found->names(network)};
}

std::optional<std::string> element_quantity(Network const& network, std::string_view name, std::string_view element,
                                            std::string_view quantity) {
    Kind const* found = find_kind(name);
    return found == nullptr ? std::nullopt : found->quantity(network, element, quantity);
}

} // namespace gridspace::launcher
