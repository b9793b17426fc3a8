// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-timebox: somebody else's program, unmodified, as a lockstep member.
#include "bus/daemon.hpp"
#include "bus/member.hpp"
#include "common/log.hpp"
#include "common/random.hpp"
#include "common/text.hpp"
#include "timebox/door/door.hpp"
#include "timebox/member/frame_exchange.hpp"
#include "timebox/member/topic_exchange.hpp"
#include "timebox/stops.hpp"

#include <csignal>
#include <cstring>
#include <fmt/format.h>

namespace gridspace::timebox {
namespace {

/// Of the time that the simulator waits for a member: before it speaks, we name the program and its call.
constexpr double kShareOfPatience = 0.8;
/// Simulated time that the program has for its end when the run is over.
constexpr std::int64_t kLastNs = 100'000'000;

/// CycloneDDS looks for others on the interface where the door is: whatever interfaces a machine has, runs are alike.
constexpr char const* kOnLoopback =
    "<General><Interfaces><NetworkInterface address=\"127.0.0.1\" multicast=\"true\"/></Interfaces>"
    "<AllowMulticast>true</AllowMulticast></General>";

class TimeboxMember final : public bus::Member {
  public:
    TimeboxMember(MemberConfig const& config, DaemonRun& run, bus::Node& node)
        : config_{config}, run_{run}, node_{node}, clock_{node}, grid_{node.config().clock} {}

    Result<void> prepare() override {
        auto exchange = FrameExchange::open(node_, config_);
        if (!exchange) {
            return std::unexpected{exchange.error()};
        }
        exchange_ = std::move(*exchange);
        auto topics = TopicExchange::open(node_, config_);
        if (!topics) {
            return std::unexpected{topics.error()};
        }
        topics_ = std::move(*topics);
        return {};
    }

    Result<void> work(bus::Tick const& tick) override {
        if (box_ == nullptr) {
            if (auto ok = start(tick); !ok) {
                return ok;
            }
        }
        exchange_->bring(*box_);
        topics_->bring(*box_);
        exchange_->maintain();
        auto const pause = box_->run_until(clock_.of(tick.time));
        if (ended_) {
            return {};
        }
        if (!pause) {
            tell();
            return std::unexpected{pause.error()};
        }
        return *pause == Box::Pause::ended ? ended() : Result<void>{};
    }

    std::uint64_t next_tick(bus::Tick const& tick) const override {
        if (topics_->hears_simulator()) {
            return tick.number + 1;
        }
        std::uint64_t out = bus::TickGrid::kNever;
        if (auto const effect = topics_->last_effect(); effect && *effect > tick.time) {
            out = grid_.tick_of(*effect);
        }
        if (auto const next_ns = box_->next_ns()) {
            out = std::min(out, grid_.tick_of(clock_.at_or_after(*next_ns)));
        }
        if (auto const next = exchange_->next()) {
            out = std::min(out, grid_.tick_of(*next));
        }
        return out;
    }

    void end(bus::Tick const&) override {
        if (box_ == nullptr) {
            return;
        }
        if (!ended_) {
            exchange_->close();
            topics_->close();
            box_->ask_to_end();
            if (auto const pause = box_->run_until(box_->report().simulated_ns + kLastNs); !pause) {
                log::warning("{}", pause.error().message);
            }
        }
        tell();
    }

  private:
    Result<void> start(bus::Tick const& tick) {
        bus::NodeConfig const& bus = node_.config();
        BoxOptions options;
        options.command = config_.command;
        options.seed = Random{static_cast<std::uint64_t>(config_.seed), bus.process}.next();
        options.epoch_unix_s = bus.clock.epoch_unix_s;
        if (tick.number > 0) { // it has been restarted
            options.begin_ns = clock_.of(tick.time - node_.time_base().nearest(bus.clock.tick_s));
        }
        options.patience_s = options.rest_s = kShareOfPatience * bus.clock.member_timeout_s;
        options.link = exchange_->link();
        if (topics_->any()) {
            options.door = topics_->door();
            options.environment.emplace_back("CYCLONEDDS_URI", kOnLoopback);
        }
        options.stop = [this] { return node_.stop_is_requested() || node_.failure().has_value(); };
        auto box = Box::start(std::move(options));
        if (!box) {
            return std::unexpected{box.error()};
        }
        box_ = std::move(*box);
        return {};
    }

    [[nodiscard]] double now_s() const { return static_cast<double>(box_->report().simulated_ns) / 1e9; }

    Result<void> ended() {
        ended_ = true;
        BoxReport const report = box_->report();
        constexpr int kSignals = 128;
        std::string const how = report.exit_code > kSignals
                                    ? fmt::format("was killed by signal {} ({})", report.exit_code - kSignals,
                                                  ::strsignal(report.exit_code - kSignals))
                                    : fmt::format("ended with exit code {}", report.exit_code);
        std::string const text = fmt::format("'{}' {} at {:.6f} s of simulated time; its last call was {}",
                                             config_.command.front(), how, now_s(), report.last_call);
        if (report.exit_code != 0) {
            tell();
            return fail(ExitCode::child_died, text, "see its log");
        }
        log::info("{}", text);
        run_.status.event(now_s(), node_.config().process, "ended", text);
        return {};
    }

    /// What was held, and what was refused: for the log, the events of the run and its report.
    void tell() {
        BoxReport const report = box_->report();
        std::vector<std::string> kinds;
        std::uint64_t calls = 0;
        for (auto const& [name, times] : report.calls) {
            kinds.push_back(fmt::format("{} {}", times, name));
            calls += times;
        }
        say("held_calls", fmt::format("{} calls of {} threads were answered in simulated time: {}", calls,
                                      report.threads, join(kinds, ", ")));
        if (topics_->any()) {
            auto const counted = topics_->counters();
            say("topics",
                fmt::format("{} samples given to the program, {} taken from it{}", counted.read, counted.written,
                            counted.misfits == 0 ? "" : fmt::format(", {} not of their type", counted.misfits)));
        }
        for (auto const& [what, times] : report.refused) {
            say("refused", fmt::format("{}, which cannot be had in simulated time: refused {} time{}", what, times,
                                       times == 1 ? "" : "s"));
        }
        for (auto const& [what, times] : report.not_simulated) {
            say("not_simulated", fmt::format("{} ({} time{})", what, times, times == 1 ? "" : "s"));
        }
    }

    void say(char const* kind, std::string const& text) {
        log::info("{}", text);
        run_.status.event(now_s(), node_.config().process, kind, text);
    }

    MemberConfig const& config_;
    DaemonRun& run_;
    bus::Node& node_;
    gateways::WireClock clock_;
    bus::TickGrid grid_;
    std::unique_ptr<FrameExchange> exchange_;
    std::unique_ptr<TopicExchange> topics_;
    std::unique_ptr<Box> box_; ///< before exchange_ goes
    bool ended_{false};
};

} // namespace
} // namespace gridspace::timebox

int main(int argc, char** argv) {
    using namespace gridspace;
    if (timebox::is_door(argc, argv)) {
        return timebox::run_door(argc, argv);
    }
    timebox::Stops::keep_child_signal(); // from the threads of the bus
    timebox::MemberConfig settings;
    Daemon daemon{"gridspace-timebox",
                  "somebody else's program, unmodified, in simulated time",
                  [&](config::Fields& f) { describe(f, settings); },
                  {},
                  [&](DaemonRun& run) {
                      return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                          timebox::TimeboxMember member{settings, run, node};
                          return bus::run_member(node, member);
                      });
                  }};
    daemon.is_ours = false; // it starts a program, and traces it
    return run_daemon(daemon, argc, argv);
}
