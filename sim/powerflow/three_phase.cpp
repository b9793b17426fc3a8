// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/three_phase.hpp"

#include <Eigen/LU>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <numbers>

namespace gridspace::sim {
namespace {

using Matrix3 = Eigen::Matrix3cd;

/// What nothing connects to earth still needs a potential: an earth connection of this share of a node's own
/// admittance.
constexpr double kAnchorShare = 1e-10;

/// Three coils: their ends, and the volts of one at nominal voltage.
struct Coils {
    std::array<std::pair<int, int>, 3> ends;
    double rated_v{0};
};

class Feeder : private PowerFlowFace {
  public:
    Feeder(Network const& n, SwitchState const& state)
        : n_{n}, state_{state}, omega_{2 * std::numbers::pi * n.frequency_hz} {
        nodes_ = static_cast<int>(3 * n.buses.size());
        for (Bus const& b : n.buses) {
            phase_v_.push_back(b.voltage_v / std::sqrt(3.0));
        }
    }

    Result<ThreePhaseFlow> solve(ThreePhaseOptions const& options) {
        hours_ = options.hours;
        start_hour_of_day_ = options.start_hour_of_day;
        if (!n_.machines.empty()) {
            return fail(
                ExitCode::usage,
                fmt::format("machine '{}': the three-phase power flow has no machines", n_.machines.front().name.name),
                "use the balanced power flow, or a source");
        }
        for (Generator const& g : n_.generators) {
            if (g.role == GeneratorRole::pv) {
                return fail(
                    ExitCode::usage,
                    fmt::format("generator '{}': the three-phase power flow regulates no voltages", g.name.name),
                    "give it role pq or slack");
            }
        }
        for (std::size_t i = 0; i < n_.lines.size(); ++i) {
            line(i);
        }
        for (std::size_t i = 0; i < n_.transformers.size(); ++i) {
            if (auto ok = transformer(i); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        if (auto ok = sources(); !ok) {
            return std::unexpected{ok.error()};
        }
        for (OnePort const* e : one_ports(n_)) {
            if (e->closed_at_start()) {
                e->power_flow(*this);
            }
        }
        // The share of a load that is an impedance belongs to the matrix: behind windings without earth it is all that
        // holds the potential. Where that does not lead to a solution, the whole load at nominal voltage may.
        add_loads([](VoltageDependent const& l) { return l.impedance_shares(); });
        auto flow = iterate(options);
        if (!flow) {
            add_loads([](VoltageDependent const&) { return std::pair{1.0, 1.0}; });
            auto again = iterate(options);
            return again ? again : flow;
        }
        return flow;
    }

  private:
    struct DrawnPower {
        int node{0};
        double rated_v{0}; ///< phase to earth
        VoltageDependent const* load{nullptr};
        double scale{1};
        /// Nominal power of a phase, VA.
        [[nodiscard]] Complex nominal(int k) const {
            Complex const kva = load->nominal_kva(static_cast<std::size_t>(k));
            double const times = 1e3 * scale;
            return {kva.real() * times, kva.imag() * times};
        }
    };

    void inject(Ref const& bus, Complex kva) override { converters_.emplace_back(node_of(bus), kva); }
    void admit(Ref const& bus, Complex kva) override {
        for (int k = 0; k < 3; ++k) {
            int const node = node_of(bus) + k;
            double const v = n_.buses[bus_of(bus)].voltage_v;
            add(node, node, kva * 1e3 / (v * v));
        }
    }
    void draw(Ref const& bus, VoltageDependent const& load, double scale) override {
        loads_.push_back({node_of(bus), phase_v_[bus_of(bus)], &load, scale});
    }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return n_.buses[bus_of(bus)].voltage_v; }
    [[nodiscard]] double scale(Ref const& name) const override {
        Profile const* profile = name.empty() ? nullptr : find(n_.profiles, name.name);
        return profile == nullptr ? 1 : profile_value(*profile, hours_, start_hour_of_day_);
    }

    template <class Shares>
    void add_loads(Shares shares) {
        linear_.clear();
        for (DrawnPower const& l : loads_) {
            auto const [p, q] = shares(*l.load);
            for (int k = 0; k < 3; ++k) {
                Complex const s = l.nominal(k);
                Complex const y = std::conj(Complex{s.real() * p, s.imag() * q}) / (l.rated_v * l.rated_v);
                if (y != Complex{}) {
                    linear_.emplace_back(l.node + k, y);
                }
            }
        }
    }

    std::size_t bus_of(Ref const& bus) const { return index_of(n_.buses, bus.name); }
    int node_of(Ref const& bus) const { return static_cast<int>(3 * bus_of(bus)); }
    void add(int i, int j, Complex y) {
        if (i >= 0 && j >= 0) {
            entries_.emplace_back(i, j, y);
        }
    }

    void line(std::size_t index) {
        Line const& l = n_.lines[index];
        if (state_.line_out[index] || !state_.closed(n_, l.name.name, LineEnd::from) ||
            !state_.closed(n_, l.name.name, LineEnd::to)) {
            return;
        }
        LineTotals const t = line_totals(n_, l);
        Matrix3 z;
        LineType const* type = find(n_.line_types, l.type.name);
        if (type != nullptr && !type->phase_r_ohm_per_km.empty()) {
            constexpr int kPlace[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
            for (int i = 0; i < 3; ++i) {
                for (int j = 0; j < 3; ++j) {
                    auto const p = static_cast<std::size_t>(kPlace[i][j]);
                    z(i, j) =
                        Complex{type->phase_r_ohm_per_km[p], type->phase_x_ohm_per_km[p]} * l.length_km.value_or(0);
                }
            }
        } else {
            Complex const z1{t.r_ohm, omega_ * t.l_h}, z0{t.r0_ohm, omega_ * t.l0_h};
            z = Matrix3::Constant((z0 - z1) / 3.0) + z1 * Matrix3::Identity();
        }
        Matrix3 const y = z.inverse();
        Complex const c1{0, omega_ * t.c_f / 2}, c0{0, omega_ * t.c0_f / 2};
        Matrix3 const shunt = Matrix3::Constant((c0 - c1) / 3.0) + c1 * Matrix3::Identity();
        int const from = node_of(l.from), to = node_of(l.to);
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                add(from + i, from + j, y(i, j) + shunt(i, j));
                add(to + i, to + j, y(i, j) + shunt(i, j));
                add(from + i, to + j, -y(i, j));
                add(to + i, from + j, -y(i, j));
            }
        }
        lines_.push_back({index, y, shunt, from, to});
    }

