// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/matpower_export.hpp"

#include "common/text.hpp"
#include "sim/powerflow/problem.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim {
namespace {

constexpr double kUnlimited = 1e15; // p.u. and more: what a unit has that states no limits
constexpr double kNothing = 1e-12;

struct Row {
    Complex load, shunt; ///< p.u.: what is drawn, and the admittance to earth
    Complex into;        ///< what flows from the bus into branches and shunts
};

/// MATPOWER's branch: r + jx in series, half of b at each end, an ideal transformer at the `from` end.
struct CaseBranch {
    Complex z;
    double b{0}, ratio{1}, shift{0};
    Complex rest_from, rest_to; ///< admittances to earth that it cannot hold
};

CaseBranch case_branch(Branch const& y) {
    CaseBranch out;
    double const square = y.ff == Complex{} ? 1 : (y.tt / y.ff).real();
    out.ratio = square > 0 && std::abs(square - 1) > kNothing ? std::sqrt(square) : 1;
    out.shift = 0 - lead_of(y); // without -0
    Complex const series = -y.ft * out.ratio * std::polar(1.0, -out.shift);
    out.z = 1.0 / series;
    double const b = 2 * (y.tt - series).imag();
    out.b = std::abs(b) > kNothing * std::abs(series) ? b : 0;
    Complex const end = series + Complex{0, out.b / 2};
    auto const rest = [&](Complex admittance) {
        return std::abs(admittance) > kNothing * std::abs(series) ? admittance : Complex{};
    };
    out.rest_from = rest(y.ff - end / (out.ratio * out.ratio));
    out.rest_to = rest(y.tt - end);
    return out;
}

std::string limit(double pu, double mva) {
    return std::abs(pu) > kUnlimited ? (pu < 0 ? "-Inf" : "Inf") : shortest(pu * mva);
}

class Writer {
  public:
    Writer(Network const& network, PowerFlowProblem problem, PowerFlow const& solution)
        : network_{network}, problem_{std::move(problem)}, mva_{network.power_kva / 1e3}, rows_(problem_.nodes.size()) {
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            PowerFlowProblem::Node const& node = problem_.nodes[i];
            v_.push_back(i < solution.buses.size() ? solution.buses[i].v : std::polar(node.v, node.angle));
            voltage_v_.push_back(i < network.buses.size() ? network.buses[i].voltage_v : 0);
            rows_[i].shunt = problem_.shunts[i];
        }
    }

    std::string write() {
        std::string const branches = branch_rows(); // first: adds to what stands in the rows of the buses
        for (PowerFlowProblem::BusLoad const& load : problem_.loads) {
            VoltagePower const factor = load.load->factor(std::abs(v_[load.node]), 0);
            rows_[load.node].load += Complex{load.p * factor.p, load.q * factor.q};
        }
        std::string out = fmt::format("function mpc = {}\n%% {}: network and solution; written by Gridspace\n"
                                      "mpc.version = '2';\nmpc.baseMVA = {};\n\n",
                                      identifier(network_.name), printable(network_.name), shortest(mva_));
        out += "%% bus_i type Pd Qd Gs Bs area Vm Va baseKV zone Vmax Vmin\nmpc.bus = [\n" + bus_rows() + "];\n\n";
        out += "%% bus Pg Qg Qmax Qmin Vg mBase status Pmax Pmin\nmpc.gen = [\n" + generator_rows() + "];\n\n";
        out += "%% fbus tbus r x b rateA rateB rateC ratio angle status angmin angmax\nmpc.branch = [\n" + branches;
        return out + "];\n\nmpc.bus_name = {\n" + names() + "};\n";
    }

  private:
    static std::string identifier(std::string const& name) {
        std::string out = name.empty() || !std::isalpha(static_cast<unsigned char>(name.front())) ? "case_" : "";
        for (char const c : name) {
            out += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
        }
        return out;
    }

