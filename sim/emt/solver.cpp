// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

/// Nothing is cut shorter than this share of the usual step.
constexpr double kLeastSegment = 1e-5;
/// A pole without current opens at once; rounding noise is no current.
constexpr double kNoCurrentA = 1e-7;
/// Switch states whose factors are kept.
constexpr std::size_t kCacheSize = 64;

} // namespace

Solver::Solver(Circuit circuit, double step_s) : circuit_{std::move(circuit)}, step_s_{step_s} {
    for (MachinePort const& m : circuit_.machines) {
        state_.machines.emplace_back(m, circuit_.frequency_hz);
        limit_v_ = std::max(limit_v_, m.v_base);
    }
    for (VoltageSource const& s : circuit_.sources) {
        source_phase_.push_back(s.angle_rad);
        source_since_.push_back(0);
        limit_v_ = std::max(limit_v_, s.amplitude_v);
    }
    limit_v_ = 1e6 * std::max(limit_v_, 1.0);
    for (Switch const& s : circuit_.switches) {
        bits_.closed.push_back(s.closed);
    }
    rebuild();
}

void Solver::rebuild() {
    resize();
    fill_coefficients(circuit_, step_s_, usual_);
    cache_.clear();
    odd_.reset();
    system_ = nullptr;
    restart_ = modified_ = true;
}

void Solver::resize() {
    Circuit const& c = circuit_;
    auto const grow = [](std::vector<double>& v, std::size_t n) { v.resize(n, 0.0); };
    grow(state_.rl_v, 3 * c.rl.size());
    grow(state_.rl_i, 3 * c.rl.size());
    grow(rl_history_, 3 * c.rl.size());
    grow(state_.capacitor_v, 3 * c.capacitors.size());
    grow(state_.capacitor_i, 3 * c.capacitors.size());
    grow(capacitor_history_, 3 * c.capacitors.size());
    grow(state_.winding_v, c.windings.size());
    grow(state_.winding_i, c.windings.size());
    grow(winding_history_, c.windings.size());
    grow(state_.core_flux, c.cores.size());
    grow(state_.core_v, c.cores.size());
    grow(state_.core_i, c.cores.size());
    grow(core_history_, c.cores.size());
    for (std::size_t i = waves_.size(); i < c.bergeron.size(); ++i) {
        waves_.emplace_back(c.bergeron[i], step_s_);
    }
    grow(state_.wave_i, 6 * c.bergeron.size());
    grow(wave_history_, 6 * c.bergeron.size());
    state_.wave_marks.resize(c.bergeron.size(), 0);
    grow(injected_, 3 * c.injections.size());
    switches_.resize(c.switches.size());
    for (std::size_t i = bits_.closed.size(); i < c.switches.size(); ++i) {
        bits_.closed.push_back(c.switches[i].closed);
    }
    bits_.faulted.resize(c.faults.size(), {false, false, false});
    fault_armed_.resize(c.faults.size(), {false, false, false});
    bits_.segment.resize(c.cores.size(), 0);
    auto const nodes = static_cast<std::size_t>(c.nodes()) + 3 * c.sources.size();
    rhs_.assign(nodes, 0.0);
    correction_.assign(nodes, 0.0);
    watched_before_.assign(3 * (c.switches.size() + c.faults.size()), 0.0);
    watched_after_ = watched_before_;
}

Result<void> Solver::use(double h) {
    // The last system nearly always fits; everything else is an event.
    if (system_ != nullptr && !modified_ && system_->h == h) {
        return {};
    }
    std::vector<double> nodes;
    if (system_ != nullptr) {
        for (int const slot : system_->topology.slot) {
            nodes.push_back(state_.v[static_cast<std::size_t>(slot)]);
        }
    }
    bool const usual = h == step_s_;
    if (!usual && other_.h != h) {
        fill_coefficients(circuit_, h, other_);
    }
    coefficients_ = usual ? &usual_ : &other_;
    NodalSystem* found = nullptr;
    for (auto const& s : cache_) {
        if (usual && s->bits == bits_) {
            found = s.get();
        }
    }
    if (found == nullptr) {
        auto made = make_system(circuit_, bits_, *coefficients_, state_.machines);
        if (!made) {
            return std::unexpected{made.error()};
        }
        found = made->get();
        if (usual) {
            if (cache_.size() >= kCacheSize) {
                cache_.erase(std::min_element(cache_.begin(), cache_.end(), [](auto const& a, auto const& b) {
                    return a->last_used < b->last_used;
                }));
            }
            cache_.push_back(std::move(*made));
        } else {
            odd_ = std::move(*made);
        }
    }
    found->last_used = ++uses_;
    system_ = found;
    modified_ = false;
    for (EmtMachine& m : state_.machines) {
        m.use_step(h);
    }
    state_.v.assign(static_cast<std::size_t>(system_->topology.slots), 0.0);
    for (std::size_t i = nodes.size(); i-- > 0;) {
        state_.v[static_cast<std::size_t>(system_->topology.slot[i])] = nodes[i];
    }
    return {};
}

