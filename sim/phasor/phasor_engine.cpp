// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/phasor_engine.hpp"

#include "common/text.hpp"
#include "sim/network/earth_connection.hpp"
#include "sim/phasor/components.hpp"
#include "sim/phasor/faults.hpp"
#include "sim/phasor/fixed_step_solver.hpp"
#include "sim/phasor/machine_component.hpp"
#include "sim/phasor/network_dae.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

namespace gridspace::sim::phasor {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;
/// Time constant of the frequency of a bus.
constexpr double kFrequencyLagS = 0.02;
/// Reactive power of a generator without limits, kvar.
constexpr double kUnlimited = 1e30;
/// Double-point values of IEC 61850-7-3: intermediate 0, off 1, on 2, bad 3.
constexpr double kIntermediate = 0, kOpen = 1, kClosed = 2;

class PhasorEngine final : public Engine {
  public:
    PhasorEngine(Network network, PhasorOptions options)
        : network_{std::move(network)}, options_{options}, switches_{network_} {
        add_components();
        dae_ = std::make_unique<NetworkDae>(components_, network_.buses.size());
        y_.assign(dae_->size(), 0.0);
        at_q_limit_.assign(network_.buses.size(), 0);
        angles_.assign(network_.buses.size(), 0.0);
        slopes_hz_.assign(network_.buses.size(), 0.0);
        yp_.assign(dae_->size(), 0.0);
        define_signals();
    }

    Result<void> initialise() override {
        if (auto const bus = unearthed_bus(network_)) {
            return fail(ExitCode::usage,
                        fmt::format("nothing connects bus '{}' to earth: its voltage is undefined",
                                    network_.buses[*bus].name.name),
                        "earth a star point, or add a load, a shunt or line capacitance there");
        }
        PowerFlowOptions options;
        options.start_hour_of_day = options_.start_hour_of_day;
        options.enforce_q_limits = true;
        auto const flow = solve_power_flow(network_, switches_, options);
        if (!flow) {
            return std::unexpected{flow.error()};
        }
        for (std::size_t i = 0; i < network_.buses.size(); ++i) {
            dae_->set_voltage(i, flow->buses[i].v, y_);
            angles_[i] = std::arg(flow->buses[i].v);
        }
        for (std::size_t m = 0; m < machines_.size(); ++m) {
            machines_[m]->set_start_power(Complex{flow->machines[m].p_kw, flow->machines[m].q_kvar} /
                                          network_.power_kva);
        }
        for (std::size_t k = 0; k < components_.size(); ++k) {
            components_[k]->start(0, flow->buses[components_[k]->bus()].v, dae_->states_of(k, std::span{y_}));
        }
        for (Generator const& g : network_.generators) {
            std::size_t const bus = bus_of(g.bus);
            double const v = std::abs(flow->buses[bus].v);
            if (g.role == GeneratorRole::pv && std::abs(v - g.voltage_setpoint_pu) > 1e-9) {
                at_q_limit_[bus] = v < g.voltage_setpoint_pu ? 1 : -1; // as the power flow found it
            }
        }
        if (auto ok = set_topology(); !ok) {
            return ok;
        }
        for (MachineComponent const* m : machines_) {
            if (auto ok = m->check_field(dae_->states_of(component_index(m), std::span<double const>{y_})); !ok) {
                return ok;
            }
        }
        return restart();
    }

    Result<void> advance(SimTime until) override {
        double const target = options_.time_base.seconds(until), before = t_;
        if (input_changed_) {
            if (auto ok = restart(); !ok) {
                return ok;
            }
        }
        while (t_ < target) {
            double const next = pending_.empty() ? target : std::min(target, pending_.begin()->first);
            if (next <= t_) {
                if (auto ok = open_breakers(); !ok) {
                    return ok;
                }
                continue;
            }
            auto const stop = solver_->advance(next, y_, yp_);
            if (!stop) {
                return std::unexpected{stop.error()};
            }
            t_ = stop->events.empty() ? next : stop->t;
            if (!stop->events.empty()) {
                bool limits = false;
                for (int const found : stop->events) {
                    auto const k = static_cast<std::size_t>(found);
                    if (k < components_.size()) {
                        components_[k]->on_event(dae_->states_of(k, std::span{y_}));
                    } else {
                        limits = true;
                        reach_q_limit(k - components_.size());
                    }
                }
                if (auto ok = limits ? set_topology() : Result<void>{}; !ok) {
                    return ok;
                }
                if (auto ok = restart(); !ok) {
                    return ok;
                }
            }
        }
        follow_angles(target - before);
        return check_voltages();
    }

