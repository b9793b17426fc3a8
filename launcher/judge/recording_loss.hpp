// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/expectation.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What a recorder could not keep of the signals of a run in real time. It is known by the recorder's own words, the
/// texts of its `samples_dropped` events.
class RecordingLoss {
  public:
    /// A process has said that this is one of its signals.
    void publishes(std::string const& process, std::string const& signal);
    /// The same by a sample of `signal_catalog`.
    void publishes_catalog(std::string const& process, std::span<std::byte const> sample);
    /// The text of a `samples_dropped` event; topics that carry no signals are passed over.
    void dropped(std::string const& event_text);

    /// What is missing of the signals that match one of the patterns, for people: "3 of 50 samples of 'signals' from
    /// sim". Empty: nothing.
    [[nodiscard]] std::string of(std::vector<std::string> const& patterns) const;

    /// The signals of each process.
    [[nodiscard]] std::map<std::string, std::set<std::string>> const& published() const { return signals_; }

  private:
    [[nodiscard]] bool concerns(std::string const& topic, std::optional<std::string> const& process,
                                std::vector<std::string> const& patterns) const;
    using Place = std::pair<std::string, std::optional<std::string>>; ///< topic, and whose samples; nothing: anybody's
    std::map<Place, std::string> lost_;                               ///< the last that was said
    std::map<std::string, std::set<std::string>> signals_;            ///< by process
};

/// A failed expectation on signals with holes says nothing about the run: it stays failed, without a value, and its
/// detail says that it cannot be judged and why.
void name_loss(Expectation const& expectation, RecordingLoss const& loss, ExpectationResult& result);

/// The recording was cut at `cut_at_s` of `duration_s` simulated seconds: what asks about a later time, and is not
/// decided by what is there, fails, without a value, and its detail says so.
void mind_the_end(Expectation const& expectation, Moments const& moments, double cut_at_s, double duration_s,
                  ExpectationResult& result);

} // namespace gridspace::launcher
