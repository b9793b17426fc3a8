// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/tick_length.hpp"

#include "common/text.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_use.hpp"
#include "sim/gateway/gateway_config.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

std::string microseconds(Rational seconds) {
    return shortest((seconds * Rational{1'000'000}).to_double()) + " us";
}

/// The loops through the simulator, as far as they can be told apart: of each member the shortest way to it.
class Loops {
  public:
    Loops(Scenario const& scenario, Dataflow const& flow) : scenario_{scenario} {
        for (bus::MemberPlan const& member : flow.members) {
            members_[member.name] = &member;
        }
        for (auto const& [topic, readers] : flow.readers) {
            auto const writers = flow.writers.find(topic);
            bool const of_simulator = writers != flow.writers.end() &&
                                      std::ranges::any_of(writers->second, [&](Dataflow::Endpoint const& writer) {
                                          return writer.process == scenario.simulator()->name.name;
                                      });
            for (Dataflow::Endpoint const& reader : readers) {
                hears_simulator_[reader.process] |= of_simulator;
            }
        }
        // Where processes begin and end between two ticks, ticks end for everybody at one instant.
        may_work_ahead_ = process_events(scenario).empty();
    }

    /// So long beyond a tick the input of a member is complete.
    [[nodiscard]] Rational ahead(std::string const& member) const {
        ProcessSettings const& settings = *scenario_.find_process(member)->settings;
        if (!may_work_ahead_ || !settings.works_ahead() || hears_simulator(member) || !on_way_.insert(member).second) {
            return Rational{0}; // on the way already: members in a circle, which is said elsewhere
        }
        std::string const first = earliest(member);
        Rational const out = first.empty() ? Rational{0} : ahead(first) + promise(first);
        on_way_.erase(member);
        return out;
    }
    /// So long beyond its own tick what a member sends is complete.
    [[nodiscard]] Rational promise(std::string const& member) const {
        Process const& process = *scenario_.find_process(member);
        return process.settings->promises_s(process);
    }
    [[nodiscard]] Rational latency(std::string const& member) const {
        Process const& process = *scenario_.find_process(member);
        return process.settings->latency_s(process);
    }
    /// Of the members that it hears, the one whose output is complete first; empty: it hears nobody.
    [[nodiscard]] std::string earliest(std::string const& member) const {
        std::string out;
        for (std::string const& up : members_.at(member)->upstream) {
            if (out.empty() || ahead(up) + promise(up) < ahead(out) + promise(out)) {
                out = up;
            }
        }
        return out;
    }
    [[nodiscard]] std::vector<std::string> feeding() const {
        std::vector<std::string> out;
        for (auto const& [name, member] : members_) {
            if (member->feeds_simulator) {
                out.push_back(name);
            }
        }
        return out;
    }
    /// " (relay2 900 us, then breaker2 1111.2 us)"; empty for one hop.
    [[nodiscard]] std::string hops(std::string const& member) const {
        std::string out = fmt::format("{} {}", member, microseconds(latency(member)));
        std::string at = member;
        while (ahead(at) > Rational{0}) {
            at = earliest(at);
            out = fmt::format("{} {}, then ", at, microseconds(promise(at))) + out;
        }
        return at == member ? "" : fmt::format(" ({})", out);
    }
    [[nodiscard]] bool may_work_ahead() const { return may_work_ahead_; }

  private:
    [[nodiscard]] bool hears_simulator(std::string const& member) const {
        auto const found = hears_simulator_.find(member);
        return found != hears_simulator_.end() && found->second;
    }

    Scenario const& scenario_;
    std::map<std::string, bus::MemberPlan const*> members_;
    std::map<std::string, bool> hears_simulator_;
    bool may_work_ahead_{true};
    mutable std::set<std::string> on_way_;
};

