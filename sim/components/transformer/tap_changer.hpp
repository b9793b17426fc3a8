// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <complex>
#include <cstdint>
#include <optional>

namespace gridspace::sim {

/// Line drop compensation of a voltage regulator: it holds the voltage of a load centre down the line, which it finds
/// from the voltage and the current of its own transformer [IEEE C57.15].
struct LineDropCompensation {
    double r_v{0}, x_v{0}; ///< its settings: drop at the rated current of its CT
    double ct_a{0};        ///< that current
    double base_v{120};    ///< on its voltage circuit at the nominal voltage of `to`, phase to earth

    void fields(config::Fields& f);
    /// |V - (R + j X) I / I_ct|, p.u. of the nominal voltage, from the voltage at `to` and the power that leaves there.
    [[nodiscard]] double compensated_pu(double v_pu, std::complex<double> kva, double nominal_v) const;
};

/// On-load tap changer of a transformer with its voltage regulator, at the `from` winding.
struct TapChanger {
    config::Ref bus; ///< whose voltage it holds; empty: that at `to`
    double voltage_pu{1}, bandwidth_percent{2};
    double delay_s{30}, next_delay_s{10};
    double step_percent{1.25};
    std::int64_t position{0}, lowest{-8}, highest{8};
    double block_below_pu{0.7};
    std::optional<LineDropCompensation> compensation;
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
