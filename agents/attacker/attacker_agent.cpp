// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-attacker: does what the scenario's attacks say, as a man in the middle of a cable or next to the real
// publisher, and publishes what was true.
#include "agents/attacker/attack_hook.hpp"
#include "agents/attacker/attacker_config.hpp"
#include "agents/attacker/attacker_declaration.hpp"
#include "bus/daemon.hpp"
#include "bus/member.hpp"
#include "bus/signal_publisher.hpp"
#include "bus/tick_grid.hpp"
#include "common/log.hpp"
#include "gateways/bump_in_the_wire/bump_in_the_wire.hpp"
#include "gateways/ethernet/interface.hpp"
#include "gateways/port/wire_clock.hpp"
#include "gateways/port/wire_port.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::attacker {
namespace {

using gateways::BumpInTheWire;
using gateways::WireClock;
using gateways::WirePort;

struct Settings {
    AttackerSettings own;
    gateways::WireConfig wire; ///< interface empty: nothing is sent as a second publisher
    std::vector<gateways::BumpConfig> bumps;
    double speed{1};
};

void describe(config::Fields& f, Settings& s) {
    describe(f, s.own);
    gateways::describe_wire(f, s.wire);
    gateways::describe_bumps(f, s.bumps);
    f.number("speed", s.speed, {.doc = "of the simulation clock, in real time", .above = 0});
}

class AttackerAgent final : public bus::Member {
  public:
    AttackerAgent(Settings const& settings, DaemonRun& run, bus::Node& node)
        : settings_{settings}, run_{run}, node_{node}, clock_{node}, grid_{node.config().clock},
          latency_{node.time_base().ceil(settings.own.config.latency_us / Rational{1'000'000})} {}

    Result<void> prepare() override {
        for (auto const& step :
             {&AttackerAgent::check_interfaces, &AttackerAgent::make_attacks, &AttackerAgent::open_wires,
              &AttackerAgent::open_topics, &AttackerAgent::open_outputs}) {
            if (auto ok = (this->*step)(); !ok) {
                return ok;
            }
        }
        return {};
    }

    void begin(bus::Tick const& tick) override {
        if (signals_ != nullptr) {
            signals_->announce(tick.time);
        }
    }

    Result<void> work(bus::Tick const& tick) override {
        for (auto const& bump : bumps_) {
            bump->work(tick.time);
        }
        beside(clock_.simulated_ns(tick.time, settings_.speed));
        publish(tick.time, tick.final);
        if (port_ != nullptr) {
            port_->maintain();
        }
        return {};
    }

    std::uint64_t next_tick(bus::Tick const& tick) const override {
        std::uint64_t needed = next_second(tick.time);
        for (auto const& bump : bumps_) {
            needed = std::min(needed, bump->next_tick(grid_));
        }
        if (auto const work = next_work()) {
            needed = std::min(needed, grid_.tick_of(clock_.at_or_after(*work)));
        }
        bool const in_every_tick = std::ranges::any_of(
            attacks_, [](auto const& attack) { return attack->topic && attack->topic->works_in_every_tick(); });
        return in_every_tick ? tick.number + 1 : needed;
    }

    std::optional<std::chrono::steady_clock::time_point> deadline() const override {
        auto const next = next_work();
        return next ? std::optional{wall_of(*next)} : std::nullopt;
    }

  private:
    /// Forged frames can operate real switchgear: virtual cables only, unless somebody means it.
    Result<void> check_interfaces() {
        std::vector<std::string> interfaces;
        if (!settings_.wire.interface.empty()) {
            interfaces.push_back(settings_.wire.interface);
        }
        for (auto const& bump : settings_.bumps) {
            interfaces.insert(interfaces.end(), {bump.host_interface, bump.switch_interface});
        }
        for (std::string const& interface : interfaces) {
            std::string const kind = ethernet::interface_kind(interface);
            if (kind != "veth" && interface != settings_.own.allow_attacks_on) {
                return fail(
                    ExitCode::usage,
                    fmt::format("'{}' is not a virtual cable ({})", interface, kind.empty() ? "unknown" : kind),
                    fmt::format("forged frames can operate real switchgear; if that is meant: --allow-attacks-on {}",
                                interface));
            }
        }
        return {};
    }

    Result<void> make_attacks() {
        for (AttackConfig const& config : settings_.own.attacks) {
            auto attack = make_attack(node_, config, settings_.own, settings_.wire.streams);
            if (!attack) {
                return std::unexpected{attack.error()};
            }
            attacks_.push_back(std::move(*attack));
        }
        return {};
    }

