// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/random.hpp"
#include "common/result.hpp"
#include "ids/training/training_config.hpp"
#include "sim/engine/action.hpp"
#include "sim/network/network.hpp"

#include <functional>
#include <vector>

namespace gridspace::cli {

/// Random runs of the waveform solver: loads and instants differ from run to run, and the situations take turns. The
/// currents of the protected line are measured with ratio errors, noise and resolution. The same seed and number give
/// the same samples, whatever the number of threads.
class Exploration {
  public:
    /// Reads the network and looks for the line, its transformers, and what can happen around it.
    [[nodiscard]] static Result<Exploration> create(ids::SimulatedParams const& params, double rate_hz);

    [[nodiscard]] Result<ids::LineWaveform> run(ids::Situation situation, std::uint64_t seed,
                                                std::uint64_t number) const;

    /// Runs number `first` to `first + params.runs` - 1.
    [[nodiscard]] Result<std::vector<ids::LineWaveform>>
    all(std::uint64_t seed, std::uint64_t first, int threads,
        std::function<void(std::size_t done, std::size_t of)> const& progress) const;

  private:
    struct Planned {
        double at_s{0};
        sim::Action action;
    };
    /// What happens in a run, in the order of time; nothing where this grid has nothing of the situation.
    [[nodiscard]] std::vector<Planned> draw_plan(ids::Situation situation, sim::Network const& network,
                                                 Random& r) const;

    ids::SimulatedParams params_;
    double rate_hz_{4800};
    std::int64_t steps_per_sample_{0};
    sim::Network network_;
    double from_sign_{1}, to_sign_{1};     ///< to currents counted along the line
    std::vector<std::string> other_lines_; ///< with breakers
    std::vector<std::string> buses_;       ///< where external faults happen
};

} // namespace gridspace::cli
