// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/exploration.hpp"

#include "common/elementary.hpp"
#include "ids/training/chunks.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/network/network_config.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <mutex>

namespace gridspace::cli {
namespace {

using ids::Situation;
constexpr double kTwoPi = 6.283185307179586;

template <class T>
T const& one_of(Random& r, std::vector<T> const& from) {
    return from[r.below(from.size())];
}

/// The line's two transformers as they are in one run: ratio errors, what the grid has of harmonics, noise, resolution.
class MeasuringChain {
  public:
    /// `from_sign`, `to_sign`: what makes currents of the transformers those that are counted along the line.
    static Result<MeasuringChain> draw(ids::SimulatedParams const& params, sim::Engine const& engine, double from_sign,
                                       double to_sign, double frequency_hz, Random& r) {
        MeasuringChain out;
        out.frequency_hz_ = frequency_hz;
        for (std::size_t c = 0; c < 6; ++c) {
            std::string const name = fmt::format("ct.{}.i.{}", c < 3 ? params.from_ct : params.to_ct, "abc"[c % 3]);
            out.signals_[c] = engine.find_signal(name);
            if (out.signals_[c] == engine.signals().size()) {
                return fail(ExitCode::usage, fmt::format("the engine has no signal '{}'", name));
            }
            out.gain_[c] = (c < 3 ? from_sign : to_sign) * (1 + params.ct_error_percent / 100 * r.normal());
        }
        for (std::size_t k = 0; k < 3; ++k) {
            out.harmonics_[k] = {3.0 + 2 * static_cast<double>(k),
                                 params.nominal_peak_a * r.uniform(0, params.harmonics_percent) / 100,
                                 r.uniform(0, kTwoPi)};
        }
        out.noise_a_ = params.nominal_peak_a * r.uniform(params.noise_percent[0], params.noise_percent[1]) / 100;
        return out;
    }

    /// Ia, Ib, Ic of the from end, then of the to end, in A, at the engine's present time.
    [[nodiscard]] std::array<double, 6> sample(sim::Engine const& engine, double t_s, Random& r) const {
        std::array<double, 6> out{};
        for (std::size_t c = 0; c < 6; ++c) {
            double v = engine.value(signals_[c]);
            for (Harmonic const& h : harmonics_) {
                double const turns = frequency_hz_ * t_s - static_cast<double>(c % 3) / 3;
                v += h.amplitude * elementary::cos(h.order * kTwoPi * turns + h.angle);
            }
            v = v * gain_[c] + noise_a_ * r.normal();
            out[c] = std::floor(v * 1000 + 0.5) / 1000;
        }
        return out;
    }

