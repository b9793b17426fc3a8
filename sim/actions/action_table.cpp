// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/actions/action_table.hpp"

#include "common/text.hpp"
#include "sim/components/faces/number_specs.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <tuple>
#include <type_traits>
#include <utility>

namespace gridspace::sim {
namespace {

using elements::any;
using elements::not_negative;
using elements::positive;

constexpr CommandUse kService[] = {{Command::connect, "puts it back into service"},
                                   {Command::disconnect, "takes it out of service"}};
constexpr CommandUse kConverter[] = {
    kService[0],
    kService[1],
    {Command::start, "gives its power again: with waveforms as after an outage, with phasors at once"},
    {Command::stop, "stands by: connected, and without current"}};
constexpr CommandUse kSwitch[] = {{Command::open, "opens its poles, each at a zero of its current"},
                                  {Command::close, "closes its poles"},
                                  kService[0],
                                  kService[1]};
constexpr CommandUse kOnlyOut[] = {kService[1]};
constexpr CommandUse kGeneratorService[] = {
    {Command::connect, "puts it back into service; with phasors one of role pq, with waveforms no slack"},
    {Command::disconnect, "takes it out of service; with phasors one of role pq"}};
constexpr CommandUse kOnlyOutInWaveforms[] = {{Command::disconnect, "takes it out of service", false}};
constexpr CommandUse kBreaker[] = {
    {Command::open, "opens its poles after its mechanism's time; a stuck one stays closed"},
    {Command::close, "closes its poles"},
    {Command::reset, "its mechanism works again, if it was stuck (`fail_to_open`)"}};

constexpr Quantity kSource[] = {
    {"voltage_pu", not_negative("its internal voltage")},
    {"frequency_hz", positive("its frequency, the phase goes on; with phasors behind an impedance")}};
constexpr Quantity kMachine[] = {{"p_kw", any("power at nominal speed that its governor holds")},
                                 {"voltage_setpoint_pu", positive("voltage that its regulator holds")},
                                 {"droop_percent", positive("of its governor")}};
constexpr Quantity kGenerator[] = {{"p_kw", any("power into the network; not of a slack")},
                                   {"q_kvar", any("reactive power into the network; of role pq")},
                                   {"voltage_setpoint_pu", positive("voltage that it holds; of roles slack and pv")}};
constexpr Quantity kTransformer[] = {
    {"tap_ratio", positive("off-nominal ratio at its `from` side; with waveforms not of one that saturates")}};

template <auto Member>
std::vector<std::string> names_of(Network const& network) {
    std::vector<std::string> out;
    for (auto const& element : network.*Member) {
        out.push_back(element.name.name);
    }
    return out;
}

template <auto Member>
constexpr ActionKind one_port() {
    using Elements = std::remove_cvref_t<decltype(std::declval<Network const&>().*Member)>;
    constexpr Kind const& kKind = Elements::value_type::kKind;
    return {kKind.section,
            kKind.prefix,
            kKind.word,
            kKind.settable,
            kKind.stands_by  ? std::span<CommandUse const>{kConverter}
            : kKind.switched ? std::span<CommandUse const>{kSwitch}
                             : std::span<CommandUse const>{kService},
            names_of<Member>};
}

template <std::size_t... I>
constexpr auto all_kinds(std::index_sequence<I...>) {
    return std::array{
        one_port<std::get<I>(kOnePorts)>()...,
        ActionKind{"sources", "source", "source", kSource, kOnlyOutInWaveforms, names_of<&Network::sources>},
        ActionKind{"machines", "machine", "machine", kMachine, kOnlyOut, names_of<&Network::machines>},
        ActionKind{"generators", "generator", "generator", kGenerator, kGeneratorService,
                   names_of<&Network::generators>},
        ActionKind{"lines", "line", "line", {}, kService, names_of<&Network::lines>},
        ActionKind{"transformers", "transformer", "transformer", kTransformer, kService,
                   names_of<&Network::transformers>},
        ActionKind{"breakers", "breaker", "breaker", {}, kBreaker, names_of<&Network::breakers>},
    };
}

constexpr auto kKinds = all_kinds(std::make_index_sequence<std::tuple_size_v<decltype(kOnePorts)>>{});

ActionKind const* kind_where(std::string_view ActionKind::* word, std::string_view is) {
    auto const found = std::find_if(kKinds.begin(), kKinds.end(), [&](ActionKind const& k) { return k.*word == is; });
    return found == kKinds.end() ? nullptr : &*found;
}

/// "loads.<name>.p_kw, ..."
std::string settable_paths(bool waveform) {
    std::vector<std::string> out;
    for (ActionKind const& kind : kKinds) {
        for (std::string const& quantity : kind.quantity_names(waveform)) {
            out.push_back(fmt::format("{}.<name>.{}", kind.section, quantity));
        }
    }
    return join(out, ", ");
}

} // namespace

Quantity const* ActionKind::quantity(std::string_view name, bool waveform) const {
    auto const found = std::find_if(quantities.begin(), quantities.end(), [&](Quantity const& q) {
        return q.name == name && (waveform ? q.in_waveforms : q.in_phasors);
    });
    return found == quantities.end() ? nullptr : &*found;
}

CommandUse const* ActionKind::use(Command command, bool waveform) const {
    auto const found = std::find_if(commands.begin(), commands.end(), [&](CommandUse const& c) {
        return c.command == command && (waveform ? c.in_waveforms : c.in_phasors);
    });
    return found == commands.end() ? nullptr : &*found;
}

std::vector<std::string> ActionKind::quantity_names(bool waveform) const {
    std::vector<std::string> out;
    for (Quantity const& q : quantities) {
        if (waveform ? q.in_waveforms : q.in_phasors) {
            out.emplace_back(q.name);
        }
    }
    return out;
}

std::span<ActionKind const> action_kinds() {
    return kKinds;
}
ActionKind const* kind_of_section(std::string_view section) {
    return kind_where(&ActionKind::section, section);
}
ActionKind const* kind_of_prefix(std::string_view prefix) {
    return kind_where(&ActionKind::prefix, prefix);
}

bool within(config::NumberSpec const& range, double value) {
    return std::isfinite(value) && value >= range.min && value <= range.max && value > range.above &&
           value < range.below;
}

std::string range_text(config::NumberSpec const& range) {
    std::vector<std::string> parts;
    for (auto const& [sign, bound] :
         {std::pair{">=", range.min}, {">", range.above}, {"<=", range.max}, {"<", range.below}}) {
        if (std::isfinite(bound)) {
            parts.push_back(fmt::format("{} {}", sign, shortest(bound)));
        }
    }
    return join(parts, " and ");
}

Error cannot_be_set(SetParameter const& action, bool waveform) {
    return {ExitCode::usage,
            fmt::format("'{}' cannot be set to {} while a {} simulation runs", action.path, shortest(action.value),
                        waveform ? "waveform" : "phasor"),
            settable_paths(waveform) + " can"};
}

Result<Setting> setting_of(SetParameter const& action, bool waveform) {
    std::string_view const path = action.path;
    std::size_t const first = path.find('.'), last = path.rfind('.');
    if (first == std::string_view::npos || first == last) {
        return std::unexpected{cannot_be_set(action, waveform)};
    }
    ActionKind const* kind = kind_of_section(path.substr(0, first));
    Quantity const* quantity = kind == nullptr ? nullptr : kind->quantity(path.substr(last + 1), waveform);
    if (quantity == nullptr || !within(quantity->range, action.value)) {
        return std::unexpected{cannot_be_set(action, waveform)};
    }
    return Setting{kind, path.substr(first + 1, last - first - 1), quantity};
}

} // namespace gridspace::sim
