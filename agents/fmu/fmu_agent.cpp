// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-fmu: a model of somebody else (FMI 2.0 or 3.0, co-simulation) as an agent.
#include "agents/fmu/fmu_declaration.hpp"
#include "agents/fmu/fmu_topics.hpp"
#include "agents/fmu/model_run.hpp"
#include "agents/fmu/unpacked_fmu.hpp"
#include "bus/daemon.hpp"
#include "bus/member.hpp"
#include "bus/topics.hpp"
#include "common/log.hpp"

#include <fmt/format.h>

namespace gridspace::agents {
namespace {

class FmuAgent final : public bus::Member {
  public:
    FmuAgent(FmuConfig const& config, bus::Node& node, StatusReporter& status)
        : config_{config}, node_{node}, status_{status}, period_{node.time_base().nearest(config.period_s)},
          grid_{node.config().clock}, guard_{config.fmu.filename().string(), status.fd()} {}

    Result<void> prepare() override {
        bus::ClockConfig const& clock = node_.config().clock;
        auto unpacked = UnpackedFmu::open(config_.fmu, node_.config().process);
        if (!unpacked) {
            return std::unexpected{unpacked.error()};
        }
        unpacked_ = std::move(*unpacked);
        config::Diagnostics diagnostics;
        table_ = make_table(config_, unpacked_->description(), node_.config().process, bus::idl_of_type, diagnostics);
        if (!diagnostics.ok()) {
            return fail(ExitCode::usage, diagnostics.render());
        }
        guard_.patience(clock.start_timeout_s / 2);
        auto instance = unpacked_->instantiate(node_.config().process, guard_);
        if (!instance) {
            return std::unexpected{instance.error()};
        }
        bool const resumes = config_.on_restart == FmuConfig::OnRestart::resume;
        std::filesystem::path const state = resumes ? node_.config().process + ".fmu_state" : "";
        run_ = std::make_unique<ModelRun>(
            ModelRun::Settings{config_, table_, unpacked_->description(), node_.time_base(), period_, state},
            std::move(*instance), guard_);
        if (resumes && node_.config().incarnation > 0) {
            auto const resumed = run_->resume();
            if (!resumed) {
                return std::unexpected{resumed.error()};
            }
            log::info("{}", *resumed ? "it goes on with the state of its last communication point"
                                     : "there is no state of an earlier process: it begins anew");
        }
        guard_.patience(clock.member_timeout_s / 2);
        auto topics = FmuTopics::open(node_, config_, table_, unpacked_->description());
        if (!topics) {
            return std::unexpected{topics.error()};
        }
        topics_ = std::move(*topics);
        return {};
    }

    void begin(bus::Tick const& tick) override {
        topics_->announce(tick.time);
        while (due_ + period_ <= tick.time) { // who joins late starts with the period that it is in
            due_ = due_ + period_;
        }
    }

    Result<void> work(bus::Tick const& tick) override {
        while (node_.is_over(due_, tick)) { // who was paused: what it would have said is of no use now
            due_ = due_ + period_;
        }
        for (FmuTopics::Arrival const& arrival : topics_->arrived()) {
            while (arrival.origin.time > due_ && due_ <= tick.time) {
                if (auto ok = exchange(); !ok) {
                    return ok;
                }
            }
            topics_->read(arrival,
                          [&](std::size_t variable, fmi::Value value) { run_->input(variable, std::move(value)); });
        }
        while (due_ <= tick.time && measured(tick.time)) {
            if (auto ok = exchange(); !ok) {
                return ok;
            }
        }
        if (tick.final) {
            topics_->flush();
        }
        return {};
    }

    std::uint64_t next_tick(bus::Tick const&) const override {
        return ended_ ? bus::TickGrid::kNever : grid_.tick_of(due_);
    }

    void end(bus::Tick const&) override { run_.reset(); }

  private:
    /// Lockstep: all that belongs to the point is here. Real time: it may still be on its way; but not for long.
    bool measured(SimTime now) const {
        return node_.lockstep() || topics_->came_after(due_) || now >= due_ + SimSpan{period_.quanta / 10};
    }

    /// The communication point that is due; the next is a period later.
    Result<void> exchange() {
        SimTime const point = due_;
        due_ = due_ + period_;
        auto const goes_on = run_->exchange(point);
        if (!goes_on) {
            return std::unexpected{goes_on.error()};
        }
        if (*goes_on) {
            topics_->write(point, run_->values());
        } else if (!ended_) {
            ended_ = true;
            std::string const text =
                fmt::format("{} has ended itself: nothing more comes of it", unpacked_->description().file);
            log::warning("{}", text);
            status_.event(node_.time_base().seconds(point), node_.config().process, "fmu_ended", text);
        }
        return {};
    }

    FmuConfig const& config_;
    bus::Node& node_;
    StatusReporter& status_;
    SimSpan period_;
    bus::TickGrid grid_;
    SimTime due_; ///< the next communication point; the first is at simulated time 0
    bool ended_{false};
    CallGuard guard_;
    std::unique_ptr<UnpackedFmu> unpacked_;
    FmuTable table_;
    std::unique_ptr<FmuTopics> topics_;
    std::unique_ptr<ModelRun> run_; // before what it was loaded from
};

} // namespace
} // namespace gridspace::agents

int main(int argc, char** argv) {
    using namespace gridspace;
    agents::FmuConfig config;
    program::Declaration const declaration = agents::fmu_declaration();
    Daemon const daemon{.program = declaration.name,
                        .description = declaration.description,
                        .describe_settings = [&](config::Fields& f) { describe(f, config); },
                        .check = {},
                        .run =
                            [&](DaemonRun& run) {
                                return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                    agents::FmuAgent agent{config, node, run.status};
                                    return bus::run_member(node, agent);
                                });
                            },
                        .declaration = agents::fmu_declaration,
                        .is_ours = false}; // an FMU may start programs and open sockets
    return run_daemon(daemon, argc, argv);
}