    Result<void> apply(Action const& action) override {
        return std::visit([this](auto const& a) { return act(a); }, action);
    }

    [[nodiscard]] std::vector<SignalDef> const& signals() const override { return signals_; }
    [[nodiscard]] double value(std::size_t signal) const override { return readers_[signal](); }

  private:
    Result<void> act(SetChargingCurrent const& a) {
        auto const it = evs_.find(a.ev);
        if (it == evs_.end()) {
            return fail(ExitCode::usage, fmt::format("there is no EV '{}'", a.ev));
        }
        it->second->set_reference(a.current_a);
        input_changed_ = true;
        return {};
    }
    Result<void> act(SwitchBreaker const& a) {
        std::size_t const i = index_of(network_.breakers, a.breaker);
        if (i == network_.breakers.size()) {
            return fail(ExitCode::usage, fmt::format("there is no breaker '{}'", a.breaker));
        }
        std::erase_if(pending_, [&](auto const& p) { return p.second == i; });
        double const mechanism_s = find(network_.breaker_types, network_.breakers[i].type.name)->mechanism_ms * 1e-3;
        if (!a.close && switches_.breaker_closed[i] && mechanism_s > 0) {
            pending_.emplace(t_ + mechanism_s, i);
            return {};
        }
        switches_.breaker_closed[i] = a.close;
        return set_topology();
    }
    /// Contacts that part now.
    Result<void> open_breakers() {
        while (!pending_.empty() && pending_.begin()->first <= t_) {
            switches_.breaker_closed[pending_.begin()->second] = false;
            pending_.erase(pending_.begin());
        }
        if (auto ok = set_topology(); !ok) {
            return ok;
        }
        return restart();
    }
    [[nodiscard]] bool opening(std::size_t breaker) const {
        return std::any_of(pending_.begin(), pending_.end(), [&](auto const& p) { return p.second == breaker; });
    }
    Result<void> act(SetParameter const& a) {
        std::vector<std::string> const path = split(a.path, '.');
        if (path.size() == 3 && path[0] == "loads" && path[2] == "p_kw") {
            if (auto const it = loads_.find(path[1]); it != loads_.end()) {
                it->second->set_power(a.value);
                input_changed_ = true;
                return {};
            }
        }
        if (path.size() == 3 && path[0] == "evs" && path[2] == "current_a" && a.value >= 0) {
            return act(SetChargingCurrent{path[1], a.value});
        }
        if (path.size() == 3 && path[0] == "batteries" && (path[2] == "p_kw" || path[2] == "q_kvar")) {
            if (auto const it = batteries_.find(path[1]); it != batteries_.end()) {
                Battery const& b = it->second->data();
                it->second->set_power(path[2] == "p_kw" ? a.value : b.p_kw, path[2] == "p_kw" ? b.q_kvar : a.value);
                input_changed_ = true;
                return {};
            }
        }
        for (std::size_t m = 0; m < machines_.size() && path.size() == 3 && path[0] == "machines"; ++m) {
            Machine& machine = network_.machines[m];
            if (path[1] != machine.name.name) {
                continue;
            }
            if (path[2] == "p_kw") {
                machines_[m]->setpoints().p_ref += (a.value - machine.p_kw) / machine.rating_kva;
                machine.p_kw = a.value;
            } else if (path[2] == "voltage_setpoint_pu") {
                machines_[m]->setpoints().v_ref += a.value - machine.voltage_setpoint_pu;
                machine.voltage_setpoint_pu = a.value;
            } else {
                break;
            }
            input_changed_ = true;
            return {};
        }
        return fail(ExitCode::usage, fmt::format("'{}' cannot be changed while a phasor simulation runs", a.path),
                    "loads.<name>.p_kw, machines.<name>.p_kw and .voltage_setpoint_pu, batteries.<name>.p_kw and "
                    ".q_kvar, evs.<name>.current_a can");
    }
    Result<void> act(Disconnect const& a) {
        if (auto const it = switchable_.find(a.element); it != switchable_.end()) {
            it->second();
            out_.insert(a.element);
            return set_topology();
        }
        if (std::size_t const i = index_of(network_.lines, a.element); i < network_.lines.size()) {
            switches_.line_out[i] = true;
        } else if (std::size_t const j = index_of(network_.transformers, a.element); j < network_.transformers.size()) {
            switches_.transformer_out[j] = true;
        } else {
            return fail(ExitCode::usage,
                        fmt::format("'{}' cannot be disconnected: there is no such load, PV, EV, battery, "
                                    "generator with given power, line or transformer",
                                    a.element));
        }
        return set_topology();
    }
    Result<void> act(ApplyFault const& a) {
        auto ok = faults_.apply(network_, a);
        return ok ? set_topology() : ok;
    }
    Result<void> act(ClearFault const& a) {
        auto ok = faults_.clear(a.name);
        return ok ? set_topology() : ok;
    }

