// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "sim/components/faces/command.hpp"
#include "sim/components/faces/surroundings.hpp"

#include <algorithm>
#include <complex>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace gridspace::sim {

/// A quantity that an event or an agent may set in a run. Its unit is the suffix of its name.
struct Quantity {
    std::string_view name;
    config::NumberSpec range{}; ///< for every element of the kind, and what the quantity is
    bool in_phasors{true}, in_waveforms{true};
    bool turns_voltages{false}; ///< voltages turn at another speed from then on
};

/// What all elements of a kind have in common: words and small facts.
struct Kind {
    std::string_view section; ///< of a network file, and in the paths of `set:` ("loads")
    std::string_view doc;     ///< of that section
    std::string_view word;    ///< in messages ("load")
    /// Of its signals, and its symbol in the one-line diagram ("load"). Empty: data that elements share, or a profile.
    std::string_view prefix{};
    bool feeds{false};      ///< its powers count positive into the network, and it ceases when no grid holds its bus
    bool has_signals{true}; ///< waveforms: the powers and currents at its poles
    std::span<CommandUse const> commands{};
    std::span<Quantity const> settable{};
    std::span<Mode const> modes{}; ///< of Command::mode

    [[nodiscard]] constexpr CommandUse const* use(Command command) const {
        auto const found = std::find_if(commands.begin(), commands.end(),
                                        [command](CommandUse const& c) { return c.command == command; });
        return found == commands.end() ? nullptr : &*found;
    }
    [[nodiscard]] constexpr bool follows(Command command) const { return use(command) != nullptr; }
};

/// How an element finds mistakes that its own keys do not show.
class ElementCheck {
  public:
    virtual ~ElementCheck() = default;
    [[nodiscard]] virtual Surroundings const& around() const = 0;
    /// `ref` must name an element of that kind; otherwise this is said, and false.
    virtual bool exists(Kind const& kind, Ref const& ref) = 0;
    virtual void wrong(std::string_view what, std::string hint) = 0;
    /// The same, at another place than its name.
    virtual void wrong_at(Ref const& place, std::string_view what, std::string hint) = 0;
    /// `profile`, if it is given, must exist.
    virtual void profile(Ref const& profile) = 0;
};

/// Why a quantity of this element cannot be set, and what to do instead.
struct Refusal {
    std::string_view why, hint;
};

/// What a network file names: its data as in the file, and what everybody may ask of it.
struct Element {
    Ref name;
    std::string label; ///< display text; the name when empty

    Element() = default;
    Element(Element const&) = default;
    Element(Element&&) = default;
    Element& operator=(Element const&) = default;
    Element& operator=(Element&&) = default;
    virtual ~Element() = default;

    [[nodiscard]] virtual Kind const& kind() const = 0;
    /// The keys of the network file.
    virtual void fields(config::Fields& f) = 0;
    virtual void check(ElementCheck& /*check*/) const {}
    /// What of it phasors do not show, in words that its name follows ("the harmonics of source").
    [[nodiscard]] virtual std::string_view unseen_by_phasors() const { return {}; }

    /// Changes a quantity of kind().settable in a run, as far as it is in the element's data; false when it cannot have
    /// this value.
    virtual bool set(std::string_view /*quantity*/, double /*value*/) { return true; }
    [[nodiscard]] virtual std::optional<Refusal> refuses(std::string_view /*quantity*/, Surroundings const& /*around*/,
                                                         bool /*waveform*/) const {
        return {};
    }
    /// The same of a mode of kind().modes.
    [[nodiscard]] virtual std::optional<Refusal> refuses_mode(std::string_view /*mode*/,
                                                              Surroundings const& /*around*/) const {
        return {};
    }
    /// The values that such a quantity of this element can have.
    [[nodiscard]] virtual config::NumberSpec range(Quantity const& quantity, Surroundings const& /*around*/,
                                                   bool /*waveform*/) const {
        return quantity.range;
    }
    /// What such a quantity is now.
    [[nodiscard]] virtual double value(std::string_view /*quantity*/, Surroundings const& /*around*/) const {
        return 0;
    }
};

template <class T>
T const* Surroundings::find(Ref const& name) const {
    return static_cast<T const*>(element(T::kKind.section, name));
}

/// Of its signals: "load.L1".
[[nodiscard]] inline std::string signal_prefix(Element const& e) {
    return std::string{e.kind().prefix} + "." + e.name.name;
}

/// In messages: "load 'L1'".
[[nodiscard]] inline std::string owner_of(Element const& e) {
    return std::string{e.kind().word} + " '" + e.name.name + "'";
}

} // namespace gridspace::sim
