// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/results.hpp"
#include "launcher/judge/wire_timing.hpp"
#include "launcher/report/figure.hpp"
#include "launcher/scenario/report_settings.hpp"

#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// A finished run as the figures see it.
struct Drawn {
    Results const& results;
    config::Node const& scenario; ///< resolved
    WireTiming const& timing;
};

/// The figures of `report:`; those for which nothing was recorded are left out.
[[nodiscard]] std::vector<Figure> make_figures(ReportSettings const& settings, Drawn const& run);

/// A figure with everything but its series: title, window, lines, marks, shades. Kinds whose horizontal axis is not
/// time say so afterwards.
[[nodiscard]] Figure empty_figure(FigureSettings const& settings, Drawn const& run);

/// The same of a figure whose axes are neither of them time, of one relay (or of all: no name), with these labels where
/// the settings have none.
[[nodiscard]] Figure empty_plane(FigureSettings const& settings, Drawn const& run, std::string const& relay,
                                 std::string const& x_label, std::string const& y_label);

/// The usual figures as YAML, where the scenario lists none or asks for them too; otherwise nothing.
[[nodiscard]] std::string_view unasked_figures(config::Node const& scenario);

/// `report:` as the scenario says it; the usual figures where it lists none, or asks for them too.
[[nodiscard]] ReportSettings report_settings(config::Node const& scenario);

} // namespace gridspace::launcher
