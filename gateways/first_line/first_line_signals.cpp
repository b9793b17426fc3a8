// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/first_line/first_line_signals.hpp"

#include <fmt/format.h>

namespace gridspace::gateways {

Result<std::unique_ptr<FirstLineSignals>> FirstLineSignals::create(bus::Node& node,
                                                                   std::span<std::string const> streams) {
    std::vector<bus::SignalColumn> columns;
    for (std::string const& stream : streams) {
        std::string const prefix = fmt::format("first_line.{}.{}.", node.config().process, stream);
        columns.push_back({prefix + "suspicious", ""});
        columns.push_back({prefix + "refused", ""});
    }
    auto signals = bus::SignalPublisher::create(node, "first_line", 0, std::move(columns));
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    return std::unique_ptr<FirstLineSignals>{new FirstLineSignals{std::move(*signals)}};
}

void FirstLineSignals::publish(SimTime now, std::span<FirstLineCounters const> counters) {
    std::vector<double> row;
    for (FirstLineCounters const& c : counters) {
        row.push_back(static_cast<double>(c.suspicious));
        row.push_back(static_cast<double>(c.refused));
    }
    if (row != last_) {
        signals_->row(now, row);
        signals_->flush();
        last_ = std::move(row);
    }
}

} // namespace gridspace::gateways
