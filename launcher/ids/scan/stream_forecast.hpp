// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/line_sample.hpp"
#include "ids/detector/stream_guard.hpp"
#include "launcher/ids/scan/alarms.hpp"
#include "launcher/ids/scan/forecast_settings.hpp"
#include "launcher/ids/scan/frequency_meter.hpp"

namespace gridspace::scan {

/// What the forecaster made of the currents of one stream.
struct ForecastResult {
    std::string why_not; ///< why it says nothing; empty where it does
    std::uint64_t samples{0}, flagged{0};
    double sigma_percent{0}; ///< standard deviation of its error
    double nominal_peak_a{0};
};

/// The largest magnitude of the first two cycles of a current, while samples wait for it.
template <class T>
class FirstCycles {
  public:
    explicit FirstCycles(double samples_per_cycle) : wanted_{static_cast<std::size_t>(2 * samples_per_cycle)} {}
    /// False: enough have waited, and all of them are to be judged now.
    [[nodiscard]] bool wait(T const& sample) {
        waiting_.push_back(sample);
        return waiting_.size() < wanted_;
    }
    void see(relay::Abc const& i_a) {
        for (double const i : i_a) {
            peak_a_ = std::isfinite(i) && std::fabs(i) <= kLargest ? std::fmax(peak_a_, std::fabs(i)) : peak_a_;
        }
    }
    [[nodiscard]] double peak_a() const { return peak_a_; }
    [[nodiscard]] std::vector<T> take() { return std::exchange(waiting_, {}); }

  private:
    static constexpr double kLargest = 1e9; ///< amperes; a relay takes none above either
    std::size_t wanted_;
    double peak_a_{0};
    std::vector<T> waiting_;
};

/// Watches the currents of one stream by themselves: a sample that those before it do not explain is a disturbance of
/// the grid or a forgery, and one end alone cannot tell which.
class StreamForecast {
  public:
    StreamForecast(ids::Model const& model, double rate_hz, double nominal_peak_a)
        : model_{at_rate(model, rate_hz)}, nominal_peak_a_{nominal_peak_a},
          first_{model_.rate_hz / model_.frequency_hz} {}

    /// `index`: rising; a jump is a loss.
    void add(std::int64_t index, relay::EndSample const& sample, Place at);
    /// Judges what still waits.
    void finish();

    [[nodiscard]] ForecastResult result() const;
    [[nodiscard]] Alarms const& alarms() const { return alarms_; }

  private:
    struct Sample {
        std::int64_t index{0};
        relay::Abc i_a{};
        bool usable{false};
        Place at;
    };
    void judge(Sample const& sample);
    void begin();

    ids::Model model_;
    double nominal_peak_a_;
    FirstCycles<Sample> first_;
    std::optional<ids::StreamGuard> guard_;
    FrequencyMeter meter_;
    Alarms alarms_;
    std::uint64_t flagged_{0};
};

} // namespace gridspace::scan