    Scale scale_of(Ref const& name) const {
        Profile const* profile = find(network_.profiles, name.name);
        if (profile == nullptr) {
            return [](double) { return 1.0; };
        }
        return [profile, start = options_.start_hour_of_day](double t) {
            return profile_value(*profile, t / 3600, start);
        };
    }

    std::size_t component_index(Component const* component) const {
        for (std::size_t k = 0; k < components_.size(); ++k) {
            if (components_[k].get() == component) {
                return k;
            }
        }
        return components_.size();
    }

    std::size_t bus_of(Ref const& bus) const { return index_of(network_.buses, bus.name); }

    template <class C>
    C* add(std::unique_ptr<C> component) {
        C* raw = component.get();
        components_.push_back(std::move(component));
        return raw;
    }

    void add_components() {
        double const base = network_.power_kva;
        for (Load const& load : network_.loads) {
            auto* c = add(std::make_unique<LoadComponent>(load, bus_of(load.bus), base, scale_of(load.scale)));
            loads_[load.name.name] = c;
            switchable_[load.name.name] = [c] { c->set_connected(false); };
        }
        for (Pv const& pv : network_.pv) {
            auto* c = add(std::make_unique<PvComponent>(pv, bus_of(pv.bus), base, scale_of(pv.scale)));
            switchable_[pv.name.name] = [c] { c->set_connected(false); };
        }
        for (Ev const& ev : network_.evs) {
            auto* c = add(std::make_unique<EvComponent>(ev, bus_of(ev.bus), base));
            evs_[ev.name.name] = c;
            switchable_[ev.name.name] = [c] { c->set_connected(false); };
        }
        for (Battery const& b : network_.batteries) {
            auto* c = add(std::make_unique<BatteryComponent>(b, bus_of(b.bus), base, scale_of(b.scale)));
            batteries_[b.name.name] = c;
            switchable_[b.name.name] = [c] { c->set_connected(false); };
        }
        for (Source const& source : network_.sources) {
            if (source.r_ohm != 0 || source.l_mh != 0) {
                add(std::make_unique<SourceComponent>(network_, source, bus_of(source.bus)));
            }
        }
        for (Machine const& machine : network_.machines) {
            auto* c = add(std::make_unique<MachineComponent>(network_, machine, bus_of(machine.bus)));
            machines_.push_back(c);
            switchable_[machine.name.name] = [c] { c->set_connected(false); };
        }
        for (Generator const& g : network_.generators) {
            if (g.role == GeneratorRole::pq) {
                auto* c = add(std::make_unique<FixedPowerComponent>(g.name.name, Complex{g.p_kw, g.q_kvar} / base,
                                                                    g.rating_kva / base, bus_of(g.bus), base));
                switchable_[g.name.name] = [c] { c->set_connected(false); };
            }
        }
    }

