// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

namespace gridspace::sim::emt {

/// Flux linkage and magnetising current of a core with two slopes: i = flux / l up to the knee, slope 1 / l_air beyond.
struct TwoSlopeCore {
    double l{0}, l_air{0}, knee{0}; ///< H, H, Wb turns
    [[nodiscard]] double current(double flux) const {
        double const inside = std::clamp(flux, -knee, knee);
        return inside / l + (flux - inside) / l_air;
    }
    /// The flux x with x + k current(x) = rhs, k >= 0.
    [[nodiscard]] double flux(double rhs, double k) const {
        // x + k current(x) rises with x: where it passes the knee gives the slope.
        double const at_knee = knee * (1 + k / l);
        if (std::abs(rhs) <= at_knee) {
            return rhs / (1 + k / l);
        }
        return std::copysign(knee + (std::abs(rhs) - at_knee) / (1 + k / l_air), rhs);
    }
};

/// What an instrument transformer is to the waveform simulation.
struct InstrumentData {
    double factor{1};    ///< sign and ratio error, of what comes out
    double quantum{0};   ///< of what comes out; 0: none
    double cutoff_hz{0}; ///< Butterworth of second order; 0: no filter
    /// A core in series with a resistance. Of a CT: what the secondary current drives, input and output in primary
    /// amperes over `turns`. Of a VT: the primary, `turns` 1.
    struct Core {
        enum class Of { current, voltage } of{Of::current};
        TwoSlopeCore slopes;
        double r_ohm{0}, turns{1}, remanence{0}; ///< remanence: flux at the start, Wb turns
    };
    std::optional<Core> core;
};

} // namespace gridspace::sim::emt
