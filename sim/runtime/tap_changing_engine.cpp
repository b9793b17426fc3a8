// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/tap_changing_engine.hpp"

#include "sim/runtime/wrapped_engine.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

namespace gridspace::sim {
namespace {

class TapChangingEngine final : public WrappedEngine {
  public:
    TapChangingEngine(std::unique_ptr<Engine> engine, Network const& network, TimeBase const& base)
        : WrappedEngine{std::move(engine)}, base_{base} {
        units_.reserve(network.transformers.size()); // signals look into it
        for (Transformer const& t : network.transformers) {
            if (!t.tap_changer) {
                continue;
            }
            config::Ref const& bus = t.tap_changer->bus.empty() ? t.to : t.tap_changer->bus;
            units_.push_back({"transformers." + t.name.name + ".tap_ratio",
                              TapRegulator{*t.tap_changer, bus.name == t.from.name},
                              measure("bus." + bus.name + ".v_pu")});
            if (t.tap_changer->compensation) {
                units_.back().compensated = {*t.tap_changer->compensation, find(network.buses, t.to.name)->voltage_v,
                                             measure(signal_prefix(t) + ".to.p_kw"),
                                             measure(signal_prefix(t) + ".to.q_kvar")};
            }
            add_signal({signal_prefix(t) + ".tap_position", ""},
                       [&unit = units_.back()] { return static_cast<double>(unit.regulator.position()); });
        }
    }

    [[nodiscard]] Result<void> advance(SimTime until) override {
        for (Unit& unit : units_) {
            if (unit.due) {
                unit.due = false;
                if (auto ok = inner().apply(SetParameter{unit.path, unit.regulator.ratio()}); !ok) {
                    return ok;
                }
            }
        }
        if (auto ok = inner().advance(until); !ok) {
            return ok;
        }
        double const h = base_.seconds(until) - base_.seconds(now_);
        now_ = until;
        for (Unit& unit : units_) {
            unit.due = unit.regulator.step(measured_pu(unit), h);
        }
        return {};
    }
    [[nodiscard]] Result<void> apply(Action const& action) override {
        auto const* set = std::get_if<SetParameter>(&action);
        if (set != nullptr && std::ranges::any_of(units_, [&](Unit const& unit) { return unit.path == set->path; })) {
            return fail(ExitCode::usage, fmt::format("'{}' cannot be set: its tap changer does that", set->path),
                        "leave out `tap_changer`, or the event");
        }
        return inner().apply(action);
    }

  private:
    struct Unit {
        std::string path;
        TapRegulator regulator;
        std::size_t voltage; ///< signal
        bool due{false};     ///< its step takes effect now
        struct Compensated {
            LineDropCompensation how;
            double nominal_v;
            std::size_t p_kw, q_kvar; ///< signals: into the transformer at `to`
        };
        std::optional<Compensated> compensated{};
    };
    [[nodiscard]] double measured_pu(Unit const& unit) const {
        double const v = inner().value(unit.voltage);
        auto const& c = unit.compensated;
        return c ? c->how.compensated_pu(v, {-inner().value(c->p_kw), -inner().value(c->q_kvar)}, c->nominal_v) : v;
    }

    TimeBase base_;
    std::vector<Unit> units_;
    SimTime now_;
};

} // namespace

std::unique_ptr<Engine> with_tap_changers(std::unique_ptr<Engine> engine, Network const& network,
                                          TimeBase const& base) {
    bool const any =
        std::ranges::any_of(network.transformers, [](Transformer const& t) { return t.tap_changer.has_value(); });
    return any ? std::make_unique<TapChangingEngine>(std::move(engine), network, base) : std::move(engine);
}

} // namespace gridspace::sim