    /// Admittances and bus rules for the switches as they are now; the solver starts anew.
    Result<void> set_topology() {
        std::vector<TwoPort> branches = two_ports(network_, switches_);
        std::vector<Complex> shunts(network_.buses.size());
        for (Shunt const& s : network_.shunts) {
            shunts[bus_of(s.bus)] += Complex{s.p_kw, s.q_kvar} / network_.power_kva;
        }
        if (auto ok = faults_.enter(network_, switches_, out_, branches, shunts); !ok) {
            return ok;
        }
        std::vector<BusRule> rules(network_.buses.size());
        std::vector<bool> fed(network_.buses.size(), false);
        for (Source const& s : network_.sources) {
            fed[bus_of(s.bus)] = true;
            if (s.r_ohm == 0 && s.l_mh == 0) {
                rules[bus_of(s.bus)] = {BusRule::Kind::held, std::polar(s.voltage_pu, s.angle_deg / kDegrees), 1, 0};
            }
        }
        for (Machine const& m : network_.machines) {
            fed[bus_of(m.bus)] = fed[bus_of(m.bus)] || !out_.contains(m.name.name);
        }
        for (Generator const& g : network_.generators) {
            BusRule& rule = rules[bus_of(g.bus)];
            if (g.role == GeneratorRole::slack) {
                rule = {BusRule::Kind::held, std::polar(g.voltage_setpoint_pu, g.angle_deg / kDegrees), 1, 0};
                fed[bus_of(g.bus)] = true;
            } else if (g.role == GeneratorRole::pv && rule.kind != BusRule::Kind::held) {
                double const base = network_.power_kva;
                bool const first = rule.kind != BusRule::Kind::regulated;
                rule = {BusRule::Kind::regulated,
                        {},
                        first ? g.voltage_setpoint_pu : rule.v_set,
                        (first ? 0 : rule.p) + g.p_kw / base,
                        (first ? 0 : rule.q_min) + g.q_min_kvar.value_or(-kUnlimited) / base,
                        (first ? 0 : rule.q_max) + g.q_max_kvar.value_or(kUnlimited) / base,
                        0};
            }
        }
        for (std::size_t i = 0; i < rules.size(); ++i) {
            if (rules[i].kind == BusRule::Kind::regulated && at_q_limit_[i] != 0) {
                rules[i].kind = BusRule::Kind::limited;
                rules[i].at_limit = at_q_limit_[i];
            }
        }
        mark_dead(branches, fed, rules);
        dae_->set_network(branches, shunts, rules);
        branches_ = std::move(branches);
        if (options_.fixed_step_s > 0) {
            solver_ = std::make_unique<FixedStepSolver>(*dae_, options_.fixed_step_s);
        } else {
            solver_ = std::make_unique<DaeSolver>(*dae_,
                                                  DaeOptions{options_.relative_tolerance, options_.absolute_tolerance});
        }
        for (std::size_t i = 0; i < rules.size(); ++i) {
            // A bus that comes back to life starts near nominal voltage.
            if (rules[i].kind != BusRule::Kind::dead && std::abs(dae_->voltage(i, y_)) < 0.01) {
                dae_->set_voltage(i, 1, y_);
            }
        }
        input_changed_ = true;
        return {};
    }

    void mark_dead(std::vector<TwoPort> const& branches, std::vector<bool> fed, std::vector<BusRule>& rules) const {
        for (bool changed = true; changed;) {
            changed = false;
            for (TwoPort const& b : branches) {
                if ((b.ft != Complex{} || b.tf != Complex{}) && fed[b.from] != fed[b.to]) {
                    fed[b.from] = fed[b.to] = changed = true;
                }
            }
        }
        for (std::size_t i = 0; i < rules.size(); ++i) {
            if (!fed[i]) {
                rules[i] = {BusRule::Kind::dead, {}, 1, 0};
            }
        }
    }

    /// Frequencies of the buses: slopes of their angles behind a lag.
    void follow_angles(double h) {
        for (std::size_t i = 0; i < angles_.size() && h > 0; ++i) {
            Complex const v = dae_->voltage(i, y_);
            double const ahead = v == Complex{} ? 0 : std::remainder(std::arg(v) - angles_[i], 2 * std::numbers::pi);
            double const share = h / (kFrequencyLagS + h);
            angles_[i] += ahead * share;
            slopes_hz_[i] = ahead * (1 - share) / (2 * std::numbers::pi * kFrequencyLagS);
        }
    }

    /// A generator that holds a voltage meets its reactive limit, or the voltage is back.
    void reach_q_limit(std::size_t bus) {
        int& at = at_q_limit_[bus];
        BusRule const& rule = dae_->rule(bus);
        double const q = rule.kind == BusRule::Kind::regulated ? dae_->regulating_q(bus, t_, y_) : 0;
        at = at != 0 ? 0 : rule.q_max - q < q - rule.q_min ? 1 : -1;
    }

    /// Generators that a jump of the voltages has taken across a reactive limit. False when there are none.
    bool cross_q_limits() {
        constexpr double kTouching = -1e-9;
        std::vector<double> values(dae_->events());
        dae_->event_values(t_, y_, values);
        bool any = false;
        for (std::size_t i = 0; i < network_.buses.size(); ++i) {
            if (values[components_.size() + i] < kTouching) {
                reach_q_limit(i);
                any = true;
            }
        }
        return any;
    }