    Coils coils(Ref const& bus, Winding connection, bool forward) {
        Coils out;
        int const node = node_of(bus);
        double const v = n_.buses[bus_of(bus)].voltage_v;
        int const neutral = connection == Winding::wye ? nodes_++ : -1;
        out.rated_v = connection == Winding::delta ? v : v / std::sqrt(3.0);
        for (int k = 0; k < 3; ++k) {
            int const other = connection == Winding::delta ? node + (k + (forward ? 1 : 2)) % 3 : neutral;
            out.ends[static_cast<std::size_t>(k)] = {node + k, other};
        }
        return out;
    }

    Result<void> transformer(std::size_t index) {
        Transformer const& t = n_.transformers[index];
        if (state_.transformer_out[index]) {
            return {};
        }
        bool const from_delta = t.from_winding == Winding::delta, to_delta = t.to_winding == Winding::delta;
        double const natural = from_delta == to_delta ? 0 : 30;
        if (std::abs(std::abs(t.phase_shift_deg) - natural) > 1e-6) {
            return fail(ExitCode::usage,
                        fmt::format("transformer '{}' cannot shift by {} degrees with its windings", t.name.name,
                                    t.phase_shift_deg),
                        natural == 0 ? "two stars or two deltas have phase_shift_deg: 0"
                                     : "a star and a delta have phase_shift_deg: 30 or -30");
        }
        bool const lags = t.phase_shift_deg > 0, both = from_delta && to_delta;
        Coils const primary = coils(t.from, t.from_winding, both || !lags);
        Coils const secondary = coils(t.to, t.to_winding, both || lags);
        double const ratio = secondary.rated_v / (primary.rated_v * t.tap_ratio);
        double const z_base = secondary.rated_v * secondary.rated_v / (t.rating_kva * 1e3 / 3);
        Complex const y = 100.0 / (Complex{t.r_percent, t.x_percent} * z_base);
        double const s = t.rating_kva * 1e3, v_from = n_.buses[bus_of(t.from)].voltage_v * t.tap_ratio,
                     v_to = n_.buses[bus_of(t.to)].voltage_v;
        double const z_from = 3 * std::pow(primary.rated_v * t.tap_ratio, 2) / s;
        Complex const magnetising{0, -t.magnetising_percent / 100 / z_from};
        for (std::size_t k = 0; k < 3; ++k) {
            auto const [a, b] = primary.ends[k];
            auto const [c, d] = secondary.ends[k];
            int const phase = static_cast<int>(k);
            limb({index, y, {a, b, c, d}, {ratio, -ratio, -1, 1}});
            limb({index, magnetising, {a, b, -1, -1}, {1, -1, 0, 0}});
            limb({index,
                  {0, t.charging_percent / 200 * s / (v_from * v_from)},
                  {node_of(t.from) + phase, -1, -1, -1},
                  {1, 0, 0, 0}});
            limb({index,
                  {0, t.charging_percent / 200 * s / (v_to * v_to)},
                  {node_of(t.to) + phase, -1, -1, -1},
                  {1, 0, 0, 0}});
        }
        return {};
    }