    std::string branch_rows() {
        std::string out;
        for (Branch const& y : problem_.branches) {
            if (voltage_v_[y.from] == 0) {
                voltage_v_[y.from] = voltage_v_[y.to]; // an ideal source behind its impedance
            }
            rows_[y.from].into += v_[y.from] * std::conj(y.ff * v_[y.from] + y.ft * v_[y.to]);
            rows_[y.to].into += v_[y.to] * std::conj(y.tf * v_[y.from] + y.tt * v_[y.to]);
            if (y.ft == Complex{}) { // open at an end
                rows_[y.from].shunt += y.ff;
                rows_[y.to].shunt += y.tt;
                continue;
            }
            CaseBranch const b = case_branch(y);
            rows_[y.from].shunt += b.rest_from;
            rows_[y.to].shunt += b.rest_to;
            bool const plain = b.ratio == 1 && b.shift == 0;
            out += fmt::format("\t{} {} {} {} {} 0 0 0 {} {} 1 -360 360;\n", y.from + 1, y.to + 1, shortest(b.z.real()),
                               shortest(b.z.imag()), shortest(b.b), plain ? "0" : shortest(b.ratio),
                               shortest(b.shift * 180 / std::numbers::pi));
        }
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            rows_[i].into += std::norm(v_[i]) * std::conj(problem_.shunts[i]);
        }
        return out;
    }

    /// A generator that gave up its voltage at a limit is a given power.
    [[nodiscard]] NodeKind kind(std::size_t i) const {
        PowerFlowProblem::Node const& node = problem_.nodes[i];
        bool const gave_up = node.kind == NodeKind::pv && std::abs(std::abs(v_[i]) - node.v) > 1e-9;
        return gave_up ? NodeKind::pq : node.kind;
    }

    std::string bus_rows() const {
        std::string out;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            NodeKind const is = kind(i);
            int const type = is == NodeKind::slack ? 3 : is == NodeKind::pv ? 2 : is == NodeKind::pq ? 1 : 4;
            double const degrees = std::abs(v_[i]) > 0 ? std::arg(v_[i]) * 180 / std::numbers::pi : 0;
            Row const& row = rows_[i];
            out += fmt::format("\t{} {} {} {} {} {} 1 {} {} {} 1 1.1 0.9;\n", i + 1, type,
                               shortest(row.load.real() * mva_), shortest(row.load.imag() * mva_),
                               shortest(row.shunt.real() * mva_), shortest(row.shunt.imag() * mva_),
                               shortest(std::abs(v_[i])), shortest(degrees), shortest(voltage_v_[i] / 1e3));
        }
        return out;
    }

    std::string generator_rows() const {
        std::string out;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            PowerFlowProblem::Node const& node = problem_.nodes[i];
            NodeKind const is = kind(i);
            if (is == NodeKind::dead ||
                (is == NodeKind::pq && node.kind == NodeKind::pq && node.p == 0 && node.q == 0)) {
                continue;
            }
            Complex const gives = (rows_[i].into + rows_[i].load) * mva_;
            // One generator for all that injects here: the limits hold for those that regulate.
            double const most = node.q_max + node.q, least = node.q_min + node.q;
            out += fmt::format("\t{} {} {} {} {} {} {} 1 {} 0;\n", i + 1, shortest(gives.real()),
                               shortest(gives.imag()), limit(most, mva_), limit(least, mva_), shortest(std::abs(v_[i])),
                               shortest(mva_), shortest(std::max(gives.real(), 0.0)));
        }
        return out;
    }

    std::string names() const {
        std::string out;
        for (std::size_t i = 0; i < rows_.size(); ++i) {
            out += fmt::format("\t'{}';\n", i < network_.buses.size() ? network_.buses[i].name.name : "ideal source");
        }
        return out;
    }

    Network const& network_;
    PowerFlowProblem problem_;
    double mva_;
    std::vector<Row> rows_;
    std::vector<Complex> v_;
    std::vector<double> voltage_v_;
};

} // namespace

std::string to_matpower(Network const& network, SwitchState const& state, PowerFlowOptions const& options,
                        PowerFlow const& solution) {
    return Writer{network, make_problem(network, state, options), solution}.write();
}

} // namespace gridspace::sim
