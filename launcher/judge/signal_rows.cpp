// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/signal_rows.hpp"

namespace gridspace::launcher {

SignalSeries const* series_of(SignalStore const& signals, std::string const& name) {
    auto const it = signals.find(name);
    return it == signals.end() || it->second.values.empty() ? nullptr : &it->second;
}

std::vector<double> values_of(SignalStore const& signals, std::string const& name) {
    SignalSeries const* series = series_of(signals, name);
    return series == nullptr ? std::vector<double>{} : series->values;
}

std::vector<std::size_t> rises(SignalSeries const* series) {
    std::vector<std::size_t> out;
    for (std::size_t i = 1; series != nullptr && i < series->values.size(); ++i) {
        if (series->values[i] != 0 && series->values[i - 1] == 0) {
            out.push_back(i);
        }
    }
    return out;
}

} // namespace gridspace::launcher
