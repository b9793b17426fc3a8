// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/fuse_engine.hpp"

#include "sim/components/fuse/fuse_element.hpp"
#include "sim/runtime/wrapped_engine.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace gridspace::sim {
namespace {

class FuseEngine final : public WrappedEngine {
  public:
    FuseEngine(std::unique_ptr<Engine> engine, Network const& network, TimeBase const& base, SimSpan step)
        : WrappedEngine{std::move(engine)}, base_{base}, step_{step} {
        units_.reserve(network.fuses.size()); // signals look into it
        for (Fuse const& fuse : network.fuses) {
            units_.push_back({fuse.name.name, fuse.line.name,
                              FuseElement{*NetworkAround{network}.find<FuseType>(fuse.type), network.frequency_hz}});
            Unit& unit = units_.back();
            std::string const end =
                fmt::format("line.{}.{}", fuse.line.name, fuse.end == LineEnd::from ? "from" : "to");
            by_pole_ = inner().find_signal(end + ".i.a") < inner().signals().size();
            for (std::size_t k = 0; k < (by_pole_ ? 3U : 1U); ++k) {
                std::string const phase = by_pole_ ? fmt::format(".{}", kPhases[k]) : "";
                unit.links.push_back({unit.fresh, measure(end + (by_pole_ ? ".i" + phase : ".i_a"))});
                add_signal({signal_prefix(fuse) + ".damage" + phase, "p.u."},
                           [&unit, k] { return unit.links[k].element.damage(); });
                add_signal({signal_prefix(fuse) + ".melted_s" + phase, "s", true},
                           [&unit, k] { return unit.links[k].melted_s; });
            }
        }
    }

    [[nodiscard]] Result<void> advance(SimTime until) override {
        happened_.clear();
        while (now_ < until) {
            if (auto ok = open_molten(); !ok) {
                return ok;
            }
            SimTime const next = std::min(until, now_ + step_);
            if (auto ok = inner().advance(next); !ok) {
                return ok;
            }
            double const from_s = base_.seconds(now_), h = base_.seconds(next) - from_s;
            now_ = next;
            for (Unit& unit : units_) {
                carry(unit, from_s, h);
            }
        }
        return {};
    }
    [[nodiscard]] Result<void> apply(Action const& action) override {
        auto ok = inner().apply(action);
        auto const* command = std::get_if<SwitchBreaker>(&action);
        auto const* connect = std::get_if<Connect>(&action);
        for (Unit& unit : units_) {
            if (ok && command != nullptr && command->close && command->breaker == unit.fuse) {
                for (Link& link : unit.links) {
                    link = {unit.fresh, link.current};
                }
            }
            if (ok && connect != nullptr && connect->element == unit.line) { // a line in service has no new links
                for (Link& link : unit.links) {
                    link.opens = link.element.molten();
                }
            }
        }
        return ok;
    }
    [[nodiscard]] std::span<Happening const> happened() const override { return happened_; }

  private:
    static constexpr std::string_view kPhases = "abc";
    struct Link {
        FuseElement element;
        std::size_t current; ///< signal
        double melted_s{std::numeric_limits<double>::quiet_NaN()};
        bool opens{false}; ///< its arc begins now
    };
    struct Unit {
        std::string fuse, line;
        FuseElement fresh;
        std::vector<Link> links{}; ///< one for all three in phasors
    };

    [[nodiscard]] Result<void> open_molten() {
        for (Unit& unit : units_) {
            SwitchBreaker command{.breaker = unit.fuse, .close = false, .poles = {}};
            for (std::size_t k = 0; k < command.poles.size(); ++k) {
                command.poles[k] = unit.links[by_pole_ ? k : 0].opens;
            }
            if (std::ranges::any_of(command.poles, [](bool pole) { return pole; })) {
                if (auto ok = inner().apply(command); !ok) {
                    return ok;
                }
            }
            for (Link& link : unit.links) {
                link.opens = false;
            }
        }
        return {};
    }
    void carry(Unit& unit, double from_s, double h) {
        for (std::size_t k = 0; k < unit.links.size(); ++k) {
            Link& link = unit.links[k];
            double const i_a = inner().value(link.current);
            link.opens = by_pole_ ? link.element.carry(i_a, h) : link.element.carry_rms(i_a, h);
            if (link.opens) {
                link.melted_s = from_s + h * link.element.melted_share();
                happened_.push_back({link.melted_s, unit.fuse, "fuse_melted",
                                     by_pole_ ? fmt::format("its link of phase {}", kPhases[k]) : "its three links"});
            }
        }
    }

    TimeBase base_;
    SimSpan step_;
    SimTime now_;
    bool by_pole_{true};
    std::vector<Unit> units_;
    std::vector<Happening> happened_;
};

} // namespace

std::unique_ptr<Engine> with_fuses(std::unique_ptr<Engine> engine, Network const& network, TimeBase const& base,
                                   SimSpan step) {
    return network.fuses.empty() ? std::move(engine)
                                 : std::make_unique<FuseEngine>(std::move(engine), network, base, step);
}

} // namespace gridspace::sim
