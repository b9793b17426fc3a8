// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/one_line_figure.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/judge/signal_rows.hpp"
#include "monitor/diagram/picture.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

constexpr std::size_t kMostElements = 60;

/// The monitor's settings for the run: its configuration lies in the run folder.
diagram::Grid grid_of(std::filesystem::path const& folder) {
    diagram::Grid out;
    config::Diagnostics unread; // another version may have written it
    std::filesystem::path const file = folder / "monitor.yaml";
    auto const loaded = std::filesystem::exists(file) ? config::load_yaml(file, unread) : std::nullopt;
    config::Node const* const settings = loaded ? loaded->find("settings") : nullptr;
    if (config::Node const* run = settings == nullptr ? nullptr : settings->find("run"); run != nullptr) {
        config::read_fields(*run, "run", unread, [&](config::Fields& f) { diagram::describe(f, out); });
    }
    return out;
}

std::optional<double> last_of(SignalStore const& signals, std::string const& name) {
    auto const it = signals.find(name);
    for (std::size_t i = it == signals.end() ? 0 : it->second.values.size(); i > 0; --i) {
        if (std::isfinite(it->second.values[i - 1])) {
            return it->second.values[i - 1];
        }
    }
    return std::nullopt;
}

/// Which breakers were switched, in words.
std::string note_of(diagram::Grid const& grid, SignalStore const& signals) {
    std::vector<std::string> open, again, untold;
    for (diagram::Grid::Breaker const& breaker : grid.breakers) {
        auto it = signals.find("breaker." + breaker.name + ".position");
        it = it == signals.end() ? signals.find("fuse." + breaker.name + ".position") : it;
        if (it == signals.end()) {
            untold.push_back(breaker.name);
            continue;
        }
        bool const now = last_of(signals, it->first).value_or(kClosedPosition) == kOpenPosition;
        bool const ever = std::ranges::find(it->second.values, kOpenPosition) != it->second.values.end();
        if (now || ever) {
            (now ? open : again).push_back(breaker.name);
        }
    }
    std::string out = grid.breakers.empty() ? ""
                                            : "Breakers at the end of the run: filled ones are closed, hollow ones "
                                              "open; a dashed branch is open at one end at least. ";
    out += open.empty() ? "" : fmt::format("Open: {}. ", join(open, ", "));
    out += again.empty() ? "" : fmt::format("Opened and closed again: {}. ", join(again, ", "));
    out += untold.empty() ? "" : fmt::format("Not recorded, drawn closed: {}. ", join(untold, ", "));
    bool const watched =
        std::ranges::any_of(grid.relays, [](diagram::Grid::Relay const& relay) { return !relay.cts.empty(); });
    out += watched ? "A relay stands below the current transformers that it looks at, with the device numbers of its "
                     "functions (IEEE C37.2). "
                   : "";
    return std::string{trim(out)};
}

} // namespace

Result<std::string> one_line_figure(Results const& r) {
    diagram::Grid const grid = grid_of(r.folder);
    if (grid.buses.empty()) {
        return "";
    }
    if (grid.elements() > kMostElements) {
        return fmt::format("<section class=\"box\"><h2>One-line diagram</h2><p>This grid has {} buses, branches and "
                           "elements; the report draws those with up to {}. The dashboard draws it: <code>gridspace "
                           "monitor {}</code></p></section>\n",
                           grid.elements(), kMostElements, escape_markup(r.folder.filename().string()));
    }
    std::string const svg =
        one_line(grid, {[&](std::string const& name) { return last_of(r.signals, name); }, false}).svg;
    if (auto ok = replace_file(r.folder / "report" / "figures" / "one_line.svg", "<?xml version=\"1.0\"?>\n" + svg);
        !ok) {
        return std::unexpected{ok.error()};
    }
    std::string const note = note_of(grid, r.signals);
    return fmt::format("<figure id=\"one_line\" class=\"diagram\" tabindex=\"0\"><figcaption>One-line diagram <span "
                       "class=\"files\"><a href=\"figures/one_line.svg\">SVG</a></span></figcaption>{}{}</figure>\n",
                       svg, note.empty() ? "" : "<p class=\"method\">" + escape_markup(note) + "</p>");
}

} // namespace gridspace::launcher
