// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace gridspace::sim::emt {
namespace {

/// Switch states whose factors are kept.
constexpr std::size_t kCacheSize = 64;

} // namespace

Solver::Solver(Circuit circuit, double step_s, std::shared_ptr<Team> team)
    : circuit_{std::move(circuit)}, step_s_{step_s}, team_{std::move(team)} {
    limit_v_ = circuit_.peak_v;
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
    switched();
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
    grow(state_.coupled_v, 3 * c.coupled.size());
    grow(state_.coupled_i, 3 * c.coupled.size());
    grow(coupled_history_, 3 * c.coupled.size());
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
    for (std::size_t i = marti_.size(); i < c.marti.size(); ++i) {
        marti_.emplace_back(c.marti[i], step_s_);
    }
    grow(state_.marti_i, 6 * c.marti.size());
    grow(marti_history_, 6 * c.marti.size());
    grow(injected_, 3 * c.injections.size());
    all_injections_.resize(c.injections.size());
    std::iota(all_injections_.begin(), all_injections_.end(), 0);
    switches_.resize(c.switches.size());
    for (std::size_t i = bits_.closed.size(); i < c.switches.size(); ++i) {
        bits_.closed.push_back(c.switches[i].closed);
    }
    bits_.faulted.resize(c.faults.size(), {false, false, false});
    fault_armed_.resize(c.faults.size(), {false, false, false});
    bits_.segment.resize(c.cores.size(), 0);
    auto const nodes = static_cast<std::size_t>(c.nodes()) + 3 * c.sources.size() + Topology::kEarths;
    rhs_.assign(team_ ? static_cast<std::size_t>(team_->size()) + 1 : 1, std::vector<double>(nodes, 0.0));
    norton_i_.assign(3 * c.norton.size(), 0.0);
    correction_.assign(3 * c.norton.size(), 0.0);
    watched_before_.assign(3 * (c.switches.size() + c.faults.size()), 0.0);
    watched_after_ = watched_before_;
    core_share_.assign(c.cores.size(), 2.0);
    core_beyond_.assign(c.cores.size(), 0);
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
        std::shared_ptr<NodalSystem> fresh;
        for (std::size_t i = 0; usual && !fresh && i < cache_.size(); ++i) {
            fresh = update_system(circuit_, cache_[i], bits_);
        }
        if (!fresh) {
            auto made = make_system(circuit_, bits_, *coefficients_, usual && team_ ? team_->size() : 1);
            if (!made) {
                return fail(made.error().code, fmt::format("at {} s {}", shortest(t_), made.error().message),
                            made.error().remedy);
            }
            fresh = std::move(*made);
        }
        found = fresh.get();
        if (usual) {
            if (cache_.size() >= kCacheSize) {
                cache_.erase(std::min_element(cache_.begin(), cache_.end(), [](auto const& x, auto const& y) {
                    return x->last_used < y->last_used;
                }));
            }
            cache_.push_back(std::move(fresh));
        } else {
            odd_ = std::move(fresh);
        }
    }
    found->last_used = ++uses_;
    system_ = found;
    modified_ = false;
    for (NortonPort const& p : circuit_.norton) {
        p.element->use_step(h);
    }
    state_.v.assign(system_->topology.places(), 0.0);
    for (std::size_t i = nodes.size(); i-- > 0;) {
        state_.v[static_cast<std::size_t>(system_->topology.slot[i])] = nodes[i];
    }
    return {};
}

Result<void> Solver::advance(double t_end, double h) {
    double const least = kMinSegment * step_s_;
    int changes = 0; // without time between them
    for (double left = h; left > 0;) {
        part_contacts();
        double piece = left;
        for (SwitchControl const& s : switches_) {
            for (double const part_at : s.part_at) {
                if (waiting_ && part_at - t_ > least && part_at - t_ < piece - least) {
                    piece = part_at - t_;
                }
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
        double const damping_s = damping_s_;
        if (auto ok = use(piece); !ok) { // first, so that saved voltages belong to the slots of the new switch state
            return ok;
        }
        for (std::size_t w = 0; w < waves_.size(); ++w) {
            state_.wave_marks[w] = waves_[w].mark();
        }
        for (MartiWaves& line : marti_) {
            line.save();
        }
        saved_ = state_;
        for (NortonPort const& p : circuit_.norton) {
            p.element->save();
        }
        remember_currents(watched_before_);
        if (auto ok = segment(t_piece, piece); !ok) {
            return ok;
        }
        remember_currents(watched_after_);
        Crossing const crossing = first_crossing(changes <= kMaxChangesAtOnce);
        if (!crossing.found || crossing.share * piece >= piece - least) {
            left = last ? 0 : left - piece;
            changes = 0;
            if (crossing.found) {
                open_crossed(crossing.share);
            }
            continue;
        }
        // Back to the start, and only as far as the current zero.
        auto const back = [&] {
            state_ = saved_;
            for (NortonPort const& p : circuit_.norton) {
                p.element->restore();
            }
            for (std::size_t w = 0; w < waves_.size(); ++w) {
                waves_[w].back_to(saved_.wave_marks[w]);
            }
            for (MartiWaves& line : marti_) {
                line.restore();
            }
            t_ = t_start;
            damping_s_ = damping_s;
        };
        back();
        double const part = crossing.share * piece;
        changes = part > least ? 0 : changes + 1;
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
    // Critical damping adjustment (Marti and Lin 1989). In the middle of a step, the rest of it is too short to damp
    // what the trapezoid would then carry on as chatter: whole steps of damping, in as many pieces as it takes.
    if (damping_s_ > kMinSegment * step_s_) {
        for (NortonPort const& p : circuit_.norton) {
            p.element->forget_history();
        }
        substep(t_ + h / 2, h / 2, Rule::backward_euler, *coefficients_);
        substep(t_end, h / 2, Rule::backward_euler, *coefficients_);
        damping_s_ -= h;
    } else {
        substep(t_end, h, Rule::trapezoid, *coefficients_);
    }
    t_ = t_end;
    return check();
}

Result<void> Solver::check() const {
    // Four sums: one is as long as an addition takes, times the nodes.
    std::array<double, 4> sums{};
    std::size_t const whole = state_.v.size() / 4 * 4;
    for (std::size_t i = 0; i < whole; i += 4) {
        for (std::size_t k = 0; k < 4; ++k) {
            sums[k] += state_.v[i + k];
        }
    }
    double sum = sums[0] + sums[1] + sums[2] + sums[3];
    for (std::size_t i = whole; i < state_.v.size(); ++i) {
        sum += state_.v[i];
    }
    bool sound = true;
    for (NortonPort const& p : circuit_.norton) {
        sound = sound && p.element->sound();
    }
    if (std::abs(sum) < limit_v_ && sound) [[likely]] { // false for NaN
        return {};
    }
    for (NortonPort const& p : circuit_.norton) {
        if (!p.element->sound()) {
            return std::unexpected{p.element->failure(t_)};
        }
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
                fmt::format("the waveforms diverge at {} s: the voltage of {} is {}", shortest(t_),
                            circuit_.node_name(static_cast<int>(node)),
                            std::isfinite(state_.v[worst]) ? shortest(state_.v[worst]) + " V" : "no number any more"),
                "look at the element there; a shorter step_s may help");
}

} // namespace gridspace::sim::emt
