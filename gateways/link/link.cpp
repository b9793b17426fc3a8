// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-link: sits in the cable between a host and a switch and does to frames what a bad cable does.
#include "bus/daemon.hpp"
#include "bus/member.hpp"
#include "bus/signal_publisher.hpp"
#include "bus/tick_grid.hpp"
#include "common/log.hpp"
#include "common/text.hpp"
#include "gateways/bump_in_the_wire/bump_in_the_wire.hpp"
#include "gateways/link/link_config.hpp"
#include "gateways/link/link_declaration.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

struct Settings {
    LinkConfig link;
    std::vector<BumpConfig> bumps;
    std::vector<ImpairmentChange> changes;
    std::vector<streams::Stream> streams;
    std::int64_t seed{0};
    double speed{1};
};

void describe_changes(config::Fields& f, std::vector<ImpairmentChange>& changes) {
    f.list("changes", {.doc = "what events of the timeline set; filled in by `gridspace run`"}, [&](config::Fields& c) {
        ImpairmentChange change;
        Rational at_s{0};
        c.fraction("at_s", at_s, {.doc = "simulated time", .required = true, .min = 0});
        c.text("key", change.key, {.doc = "which impairment", .required = true});
        c.number("value", change.value, {.doc = "its value from then on; true is 1", .required = true});
        change.at_ns = std::llround(at_s.to_double() * 1e9);
        changes.push_back(std::move(change));
    });
}

void describe(config::Fields& f, Settings& s) {
    describe(f, s.link);
    describe_bumps(f, s.bumps);
    describe_changes(f, s.changes);
    f.integer("seed", s.seed, {.doc = "of everything random"});
    f.number("speed", s.speed, {.doc = "of the simulation clock, in real time", .above = 0});
    config::Node node;
    f.raw("streams", node, {.doc = "the streams that it looks for"});
    config::Diagnostics diagnostics;
    s.streams = streams::read_streams(node, diagnostics);
    if (!diagnostics.ok()) {
        f.error("streams", diagnostics.render());
    }
}

class LinkAgent final : public bus::Member {
  public:
    LinkAgent(Settings const& settings, DaemonRun& run, bus::Node& node)
        : settings_{settings}, run_{run}, node_{node}, grid_{node.config().clock} {}

    void begin(bus::Tick const& tick) override { signals_->announce(tick.time); }

    Result<void> work(bus::Tick const& tick) override {
        for (auto const& bump : bumps_) {
            bump->work(tick.time);
        }
        report(tick.time, tick.final);
        return {};
    }
    std::uint64_t next_tick(bus::Tick const&) const override {
        std::uint64_t needed = bus::TickGrid::kNever;
        for (auto const& bump : bumps_) {
            needed = std::min(needed, bump->next_tick(grid_));
        }
        return needed;
    }
    /// In real time the bumps in the wire have threads of their own; here only counters are looked at.
    std::optional<std::chrono::steady_clock::time_point> deadline() const override {
        return std::chrono::steady_clock::now() + std::chrono::milliseconds{500};
    }

    Result<void> prepare() override {
        config::Diagnostics diagnostics;
        ImpairmentPlan plan = make_plan(settings_.link, settings_.streams, diagnostics);
        if (!diagnostics.ok()) {
            return fail(ExitCode::usage, diagnostics.render());
        }
        plan.changes = settings_.changes;
        auto const seed = static_cast<std::uint64_t>(settings_.seed);
        for (BumpConfig const& config : settings_.bumps) {
            std::string const name = fmt::format("{}.{}", node_.config().process, bumps_.size());
            auto const hook = [&](char const* direction) {
                hooks_.push_back(std::make_unique<Impairment>(plan, seed, name + direction));
                return hooks_.back().get();
            };
            auto bump = BumpInTheWire::open(node_, config, settings_.speed, {hook(".from_host"), hook(".to_host")});
            if (!bump) {
                return std::unexpected{bump.error()};
            }
            bumps_.push_back(std::move(*bump));
        }
        auto signals = bus::SignalPublisher::create(node_, "link", link_declaration().signals, {});
        if (!signals) {
            return std::unexpected{signals.error()};
        }
        signals_ = std::move(*signals);
        return {};
    }

  private:
    /// Counters once per simulated second, and what the timeline has set.
    void report(SimTime time, bool final) {
        double const now_s = node_.time_base().seconds(time);
        for (; changes_done_ < settings_.changes.size() &&
               static_cast<double>(settings_.changes[changes_done_].at_ns) / 1e9 <= now_s;
             ++changes_done_) {
            ImpairmentChange const& change = settings_.changes[changes_done_];
            std::string const text =
                fmt::format("{} is {}", change.key,
                            change.key == "up" ? (change.value != 0 ? "true" : "false") : shortest(change.value));
            log::info("{}", text);
            run_.status.event(static_cast<double>(change.at_ns) / 1e9, node_.config().process, "set", text);
        }
        auto const second = static_cast<std::int64_t>(now_s);
        if (second == reported_ && !final) {
            return;
        }
        reported_ = second;
        std::array<double, kLinkCounters.size()> row{};
        for (auto const& hook : hooks_) {
            Impairment::Counters const& c = hook->counters();
            std::array const counts{&c.seen, &c.lost, &c.delayed, &c.duplicated, &c.reordered, &c.corrupted};
            for (std::size_t i = 0; i < row.size(); ++i) {
                row[i] += static_cast<double>(counts[i]->load());
            }
        }
        signals_->row(time, row);
        signals_->flush();
    }

    Settings const& settings_;
    DaemonRun& run_;
    bus::Node& node_;
    bus::TickGrid grid_;
    std::vector<std::unique_ptr<Impairment>> hooks_;
    std::vector<std::unique_ptr<BumpInTheWire>> bumps_; ///< behind the hooks: their threads use them
    std::unique_ptr<bus::SignalPublisher> signals_;
    std::size_t changes_done_{0};
    std::int64_t reported_{-1};
};

} // namespace
} // namespace gridspace::gateways

int main(int argc, char** argv) {
    using namespace gridspace;
    gateways::Settings settings;
    program::Declaration const declaration = gateways::link_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) { describe(f, settings); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                gateways::LinkAgent agent{settings, run, node};
                                return bus::run_member(node, agent);
                            });
                        },
                        true,
                        gateways::link_declaration};
    return run_daemon(daemon, argc, argv);
}
