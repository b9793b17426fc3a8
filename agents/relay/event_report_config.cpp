// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/event_report_config.hpp"

namespace gridspace::relay {

void describe(config::Fields& f, EventReportConfig& config) {
    using Trigger = EventReportConfig::Trigger;
    f.object("event_report", {.doc = "COMTRADE of what the relay saw and did around a trip"}, [&](config::Fields& r) {
        r.choice<Trigger>("trigger", config.trigger,
                          {{"trip", Trigger::trip}, {"pickup", Trigger::pickup}, {"off", Trigger::off}},
                          {.doc = "what starts a report"});
        r.number("before_ms", config.before_ms, {.doc = "kept of what was before", .min = 0, .max = 10'000});
        r.number("after_ms", config.after_ms, {.doc = "and after", .min = 0, .max = 10'000});
        std::string folder;
        r.text("folder", folder, {.doc = "where to write; event_reports/ of the run folder when not given"});
        config.folder = folder;
    });
}

} // namespace gridspace::relay
