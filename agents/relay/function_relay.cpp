// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/function_config.hpp"
#include "agents/relay/relay_declaration.hpp"
#include "agents/relay/relay_member.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <span>

namespace gridspace::relay {
namespace {

/// The relay of a bay: its functions, their states as signals, events and members of the trip stream.
class FunctionRelay final : public RelayMember {
  public:
    using RelayMember::RelayMember;

  private:
    /// A member of the trip stream other than the trip, and its value.
    struct Output {
        FunctionOutput of;
        bool state{false};
    };

    Result<void> prepare_relay() override {
        std::vector<std::string> names;
        for (NamedFunction const& f : bay().functions().functions()) {
            names.push_back(f.name);
        }
        std::vector<program::Signal> const declared = function_signals(names);
        row_.resize(declared.size());
        auto states = bus::SignalPublisher::create(node_, "functions", declared, {});
        if (!states) {
            return std::unexpected{states.error()};
        }
        states_ = std::move(*states);
        if (auto ok = open_values(); !ok) {
            return ok;
        }
        for (auto const& [member, what] : settings_.relay.bay.outputs) {
            auto const of = find_output(bay().functions(), what.name);
            if (!of) {
                return fail(ExitCode::usage, fmt::format("'{}' is no output of a function", what.name),
                            "NAME.op or NAME.str");
            }
            outputs_.push_back({*of});
        }
        params_.required_synch = settings_.relay.logic.required_synch;
        params_.accept_questionable = settings_.relay.logic.accept_questionable;
        params_.test_mode = settings_.relay.logic.test_mode;
        if (parts_.signals->streams() == 1) {
            params_.required_synch = Synch::none; // nothing to compare it with
        }
        return {};
    }

    /// Of functions that are asked for them. The times of these rows are those of the samples.
    Result<void> open_values() {
        auto columns = bus::SignalPublisher::columns_of(node_, measured_signals(bay().functions()));
        values_row_.resize(columns.size());
        if (columns.empty()) {
            return {};
        }
        auto values = bus::SignalPublisher::create(node_, "values", parts_.rate_hz, std::move(columns));
        if (!values) {
            return std::unexpected{values.error()};
        }
        values_ = std::move(*values);
        return {};
    }

    [[nodiscard]] BayRelay& bay() { return *parts_.bay; }

    void announce(SimTime now) override {
        states_->announce(now);
        if (values_ != nullptr) {
            values_->announce(now);
        }
    }
    void report_relay(bus::Tick const&) override {
        if (values_ != nullptr) {
            values_->flush();
        }
    }

    void pair(LineSample const& sample) override {
        BaySample out{sample.index, {}, {}, {}};
        std::array<bool, 2> const is_usable{usable(sample.from, params_), usable(sample.to, params_)};
        auto const put = [&](std::optional<BaySource> const& source, bool voltages, std::optional<Abc>& value) {
            if (source && is_usable[source->end]) {
                EndSample const& end = source->end == 0 ? sample.from : sample.to;
                value = voltages ? end.v_v : end.i_a;
            }
        };
        put(parts_.sources.currents, false, out.i_a);
        put(parts_.sources.voltages, true, out.v_v);
        put(parts_.sources.bus_voltages, true, out.bus_v);
        bay().step(out);
        if (values_ != nullptr && bay().index() == sample.index && sample.index != published_) {
            published_ = sample.index;
            publish_values();
        }
        if (sample.from.present && sample.to.present) {
            parts_.signals->decided(sample.index, clock_.utc_ns(0), *time_);
        }
        act();
    }

    void silent(std::size_t end) override {
        unsigned lost = 0;
        for (auto const& [source, quantity] : {std::pair{&parts_.sources.currents, kCurrents},
                                               {&parts_.sources.voltages, kVoltages},
                                               {&parts_.sources.bus_voltages, kBusVoltages}}) {
            lost |= *source && (*source)->end == end ? unsigned{quantity} : 0U;
        }
        if (lost != 0) {
            bay().lost(static_cast<std::uint8_t>(lost));
            act();
        }
    }

    void act() {
        if (bay().changes() == seen_) {
            return;
        }
        seen_ = bay().changes();
        if (bay().trip() != tripped_) {
            tripped_ = bay().trip();
            send(tripped_ && settings_.relay.logic.in_service);
        }
        for (std::size_t i = 0; i < outputs_.size(); ++i) {
            FunctionState const& f = bay().functions().states()[outputs_[i].of.function];
            bool const state = outputs_[i].of.op ? f.op : f.str;
            if (state != outputs_[i].state) {
                outputs_[i].state = state;
                send(state && settings_.relay.logic.in_service, i + 1);
            }
        }
        publish_state();
        publish_events();
    }

    void publish_state() override {
        if (!time_->is_known()) {
            return;
        }
        parts_.signals->state(now(), bay().pickup(), bay().trip(), bay().blocked(), time_->instant_s(bay().index()));
        for (std::size_t i = 0; i < row_.size() / 2; ++i) {
            row_[2 * i] = bay().functions().states()[i].str ? 1 : 0;
            row_[2 * i + 1] = bay().functions().states()[i].op ? 1 : 0;
        }
        states_->row(now(), row_);
    }

    void publish_values() {
        if (!time_->is_known()) {
            return;
        }
        std::span<double> rest{values_row_};
        FunctionSet const& set = bay().functions();
        for (std::size_t i = 0; i < set.functions().size(); ++i) {
            NamedFunction const& f = set.functions()[i];
            std::span<double> const own = rest.first(f.publishes ? f.function->quantities().size() : 0);
            rest = rest.subspan(own.size());
            if (set.is_blocked(i)) {
                std::ranges::fill(own, std::nan(""));
            } else if (!own.empty()) {
                f.function->measure(bay().measured(), own);
            }
        }
        SimTime const instant = node_.time_base().from_nanoseconds(std::llround(time_->instant_s(bay().index()) * 1e9));
        values_->row(instant, values_row_);
    }

    void publish_events() {
        bay().events().drain([&](FunctionEvent const& event) { tell(name_of(event.kind), text_of(event)); });
    }

    std::string text_of(FunctionEvent const& event) {
        using Kind = FunctionEvent::Kind;
        std::string text = fmt::format("sample {}", event.index);
        if (event.kind <= Kind::unblock) {
            text = bay().functions().functions()[event.function].name + ", " + text;
        }
        text += event.phases != 0 ? ", phases " + phase_names(event.phases) : "";
        if (event.kind == Kind::start || event.kind == Kind::operate || event.kind == Kind::trip) {
            text += parts_.sources.currents
                        ? fmt::format(", {:.1f} {:.1f} {:.1f} A", event.i_a[0], event.i_a[1], event.i_a[2])
                        : "";
            text += parts_.sources.voltages
                        ? fmt::format(", {:.1f} {:.1f} {:.1f} V", event.v_v[0], event.v_v[1], event.v_v[2])
                        : "";
        }
        return text;
    }

    RelayParams params_;                                    ///< which samples are trusted
    std::unique_ptr<bus::SignalPublisher> states_, values_; ///< values: where a function is asked for them
    std::vector<double> row_, values_row_;
    std::vector<Output> outputs_;
    std::int64_t published_{-1}; ///< index of the sample whose values were last
    std::uint64_t seen_{0};
    bool tripped_{false};
};

} // namespace

std::unique_ptr<RelayMember> make_function_relay(RelaySettings const& settings, DaemonRun& run, bus::Node& node) {
    return std::make_unique<FunctionRelay>(settings, run, node);
}

} // namespace gridspace::relay
