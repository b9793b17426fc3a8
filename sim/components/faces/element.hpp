// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <complex>
#include <span>
#include <string>
#include <string_view>

namespace gridspace::sim {

using config::Ref;
using Complex = std::complex<double>;

/// What every named element has.
struct Element {
    Ref name;
    std::string label; ///< display text; the name when empty
};

/// A quantity that an event or an agent may set in a run. Its unit is the suffix of its name.
struct Quantity {
    std::string_view name;
    config::NumberSpec range{}; ///< for every element of the kind, and what the quantity is
    bool in_phasors{true}, in_waveforms{true};
};

/// What all elements of a kind have in common: words and small facts.
struct Kind {
    std::string_view section; ///< of a network file, and in the paths of `set:` ("loads")
    std::string_view doc;     ///< of that section
    std::string_view word;    ///< in messages ("load")
    std::string_view prefix;  ///< of its signals, and its symbol in the one-line diagram ("load")
    bool feeds{false};        ///< its powers count positive into the network, and it ceases when no grid holds its bus
    bool has_signals{true};
    bool switched{false};  ///< `open:` and `close:` of an event work on it
    bool stands_by{false}; ///< `stop:` and `start:` work on it: a converter
    std::span<Quantity const> settable{};
};

} // namespace gridspace::sim
