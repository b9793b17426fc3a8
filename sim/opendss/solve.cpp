// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/solve.hpp"

#include "sim/powerflow/nodal_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gridspace::opendss {
namespace {

Complex across(Eigen::VectorXcd const& v, std::pair<int, int> ends) {
    auto const at = [&](int node) { return node < 0 ? Complex{} : v[node]; };
    return at(ends.first) - at(ends.second);
}

template <class Add>
void between(std::pair<int, int> ends, Complex y, Add add) {
    add(ends.first, ends.first, y);
    add(ends.second, ends.second, y);
    add(ends.first, ends.second, -y);
    add(ends.second, ends.first, -y);
}

/// Thousands of short lines must not lose power to earth; transformers have an earth of their own (`ppm`).
constexpr double kAnchorShare = 1e-14;

class Solver {
  public:
    Solver(Circuit& circuit, CircuitOptions const& options) : c_{circuit}, options_{options} {}

    Result<CircuitFlow> run() {
        if (std::none_of(c_.elements.begin(), c_.elements.end(), [](auto const& e) { return e.injected.size() > 0; })) {
            return fail(ExitCode::usage, "the circuit has no source", "is its vsource disabled?");
        }
        auto const idle = sim::solve_nodal(linear(), [](auto const&, auto&) {}, {1, 1, kAnchorShare});
        if (!idle) {
            return std::unexpected{idle.error()};
        }
        idle_v_ = idle->v;
        CircuitFlow flow;
        do {
            auto const solution = solve();
            if (!solution) {
                return std::unexpected{solution.error()};
            }
            ++flow.control_rounds;
            flow.iterations = solution->iterations;
            flow.change_pu = solution->change_pu;
            flow.v = solution->v;
            flow.controls_settled = !act(flow.v);
        } while (!flow.controls_settled && flow.control_rounds < c_.max_control_rounds);
        results(flow);
        return flow;
    }

  private:
    /// The circuit without its loads.
    sim::NodalNetwork linear() {
        sim::NodalNetwork n;
        n.nodes = c_.nodes;
        for (Element const& e : c_.elements) {
            for (std::size_t i = 0; i < e.nodes.size() && e.in_service; ++i) {
                auto const row = static_cast<Eigen::Index>(i);
                for (std::size_t j = 0; j < e.nodes.size() && e.nodes[i] >= 0; ++j) {
                    Complex const y = e.y(row, static_cast<Eigen::Index>(j));
                    if (e.nodes[j] >= 0 && y != Complex{}) {
                        n.admittances.emplace_back(e.nodes[i], e.nodes[j], y);
                    }
                }
                if (e.nodes[i] >= 0 && e.injected.size() > 0) {
                    n.driven.emplace_back(e.nodes[i], e.injected[row]);
                }
            }
        }
        // Nodes to which nothing is connected have no voltage.
        std::vector<bool> connected(static_cast<std::size_t>(c_.nodes), false);
        for (auto const& e : n.admittances) {
            connected[static_cast<std::size_t>(e.row())] = true;
        }
        for (std::size_t k = 0; k < connected.size(); ++k) {
            if (!connected[k]) {
                n.admittances.emplace_back(static_cast<int>(k), static_cast<int>(k), 1e-9);
            }
        }
        return n;
    }

    Result<sim::NodalSolution> solve() {
        sim::NodalNetwork n = linear();
        for (Eigen::Index k = 0; k < idle_v_.size(); ++k) {
            n.base_v.push_back(std::abs(idle_v_[k]) > 1 ? std::abs(idle_v_[k]) : 0);
        }
        // Of each load its impedance at nominal voltage is in the matrix; the currents are the rest.
        for (Consumer const& consumer : c_.consumers) {
            Complex const y = consumer.generates ? Complex{} : consumer.law.admittance();
            for (auto const& ends : consumer.phases) {
                between(ends, y, [&](int i, int j, Complex value) {
                    if (i >= 0 && j >= 0) {
                        n.of_loads.emplace_back(i, j, value);
                    }
                });
            }
        }
        auto const currents = [this](Eigen::VectorXcd const& v, Eigen::VectorXcd& i) {
            for (Consumer const& consumer : c_.consumers) {
                Complex const y = consumer.generates ? Complex{} : consumer.law.admittance();
                for (auto const& ends : consumer.phases) {
                    Complex const u = across(v, ends), rest = y * u - consumer.law.current(u);
                    if (ends.first >= 0) {
                        i[ends.first] += rest;
                    }
                    if (ends.second >= 0) {
                        i[ends.second] -= rest;
                    }
                }
            }
        };
        return sim::solve_nodal(n, currents, {options_.tolerance_pu, options_.max_iterations, kAnchorShare});
    }

