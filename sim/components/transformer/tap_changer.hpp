// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <cstdint>

namespace gridspace::sim {

/// On-load tap changer of a transformer with its voltage regulator, at the `from` winding.
struct TapChanger {
    config::Ref bus; ///< whose voltage it holds; empty: that at `to`
    double voltage_pu{1}, bandwidth_percent{2};
    double delay_s{30}, next_delay_s{10};
    double step_percent{1.25};
    std::int64_t position{0}, lowest{-8}, highest{8};
    double block_below_pu{0.7};
    double neutral_ratio{1}; ///< at position 0: the file's tap_ratio

    void fields(config::Fields& f);
    /// A higher position raises the voltage at `to`.
    [[nodiscard]] double ratio(std::int64_t at) const {
        return neutral_ratio * (1 - static_cast<double>(at) * step_percent / 100);
    }
};

/// The regulator at work: voltage in, steps out. Definite time: the deviation must last delay_s before the first step
/// of a row and next_delay_s before each further one; back within the band, the time begins anew.
class TapRegulator {
  public:
    /// `reversed`: the bus lies at `from`, where a higher position lowers the voltage.
    TapRegulator(TapChanger const& data, bool reversed) : data_{data}, reversed_{reversed}, position_{data.position} {}

    [[nodiscard]] std::int64_t position() const { return position_; }
    [[nodiscard]] double ratio() const { return data_.ratio(position_); }
    /// A voltage (p.u.) that lasted for h; true: the position has changed.
    bool step(double v, double h);

  private:
    TapChanger data_;
    bool reversed_;
    std::int64_t position_;
    double outside_s_{0}; ///< on the side `direction_`
    int direction_{0};
    bool in_a_row_{false};
};

} // namespace gridspace::sim
