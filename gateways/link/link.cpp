// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-link: sits in the cable between a host and a switch and does to frames what a bad cable does.
#include "bus/daemon.hpp"
#include "bus/tick_grid.hpp"
#include "gateways/cut_in/cut_in.hpp"
#include "gateways/link/link_config.hpp"

namespace gridspace::gateways {
namespace {

struct Settings {
    LinkConfig link;
    std::vector<CutInConfig> cut_ins;
    double speed{1};
};

void describe(config::Fields& f, Settings& s) {
    describe(f, s.link);
    describe_cut_ins(f, s.cut_ins);
    f.number("speed", s.speed, {.doc = "of the simulation clock, in real time", .above = 0});
}

class LinkShell {
  public:
    LinkShell(Settings const& settings, bus::Node& node)
        : settings_{settings}, node_{node}, grid_{node.config().clock} {}

    Result<void> run() {
        for (CutInConfig const& config : settings_.cut_ins) {
            auto cut_in = CutIn::open(node_, config, settings_.speed, {&hook_, &hook_});
            if (!cut_in) {
                return std::unexpected{cut_in.error()};
            }
            cut_ins_.push_back(std::move(*cut_in));
        }
        if (auto ok = node_.start(); !ok) {
            return ok;
        }
        while (true) {
            auto tick = node_.next();
            if (!tick) {
                return std::unexpected{tick.error()};
            }
            if (!*tick) {
                return {};
            }
            std::uint64_t needed = bus::TickGrid::kNever;
            for (auto const& cut_in : cut_ins_) {
                cut_in->work((*tick)->time);
                needed = std::min(needed, cut_in->next_tick(grid_));
            }
            if (auto ok = node_.done(**tick, needed); !ok) {
                return ok;
            }
        }
    }

  private:
    Settings const& settings_;
    bus::Node& node_;
    bus::TickGrid grid_;
    FrameHook hook_;
    std::vector<std::unique_ptr<CutIn>> cut_ins_;
};

} // namespace
} // namespace gridspace::gateways

int main(int argc, char** argv) {
    using namespace gridspace;
    gateways::Settings settings;
    Daemon const daemon{"gridspace-link",
                        "impairments of the cable between a host and a switch",
                        [&](config::Fields& f) { describe(f, settings); },
                        {},
                        [&](DaemonRun& run) {
                            return run_on_bus(run, [&](bus::Node& node) -> Result<void> {
                                return gateways::LinkShell{settings, node}.run();
                            });
                        }};
    return run_daemon(daemon, argc, argv);
}
