// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/signal_output.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cstring>

namespace gridspace::sim {
namespace {

/// Bit by bit: a value that is not a number (a breaker that never opened has no time) is the same as before, and !=
/// says it is not.
bool differs(std::vector<double> const& a, std::vector<double> const& b) {
    return a.size() != b.size() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) != 0;
}

} // namespace

Result<std::unique_ptr<SignalOutput>> SignalOutput::create(bus::Node& node, Engine const& engine,
                                                           SimConfig const& config) {
    auto output = std::unique_ptr<SignalOutput>{new SignalOutput};
    SignalOutput& out = *output;
    out.engine_ = &engine;
    Rational const rate = signal_rate_hz(config.simulation);
    out.period_ = node.time_base().nearest(Rational{1} / rate);
    std::vector<bus::SignalColumn> sampled, switching;
    std::vector<SignalDef> const& all = engine.signals();
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (std::none_of(config.signals.begin(), config.signals.end(),
                         [&](std::string const& pattern) { return matches_glob(pattern, all[i].name); })) {
            continue;
        }
        bool const jumps = is_switching_signal(all[i].name);
        (jumps ? switching : sampled).push_back({all[i].name, all[i].unit});
        (jumps ? out.switching_ : out.sampled_).signals.push_back(i);
    }
    auto const open = [&](Group& group, char const* name, double rate_hz,
                          std::vector<bus::SignalColumn> columns) -> Result<void> {
        group.row.resize(group.signals.size());
        auto publisher = bus::SignalPublisher::create(node, name, rate_hz, std::move(columns));
        if (!publisher) {
            return std::unexpected{publisher.error()};
        }
        group.publisher = std::move(*publisher);
        if (!node.lockstep()) {
            constexpr std::size_t kRows = 8192; // more than a second
            group.outbox = std::make_unique<Outbox<std::vector<double>>>(kRows);
        }
        return {};
    };
    if (auto ok = open(out.sampled_, "electrical", rate.to_double(), std::move(sampled)); !ok) {
        return std::unexpected{ok.error()};
    }
    if (!out.switching_.signals.empty()) {
        if (auto ok = open(out.switching_, "switching", 0, std::move(switching)); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    return output;
}

SignalOutput::~SignalOutput() = default;

void SignalOutput::Group::read(Engine const& engine) {
    for (std::size_t i = 0; i < signals.size(); ++i) {
        row[i] = engine.value(signals[i]);
    }
}

void SignalOutput::Group::put(SimTime t) {
    if (outbox != nullptr) {
        outbox->put(t, row);
    } else {
        publisher->row(t, row);
    }
}

void SignalOutput::drain(SimTime until) {
    for (Group* group : {&sampled_, &switching_}) {
        if (group->publisher != nullptr) {
            group->outbox->drain(
                until, [&](std::vector<double> const& row, SimTime time) { group->publisher->row(time, row); });
        }
    }
}

std::uint64_t SignalOutput::lost() const {
    std::uint64_t lost = 0;
    for (Group const* group : {&sampled_, &switching_}) {
        lost += group->outbox == nullptr ? 0 : group->outbox->lost();
    }
    return lost;
}

void SignalOutput::announce(SimTime now) {
    for (Group* group : {&sampled_, &switching_}) {
        if (group->publisher != nullptr) {
            group->publisher->announce(now);
        }
    }
}

void SignalOutput::observe(SimTime t) {
    if (t.quanta % period_.quanta == 0) {
        sampled_.read(*engine_);
        sampled_.put(t);
    }
    if (switching_.publisher != nullptr) {
        switching_.read(*engine_);
        if (differs(switching_.row, last_switching_)) {
            switching_.put(t);
            last_switching_ = switching_.row;
        }
    }
}

void SignalOutput::flush() {
    for (Group* group : {&sampled_, &switching_}) {
        if (group->publisher != nullptr) {
            group->publisher->flush();
        }
    }
}

} // namespace gridspace::sim