    Result<void> restart() {
        // Each round moves some generator to or from its limit; more than a few are a network that has no state.
        for (std::size_t round = 0;; ++round) {
            input_changed_ = false;
            if (auto ok = solver_->restart(t_, y_, yp_); !ok) {
                return ok;
            }
            if (round > 2 * network_.generators.size() || !cross_q_limits()) {
                return {};
            }
            if (auto ok = set_topology(); !ok) {
                return ok;
            }
        }
    }

    Result<void> check_voltages() const {
        for (std::size_t i = 0; i < network_.buses.size(); ++i) {
            double const v = std::abs(dae_->voltage(i, y_));
            if (!(v < 10)) {
                return fail(ExitCode::usage,
                            fmt::format("the voltage of bus '{}' is {} at {} s", network_.buses[i].name.name,
                                        std::isfinite(v) ? shortest(v) + " p.u." : "no number any more", shortest(t_)),
                            "the network has no sensible state there; look at what happened just before");
            }
        }
        return {};
    }

    void signal(std::string name, std::string unit, std::function<double()> read) {
        signals_.push_back({std::move(name), std::move(unit)});
        readers_.push_back(std::move(read));
    }

    void define_signals() {
        double const base = network_.power_kva;
        for (std::size_t i = 0; i < network_.buses.size(); ++i) {
            std::string const bus = "bus." + network_.buses[i].name.name;
            signal(bus + ".v_pu", "p.u.", [this, i] { return std::abs(dae_->voltage(i, y_)); });
            signal(bus + ".angle_deg", "deg", [this, i] { return std::arg(dae_->voltage(i, y_)) * kDegrees; });
            signal(bus + ".frequency_hz", "Hz", [this, i] { return network_.frequency_hz + slopes_hz_[i]; });
            auto const net = [this, i] { return -dae_->voltage(i, y_) * std::conj(dae_->network_current(i, y_)); };
            signal(bus + ".p_kw", "kW", [net, base] { return net().real() * base; });
            signal(bus + ".q_kvar", "kvar", [net, base] { return net().imag() * base; });
        }
        auto const branch_signals = [&](TwoPort::Kind kind, std::string const& prefix, std::size_t element,
                                        double amperes_from, double amperes_to) {
            for (bool const from : {true, false}) {
                auto const current = [this, kind, element, from]() -> std::pair<Complex, Complex> {
                    for (TwoPort const& b : branches_) {
                        if (b.kind == kind && b.element == element) {
                            Complex const vf = dae_->voltage(b.from, y_), vt = dae_->voltage(b.to, y_);
                            return from ? std::pair{vf, b.ff * vf + b.ft * vt} : std::pair{vt, b.tf * vf + b.tt * vt};
                        }
                    }
                    return {};
                };
                std::string const end = prefix + (from ? ".from" : ".to");
                double const amperes = from ? amperes_from : amperes_to;
                signal(end + ".p_kw", "kW", [current, base] {
                    auto const [v, i] = current();
                    return (v * std::conj(i)).real() * base;
                });
                signal(end + ".q_kvar", "kvar", [current, base] {
                    auto const [v, i] = current();
                    return (v * std::conj(i)).imag() * base;
                });
                signal(end + ".i_a", "A", [current, amperes] { return std::abs(current().second) * amperes; });
            }
        };
        auto const amperes = [&](Ref const& bus) {
            return base * 1e3 / (std::sqrt(3.0) * network_.buses[bus_of(bus)].voltage_v);
        };
        for (std::size_t i = 0; i < network_.lines.size(); ++i) {
            Line const& line = network_.lines[i];
            branch_signals(TwoPort::Kind::line, "line." + line.name.name, i, amperes(line.from), amperes(line.to));
        }
        for (std::size_t i = 0; i < network_.transformers.size(); ++i) {
            Transformer const& t = network_.transformers[i];
            branch_signals(TwoPort::Kind::transformer, "transformer." + t.name.name, i, amperes(t.from), amperes(t.to));
        }
        for (std::size_t i = 0; i < network_.breakers.size(); ++i) {
            signal("breaker." + network_.breakers[i].name.name + ".position", "dpc", [this, i] {
                return opening(i) ? kIntermediate : switches_.breaker_closed[i] ? kClosed : kOpen;
            });
        }
        for (std::size_t k = 0; k < components_.size(); ++k) {
            std::vector<SignalDef> const own = components_[k]->signals();
            for (std::size_t s = 0; s < own.size(); ++s) {
                signal(own[s].name, own[s].unit, [this, k, s] {
                    return components_[k]->value(s, t_, dae_->states_of(k, std::span<double const>{y_}),
                                                 dae_->voltage(components_[k]->bus(), y_));
                });
            }
        }
        if (!machines_.empty()) {
            signal("system.coi_hz", "Hz", [this] {
                double weighted = 0, weight = 0;
                for (MachineComponent const* m : machines_) {
                    auto const x = dae_->states_of(component_index(m), std::span<double const>{y_});
                    double const inertia = m->data().h * m->data().rating_kva;
                    weighted += inertia * m->value(0, t_, x, dae_->voltage(m->bus(), y_));
                    weight += inertia;
                }
                return weighted / weight;
            });
        }
        for (Generator const& g : network_.generators) {
            if (g.role != GeneratorRole::pq) {
                // What the bus needs beyond its other components; shared equally where several hold one bus.
                std::size_t const bus = bus_of(g.bus);
                auto const holders = static_cast<double>(
                    std::count_if(network_.generators.begin(), network_.generators.end(), [&](Generator const& other) {
                        return other.role != GeneratorRole::pq && other.bus == g.bus;
                    }));
                auto const power = [this, bus, holders] {
                    Complex const v = dae_->voltage(bus, y_);
                    return v * std::conj(dae_->network_current(bus, y_) - dae_->component_current(bus, t_, y_)) /
                           holders;
                };
                signal("generator." + g.name.name + ".p_kw", "kW", [power, base] { return power().real() * base; });
                signal("generator." + g.name.name + ".q_kvar", "kvar", [power, base] { return power().imag() * base; });
            }
        }
    }

