// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/instrument_data.hpp"
#include "sim/components/faces/two_port.hpp"

namespace gridspace::sim {

/// Three poles at one end of a line: a breaker, a fuse.
struct LineSwitch : Element {
    Ref line;
    LineEnd end{LineEnd::from};

    [[nodiscard]] virtual bool closed_at_start() const { return true; }
    /// How its poles part on an opening command.
    [[nodiscard]] virtual emt::Opening opening(Surroundings const& around) const = 0;
};

/// Three instrument transformers, of currents at one end of a line or of voltages at a bus.
struct Instrument : Element {
    Ref type;
    struct Place {
        Ref line{}; ///< currents there, into the line
        LineEnd end{LineEnd::from};
        Ref bus{}; ///< voltages there, without a line
    };
    [[nodiscard]] virtual Place place() const = 0;
    [[nodiscard]] virtual emt::InstrumentData data(Surroundings const& around) const = 0;
    /// Rated primary and secondary value, A or V.
    struct Ratio {
        double primary{1}, secondary{1};
    };
    [[nodiscard]] virtual Ratio ratio(Surroundings const& around) const = 0;
};

/// The key `end` of what is at one end of a line.
inline void line_end(config::Fields& f, LineEnd& end) {
    f.choice<LineEnd>("end", end, {{"from", LineEnd::from}, {"to", LineEnd::to}},
                      {.doc = "which end of the line", .required = true});
}

} // namespace gridspace::sim
