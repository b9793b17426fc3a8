// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::score {

/// Samples of a run on which a detector may say something.
struct Extent {
    std::map<std::string, double> rates_hz;   ///< of the streams of sampled values
    std::map<std::string, std::string> names; ///< of streams, by svID: a file may say either
    double end_s{0};
    std::string only_stream; ///< of a file without the column `stream`; empty: it must have it
    [[nodiscard]] std::int64_t samples(std::string const& stream) const;
};

/// Which sample of which stream (its second times the rate, plus smpCnt), and of which phase.
struct SampleKey {
    std::string stream;
    std::int64_t index{0};
    std::uint8_t phase{0};
    friend auto operator<=>(SampleKey const&, SampleKey const&) = default;
};
struct Verdict {
    bool flagged{false};
    double score{0};
};

struct Verdicts {
    bool has_verdicts{false}, has_scores{false};
    bool by_phase{false}; ///< a verdict for each phase; otherwise one for the whole sample
    std::map<SampleKey, Verdict> all;
    bool is_alarms{false};               ///< the file says when an alarm came and went, and nothing about samples
    std::map<double, bool> alarm_from_s; ///< it stands, or not, from this instant on
};

/// Reads the text of a CSV file (docs/reference/ids.md). `threshold`: what a file with scores alone is flagged from.
/// All mistakes are reported with line and column; then it returns nothing.
[[nodiscard]] std::optional<Verdicts> parse_verdicts(std::string_view text, std::string const& name,
                                                     Extent const& extent, std::optional<double> threshold,
                                                     config::Diagnostics& diagnostics);

} // namespace gridspace::score