    /// Bumps in the wire with the attacks of their cable, and the port of the second publishers.
    Result<void> open_wires() {
        for (auto const& config : settings_.bumps) {
            AttackHook& from_host = *hooks_.emplace_back(std::make_unique<AttackHook>(node_));
            AttackHook& to_host = *hooks_.emplace_back(std::make_unique<AttackHook>(node_));
            for (auto const& attack : attacks_) {
                if (!attack->between() || attack->config->between[0].name != config.host ||
                    attack->config->between[1].name != config.link) {
                    continue;
                }
                auto const& towards = settings_.own.towards_host;
                bool const is_towards =
                    std::ranges::find(towards, attack->config->name.name, &config::Ref::name) != towards.end();
                (is_towards ? to_host : from_host).add(*attack);
                if (attack->condition) {
                    from_host.watch(*attack);
                    to_host.watch(*attack);
                }
            }
            auto bump = BumpInTheWire::open(node_, config, settings_.speed, {&from_host, &to_host});
            if (!bump) {
                return std::unexpected{bump.error()};
            }
            bumps_.push_back(std::move(*bump));
        }
        std::vector<std::uint16_t> ethertypes;
        for (auto const& attack : attacks_) {
            if (attack->between() || attack->topic != nullptr) {
                continue;
            }
            AttackConfig const& config = *attack->config;
            ethertypes.push_back(config.goose ? iec61850::kGooseEthertype : iec61850::kSvEthertype);
            if (config.waits_for_other()) {
                ethertypes.push_back(config.when->said ? iec61850::kGooseEthertype : iec61850::kSvEthertype);
            }
        }
        std::sort(ethertypes.begin(), ethertypes.end());
        ethertypes.erase(std::unique(ethertypes.begin(), ethertypes.end()), ethertypes.end());
        if (ethertypes.empty()) {
            return {};
        }
        auto port = WirePort::open(node_, settings_.wire, {ethertypes, ethertypes, false, false});
        if (!port) {
            return std::unexpected{port.error()};
        }
        port_ = std::move(*port);
        ethertypes_ = std::move(ethertypes);
        for (auto const& attack : attacks_) {
            if (attack->values) {
                attack->values->set_source(port_->mac());
            } else if (attack->messages) {
                attack->messages->set_source(port_->mac());
            }
        }
        return {};
    }

    Result<void> open_topics() {
        if (settings_.own.config.labels.empty()) {
            return {};
        }
        auto writer = node_.writer<AttackLabel>(settings_.own.config.labels);
        if (!writer) {
            return std::unexpected{writer.error()};
        }
        labels_ = std::move(*writer);
        for (auto const& attack : attacks_) {
            AttackConfig const& c = *attack->config;
            attack->labels = std::make_unique<LabelPublisher>(*labels_, c.name.name, std::string{kind_name(c)},
                                                              c.stream.empty() ? c.topic.name : c.stream.name);
        }
        return {};
    }

    Result<void> open_outputs() {
        if (attacks_.empty()) { // as it is declared
            return {};
        }
        std::vector<bus::SignalColumn> columns;
        for (auto const& attack : attacks_) {
            columns.push_back({forged_signal(*attack->config).name, ""});
        }
        auto signals = bus::SignalPublisher::create(node_, "attacks", 1, std::move(columns));
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        return {};
    }

    /// Real time.
    [[nodiscard]] std::chrono::steady_clock::time_point wall_of(std::int64_t simulated_ns) const {
        auto const ahead =
            static_cast<double>(simulated_ns - clock_.simulated_ns({}, settings_.speed)) / settings_.speed;
        return WireClock::wall(clock_.now() + static_cast<std::int64_t>(std::max(ahead, 0.0)));
    }

    /// The next forged message of a second publisher. Simulated.
    [[nodiscard]] std::optional<std::int64_t> next_work() const {
        std::optional<std::int64_t> out;
        for (auto const& attack : attacks_) {
            std::optional<std::int64_t> due;
            if (attack->topic) {
                due = attack->topic->due();
            } else if (attack->messages && !attack->between()) {
                due = attack->messages->due();
            }
            out = due && (!out || *due < *out) ? due : out;
        }
        return out;
    }

    /// What second publishers do, up to and including `until_ns`.
    void beside(std::int64_t until_ns) {
        heard_.clear();
        for (std::uint16_t const ethertype : ethertypes_) {
            for (bus::WireFrame const* frame : port_->take(ethertype)) {
                heard_.emplace_back(clock_.heard_ns(frame->time, until_ns), frame);
            }
        }
        if (ethertypes_.size() > 1) {
            std::ranges::stable_sort(heard_, {}, &std::pair<std::int64_t, bus::WireFrame const*>::first);
        }
        for (auto const& [at_ns, frame] : heard_) {
            elapse(at_ns - 1);
            hear(WirePort::octets(*frame), at_ns);
        }
        elapse(until_ns);
        for (auto const& attack : attacks_) {
            if (attack->topic) {
                attack->topic->work(until_ns, latency_, [&](Label const& label, std::int64_t time_ns) {
                    attack->now_ns = time_ns;
                    attack->tell(label);
                });
            }
        }
    }