Result<void> Solver::advance(double t_end, double h) {
    double const least = kLeastSegment * step_s_;
    for (double left = h; left > 0;) {
        part_contacts();
        double piece = left;
        for (SwitchControl const& s : switches_) {
            if (waiting_ && s.part_at - t_ > least && s.part_at - t_ < piece - least) {
                piece = s.part_at - t_;
            }
        }
        bool const last = piece == left;
        double const t_piece = last ? t_end : t_ + piece;
        if (!watching()) {
            if (auto ok = segment(t_piece, piece); !ok) {
                return ok;
            }
            left = last ? 0 : left - piece;
            continue;
        }
        double const t_start = t_;
        bool const restart = restart_;
        if (auto ok = use(piece); !ok) { // first, so that saved voltages belong to the slots of the new switch state
            return ok;
        }
        for (std::size_t w = 0; w < waves_.size(); ++w) {
            state_.wave_marks[w] = waves_[w].mark();
        }
        saved_ = state_;
        remember_currents(watched_before_);
        if (auto ok = segment(t_piece, piece); !ok) {
            return ok;
        }
        remember_currents(watched_after_);
        Crossing const crossing = first_crossing();
        if (!crossing.found || crossing.share * piece >= piece - least) {
            left = last ? 0 : left - piece;
            if (crossing.found) {
                open_crossed(crossing.share);
            }
            continue;
        }
        // Back to the start, and only as far as the current zero.
        auto const back = [&] {
            state_ = saved_;
            for (std::size_t w = 0; w < waves_.size(); ++w) {
                waves_[w].back_to(saved_.wave_marks[w]);
            }
            t_ = t_start;
            restart_ = restart;
        };
        back();
        double const part = crossing.share * piece;
        if (part > least) {
            if (auto ok = segment(t_start + part, part); !ok) {
                return ok;
            }
            left -= part;
        }
        open_crossed(crossing.share);
    }
    return {};
}

Result<void> Solver::segment(double t_end, double h) {
    if (auto ok = use(h); !ok) {
        return ok;
    }
    if (restart_) {
        for (EmtMachine& m : state_.machines) {
            m.forget_history();
        }
        substep(t_ + h / 2, h / 2, Rule::backward_euler, *coefficients_);
        substep(t_end, h / 2, Rule::backward_euler, *coefficients_);
        restart_ = false;
    } else {
        substep(t_end, h, Rule::trapezoid, *coefficients_);
    }
    t_ = t_end;
    return check();
}

Result<void> Solver::check() const {
    double sum = 0;
    for (double const v : state_.v) {
        sum += v;
    }
    if (std::abs(sum) < limit_v_) [[likely]] { // false for NaN
        return {};
    }
    std::size_t worst = 0;
    for (std::size_t i = 0; i < state_.v.size(); ++i) {
        if (!(std::abs(state_.v[i]) <= std::abs(state_.v[worst]))) {
            worst = i;
        }
    }
    auto const& slots = system_->topology.slot;
    auto const node = std::find(slots.begin(), slots.end(), static_cast<int>(worst)) - slots.begin();
    return fail(ExitCode::usage,
                fmt::format("the waveforms diverge at {} s: the voltage of {} is {} V", shortest(t_),
                            circuit_.node_name(static_cast<int>(node)), shortest(state_.v[worst])),
                "look at the element there; a shorter step_s may help");
}

bool Solver::watching() const {
    return armed_ || !circuit_.cores.empty();
}

void Solver::remember_currents(std::vector<double>& out) const {
    double* o = out.data();
    for (std::size_t s = 0; s < switches_.size(); ++s) {
        for (int k = 0; k < 3; ++k) {
            *o++ = switches_[s].armed[static_cast<std::size_t>(k)] ? switch_current(s, k) : 0;
        }
    }
    for (std::size_t f = 0; f < fault_armed_.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            *o++ = fault_armed_[f][static_cast<std::size_t>(k)] ? fault_current(f, k) : 0;
        }
    }
}

