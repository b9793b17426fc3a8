// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/wire/observer.hpp"

#include <filesystem>

namespace gridspace::wire {

struct Percentiles {
    std::size_t count{0};
    double min{0}, p50{0}, p99{0}, p999{0}, max{0}, mean{0};
};
/// Nearest rank. Sorts `values`.
[[nodiscard]] Percentiles percentiles(std::vector<double>& values);

/// A transfer time class of IEC 61850-5 (Ed. 2, table of transfer time requirements).
struct TransferClass {
    char const* name;
    double limit_ms;
    char const* use;
};
/// The tightest class that a delay meets; nullptr above all of them.
[[nodiscard]] TransferClass const* tightest_class(double delay_ms);

struct StreamStatistics {
    ObservedStream stream;
    Percentiles interval_ms; ///< between frames; without those that came before, and where the clock went back
    std::optional<Percentiles> delay_ms; ///< between two points of capture that saw the same frame
    std::optional<double> steady_ms;     ///< GOOSE: median interval where it no longer grows; nothing: nowhere
    std::vector<double> burst_ms;        ///< GOOSE: medians of the intervals behind a change of state
};

struct CaptureStatistics {
    std::uint64_t frames{0}, other{0};
    std::uint64_t cut{0};         ///< of which the capture kept only the beginning
    std::uint64_t no_ethernet{0}; ///< of interfaces of another link type; not looked at
    std::uint64_t clock_back{0};  ///< of an interface: so many frames are stamped earlier than the one before
    double seconds{0};
    bool truncated{false};
    std::vector<std::string> points; ///< interfaces of the capture
    iec61850::DecodeCounters errors;
    std::vector<StreamStatistics> streams;
};

/// Reads a capture. A frame that was seen at several points counts once, where it was seen first; the time until it was
/// seen last is its delay.
[[nodiscard]] Result<CaptureStatistics> capture_statistics(std::filesystem::path const& file);

[[nodiscard]] std::string to_text(CaptureStatistics const& statistics);
[[nodiscard]] std::string to_json(CaptureStatistics const& statistics);

} // namespace gridspace::wire
