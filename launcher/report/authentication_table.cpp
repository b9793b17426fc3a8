// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/authentication_table.hpp"

#include "common/text.hpp"
#include "gateways/iec61850/authentication.hpp"
#include "gateways/streams/stream.hpp"

#include <array>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

/// "SMV21 by 57 octets, TRIP2 by 41 octets".
std::string added_octets(config::Node const& scenario) {
    config::Diagnostics checked_before;
    config::Node const* const all = scenario.find("streams");
    std::string out;
    for (streams::Stream const& s :
         all == nullptr ? std::vector<streams::Stream>{} : streams::read_streams(*all, checked_before)) {
        if (s.authentication) {
            out += fmt::format("{}{} by {}", out.empty() ? "" : ", ", escape_markup(s.name.name),
                               iec61850::extension_octets(s.authentication->algorithm));
        }
    }
    return out;
}

} // namespace

ReportTable authentication_table(Results const& r, config::Node const& scenario) {
    ReportTable t{"What authentication adds",
                  {"process", "making a code, us: p50", "p99", "longest", "checking one, us: p50", "p99", "longest"},
                  {},
                  {}};
    for (Results::ProcessRow const& process : r.processes) {
        std::vector<std::string> row{escape_markup(process.name)};
        bool any = false;
        for (char const* const of : {"sign", "check"}) {
            for (char const* const which : {"p50", "p99", "max"}) {
                auto const value = r.signals.find(fmt::format("authentication.{}.{}_us_{}", process.name, of, which));
                bool const known = value != r.signals.end() && !value->second.values.empty();
                row.push_back(known ? fmt::format("{:.1f}", value->second.values.back()) : "-");
                any = any || known;
            }
        }
        if (any) {
            t.rows.push_back(std::move(row));
        }
    }
    if (!t.rows.empty()) {
        t.note =
            fmt::format("Wall time in the process: a subscriber gets a frame later by the time of its sender and by "
                        "its own. Longer frames, in octets: {}. In lockstep this takes no simulated time.",
                        added_octets(scenario));
    }
    return t;
}

} // namespace gridspace::launcher