  private:
    struct Harmonic {
        double order, amplitude, angle;
    };
    double frequency_hz_{0}, noise_a_{0};
    std::array<std::size_t, 6> signals_{};
    std::array<double, 6> gain_{};
    std::array<Harmonic, 3> harmonics_{};
};

} // namespace

Result<Exploration> Exploration::create(ids::SimulatedParams const& params, double rate_hz) {
    Exploration out;
    out.params_ = params;
    out.rate_hz_ = rate_hz;
    config::Diagnostics diagnostics;
    auto network = sim::load_network(params.network, diagnostics);
    if (!network || !diagnostics.ok()) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    out.network_ = std::move(*network);
    auto const steps = Rational{1} / (params.step_s * Rational{static_cast<std::int64_t>(std::lround(rate_hz))});
    if (!steps.is_whole() || steps.num() < 1) {
        return fail(
            ExitCode::usage,
            fmt::format("a sample of {} Hz is {} steps of {} s", rate_hz, steps.to_string(), params.step_s.to_string()),
            "choose a step that divides it, e.g. 1/38400");
    }
    out.steps_per_sample_ = steps.num();
    if (sim::find(out.network_.lines, params.line) == nullptr) {
        return fail(ExitCode::usage, fmt::format("{}: no line '{}'", params.network.string(), params.line));
    }
    for (auto const& [name, sign] : {std::pair{&params.from_ct, &out.from_sign_}, {&params.to_ct, &out.to_sign_}}) {
        sim::Ct const* ct = sim::find(out.network_.cts, *name);
        if (ct == nullptr || ct->line.name != params.line) {
            return fail(ExitCode::usage, fmt::format("{}: line '{}' has no current transformer '{}'",
                                                     params.network.string(), params.line, *name));
        }
        *sign = ct->positive == sim::CtPolarity::into_line && ct->end == sim::LineEnd::to ? -1 : 1;
    }
    for (sim::Breaker const& b : out.network_.breakers) {
        if (b.line.name != params.line && b.end == sim::LineEnd::from) {
            out.other_lines_.push_back(b.line.name);
        }
    }
    for (sim::Bus const& b : out.network_.buses) {
        bool const source = std::any_of(out.network_.sources.begin(), out.network_.sources.end(),
                                        [&](sim::Source const& s) { return s.bus.name == b.name.name; });
        if (!source) {
            out.buses_.push_back(b.name.name);
        }
    }
    if (out.network_.loads.empty() || out.buses_.empty()) {
        return fail(ExitCode::usage,
                    fmt::format("{}: an exploration needs loads, and buses without a source", params.network.string()));
    }
    return out;
}

std::vector<Exploration::Planned> Exploration::draw_plan(Situation situation, sim::Network const& network,
                                                         Random& r) const {
    double const event_s = r.uniform(params_.event_s[0], params_.event_s[1]),
                 cleared_s = event_s + r.uniform(0.06, 0.15);
    double const resistance = params_.fault_resistance_ohm[0] *
                              elementary::exp(r.uniform() * elementary::log(params_.fault_resistance_ohm[1] /
                                                                            params_.fault_resistance_ohm[0]));
    std::vector<Planned> plan;
    auto const switch_line = [&](std::string const& line, double at_s, bool close) {
        for (sim::Breaker const& b : network.breakers) {
            if (b.line.name == line) {
                plan.push_back({at_s, sim::SwitchBreaker{b.name.name, close}});
            }
        }
    };
    auto const fault = [&](sim::FaultType type, bool internal) {
        sim::ApplyFault f;
        f.name = "fault";
        f.type = type;
        f.resistance_ohm = resistance;
        if (internal) {
            f.line = params_.line;
            f.position_percent = r.uniform(5, 95);
        } else {
            f.bus = one_of(r, buses_);
        }
        plan.push_back({event_s, f});
        if (!internal) {
            plan.push_back({cleared_s, sim::ClearFault{"fault"}});
        }
    };
    switch (situation) {
    case Situation::quiet:
        break;
    case Situation::load_step: {
        sim::Load const& load = one_of(r, network.loads);
        plan.push_back(
            {event_s, sim::SetParameter{"loads." + load.name.name + ".p_kw", load.p_kw * r.uniform(0.3, 2)}});
        break;
    }
    case Situation::line_trip:
    case Situation::swing: // a line that comes back: what follows is the swing
        if (!other_lines_.empty()) {
            std::string const line = one_of(r, other_lines_);
            switch_line(line, event_s, false);
            if (situation == Situation::swing) {
                switch_line(line, cleared_s, true);
            }
        }
        break;
    case Situation::generator_trip:
        if (!network.machines.empty()) {
            plan.push_back({event_s, sim::Disconnect{one_of(r, network.machines).name.name}});
        }
        break;
    case Situation::external_3ph:
        fault(sim::FaultType::three_phase_ground, false);
        break;
    case Situation::external_1ph:
        fault(sim::FaultType::phase_ground, false);
        break;
    case Situation::internal_3ph:
        fault(sim::FaultType::three_phase_ground, true);
        break;
    case Situation::internal_2ph:
        fault(sim::FaultType::phase_phase, true);
        break;
    case Situation::internal_1ph:
        fault(sim::FaultType::phase_ground, true);
        break;
    }
    return plan;
}

Result<ids::LineWaveform> Exploration::run(Situation situation, std::uint64_t seed, std::uint64_t number) const {
    Random r{seed, number};
    sim::Network network = network_;
    for (sim::Load& load : network.loads) {
        load.p_kw *= r.uniform(params_.load_factor[0], params_.load_factor[1]);
    }
    std::vector<Planned> const plan = draw_plan(situation, network, r);

    TimeBase const base{params_.step_s};
    auto engine = sim::emt::make_emt_engine(std::move(network), {base, SimSpan{1}, 0});
    if (!engine) {
        return std::unexpected{engine.error()};
    }
    if (auto const ok = (*engine)->initialise(); !ok) {
        return std::unexpected{ok.error()};
    }
    auto const chain = MeasuringChain::draw(params_, **engine, from_sign_, to_sign_, network_.frequency_hz, r);
    if (!chain) {
        return std::unexpected{chain.error()};
    }
    ids::LineWaveform out;
    out.name = fmt::format("{}_{}", ids::name_of(situation), number);
    out.rate_hz = rate_hz_;
    out.frequency_hz = network_.frequency_hz;
    out.situation = plan.empty() ? Situation::quiet : situation;
    auto const quanta_at = [&](double s) { return std::llround(s / params_.step_s.to_double()); };
    auto const count = static_cast<std::int64_t>(params_.duration_s * rate_hz_);
    out.event = plan.empty() ? -1
                             : quanta_at(plan.front().at_s) / steps_per_sample_ +
                                   1; // commands act after the samples of their instant
    std::size_t next = 0;
    for (std::int64_t k = 0; k <= (count - 1) * steps_per_sample_; ++k) {
        if (k > 0) {
            if (auto const ok = (*engine)->advance(SimTime{k}); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        if (k % steps_per_sample_ == 0) {
            std::array<double, 6> const i = chain->sample(**engine, base.seconds(SimTime{k}), r);
            out.from.push_back({i[0], i[1], i[2]});
            out.to.push_back({i[3], i[4], i[5]});
        }
        while (next < plan.size() && quanta_at(plan[next].at_s) <= k) {
            if (auto const ok = (*engine)->apply(plan[next].action); !ok) {
                return std::unexpected{ok.error()};
            }
            ++next;
        }
    }
    return out;
}

Result<std::vector<ids::LineWaveform>>
Exploration::all(std::uint64_t seed, std::uint64_t first, int threads,
                 std::function<void(std::size_t, std::size_t)> const& progress) const {
    auto const count = static_cast<std::size_t>(params_.runs);
    std::vector<ids::LineWaveform> out(count);
    std::vector<std::string> errors(count);
    std::mutex showing;
    std::size_t done = 0;
    ids::for_each_chunk(count, threads, [&](std::size_t k) {
        auto one = run(static_cast<Situation>(k % 10), seed, first + k);
        if (one) {
            out[k] = std::move(*one);
        } else {
            errors[k] = describe(one.error());
        }
        std::scoped_lock const lock{showing};
        ++done;
        if (progress) {
            progress(done, count);
        }
    });
    for (std::size_t k = 0; k < count; ++k) {
        if (!errors[k].empty()) {
            return fail(ExitCode::usage, fmt::format("simulated run {} ({}): {}", first + k,
                                                     ids::name_of(static_cast<Situation>(k % 10)), errors[k]));
        }
    }
    return out;
}

} // namespace gridspace::cli