    Network network_;
    PhasorOptions options_;
    SwitchState switches_;
    std::vector<std::unique_ptr<Component>> components_;
    std::vector<MachineComponent*> machines_;
    Faults faults_;
    std::map<std::string, BatteryComponent*> batteries_;
    std::map<std::string, EvComponent*> evs_;
    std::map<std::string, LoadComponent*> loads_;
    std::map<std::string, std::function<void()>> switchable_;
    std::unique_ptr<NetworkDae> dae_;
    std::unique_ptr<DaeIntegrator> solver_;
    std::multimap<double, std::size_t> pending_; ///< breakers that will part, by time
    std::set<std::string> out_;                  ///< disconnected elements
    std::vector<double> angles_, slopes_hz_;     ///< by bus: what follows its angle, rad; and how fast that goes
    std::vector<int> at_q_limit_; ///< by bus: its generators are at their lower (-1) or upper (1) reactive limit
    std::vector<TwoPort> branches_;
    std::vector<double> y_, yp_;
    double t_{0};
    bool input_changed_{false};
    std::vector<SignalDef> signals_;
    std::vector<std::function<double()>> readers_;
};

} // namespace

Result<std::unique_ptr<Engine>> make_phasor_engine(Network network, PhasorOptions options) {
    return std::make_unique<PhasorEngine>(std::move(network), options);
}

std::vector<std::string> unseen_by_phasors(Network const& n) {
    std::vector<std::string> out;
    auto const note = [&](auto const& elements, auto const& has, std::string_view words) {
        auto const it = std::find_if(elements.begin(), elements.end(), has);
        if (it != elements.end()) {
            out.push_back(fmt::format("phasors do not know {} '{}'", words, it->name.name));
        }
    };
    note(n.sources, [](Source const& s) { return !s.harmonics.empty(); }, "the harmonics of source");
    note(
        n.transformers, [](Transformer const& t) { return t.saturation.has_value(); }, "the saturation of transformer");
    note(n.lines, [](Line const& l) { return l.model == LineModel::bergeron; }, "the travelling waves of line");
    note(
        n.line_types, [](LineType const& t) { return !t.phase_r_ohm_per_km.empty(); },
        "unequal phases: they transpose the lines of type");
    note(
        n.loads, [](Load const& l) { return !l.phase_p_kw.empty(); },
        "loads by phase: they take a third of the sum for each of load");
    return out;
}

std::vector<SignalDef> phasor_signals(Network const& network) {
    return PhasorEngine{network, {}}.signals();
}

} // namespace gridspace::sim::phasor