    /// Those controls act that want to and have the shortest delay; returns whether any did.
    bool act(Eigen::VectorXcd const& v) {
        if (!c_.controls_act) {
            return false;
        }
        std::vector<TapWish> taps;
        std::vector<std::optional<bool>> switches;
        double soonest = std::numeric_limits<double>::infinity();
        for (Regulator const& r : c_.regulators) {
            taps.push_back(wish_of(r, c_, v));
            soonest = taps.back().steps == 0 ? soonest : std::min(soonest, taps.back().delay_s);
        }
        auto const delay = [](CapacitorControl const& c, bool close) { return close ? c.delay_s : c.delay_off_s; };
        for (CapacitorControl const& c : c_.capacitor_controls) {
            switches.push_back(wish_of(c, c_, v, options_.hour));
            soonest = switches.back() ? std::min(soonest, delay(c, *switches.back())) : soonest;
        }
        bool acted = false;
        for (std::size_t i = 0; i < taps.size(); ++i) {
            if (taps[i].steps != 0 && taps[i].delay_s <= soonest) {
                acted = change_tap(c_.regulators[i], c_, taps[i].steps) || acted;
            }
        }
        for (std::size_t i = 0; i < switches.size(); ++i) {
            CapacitorControl const& c = c_.capacitor_controls[i];
            if (switches[i] && delay(c, *switches[i]) <= soonest) {
                c_.elements[c.capacitor].in_service = *switches[i];
                acted = true;
            }
        }
        return acted;
    }

    void results(CircuitFlow& flow) {
        flow.element_losses_va.reserve(c_.elements.size());
        for (Element const& e : c_.elements) {
            Complex power{};
            if (e.in_service) {
                Eigen::VectorXcd const i = currents_into(e, flow.v);
                for (std::size_t k = 0; k < e.nodes.size(); ++k) {
                    power +=
                        e.nodes[k] < 0 ? Complex{} : flow.v[e.nodes[k]] * std::conj(i[static_cast<Eigen::Index>(k)]);
                }
            }
            flow.element_losses_va.push_back(power);
            (e.injected.size() > 0 ? flow.source_va : flow.losses_va) += power;
        }
        flow.source_va = -flow.source_va;
        for (Consumer const& consumer : c_.consumers) {
            for (auto const& ends : consumer.phases) {
                Complex const u = across(flow.v, ends), s = u * std::conj(consumer.law.current(u));
                (consumer.generates ? flow.generated_va : flow.consumed_va) += consumer.generates ? -s : s;
            }
        }
        for (Regulator const& r : c_.regulators) {
            flow.regulators.push_back(wish_of(r, c_, flow.v));
        }
        bases(flow);
    }

    /// The base of a bus is the one nearest to its voltage without loads.
    void bases(CircuitFlow& flow) {
        for (auto const& [name, index] : c_.bus_index) {
            flow.bus_base_kv.resize(c_.buses.size(), 0);
            Bus const& bus = c_.buses[index];
            auto const given = c_.bus_base_kv.find(name);
            double kv = 0;
            for (auto const& [number, node] : bus.nodes) {
                kv = std::max(kv, std::abs(idle_v_[node]) * std::sqrt(3.0) / 1e3);
            }
            double best = std::numeric_limits<double>::infinity();
            for (double const base : c_.voltage_bases_kv) {
                if (double const away = std::abs(1 - kv / base); kv > 0 && away < best) {
                    best = away;
                    flow.bus_base_kv[index] = base;
                }
            }
            if (given != c_.bus_base_kv.end()) {
                flow.bus_base_kv[index] = given->second;
            }
        }
    }

    Circuit& c_;
    CircuitOptions const& options_;
    Eigen::VectorXcd idle_v_;
};

} // namespace

Eigen::VectorXcd currents_into(Element const& e, Eigen::VectorXcd const& v) {
    Eigen::VectorXcd at(static_cast<Eigen::Index>(e.nodes.size()));
    for (std::size_t k = 0; k < e.nodes.size(); ++k) {
        at[static_cast<Eigen::Index>(k)] = e.nodes[k] < 0 ? Complex{} : v[e.nodes[k]];
    }
    Eigen::VectorXcd i = e.y * at;
    if (e.injected.size() > 0) {
        i -= e.injected;
    }
    return i;
}

Result<CircuitFlow> solve_circuit(Circuit& circuit, CircuitOptions const& options) {
    return Solver{circuit, options}.run();
}

} // namespace gridspace::opendss
