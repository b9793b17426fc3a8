// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/detector/history.hpp"
#include "ids/detector/threshold.hpp"
#include "ids/forecaster/forecaster.hpp"

#include <array>
#include <cstdint>

namespace gridspace::ids {

using Abc = std::array<double, 3>;

enum class Mode {
    paper,    ///< as published: a rejected sample is replaced by its forecast, for the relay and for the next forecasts
    hold_off, ///< the same for at most `hold_off_samples` in a row; then the received samples are believed
    supervise, ///< samples pass unchanged; a trip needs evidence from both ends
    monitor,   ///< samples pass unchanged; flags only
};

struct GuardParams {
    Mode mode{Mode::supervise};
    int hold_off_samples{8};
    int max_filled{3}; ///< lost samples in a row that are filled with forecasts; more restart the window
    double clamp{1.3}; ///< forecasts stay within this multiple of the peak of believed samples; a network that runs
                       ///< on its own forecasts diverges otherwise
    ThresholdParams threshold;
};

/// What the guard made of one phase of one sample.
struct ChannelVerdict {
    double raw_a{0}, forecast_a{0}, accepted_a{0}, limit_a{0};
    bool flagged{false};
    double open_forecast_a{0}; ///< see StreamGuard
    bool open_flagged{false};
};

struct StreamVerdict {
    std::int64_t index{0};
    bool ready{false}; ///< there was a forecast; otherwise everything is accepted and nothing flagged
    std::array<ChannelVerdict, 3> phases;

    [[nodiscard]] bool any_flagged() const { return phases[0].flagged || phases[1].flagged || phases[2].flagged; }
    [[nodiscard]] bool any_open_flagged() const {
        return phases[0].open_flagged || phases[1].open_flagged || phases[2].open_flagged;
    }
    [[nodiscard]] Abc accepted_a() const { return {phases[0].accepted_a, phases[1].accepted_a, phases[2].accepted_a}; }
};

struct GuardCounters {
    std::uint64_t samples{0};                  ///< with a forecast
    std::uint64_t flagged{0}, open_flagged{0}; ///< samples with at least one phase flagged
    std::uint64_t replaced{0};                 ///< phase-samples that the relay did not get as received
    std::uint64_t filled{0}, restarts{0}, unusable{0};
};

/// Watches the three phases of one stream: forecasts each sample from those before it and compares. No allocation per
/// sample.
///
/// Besides the loop of its mode it runs an *open loop*, which is the same forecaster on received samples of which at
/// most one in a row is replaced. It shows what the forecaster can do when its own mistakes are not fed back to it: the
/// published false-positive rate is of this kind.
class StreamGuard {
  public:
    StreamGuard(Model const& model, GuardParams const& params);

    /// Takes the sample of `index` (rising; a jump is a loss). Values that are not finite count as lost.
    StreamVerdict const& step(std::int64_t index, Abc const& raw_a);
    /// The sample of `index` was lost or unusable.
    StreamVerdict const& step_lost(std::int64_t index, Abc const& raw_a = {});
    void restart();

    [[nodiscard]] StreamVerdict const& verdict() const { return verdict_; }
    [[nodiscard]] GuardCounters const& counters() const { return counters_; }
    [[nodiscard]] double sigma_percent() const; ///< the noisiest phase; 0 until the estimate has settled
    [[nodiscard]] double base_a() const;        ///< the largest max(nominal, running peak) of the phases
    /// More than half of the last 480 samples were flagged: the loop feeds on its own forecasts.
    [[nodiscard]] bool locked_out() const { return recent_flagged_ > kRecent / 2; }

  private:
    struct Loop {
        Loop(Model const& model, GuardParams const& params);
        History history;
        Forecaster<double> forecaster;
        std::array<Threshold, 3> thresholds;
        std::array<RunningPeak, 3> believed; ///< peaks of samples that were accepted as received
        std::array<int, 3> run{};            ///< flagged samples in a row
        std::array<double, 3> next{};
    };
    void predict(Loop& loop);
    void fill(std::int64_t missing);
    void remember(bool flagged);

    static constexpr int kRecent = 480;
    GuardParams params_;
    Loop closed_, open_;
    History raw_;
    StreamVerdict verdict_;
    GuardCounters counters_;
    std::array<bool, kRecent> recent_{};
    int recent_next_{0}, recent_flagged_{0};
    std::int64_t last_index_{0};
    int lost_run_{0};
    bool started_{false};
};

} // namespace gridspace::ids