    /// The current y (weights . voltages of the nodes) flows, times its weight, out of each node.
    struct Limb {
        std::size_t index; ///< of the transformer
        Complex y;
        std::array<int, 4> nodes;
        std::array<double, 4> weights;
    };

    void limb(Limb const& l) {
        if (l.y == Complex{}) {
            return;
        }
        limbs_.push_back(l);
        for (std::size_t i = 0; i < 4; ++i) {
            for (std::size_t j = 0; j < 4; ++j) {
                add(l.nodes[i], l.nodes[j], l.weights[i] * l.weights[j] * l.y);
            }
        }
    }

    Result<void> sources() {
        auto const hold = [&](std::string const& name, Ref const& bus, double pu, double angle_deg, Complex z1,
                              Complex z0) -> Result<void> {
            int const node = node_of(bus);
            Complex const e = std::polar(pu * phase_v_[bus_of(bus)], angle_deg * std::numbers::pi / 180);
            for (int i = 0; i < 3; ++i) {
                Complex const phase = e * std::polar(1.0, -i * 2 * std::numbers::pi / 3);
                if (z1 == Complex{}) {
                    auto const [it, fresh] = held_.try_emplace(node + i, phase);
                    if (!fresh && std::abs(it->second - phase) > 1e-9 * phase_v_[bus_of(bus)]) {
                        return fail(ExitCode::usage,
                                    fmt::format("'{}' holds bus '{}' at another voltage than somebody else does", name,
                                                bus.name),
                                    "give one of them an impedance");
                    }
                    continue;
                }
                Complex const y1 = 1.0 / z1, mutual = (1.0 / z0 - y1) / 3.0;
                for (int j = 0; j < 3; ++j) {
                    add(node + i, node + j, mutual + (i == j ? y1 : Complex{}));
                }
                sources_.emplace_back(node + i, y1 * phase); // balanced: no mutual part
            }
            return {};
        };
        for (Source const& s : n_.sources) {
            if (auto ok = hold(s.name.name, s.bus, s.voltage_pu, s.angle_deg, {s.r_ohm, omega_ * s.l_mh * 1e-3},
                               {s.r0_ohm.value_or(s.r_ohm), omega_ * s.l0_mh.value_or(s.l_mh) * 1e-3});
                !ok) {
                return ok;
            }
        }
        for (Generator const& g : n_.generators) {
            if (g.role == GeneratorRole::slack) {
                if (auto ok = hold(g.name.name, g.bus, g.voltage_setpoint_pu, g.angle_deg, {}, {}); !ok) {
                    return ok;
                }
            }
        }
        if (held_.empty() && sources_.empty()) {
            return fail(ExitCode::usage, "the three-phase power flow needs a source or a slack generator");
        }
        return {};
    }