namespace {

/// Where a current that was `before` and is `after` has its zero, as a share of the segment; 2 when it has none.
double zero_share(double before, double after) {
    if (std::abs(before) <= kNoCurrentA) {
        return 0;
    }
    return before * after <= 0 ? before / (before - after) : 2;
}

/// Where the flux of a core leaves its segment; 2 when it does not.
double knee_share(double before, double after, double knee, int segment) {
    double const level = segment == 0 ? (after > 0 ? knee : -knee) : segment * knee;
    bool const leaves = segment == 0 ? std::abs(after) > knee : segment * after < knee;
    return leaves ? std::clamp((level - before) / (after - before), 0.0, 1.0) : 2;
}

} // namespace

Solver::Crossing Solver::first_crossing() const {
    Crossing first;
    auto const consider = [&](double share) {
        if (share <= 1 && share < first.share) {
            first = {share, true};
        }
    };
    std::size_t o = 0;
    for (SwitchControl const& s : switches_) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (s.armed[k]) {
                consider(zero_share(watched_before_[o], watched_after_[o]));
            }
        }
    }
    for (auto const& armed : fault_armed_) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (armed[k]) {
                consider(zero_share(watched_before_[o], watched_after_[o]));
            }
        }
    }
    for (std::size_t c = 0; c < circuit_.cores.size(); ++c) {
        consider(knee_share(saved_.core_flux[c], state_.core_flux[c], circuit_.cores[c].knee, bits_.segment[c]));
    }
    return first;
}

void Solver::open_crossed(double share) {
    constexpr double kTogether = 1e-9; // currents that are each other's negative cross at one instant
    std::size_t o = 0;
    armed_ = false;
    for (std::size_t s = 0; s < switches_.size(); ++s) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (switches_[s].armed[k] && zero_share(watched_before_[o], watched_after_[o]) <= share + kTogether) {
                switches_[s].armed[k] = false;
                bits_.closed[s][k] = false;
                auto const& closed = bits_.closed[s];
                if (!closed[0] && !closed[1] && !closed[2]) {
                    switches_[s].opened_at = t_;
                }
            }
            armed_ = armed_ || switches_[s].armed[k];
        }
    }
    for (std::size_t f = 0; f < fault_armed_.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (fault_armed_[f][k] && zero_share(watched_before_[o], watched_after_[o]) <= share + kTogether) {
                fault_armed_[f][k] = false;
                bits_.faulted[f][k] = false;
            }
            armed_ = armed_ || fault_armed_[f][k];
        }
    }
    for (std::size_t c = 0; c < circuit_.cores.size(); ++c) {
        auto& segment = bits_.segment[c];
        double const flux = state_.core_flux[c], knee = circuit_.cores[c].knee;
        constexpr double kAtKnee = 1e-6;
        if (segment == 0 && std::abs(flux) >= knee * (1 - kAtKnee)) {
            segment = flux > 0 ? 1 : -1;
        } else if (segment != 0 && segment * flux <= knee * (1 + kAtKnee)) {
            // It enters the other slope only when it moves there: the crossing said so.
            bool const leaves = segment * saved_.core_flux[c] > segment * flux;
            segment = leaves ? static_cast<signed char>(0) : segment;
        }
    }
    switched();
}

void Solver::switched() {
    restart_ = modified_ = true;
}

void Solver::part_contacts() {
    if (!waiting_) {
        return;
    }
    waiting_ = false;
    for (std::size_t i = 0; i < switches_.size(); ++i) {
        SwitchControl& s = switches_[i];
        if (s.part_at <= t_ + kLeastSegment * step_s_) {
            s.part_at = std::numeric_limits<double>::infinity();
            if (s.at_once) {
                bits_.closed[i] = {false, false, false};
                s.opened_at = t_;
                switched();
            } else {
                s.armed = bits_.closed[i];
                armed_ = true;
            }
        }
        waiting_ = waiting_ || s.part_at < std::numeric_limits<double>::infinity();
    }
}

void Solver::open_switch(std::size_t index, double after_s, bool at_once) {
    auto const& closed = bits_.closed[index];
    if (!closed[0] && !closed[1] && !closed[2]) {
        return;
    }
    SwitchControl& s = switches_[index];
    if (s.part_at < std::numeric_limits<double>::infinity() || s.armed != std::array{false, false, false}) {
        return; // on its way
    }
    s.part_at = t_ + after_s;
    s.at_once = at_once;
    waiting_ = true;
}

