// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/current_inputs.hpp"
#include "agents/relay/line_relay.hpp"
#include "ids/detector/line_detector.hpp"
#include "launcher/ids/scan/known_streams.hpp"
#include "launcher/ids/scan/stream_forecast.hpp"

namespace gridspace::scan {

/// Two ends of a line, as one relay with a detector saw them.
struct LineScan {
    std::string vantage, from, to;
    ForecastResult from_forecast, to_forecast;
    std::uint64_t pairs{0};
    double pickup_a{0}; ///< RMS
    std::uint64_t pickups{0};
    std::vector<Alarm> alarms;
};

/// The detector of a line with a differential element, coupled as in the relay: phasors over a cycle, pickup
/// at 30 % of the nominal current, 30 % of slope.
class LineWatch {
  public:
    [[nodiscard]] static Result<LineWatch> create(SvDescription const& from, SvDescription const& to,
                                                  ForecastSettings const& settings);

    void frame(iec61850::Octets octets, Place at);
    void finish(Place at);
    void report(LineScan& out) const;

  private:
    struct Pair {
        relay::LineSample sample;
        Place at;
    };
    LineWatch(relay::CurrentInputs inputs, ids::Model model, ForecastSettings const& settings)
        : inputs_{std::move(inputs)}, model_{std::move(model)}, nominal_peak_a_{settings.nominal_peak_a},
          into_line_{settings.into_line}, first_{model_.rate_hz / model_.frequency_hz} {}
    void take(relay::LineSample const& sample, Place at);
    void begin();
    void judge(Pair const& pair);

    relay::CurrentInputs inputs_;
    ids::Model model_;
    double nominal_peak_a_;
    bool into_line_;
    FirstCycles<Pair> first_;
    std::optional<ids::LineDetector> detector_;
    std::optional<relay::LineRelay> relay_;
    FrequencyMeter from_meter_, to_meter_;
    Alarms alarms_;
    ids::Alarms before_{0};
    std::uint64_t pairs_{0};
};

} // namespace gridspace::scan
