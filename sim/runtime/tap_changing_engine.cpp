// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/tap_changing_engine.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim {
namespace {

class TapChangingEngine final : public Engine {
  public:
    TapChangingEngine(std::unique_ptr<Engine> inner, Network const& network, TimeBase const& base)
        : inner_{std::move(inner)}, base_{base}, signals_{inner_->signals()} {
        for (Transformer const& t : network.transformers) {
            if (!t.tap_changer) {
                continue;
            }
            config::Ref const& bus = t.tap_changer->bus.empty() ? t.to : t.tap_changer->bus;
            units_.push_back({"transformers." + t.name.name + ".tap_ratio",
                              TapRegulator{*t.tap_changer, bus.name == t.from.name},
                              inner_->find_signal("bus." + bus.name + ".v_pu")});
            signals_.push_back({signal_prefix(t) + ".tap_position", ""});
        }
    }

    [[nodiscard]] Result<void> initialise() override { return inner_->initialise(); }
    [[nodiscard]] Result<void> advance(SimTime until) override {
        for (Unit& unit : units_) {
            if (unit.due) {
                unit.due = false;
                if (auto ok = inner_->apply(SetParameter{unit.path, unit.regulator.ratio()}); !ok) {
                    return ok;
                }
            }
        }
        if (auto ok = inner_->advance(until); !ok) {
            return ok;
        }
        double const h = base_.seconds(until) - base_.seconds(now_);
        now_ = until;
        for (Unit& unit : units_) {
            unit.due = unit.regulator.step(inner_->value(unit.voltage), h);
        }
        return {};
    }
    [[nodiscard]] Result<void> apply(Action const& action) override {
        auto const* set = std::get_if<SetParameter>(&action);
        if (set != nullptr && std::ranges::any_of(units_, [&](Unit const& unit) { return unit.path == set->path; })) {
            return fail(ExitCode::usage, fmt::format("'{}' cannot be set: its tap changer does that", set->path),
                        "leave out `tap_changer`, or the event");
        }
        return inner_->apply(action);
    }
    [[nodiscard]] std::vector<SignalDef> const& signals() const override { return signals_; }
    [[nodiscard]] double value(std::size_t signal) const override {
        std::size_t const inner = signals_.size() - units_.size();
        return signal < inner ? inner_->value(signal)
                              : static_cast<double>(units_[signal - inner].regulator.position());
    }
    void will_read(std::span<std::size_t const> signals) override {
        std::vector<std::size_t> all;
        for (std::size_t const s : signals) {
            if (s < signals_.size() - units_.size()) {
                all.push_back(s);
            }
        }
        for (Unit const& unit : units_) {
            all.push_back(unit.voltage);
        }
        inner_->will_read(all);
    }

  private:
    struct Unit {
        std::string path;
        TapRegulator regulator;
        std::size_t voltage; ///< signal
        bool due{false};     ///< its step takes effect now
    };
    std::unique_ptr<Engine> inner_;
    TimeBase base_;
    std::vector<SignalDef> signals_;
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
