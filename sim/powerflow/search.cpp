// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/search.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {
namespace {

// A transmission network is operated between 0.9 and 1.1 p.u., feeders somewhat beyond; power angles stay below 90
// degrees.
constexpr double kLowest = 0.8, kHighest = 1.2;
constexpr double kLossShare = 0.25;
constexpr int kRetryIterations = 15; ///< from a start that is good Newton needs three to eight

void doubt_voltages(Network const& n, PowerFlowProblem const& problem, NewtonOutcome const& solution,
                    std::vector<std::string>& out) {
    std::size_t low = 0, high = 0, lowest = 0, highest = 0;
    for (std::size_t i = 0; i < n.buses.size(); ++i) {
        if (problem.nodes[i].kind == NodeKind::dead) {
            continue;
        }
        double const v = solution.v[i];
        if (v < kLowest && (low++ == 0 || v < solution.v[lowest])) {
            lowest = i;
        }
        if (v > kHighest && (high++ == 0 || v > solution.v[highest])) {
            highest = i;
        }
    }
    if (low > 0) {
        out.push_back(fmt::format("{} of {} buses are below {} p.u., the lowest is '{}' at {:.3f}", low, n.buses.size(),
                                  kLowest, n.buses[lowest].name.name, solution.v[lowest]));
    }
    if (high > 0) {
        out.push_back(fmt::format("{} of {} buses are above {} p.u., the highest is '{}' at {:.3f}", high,
                                  n.buses.size(), kHighest, n.buses[highest].name.name, solution.v[highest]));
    }
}

void doubt_angles(Network const& n, PowerFlowProblem const& problem, NewtonOutcome const& solution,
                  std::vector<std::string>& out) {
    std::size_t wide = 0;
    Branch const* widest = nullptr;
    double most = 0;
    for (Branch const& b : problem.branches) {
        if (b.ft == Complex{} || b.from >= n.buses.size() || b.to >= n.buses.size()) {
            continue;
        }
        double const across =
            std::remainder(solution.angle[b.from] - solution.angle[b.to] + lead_of(b), 2 * std::numbers::pi);
        if (std::abs(across) > std::numbers::pi / 2) {
            ++wide;
            if (std::abs(across) > std::abs(most)) {
                most = across;
                widest = &b;
            }
        }
    }
    if (widest != nullptr) {
        std::string const& name = two_ports(n)[widest->element]->name.name;
        out.push_back(fmt::format("{} of {} branches carry more than 90 degrees, '{}' {:.0f}", wide,
                                  problem.branches.size(), name, most * 180 / std::numbers::pi));
    }
}

void doubt_losses(Network const& n, PowerFlowProblem const& problem, NewtonOutcome const& solution,
                  std::vector<std::string>& out) {
    double losses = 0, taken = 0;
    for (Branch const& b : problem.branches) {
        Complex const from = std::polar(solution.v[b.from], solution.angle[b.from]);
        Complex const to = std::polar(solution.v[b.to], solution.angle[b.to]);
        losses += (from * std::conj(b.ff * from + b.ft * to) + to * std::conj(b.tf * from + b.tt * to)).real();
    }
    for (Complex const& s : solution.injection) {
        taken += std::max(0.0, -s.real());
    }
    (void)problem;
    if (losses > kLossShare * taken && losses * n.power_kva > 1) {
        out.push_back(fmt::format("losses are {:.4g} kW, {:.0f} % of the {:.4g} kW that all loads take",
                                  losses * n.power_kva, 100 * losses / taken, taken * n.power_kva));
    }
}

PowerFlowStart start_at(NewtonOutcome const& solution) {
    return {solution.v, solution.angle};
}

/// From no load to all powers, each step from the solution before; steps grow where it is easy and shrink where it is
/// not.
NewtonOutcome follow(PowerFlowProblem const& problem, PowerFlowOptions const& options, SearchOutcome& out) {
    PowerFlowOptions rough = options;
    rough.tolerance_pu = std::max(options.tolerance_pu, 1e-8);
    rough.max_iterations = kRetryIterations;
    rough.enforce_q_limits = false;
    NewtonOutcome last = newton(problem, rough, 0);
    if (!last.converged) {
        return last;
    }
    double step = 0.25;
    while (out.reached < 1 && step > 1.0 / 2048) {
        double const next = std::min(1.0, out.reached + step);
        PowerFlowStart const from = start_at(last);
        NewtonOutcome tried = newton(problem, rough, next, &from);
        if (tried.converged) {
            out.reached = next;
            step *= 2;
            last = std::move(tried);
        } else {
            step /= 4;
        }
    }
    out.v_reached = last.v;
    PowerFlowStart const from = start_at(last);
    return out.reached < 1 ? last : newton(problem, options, 1, &from);
}

} // namespace

std::vector<std::string> doubts_about(Network const& network, PowerFlowProblem const& problem,
                                      NewtonOutcome const& solution) {
    std::vector<std::string> out;
    doubt_voltages(network, problem, solution, out);
    doubt_angles(network, problem, solution, out);
    doubt_losses(network, problem, solution, out);
    return out;
}

SearchOutcome search(Network const& network, PowerFlowProblem const& problem, PowerFlowOptions const& options) {
    SearchOutcome out;
    bool first = true;
    // Whether that ends the search.
    auto const keep = [&](NewtonOutcome attempt) {
        std::vector<std::string> doubts =
            attempt.converged ? doubts_about(network, problem, attempt) : std::vector<std::string>{};
        bool const better =
            first || (attempt.converged ? !out.solution.converged || doubts.size() < out.doubts.size()
                                        : !out.solution.converged && attempt.mismatch < out.solution.mismatch);
        first = false;
        if (better) {
            out.solution = std::move(attempt);
            out.doubts = std::move(doubts);
        }
        return out.solution.converged && out.doubts.empty();
    };
    PowerFlowOptions retry = options;
    retry.max_iterations = std::min(options.max_iterations, kRetryIterations);
    if (problem.given && keep(newton(problem, retry, 1, &*problem.given))) {
        return out;
    }
    if (keep(newton(problem, problem.given ? retry : options))) {
        return out;
    }
    PowerFlowStart const linear = linear_start(problem);
    if (keep(newton(problem, retry, 1, &linear)) || out.solution.converged) {
        return out;
    }
    if (NewtonOutcome followed = follow(problem, retry, out); out.reached >= 1) {
        (void)keep(std::move(followed));
    }
    return out;
}

} // namespace gridspace::sim
