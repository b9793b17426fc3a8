// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/signals/signal_store.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace gridspace {
namespace {

SignalSeries const* find(SignalStore const& signals, std::string const& name) {
    auto const it = signals.find(name);
    return it == signals.end() ? nullptr : &it->second;
}

/// Samples: both ends give the simulated instant of a sample as the time of its row.
SignalSeries of_samples(SignalSeries const& published, SignalSeries const& arrived) {
    SignalSeries out{"ms", {}, {}};
    for (std::size_t p = 0, a = 0; p < published.times_ns.size() && a < arrived.times_ns.size();) {
        if (published.times_ns[p] < arrived.times_ns[a]) {
            ++p;
        } else if (published.times_ns[p] > arrived.times_ns[a]) {
            ++a;
        } else {
            out.times_ns.push_back(published.times_ns[p]);
            out.values.push_back(arrived.values[a++] - published.values[p++]);
        }
    }
    return out;
}

/// Messages: recognised by stNum and sqNum.
SignalSeries of_messages(SignalStore const& signals, std::string const& stream, SignalSeries const& sent,
                         SignalSeries const& heard) {
    SignalSeries out{"ms", {}, {}};
    std::array<SignalSeries const*, 4> const n{find(signals, stream + ".st_num"), find(signals, stream + ".sq_num"),
                                               find(signals, stream + ".heard_st_num"),
                                               find(signals, stream + ".heard_sq_num")};
    if (std::find(n.begin(), n.end(), nullptr) != n.end()) {
        return out;
    }
    // A recording may come from somebody else: nothing says that the columns are equally long.
    std::size_t const sends = std::min({sent.values.size(), n[0]->values.size(), n[1]->values.size()});
    std::size_t const hears = std::min({heard.values.size(), n[2]->values.size(), n[3]->values.size()});
    std::map<std::pair<double, double>, double> sent_at;
    for (std::size_t i = 0; i < sends; ++i) {
        if (std::isnan(sent.values[i])) { // before its process knew when the run began
            continue;
        }
        sent_at[{n[0]->values[i], n[1]->values[i]}] = sent.values[i];
    }
    for (std::size_t i = 0; i < hears; ++i) {
        if (auto const it = sent_at.find({n[2]->values[i], n[3]->values[i]});
            it != sent_at.end() && !std::isnan(heard.values[i])) {
            out.times_ns.push_back(heard.times_ns[i]);
            out.values.push_back(heard.values[i] - it->second);
        }
    }
    return out;
}

} // namespace

bool is_wall_clock_signal(std::string_view name) {
    if (!name.starts_with("stream.") && !name.starts_with("relay.")) {
        return false;
    }
    constexpr std::array<std::string_view, 5> kEnds{".rate_hz", ".publish_age_ms", ".arrival_age_ms", ".wire_delay_ms",
                                                    ".sample_to_decision_ms"};
    return std::any_of(kEnds.begin(), kEnds.end(), [&](std::string_view end) { return name.ends_with(end); });
}

void derive_wire_delays(SignalStore& signals) {
    SignalStore derived;
    for (auto const& [name, series] : signals) {
        auto const stream_of = [&](std::string_view end) -> std::optional<std::string> {
            return name.ends_with(end) ? std::optional{name.substr(0, name.size() - end.size())} : std::nullopt;
        };
        if (auto const sampled = stream_of(".publish_age_ms")) {
            if (auto const* arrived = find(signals, *sampled + ".arrival_age_ms")) {
                derived[*sampled + ".wire_delay_ms"] = of_samples(series, *arrived);
            }
        } else if (auto const messages = stream_of(".sent_after_ms")) {
            if (auto const* heard = find(signals, *messages + ".heard_after_ms")) {
                derived[*messages + ".wire_delay_ms"] = of_messages(signals, *messages, series, *heard);
            }
        }
    }
    signals.merge(derived);
}

} // namespace gridspace