/// Whether a tick of this length falls on everything that must not depend on it, and into every buffer.
bool fits(Scenario const& scenario, Dataflow const& flow, std::int64_t samples, Rational rate,
          std::int64_t per_message) {
    constexpr std::int64_t kMessages = 16;       // of one topic: a quarter of the shortest history (qos/)
    constexpr std::int64_t kFramesPerTick = 256; // half of what a ledger lists; GOOSE comes on top
    Rational const tick = Rational{samples} / rate;
    Rational const duration = scenario.simulation.duration();
    bool const on_seconds = (Rational{1} / tick).is_whole(); // what is said once a second is said at the end of a tick
    bool const in_messages = samples % per_message == 0 ? samples / per_message <= kMessages
                                                        : per_message % samples == 0; // shorter: it cuts them evenly
    bool const in_steps = (tick / scenario.simulation.step_s).is_whole();
    if (!on_seconds || !in_messages || !in_steps || !(duration / tick).is_whole()) {
        return false;
    }
    for (sim::Event const& event : process_events(scenario)) {
        if (event.at_s && !(*event.at_s / tick).is_whole()) {
            return false;
        }
    }
    for (Process const& process : scenario.processes) {
        if (frames_per_second(scenario, process) * tick > Rational{kFramesPerTick}) {
            return false;
        }
    }
    bool const due_after_it = std::ranges::all_of(scenario.processes, [&](Process const& process) {
        return !process.settings->sends_late(scenario) || process.settings->latency_s(process) >= tick;
    });
    if (!due_after_it) {
        return false;
    }
    Loops const loops{scenario, flow};
    return std::ranges::all_of(loops.feeding(), [&](std::string const& member) {
        return loops.ahead(member) + loops.latency(member) >= tick;
    });
}

} // namespace

Rational frames_per_second(Scenario const& scenario, Process const& process) {
    Rational out{0};
    for (WireUse const& use : frames_sent(scenario, process)) {
        streams::Stream const* const stream = streams::find_stream(scenario.streams, use.stream);
        if (stream != nullptr && stream->rate_hz > Rational{0}) {
            out = out + stream->rate_hz / Rational{stream->samples_per_frame};
        }
    }
    return out;
}

WorkAhead work_ahead(Scenario const& scenario, Dataflow const& flow) {
    WorkAhead out;
    if (scenario.clock.mode != bus::ClockMode::lockstep) {
        return out;
    }
    Loops const loops{scenario, flow};
    Rational const quantum = scenario.quantum_s();
    auto const on_grid = [&](Rational seconds) { return Rational{(seconds / quantum).ceil()} * quantum; };
    std::function<Rational(std::string const&)> const settle = [&](std::string const& member) {
        if (loops.ahead(member) <= Rational{0}) {
            return Rational{0};
        }
        std::string const up = loops.earliest(member);
        out.promise_s[up] = on_grid(loops.promise(up)); // as programs round their latencies
        return out.ahead_s[member] = settle(up) + out.promise_s[up];
    };
    for (std::string const& member : loops.feeding()) {
        if (loops.latency(member) < scenario.tick_s()) {
            (void)settle(member);
        }
    }
    return out;
}

void check_loops(Scenario const& scenario, Dataflow const& flow, Diagnostics& diagnostics) {
    Rational const tick = scenario.tick_s();
    Loops const loops{scenario, flow};
    for (std::string const& member : loops.feeding()) {
        Rational const loop = loops.ahead(member) + loops.latency(member);
        if (loop >= tick) {
            continue;
        }
        Process const& process = *scenario.find_process(member);
        Node const* written = process.node.find("latency_us");
        std::string const hops = loops.hops(member);
        bool const held_back = !loops.may_work_ahead() && process.settings->works_ahead();
        diagnostics.error(written == nullptr ? process.name.where : written->where,
                          fmt::format("process '{}' acts on the simulator {} after its input{}, and a tick is {}",
                                      member, microseconds(loop), hops, microseconds(tick)),
                          fmt::format("{} must be at least a tick{}: a tick that is over cannot be changed",
                                      hops.empty() ? "its `latency_us`" : "together they",
                                      held_back ? ", because events act on processes between two ticks" : ""));
    }
}

std::int64_t longest_tick_samples(Scenario const& scenario) {
    Diagnostics ignored; // said elsewhere
    auto const sampling = sim::read_sampling(scenario.simulation.sampling, ignored);
    bool const in_messages = !sim::read_gateways(scenario.simulation.gateways, ignored).lines.empty();
    std::int64_t const per_message = in_messages ? sampling.samples_per_message : 1;
    if (scenario.clock.mode != bus::ClockMode::lockstep) {
        return per_message;
    }
    constexpr std::int64_t kLongest = 64;
    Dataflow const flow = dataflow(scenario);
    for (std::int64_t samples = kLongest; samples > 1; --samples) {
        if (fits(scenario, flow, samples, sampling.rate_hz, per_message)) {
            return samples;
        }
    }
    return 1;
}

} // namespace gridspace::launcher