    /// Currents of loads and converters at these voltages.
    void currents(Eigen::VectorXcd const& v, Eigen::VectorXcd& i) const {
        auto const consume = [&](int node, Complex power_va) {
            if (std::abs(v[node]) > 0) {
                i[node] -= std::conj(power_va / v[node]);
            }
        };
        // A converter: balanced currents that carry its power at the positive sequence voltage.
        auto const convert = [&](int node, Complex power_kva) {
            Complex const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
            Complex const v1 = (v[node] + turn * v[node + 1] + turn * turn * v[node + 2]) / 3.0;
            if (std::abs(v1) > 0) {
                Complex const current = std::conj(power_kva * 1e3 / 3.0 / v1);
                i[node] += current;
                i[node + 1] += current / turn;
                i[node + 2] += current * turn;
            }
        };
        for (DrawnPower const& l : loads_) {
            for (int k = 0; k < 3; ++k) {
                Complex const s = l.nominal(k);
                VoltagePower const f = l.load->factor(std::abs(v[l.node + k]) / l.rated_v);
                consume(l.node + k, {s.real() * f.p, s.imag() * f.q});
            }
        }
        for (auto const& [node, y] : linear_) { // the matrix has it
            i[node] += y * v[node];
        }
        for (auto const& [node, kva] : converters_) {
            convert(node, kva);
        }
        for (Generator const& g : n_.generators) {
            if (g.role == GeneratorRole::pq) {
                convert(node_of(g.bus), {g.p_kw, g.q_kvar});
            }
        }
    }

    Result<ThreePhaseFlow> iterate(ThreePhaseOptions const& options) {
        std::vector<Eigen::Triplet<Complex>> places;
        std::vector<double> own(static_cast<std::size_t>(nodes_), 0.0);
        for (auto const& e : entries_) {
            if (!held_.contains(e.row())) {
                places.push_back(e);
                own[static_cast<std::size_t>(e.row())] += e.row() == e.col() ? std::abs(e.value()) : 0;
            }
        }
        for (auto const& [node, admittance] : linear_) {
            if (!held_.contains(node)) {
                places.emplace_back(node, node, admittance);
            }
        }
        for (int k = 0; k < nodes_; ++k) {
            places.emplace_back(k, k, held_.contains(k) ? 1 : kAnchorShare * own[static_cast<std::size_t>(k)]);
        }
        Eigen::SparseMatrix<Complex> y(nodes_, nodes_);
        y.setFromTriplets(places.begin(), places.end());
        Eigen::SparseLU<Eigen::SparseMatrix<Complex>> factors{y};
        if (factors.info() != Eigen::Success) {
            return fail(ExitCode::usage, "the three-phase admittance matrix is singular",
                        "is a part of the network without any element?");
        }
        Eigen::VectorXcd driven = Eigen::VectorXcd::Zero(nodes_);
        for (auto const& [node, current] : sources_) {
            driven[node] += current;
        }
        auto const hold = [&](Eigen::VectorXcd& rhs) {
            for (auto const& [node, voltage] : held_) {
                rhs[node] = voltage;
            }
        };
        hold(driven);
        Eigen::VectorXcd v = factors.solve(driven);
        ThreePhaseFlow out;
        for (out.iterations = 1; out.iterations <= options.max_iterations; ++out.iterations) {
            Eigen::VectorXcd i = driven;
            currents(v, i);
            hold(i);
            Eigen::VectorXcd const next = factors.solve(i);
            out.change_pu = 0;
            for (std::size_t b = 0; b < n_.buses.size(); ++b) {
                for (int k = 0; k < 3; ++k) {
                    auto const node = static_cast<int>(3 * b) + k;
                    out.change_pu = std::max(out.change_pu, std::abs(next[node] - v[node]) / phase_v_[b]);
                }
            }
            v = next;
            if (!(out.change_pu < 1e3)) {
                break;
            }
            if (out.change_pu < options.tolerance_pu) {
                results(v, out);
                return out;
            }
        }
        return fail(
            ExitCode::usage,
            fmt::format("the three-phase power flow does not converge: voltages still move by {:.3g} p.u.",
                        out.change_pu),
            "the loads are more than the network can carry, an impedance is wrong, or loads of constant power lie "
            "behind windings that nothing connects to earth");
    }