    void hear(iec61850::Octets octets, std::int64_t at_ns) {
        for (auto const& attack : attacks_) {
            if (!attack->between() && !attack->topic) { // those have a time of their own, on the thread of the cable
                attack->now_ns = at_ns;
                attack->look(octets, at_ns);
            }
            if (attack->values && !attack->between()) {
                attack->values->hear(octets, at_ns, [&](auto forged) { send(forged, at_ns); }, attack->tell);
            } else if (attack->messages && !attack->between()) {
                attack->messages->pass(octets, at_ns, nullptr, attack->tell);
            }
        }
    }

    void elapse(std::int64_t until_ns) {
        for (auto const& attack : attacks_) {
            if (!attack->messages || attack->between()) {
                continue;
            }
            attack->messages->set_utc_base(clock_.start_utc_ns());
            while (attack->messages->due() && *attack->messages->due() <= until_ns) {
                attack->now_ns = *attack->messages->due();
                attack->messages->elapse(
                    attack->now_ns, [&](auto forged) { send(forged, attack->now_ns); }, attack->tell);
            }
        }
    }

    void send(std::span<std::uint8_t const> frame, std::int64_t at_ns) {
        port_->send(frame, node_.effect_time(clock_.sim_time(at_ns), latency_));
    }

    [[nodiscard]] std::uint64_t next_second(SimTime now) const {
        auto const second = static_cast<std::int64_t>(node_.time_base().seconds(now)) + 1;
        return grid_.tick_of(node_.time_base().from_nanoseconds(second * 1'000'000'000));
    }

    /// Labels that have come, events, and counters once a simulated second.
    void publish(SimTime now, bool final) {
        for (auto const& attack : attacks_) {
            for (Running::TimedLabel timed; attack->timed_labels.pop(timed);) {
                attack->first_ns = attack->first_ns.value_or(timed.time_ns);
                if (attack->labels) {
                    attack->labels->add(timed.label, timed.time_ns, std::min(clock_.sim_time(timed.time_ns), now));
                }
            }
            if (final && attack->labels) {
                attack->labels->flush(now);
            }
            tell_progress(*attack, now, final);
        }
        auto const second = static_cast<std::int64_t>(node_.time_base().seconds(now));
        if (signals_ == nullptr || (second == reported_ && !final)) {
            return;
        }
        reported_ = second;
        std::vector<double> row;
        for (auto const& attack : attacks_) {
            row.push_back(static_cast<double>(attack->forged()));
        }
        signals_->row(now, row);
        signals_->flush();
    }

    void tell_progress(Running& attack, SimTime now, bool final) {
        double const time_s = node_.time_base().seconds(now);
        AttackConfig const& c = *attack.config;
        std::string const target = c.stream.empty() ? c.topic.name : c.stream.name;
        if (!attack.began && attack.forged() > 0) {
            attack.began = true;
            log::info("attack '{}' on {}: begins", c.name.name, target);
            // Within the tick: before what answers to it.
            double const begins_s = attack.first_ns ? 1e-9 * static_cast<double>(*attack.first_ns) : time_s;
            run_.status.event(std::min(begins_s, time_s), node_.config().process, c.name.name + ".begins",
                              fmt::format("attack '{}' on {} begins", c.name.name, target));
        }
        if (!attack.ended && (final || time_s > c.end_s())) {
            attack.ended = true;
            std::string const text = fmt::format("attack '{}' on {} ends: {} {}", c.name.name, target, attack.forged(),
                                                 attack.values ? "frames altered"
                                                 : c.frames    ? "frames altered, delayed, dropped or copied"
                                                               : "messages forged or dropped");
            log::info("{}", text);
            run_.status.event(time_s, node_.config().process, c.name.name + ".ends", text);
        }
        if (std::uint64_t const lost = attack.lost.exchange(0); lost > 0) {
            log::warning("attack '{}': {} labels lost, the queue was full", c.name.name, lost);
        }
    }

    Settings const& settings_;
    DaemonRun& run_;
    bus::Node& node_;
    WireClock clock_;
    bus::TickGrid grid_;
    SimSpan latency_;
    std::vector<std::unique_ptr<Running>> attacks_;
    std::vector<std::unique_ptr<AttackHook>> hooks_;
    std::unique_ptr<bus::Writer<AttackLabel>> labels_;
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::vector<std::uint16_t> ethertypes_;
    std::vector<std::pair<std::int64_t, bus::WireFrame const*>> heard_; ///< in this tick, by simulated time
    std::unique_ptr<WirePort> port_;
    std::vector<std::unique_ptr<BumpInTheWire>> bumps_; ///< last: their threads use what stands above
    std::int64_t reported_{-1};
};

} // namespace
} // namespace gridspace::attacker

int main(int argc, char** argv) {
    using namespace gridspace;
    attacker::Settings settings;
    program::Declaration const declaration = attacker::attacker_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) { describe(f, settings); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                attacker::AttackerAgent agent{settings, run, node};
                                return bus::run_member(node, agent);
                            });
                        },
                        true,
                        attacker::attacker_declaration};
    return run_daemon(daemon, argc, argv);
}