void Solver::close_switch(std::size_t index) {
    SwitchControl& s = switches_[index];
    s.part_at = std::numeric_limits<double>::infinity();
    s.armed = {};
    if (bits_.closed[index] != std::array{true, true, true}) {
        bits_.closed[index] = {true, true, true};
        switched();
    }
}

bool Solver::opening(std::size_t index) const {
    SwitchControl const& s = switches_[index];
    return s.part_at < std::numeric_limits<double>::infinity() || s.armed != std::array{false, false, false};
}

void Solver::apply_fault(std::size_t fault) {
    bits_.faulted[fault] = circuit_.faults[fault].phases;
    fault_armed_[fault] = {};
    switched();
}

void Solver::clear_fault(std::size_t fault) {
    fault_armed_[fault] = bits_.faulted[fault];
    armed_ = true;
}

int Solver::split_rl(int branch, double share, std::string const& name) {
    auto const old = static_cast<std::size_t>(branch);
    int const middle = circuit_.add_triple(name);
    RlBranch second = circuit_.rl[old];
    auto const scale = [](PhaseMatrix& m, double k) {
        m.one *= k;
        m.mutual *= k;
    };
    scale(second.r, 1 - share);
    scale(second.l, 1 - share);
    second.from = middle;
    RlBranch& first = circuit_.rl[old];
    scale(first.r, share);
    scale(first.l, share);
    first.to = middle;
    circuit_.rl.push_back(second);
    for (std::size_t k = 0; k < 3; ++k) {
        double const v = state_.rl_v[3 * old + k];
        state_.rl_v.push_back(v * (1 - share));
        state_.rl_v[3 * old + k] = v * share;
        state_.rl_i.push_back(state_.rl_i[3 * old + k]);
    }
    return static_cast<int>(circuit_.rl.size()) - 1;
}

void Solver::set_source_frequency(std::size_t source, double frequency_hz) {
    VoltageSource& s = circuit_.sources[source];
    source_phase_[source] += 2 * std::numbers::pi * s.frequency_hz * (t_ - source_since_[source]);
    source_phase_[source] = std::fmod(source_phase_[source], 2 * std::numbers::pi);
    source_since_[source] = t_;
    s.frequency_hz = frequency_hz;
}

void Solver::set_source_amplitude(std::size_t source, double amplitude_v) {
    circuit_.sources[source].amplitude_v = amplitude_v;
    restart_ = true;
}

double Solver::current(CurrentTerm const& term, int phase) const {
    using Kind = CurrentTerm::Kind;
    auto const i = static_cast<std::size_t>(term.index);
    auto const k = static_cast<std::size_t>(phase);
    switch (term.kind) {
    case Kind::rl:
        return term.sign * state_.rl_i[3 * i + k];
    case Kind::capacitor:
        return term.sign * state_.capacitor_i[3 * i + k];
    case Kind::winding: // sign is the weight; the index of the limb of phase a
        return term.sign * state_.winding_i[i + (k + static_cast<std::size_t>(term.turn)) % 3];
    case Kind::core:
        return term.sign * state_.core_i[i + (k + static_cast<std::size_t>(term.turn)) % 3];
    case Kind::bergeron_from:
        return term.sign * state_.wave_i[6 * i + k];
    case Kind::bergeron_to:
        return term.sign * state_.wave_i[6 * i + 3 + k];
    case Kind::fault:
        return term.sign * fault_current(i, phase);
    case Kind::machine:
        return term.sign * state_.machines[i].current_a(phase);
    case Kind::injection:
        return term.sign * injected_[3 * i + k];
    }
    return 0;
}

double Solver::switch_current(std::size_t index, int phase) const {
    double sum = 0;
    for (CurrentTerm const& term : circuit_.switches[index].terms) {
        sum += current(term, phase);
    }
    return sum;
}

double Solver::fault_current(std::size_t index, int phase) const {
    FaultBranch const& f = circuit_.faults[index];
    Conductances const g = fault_conductances(f, bits_.faulted[index]);
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        sum += g[static_cast<std::size_t>(phase)][static_cast<std::size_t>(k)] * node_voltage(f.node + k);
    }
    return sum;
}

std::vector<std::string> Solver::floating_nodes() const {
    std::vector<std::string> out;
    auto const& slots = system_->topology.slot;
    for (int const unknown : system_->anchored) {
        auto const node = std::find(slots.begin(), slots.end(), unknown) - slots.begin();
        out.push_back(circuit_.node_name(static_cast<int>(node)));
    }
    return out;
}

} // namespace gridspace::sim::emt
