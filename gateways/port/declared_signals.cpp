// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/port/declared_signals.hpp"

#include "gateways/first_line/first_line.hpp"
#include "gateways/port/frame_authentication.hpp"

#include <algorithm>
#include <iterator>

namespace gridspace::gateways {

using program::Signal;

program::Topic stream_statistics() {
    return {.topic = "stream_statistics", .type = "StreamStatistics", .optional = true};
}

void add(std::vector<Signal>& signals, std::vector<Signal> more) {
    signals.insert(signals.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
}

std::vector<Signal> publisher_signals() {
    return {{"publisher.{process}.sent", "", 1},
            {"publisher.{process}.late", "", 1},
            {"publisher.{process}.underruns", "", 1}};
}

std::vector<Signal> sent_sample_signals(std::string const& stream) {
    std::string const prefix = "stream." + stream + ".";
    return {{prefix + "publish_age_ms", "ms"}, {prefix + "wire_delay_ms", "ms"}};
}

std::vector<Signal> clock_signals() {
    return {{"clock.{process}.smp_synch", ""}, {"clock.{process}.offset_us", "us"}};
}

std::vector<Signal> clock_signals(std::optional<ptp::PtpConfig> const& ptp, DeclarationContext const& context) {
    return ptp && context.real_time ? clock_signals() : std::vector<Signal>{};
}

Signal first_line_alarm() {
    return {"first_line.{process}.alarm", ""};
}

std::vector<Signal> first_line_counter_signals(std::vector<GuardedStream> const& streams) {
    std::vector<Signal> out;
    for (GuardedStream const& stream : streams) {
        std::vector<std::string> counters = first_line_counters(stream.sampled_values);
        if (stream.authenticated) {
            std::ranges::move(authenticity_counters(), std::back_inserter(counters));
        }
        for (std::string const& counter : counters) {
            out.push_back({"first_line.{process}." + stream.name + "." + counter, "", 1});
        }
    }
    return out;
}

std::vector<Signal> first_line_signals(FirstLineConfig const& config, std::vector<GuardedStream> const& streams) {
    if (config.on_finding == FirstLineConfig::OnFinding::ignore || streams.empty()) {
        return {};
    }
    std::vector<Signal> out{first_line_alarm()};
    add(out, first_line_counter_signals(streams));
    return out;
}

GuardedStream guarded(DeclarationContext const& context, std::string const& stream, bool sampled_values) {
    streams::Stream const* const declared = streams::find_stream(context.streams, stream);
    return {stream, sampled_values, declared != nullptr && declared->authentication.has_value()};
}

} // namespace gridspace::gateways