    void results(Eigen::VectorXcd const& v, ThreePhaseFlow& out) const {
        for (std::size_t b = 0; b < n_.buses.size(); ++b) {
            auto const node = static_cast<int>(3 * b);
            out.buses.push_back({v[node], v[node + 1], v[node + 2]});
        }
        for (LineParts const& l : lines_) {
            Eigen::Vector3cd const from = v.segment<3>(l.from), to = v.segment<3>(l.to);
            Eigen::Vector3cd const series = l.y * (from - to), i_from = series + l.shunt * from,
                                   i_to = l.shunt * to - series;
            out.branches.push_back(
                {TwoPort::Kind::line, l.index, {i_from[0], i_from[1], i_from[2]}, {i_to[0], i_to[1], i_to[2]}});
        }
        for (std::size_t t = 0; t < limbs_.size();) {
            ThreePhaseFlow::Branch branch{TwoPort::Kind::transformer, limbs_[t].index, {}, {}};
            int const from = node_of(n_.transformers[branch.element].from),
                      to = node_of(n_.transformers[branch.element].to);
            for (; t < limbs_.size() && limbs_[t].index == branch.element; ++t) {
                Limb const& l = limbs_[t];
                Complex i{};
                for (std::size_t e = 0; e < 4; ++e) {
                    i += l.nodes[e] < 0 ? Complex{} : l.y * l.weights[e] * v[l.nodes[e]];
                }
                for (std::size_t e = 0; e < 4; ++e) {
                    int const node = l.nodes[e];
                    if (node >= from && node < from + 3) {
                        branch.from[static_cast<std::size_t>(node - from)] += l.weights[e] * i;
                    } else if (node >= to && node < to + 3) {
                        branch.to[static_cast<std::size_t>(node - to)] += l.weights[e] * i;
                    }
                }
            }
            out.branches.push_back(branch);
        }
    }

    struct LineParts {
        std::size_t index;
        Matrix3 y, shunt;
        int from, to;
    };
    Network const& n_;
    SwitchState const& state_;
    double omega_;
    double hours_{0}, start_hour_of_day_{0};
    int nodes_{0};
    std::map<int, Complex> held_; ///< voltages of ideal sources, by node
    std::vector<double> phase_v_;
    std::vector<Eigen::Triplet<Complex>> entries_;
    std::vector<std::pair<int, Complex>> sources_;
    std::vector<std::pair<int, Complex>> linear_; ///< admittances of loads that are in the matrix, by node
    std::vector<DrawnPower> loads_;
    std::vector<std::pair<int, Complex>> converters_; ///< first node, kVA
    std::vector<LineParts> lines_;
    std::vector<Limb> limbs_;
};

} // namespace

bool is_unbalanced(Network const& n) {
    std::vector<OnePort const*> const elements = one_ports(n);
    return std::any_of(elements.begin(), elements.end(), [](OnePort const* e) { return e->unbalanced(); }) ||
           std::any_of(n.line_types.begin(), n.line_types.end(),
                       [](LineType const& t) { return !t.phase_r_ohm_per_km.empty(); });
}

Result<ThreePhaseFlow> solve_three_phase(Network const& network, SwitchState const& state,
                                         ThreePhaseOptions const& options) {
    return Feeder{network, state}.solve(options);
}

} // namespace gridspace::sim
